"""Results of a run as variables with units over time and side."""

from __future__ import annotations

from datetime import UTC, datetime
from typing import TYPE_CHECKING, Any

import numpy as np

from wheelrail.contact.kinematics.frames import SIDES
from wheelrail.contact.loading.flexible_wheelset import MIRRORED_HUB, MIRRORED_RAIL
from wheelrail.scenes.datasets.netcdf import machine
from wheelrail.scenes.datasets.patches import means, patch_variables
from wheelrail.support.arrays import Array
from wheelrail.support.version import commit, versions
from wheelrail.vehicle.multibody.plane_wagon import COORDINATES, COUNT, WagonOutputs, outward
from wheelrail.vehicle.track.irregularity import QUANTITIES

if TYPE_CHECKING:
    from xarray import Dataset

    from wheelrail.vehicle.simulation.history import History, RunCost

AXES = ("longitudinal", "lateral", "vertical")
TURNS = ("roll", "spin", "yaw")
IRREGULARITIES = {
    "alignment": "lateral irregularity of the track, positive to the left",
    "level": "vertical irregularity of the track, positive upwards",
    "cross_level": "irregularity of the height of the right rail above the left",
    "gauge": "irregularity of the gauge, positive for widening",
}


def dataset(history: History, *, scene: str = "") -> Dataset:
    """Dataset over time, side (left, right), patch (padded with NaN) and edge (low, high).

    Parameters:
        history: of the run.
        scene: its text.
    """
    from xarray import Dataset

    every: dict[str, Any] = {
        **_motion(history),
        **wheel_variables(history.force[:, 0], history.moment[:, 0], history.approach[:, 0]),
        **patch_variables(
            [patches for row in history.rows for patches in row.patches[0]],
            ("time", "side"),
            (len(history), len(SIDES)),
        ),
        "in_contact": (
            ("time", "side"),
            np.array([row.contact_status[0] for row in history.rows]) == "converged",
            means("1", "whether wheel and rail are in contact"),
        ),
        **cost_variables(history.cost),
    }
    attributes = {
        "title": "Vehicle run on finite-element wheel-rail contact",
        "frame": "moving track frame: x forward, y to the left, z upwards; forces act on the wheels",
        "nominal_radius": history.dynamics.vehicle.radius,
    }
    return Dataset(every, coords=run_coordinates(history), attrs=attributes | run_attributes(history, scene))


def cost_variables(cost: RunCost) -> dict[str, Any]:
    """Call statistics of the contact over side."""
    costs = [cost.contact[side] for side in SIDES]
    return {
        "contact_solves": ("side", [cost.solves for cost in costs], means("1", "contact problems solved")),
        "failed_solves": (
            "side",
            [cost.failed for cost in costs],
            means("1", "contact problems that failed and were repeated"),
        ),
        "newton_iterations": ("side", [cost.newton for cost in costs], means("1", "total Newton iterations")),
        "linear_iterations": ("side", [cost.linear for cost in costs], means("1", "total linear iterations")),
        "contact_seconds": ("side", [cost.seconds for cost in costs], means("s", "time for all contact solves")),
    }


def run_coordinates(history: History) -> dict[str, Any]:
    """Coordinates of every run: time, distance, side, edge of a patch."""
    return {
        "time": ("time", history.time, {"units": "s", "long_name": "time"}),
        "distance": ("time", history.distance, means("m", "distance along the track")),
        "side": ("side", list(SIDES)),
        "edge": ("edge", ["low", "high"]),
    }


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


def irregularity_variables(values: Array | None) -> dict[str, Any]:
    """Irregularities of the track over time; values: (n, 4) m, none on smooth rails."""
    if values is None:
        return {}
    return {
        f"irregularity_{name}": ("time", values[:, index], means("m", IRREGULARITIES[name]))
        for index, name in enumerate(QUANTITIES)
    }


def _motion(history: History) -> dict[str, Any]:
    """Coordinates of the bodies and their rates, and the track."""
    variables: dict[str, Any] = {}
    state, (pitch,) = history.state.copy(), history.dynamics.coordinates.rolling_angles
    state[:, pitch] += history.distance / history.dynamics.vehicle.radius
    state[:, pitch + COUNT] += history.speeds / history.dynamics.vehicle.radius
    for index, name in enumerate(COORDINATES):
        turns = name.endswith(("roll", "pitch"))
        text = name.replace("_", " ") + (", above the nominal height" if name.endswith("z") else "")
        variables[name] = ("time", state[:, index], means("rad" if turns else "m", text))
        rate = state[:, COUNT + index]
        variables[f"{name}_rate"] = ("time", rate, means("rad/s" if turns else "m/s", f"rate of {text}"))
    if history.series.size:
        text = "outward deflection of the series springs of the Maxwell elements, left side, then right side"
        series = outward(history.dynamics, history.series)
        variables["series_deflection"] = (("time", "series"), series, means("m", text))
    variables |= _structure_motion(history)
    variables |= track_variables(history)
    wrenches = np.concatenate([history.force, history.moment], axis=3).sum(axis=2)[:, 0]
    outputs = WagonOutputs.of(history.dynamics, history.time, history.state, wrenches)
    texts = {
        "yaw_reaction": ("N m", "reaction moment of the constrained yaw of the wheelset"),
        "secondary_deflection": (
            "m",
            "displacement of the car body against the bogie at the secondary springs, positive to the left",
        ),
        "bumpstop_deflection": ("m", "deflection of the lateral bumpstop, positive to the left"),
        "bumpstop_force": ("N", "force of the bumpstop on the car body, positive to the left"),
    }
    for name, values in outputs._asdict().items():
        variables[name] = ("time", values, means(*texts[name]))
    return variables


def track_variables(history: History) -> dict[str, Any]:
    """Speed and track at the distance of the reference motion."""
    track, distances = history.dynamics.track, history.distance.tolist()
    irregularities = track.irregularities
    return {
        "speed": ("time", history.speeds, means("m/s", "speed along the track")),
        **irregularity_variables(None if irregularities is None else irregularities.at(history.distance)),
        "curvature": (
            "time",
            np.array([track.curvature(s)[0] for s in distances]),
            means("1/m", "curvature of the track, positive to the left"),
        ),
        "lift": (
            "time",
            np.array([track.superelevation(s)[0] for s in distances]),
            means("m", "height of the right rail above the left"),
        ),
    }


def _structure_motion(history: History) -> dict[str, Any]:
    """Motions of hubs and rails, where they are elastic."""
    structure = history.dynamics.structure
    if structure is None:
        return {}
    elastic, motion = structure.pairs.flexibility, history.motions[:, 0]
    hubs = motion[:, :12].reshape(-1, 2, 6) * [np.ones(6), MIRRORED_HUB]
    rails = motion[:, 12:18].reshape(-1, 2, 3) * [np.ones(3), MIRRORED_RAIL]
    units = {"hub": "m and rad, x, y, z, then about x, y, z", "rail": "m and rad, y, z, then roll about the foot"}
    variables: dict[str, Any] = {}
    if elastic.hubs is not None:
        text = "motion of the hub relative to the line through the journals"
        variables["hub_motion"] = (("time", "side", "hub_component"), hubs, means(units["hub"], text))
    if elastic.rails is not None:
        text = "motion of the rail on its pads"
        variables["rail_motion"] = (("time", "side", "rail_component"), rails, means(units["rail"], text))
    if structure.velocities:
        sleepers = motion[:, 18:22].reshape(-1, 2, 2) * [[1.0, 1.0], [-1.0, 1.0]]
        text = "motion of the sleepers under the wheel, across and normal to the foot of the rail"
        variables["sleeper_motion"] = (("time", "side", "sleeper_component"), sleepers, means("m", text))
    return variables


def wheel_variables(
    force: Array, moment: Array, approach: Array, dimensions: tuple[str, ...] = ("time", "side")
) -> dict[str, Any]:
    """Contact forces on the wheels and moments about the centres of the wheelsets, in the track frame.

    Parameters:
        force, moment: (..., 3) N and N m.
        approach: (...) m.
        dimensions: names of the dimensions (...).
    """
    variables: dict[str, Any] = {}
    for index, (axis, turn) in enumerate(zip(AXES, TURNS, strict=True)):
        variables[f"{axis}_force"] = (dimensions, force[..., index], means("N", f"{axis} contact force on the wheel"))
        text = f"{turn} moment of the contact force about the centre of the wheelset"
        variables[f"{turn}_moment"] = (dimensions, moment[..., index], means("N m", text))
    text = "largest penetration of the undeformed bodies; negative is a gap"
    variables["approach"] = (dimensions, approach, means("m", text))
    return variables
