"""Results of a run as named variables with units, left and right as a coordinate."""

from __future__ import annotations

from datetime import UTC, datetime
from typing import TYPE_CHECKING, Any

import numpy as np

from contact.pose import SIDES
from scenes.netcdf import versions
from vehicle.irregularity import QUANTITIES
from vehicle.state import COORDINATES, COUNT

if TYPE_CHECKING:
    from xarray import Dataset

    from vehicle.history import History

AXES = ("longitudinal", "lateral", "vertical")
TURNS = ("roll", "spin", "yaw")
# Variable: attribute of the patch, index in it or None, unit, meaning.
PATCH_VARIABLES: dict[str, tuple[str, int | None, str, str]] = {
    "patch_area": ("area", None, "m2", "area of the patch"),
    "patch_max_pressure": ("max_pressure", None, "Pa", "peak pressure of the patch"),
    "patch_normal_force": ("normal_force", None, "N", "normal force of the patch"),
    "patch_longitudinal_force": ("tangential_force", 0, "N", "tangential force on the wheel, forward"),
    "patch_lateral_force": (
        "tangential_force",
        1,
        "N",
        "tangential force on the wheel in the contact plane, to the left",
    ),
    "patch_semi_axis_x": ("semi_axes", 0, "m", "semi-axis along the track of the ellipse of the same second moments"),
    "patch_semi_axis_y": ("semi_axes", 1, "m", "semi-axis across"),
    "patch_contact_angle": ("contact_angle", None, "rad", "turn of the contact plane about the track"),
    "patch_stick_area": ("stick_area", None, "m2", "area that sticks"),
    "patch_longitudinal_creepage": ("creepage", 0, "1", "creepage of the wheel, forward, at the patch's resultant"),
    "patch_lateral_creepage": ("creepage", 1, "1", "creepage of the wheel in the contact plane, to the left"),
    "patch_spin": ("creepage", 2, "rad/m", "spin creepage of the wheel, about the patch's upward normal"),
    "patch_frictional_power": ("frictional_power", None, "W", "power of friction that turns into heat"),
    "patch_x": ("x", None, "m", "position of the resultant along the track"),
    "wheel_s": ("wheel_s", None, "m", "arc length on the wheel's profile from the rolling circle, to the field side"),
    "rail_s": ("rail_s", None, "m", "arc length on the rail's profile from its top as laid, to the field side"),
    "wheel_y": ("wheel_y", None, "m", "lateral position on the wheel from the rolling circle, to the field side"),
    "rail_y": ("rail_y", None, "m", "lateral position on the rail from its top as laid, to the field side"),
}
BANDS = {
    "wheel_band": "lateral extent of the patch on the wheel, from the rolling circle, to the field side",
    "rail_band": "lateral extent of the patch on the rail, from its top as laid, to the field side",
}

IRREGULARITIES = {
    "alignment": "irregularity of the track to the left",
    "level": "irregularity of the track upwards",
    "cross_level": "irregularity of the height of the right rail over the left",
    "gauge": "irregularity of the gauge, wider",
}


def dataset(history: History, *, scene: str = "") -> Dataset:
    """The history as a Dataset over time, side (left, right), patch (padded with NaN) and edge (low, high)."""
    from xarray import Dataset

    costs = [history.cost.contact[side] for side in SIDES]
    every: dict[str, Any] = {
        **_motion(history),
        **_forces(history),
        **_patches(history),
        "in_contact": (
            ("time", "side"),
            np.array(history.contact_status) == "converged",
            _means("1", "wheel touches rail"),
        ),
        "contact_solves": ("side", [cost.solves for cost in costs], _means("1", "contact problems solved")),
        "failed_solves": ("side", [cost.failed for cost in costs], _means("1", "of these, failed and tried again")),
        "newton_iterations": ("side", [cost.newton for cost in costs], _means("1", "Newton iterations in all")),
        "linear_iterations": ("side", [cost.linear for cost in costs], _means("1", "linear iterations in all")),
        "contact_seconds": ("side", [cost.seconds for cost in costs], _means("s", "time for all contact solves")),
    }
    coordinates = {
        "time": ("time", history.time, {"units": "s", "long_name": "time"}),
        "distance": ("time", history.distance, _means("m", "distance along the track")),
        "side": ("side", list(SIDES)),
        "edge": ("edge", ["low", "high"]),
    }
    steps = history.cost.steps
    attributes = {
        "title": "Vehicle run on finite-element wheel-rail contact",
        "frame": "moving with the track: x forward, y to the left, z up; forces act on the wheels",
        "status": history.status,
        "speed": float(history.speeds[0]),
        "nominal_radius": history.radius,
        "seconds": history.cost.seconds,
        "steps_accepted": steps.accepted,
        "steps_rejected": steps.rejected,
        "steps_failed": steps.failed,
        "evaluations": steps.evaluations,
        "scene": scene,
        "versions": ", ".join(f"{name} {number}" for name, number in versions().items()),
        "created": datetime.now(UTC).isoformat(timespec="seconds"),
    }
    return Dataset(every, coords=coordinates, attrs=attributes)


def _means(units: str, long_name: str) -> dict[str, str]:
    return {"units": units, "long_name": long_name}


def _motion(history: History) -> dict[str, Any]:
    """Coordinates of the bodies and their rates, the track below them."""
    found: dict[str, Any] = {}
    state = history.state.copy()
    state[:, 9] += history.distance / history.radius
    state[:, 9 + COUNT] += history.speeds / history.radius
    for index, name in enumerate(COORDINATES):
        turns = name.endswith(("roll", "pitch"))
        text = name.replace("_", " ") + (", from the nominal height" if name.endswith("z") else "")
        found[name] = ("time", state[:, index], _means("rad" if turns else "m", text))
        rate = state[:, COUNT + index]
        found[f"{name}_rate"] = ("time", rate, _means("rad/s" if turns else "m/s", f"rate of {text}"))
    if history.series_deflection.size:
        text = "deflection outwards of the springs in series with dampers, of the left side, then of the right side"
        found["series_deflection"] = (("time", "series"), history.series_deflection, _means("m", text))
    found["speed"] = ("time", history.speeds, _means("m/s", "speed along the track"))
    if history.irregularities is not None:
        for index, name in enumerate(QUANTITIES):
            found[f"irregularity_{name}"] = (
                "time",
                history.irregularities[:, index],
                _means("m", IRREGULARITIES[name]),
            )
    for source, name, units, text in (
        (history, "curvature", "1/m", "curvature of the track, positive to the left"),
        (history, "lift", "m", "height of the right rail over the left"),
        (history.outputs, "yaw_reaction", "N m", "moment that replaces the yaw freedom of the wheelset"),
        (history.outputs, "secondary_deflection", "m", "car body against bogie at the secondary springs, to the left"),
        (history.outputs, "bumpstop_deflection", "m", "deflection of the lateral bumpstop, to the left"),
        (history.outputs, "bumpstop_force", "N", "force of the bumpstop on the car body, to the left"),
    ):
        found[name] = ("time", getattr(source, name), _means(units, text))
    return found


def _forces(history: History) -> dict[str, Any]:
    """Contact forces on the wheels and moments about the wheelset's centre, in the track's axes."""
    by_side = ("time", "side")
    found: dict[str, Any] = {}
    for index, (axis, turn) in enumerate(zip(AXES, TURNS, strict=True)):
        found[f"{axis}_force"] = (
            by_side,
            history.outputs.force[:, :, index],
            _means("N", f"{axis} contact force on the wheel"),
        )
        text = f"{turn} moment of the contact force about the wheelset's centre"
        found[f"{turn}_moment"] = (by_side, history.outputs.moment[:, :, index], _means("N m", text))
    found["approach"] = (
        by_side,
        history.outputs.approach,
        _means("m", "largest undeformed overlap; negative is a gap"),
    )
    return found


def _patches(history: History) -> dict[str, Any]:
    """Values of every patch; a patch keeps its place in the list of its sample only."""
    counts = np.array([[len(patches) for patches in pair] for pair in history.patches], dtype=int).reshape(-1, 2)
    present = np.arange(max(1, counts.max(initial=0))) < counts[:, :, None]
    listed = [patch for pair in history.patches for patches in pair for patch in patches]
    by_patch = ("time", "side", "patch")
    found: dict[str, Any] = {"patches": (by_patch[:2], counts, _means("1", "number of contact patches"))}
    for name, (attribute, index, units, text) in PATCH_VARIABLES.items():
        values = [getattr(patch, attribute) for patch in listed]
        filled = np.full(present.shape, np.nan)
        filled[present] = values if index is None else [value[index] for value in values]
        found[name] = (by_patch, filled, _means(units, text))
    for name, text in BANDS.items():
        filled = np.full((*present.shape, 2), np.nan)
        filled[present] = np.array([getattr(patch, name) for patch in listed]).reshape(-1, 2)
        found[name] = ((*by_patch, "edge"), filled, _means("m", text))
    return found
