"""Results of a run as variables with units over time, body, wheelset and side."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from wheelrail.contact.kinematics.frames import SIDES
from wheelrail.contact.loading.flexible_wheelset import MIRRORED_HUB, MIRRORED_RAIL
from wheelrail.scenes.datasets.netcdf import provenance
from wheelrail.scenes.datasets.patches import patch_variables
from wheelrail.scenes.datasets.run_derived import guiding_variables, on_check_rails, wear
from wheelrail.scenes.datasets.run_file import FORM
from wheelrail.scenes.quantities import AXES, EDGES, RUN, TURNS
from wheelrail.scenes.quantity import filled
from wheelrail.support.arrays import Array
from wheelrail.vehicle.multibody.coordinates import PITCH, YAW
from wheelrail.vehicle.multibody.vehicle import COORDINATES
from wheelrail.vehicle.track.irregularity import QUANTITIES

if TYPE_CHECKING:
    from xarray import Dataset

    from wheelrail.vehicle.simulation.history import History, RunCost


def dataset(history: History, *, scene: str = "", vehicle: str = "", shear_yield: float = 300e6) -> Dataset:
    """Dataset over time, body, wheelset, side (left, right), element, axis, patch (padded with NaN), edge (low, high).

    Parameters:
        history: of the run.
        scene: its text.
        vehicle: text of the vehicle file; empty for the plane wagon of the scene.
        shear_yield: yield stress in shear, Pa, for the shakedown map.
    """
    from xarray import Dataset

    own, (deflections, forces) = history.dynamics.vehicle, history.suspension()
    wheels = [patches for row in history.rows for pair in row.patches for patches in pair]
    values = {
        **_motion(history),
        **_structure_motion(history),
        **_track(history),
        **_wheels(history.force, history.moment, history.approach),
        "in_contact": np.array([row.contact_status for row in history.rows]) == "converged",
        "element_deflection": deflections,
        "element_force": forces,
        **_applied(history),
        **_costs(history.cost),
        "time": history.time,
        "distance": history.distance,
        "side": list(SIDES),
        "edge": list(EDGES),
        "body": list(own.names),
        "nominal_x": [body.x for body in own.bodies.values()],
        "wheelset": list(own.wheelsets),
        "element": list(own.elements),
        "axis": ["x", "y", "z"],
    }
    patches = patch_variables(wheels, RUN, (len(history), len(own.wheelsets), len(SIDES)))
    attributes = {
        "title": "Run of a vehicle on elastic wheel-rail contact",
        "form": FORM,
        "frame": "track frame of each body at its own distance: x forward, y to the left, z upwards; forces act on the "
        "wheels",
        "vehicle": vehicle,
        "wheel_y": own.wheel_y,
        "nominal_radius": own.radius,
        "mean_wheel_load": own.mean_wheel_load,
    }
    data = Dataset(filled(RUN, values) | patches, attrs=attributes | _attributes(history, scene))
    data = data.set_coords(["distance", "nominal_x"])
    return data.assign(wear(data, shear_yield)).assign(guiding_variables(data)).assign(on_check_rails(data))


def _costs(cost: RunCost) -> dict[str, Any]:
    """Call statistics of the contact by side."""
    costs = [cost.contact[side] for side in SIDES]
    return {
        "contact_solves": [cost.solves for cost in costs],
        "failed_solves": [cost.failed for cost in costs],
        "newton_iterations": [cost.newton for cost in costs],
        "linear_iterations": [cost.linear for cost in costs],
        "contact_seconds": [cost.seconds for cost in costs],
    }


def _attributes(history: History, scene: str) -> dict[str, Any]:
    """Status, statistics and provenance of every run; scene: its text."""
    steps = history.cost.steps
    return {
        "status": history.status,
        "speed": float(history.speeds[0]),
        "seconds": history.cost.seconds,
        "steps_accepted": steps.accepted,
        "steps_rejected": steps.rejected,
        "steps_failed": steps.failed,
        "evaluations": steps.evaluations,
        "scene": scene,
        **provenance(),
    }


def _motion(history: History) -> dict[str, Any]:
    """Coordinates of the bodies and their rates, and the reactions of held yaw."""
    values: dict[str, Any] = {}
    position, rate, series = history.motion
    for index, name in enumerate(COORDINATES):
        values[f"body_{name}"], values[f"body_{name}_rate"] = position[..., index], rate[..., index]
    d, wrenches = history.dynamics, np.concatenate([history.force, history.moment], axis=3).sum(axis=2)
    if d.coordinates.held[d.coordinates.wheelset_bodies, YAW].all():
        rows = zip(history.rows, wrenches, strict=True)
        values["yaw_reaction"] = [d.yaw_reactions(row.time, row.state, wrench) for row, wrench in rows]
    if d.twists:
        mean = rate[:, d.coordinates.wheelset_bodies, PITCH] + history.speeds[:, None] / d.vehicle.radius
        values["wheel_spin"] = mean[..., None] + d.twists.spins(history.state)
    return values | ({"series_deflection": series} if series.size else {})


def _applied(history: History) -> dict[str, Any]:
    """Torques and forces on the vehicle, where there are any."""
    loads = history.dynamics.loads
    if not loads:
        return {}
    torque, force = history.applied()
    torques = {"applied_torque": torque} if loads.torques else {}
    return torques | ({"applied_force": force} if loads.forces else {})


def _track(history: History) -> dict[str, Any]:
    """Speed and track at the distance of the reference motion."""
    track, distances = history.dynamics.track, history.distance.tolist()
    values: dict[str, Any] = {
        "speed": history.speeds,
        "curvature": np.array([track.curvature(s)[0] for s in distances]),
        "lift": np.array([track.superelevation(s)[0] for s in distances]),
    }
    if track.irregularities is not None:
        columns = track.irregularities.at(history.distance).T
        values |= {f"irregularity_{name}": column for name, column in zip(QUANTITIES, columns, strict=True)}
    return values


def _structure_motion(history: History) -> dict[str, Any]:
    """Motions of elastic hubs and rails, if any; NaN of wheelsets without."""
    structures, values = history.dynamics.structures, dict[str, Array]()
    for i, structure, states in structures.elastic:
        elastic, motion = structure.pairs.flexibility, history.motions[:, states] @ structure.of_sides
        for name, moves, first, mirrored in (
            ("hub_motion", elastic.hubs is not None, 0, MIRRORED_HUB),
            ("rail_motion", elastic.rails is not None, 12, MIRRORED_RAIL),
            ("sleeper_motion", structure.velocities > 0, 18, MIRRORED_RAIL[:2]),
        ):
            if moves:
                size = len(mirrored)
                own = motion[:, first : first + 2 * size].reshape(-1, 2, size) * [np.ones(size), mirrored]
                rigid = np.full((len(history), len(structures.own), 2, size), np.nan)
                values.setdefault(name, rigid)[:, i] = own
    return values


def _wheels(force: Array, moment: Array, approach: Array) -> dict[str, Any]:
    """Contact forces on the wheels and moments about the centres of the wheelsets, in the track frame.

    Parameters:
        force, moment: (..., 3) N and N m.
        approach: (...) m.
    """
    values = {f"{axis}_force": force[..., index] for index, axis in enumerate(AXES)}
    values |= {f"{turn}_moment": moment[..., index] for index, turn in enumerate(TURNS)}
    return values | {"approach": approach}
