"""Results of a run as variables with units over time and side."""

from __future__ import annotations

from datetime import UTC, datetime
from typing import TYPE_CHECKING, Any

import numpy as np

from wheelrail.contact.kinematics.frames import SIDES
from wheelrail.contact.loading.flexible_wheelset import MIRRORED_HUB, MIRRORED_RAIL
from wheelrail.scenes.datasets.declared import filled
from wheelrail.scenes.datasets.netcdf import machine
from wheelrail.scenes.datasets.patches import patch_variables
from wheelrail.scenes.datasets.run_schema import AXES, EDGES, TURNS, WAGON
from wheelrail.support.arrays import Array
from wheelrail.support.version import commit, versions
from wheelrail.vehicle.multibody.plane_wagon import COORDINATES, COUNT, WagonOutputs, outward
from wheelrail.vehicle.track.irregularity import QUANTITIES

if TYPE_CHECKING:
    from xarray import Dataset

    from wheelrail.vehicle.simulation.history import History, RunCost


def dataset(history: History, *, scene: str = "") -> Dataset:
    """Dataset over time, side (left, right), patch (padded with NaN) and edge (low, high).

    Parameters:
        history: of the run.
        scene: its text.
    """
    from xarray import Dataset

    values = {
        **_motion(history),
        **wheel_values(history.force[:, 0], history.moment[:, 0], history.approach[:, 0]),
        "in_contact": np.array([row.contact_status[0] for row in history.rows]) == "converged",
        **cost_values(history.cost),
        **run_coordinates(history),
    }
    patches = patch_variables(
        [patches for row in history.rows for patches in row.patches[0]], ("time", "side"), (len(history), len(SIDES))
    )
    attributes = {
        "title": "Vehicle run on finite-element wheel-rail contact",
        "frame": "moving track frame: x forward, y to the left, z upwards; forces act on the wheels",
        "nominal_radius": history.dynamics.vehicle.radius,
    }
    data = Dataset(filled(WAGON, values) | patches, attrs=attributes | run_attributes(history, scene))
    return data.set_coords("distance")


def cost_values(cost: RunCost) -> dict[str, Any]:
    """Call statistics of the contact by side."""
    costs = [cost.contact[side] for side in SIDES]
    return {
        "contact_solves": [cost.solves for cost in costs],
        "failed_solves": [cost.failed for cost in costs],
        "newton_iterations": [cost.newton for cost in costs],
        "linear_iterations": [cost.linear for cost in costs],
        "contact_seconds": [cost.seconds for cost in costs],
    }


def run_coordinates(history: History) -> dict[str, Any]:
    """Coordinates of every run: time, distance, side, edge of a patch."""
    return {"time": history.time, "distance": history.distance, "side": list(SIDES), "edge": list(EDGES)}


def run_attributes(history: History, scene: str) -> dict[str, Any]:
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
        "versions": ", ".join(f"{name} {number}" for name, number in versions().items()),
        "commit": commit(),
        "machine": machine(),
        "created": datetime.now(UTC).isoformat(timespec="seconds"),
    }


def _motion(history: History) -> dict[str, Any]:
    """Coordinates of the bodies and their rates, and the track."""
    state, (pitch,) = history.state.copy(), history.dynamics.coordinates.rolling_angles
    state[:, pitch] += history.distance / history.dynamics.vehicle.radius
    state[:, pitch + COUNT] += history.speeds / history.dynamics.vehicle.radius
    values: dict[str, Any] = {}
    for index, name in enumerate(COORDINATES):
        values[name], values[f"{name}_rate"] = state[:, index], state[:, COUNT + index]
    if history.series.size:
        values["series_deflection"] = outward(history.dynamics, history.series)
    wrenches = np.concatenate([history.force, history.moment], axis=3).sum(axis=2)[:, 0]
    outputs = WagonOutputs.of(history.dynamics, history.time, history.state, wrenches)
    return values | _structure_motion(history) | track_values(history) | outputs._asdict()


def track_values(history: History) -> dict[str, Any]:
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
    """Motions of hubs and rails, where they are elastic."""
    structure = history.dynamics.structure
    if structure is None:
        return {}
    elastic, motion = structure.pairs.flexibility, history.motions[:, 0]
    values: dict[str, Any] = {}
    if elastic.hubs is not None:
        values["hub_motion"] = motion[:, :12].reshape(-1, 2, 6) * [np.ones(6), MIRRORED_HUB]
    if elastic.rails is not None:
        values["rail_motion"] = motion[:, 12:18].reshape(-1, 2, 3) * [np.ones(3), MIRRORED_RAIL]
    if structure.velocities:
        values["sleeper_motion"] = motion[:, 18:22].reshape(-1, 2, 2) * [[1.0, 1.0], [-1.0, 1.0]]
    return values


def wheel_values(force: Array, moment: Array, approach: Array) -> dict[str, Any]:
    """Contact forces on the wheels and moments about the centres of the wheelsets, in the track frame.

    Parameters:
        force, moment: (..., 3) N and N m.
        approach: (...) m.
    """
    values = {f"{axis}_force": force[..., index] for index, axis in enumerate(AXES)}
    values |= {f"{turn}_moment": moment[..., index] for index, turn in enumerate(TURNS)}
    return values | {"approach": approach}
