"""Variables of the results of a run: dimensions, units and meanings."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from wheelrail.contact.kinematics.frames import SIDES
from wheelrail.scenes.datasets.declared import Declared, Schema, check
from wheelrail.scenes.datasets.netcdf import read
from wheelrail.scenes.datasets.patches import BANDS, PATCH_VARIABLES
from wheelrail.scenes.schema.errors import SceneError
from wheelrail.vehicle.multibody.plane_wagon import COORDINATES as WAGON_COORDINATES
from wheelrail.vehicle.multibody.vehicle import COORDINATES as BODY_COORDINATES

if TYPE_CHECKING:
    from xarray import Dataset

AXES = ("longitudinal", "lateral", "vertical")
TURNS = ("roll", "spin", "yaw")
EDGES = ("low", "high")
FARTHEST = 1e7  # m along the track
TIME = ("time",)
BY_BODY = ("time", "body")
BY_ELEMENT = ("time", "element", "axis")
COORDINATE_TEXTS = {
    "x": "displacement forward of the place in the reference motion, with distance and speed",
    "y": "lateral displacement from the centre line of the track at the body's own centre, positive to the left; in a "
    "curve that of a long body contains the rise of its chord",
    "z": "height above the nominal position",
    "roll": "roll about the track direction",
    "pitch": "pitch; of a wheelset in excess of nominal rolling",
    "yaw": "yaw about the track normal, positive to the left",
}
IRREGULARITIES = {
    "alignment": "lateral irregularity of the track, positive to the left",
    "level": "vertical irregularity of the track, positive upwards",
    "cross_level": "irregularity of the height of the right rail above the left",
    "gauge": "irregularity of the gauge, positive for widening",
}
TRACK: Schema = {
    "speed": Declared(TIME, "m/s", "speed along the track"),
    "curvature": Declared(TIME, "1/m", "curvature of the track, positive to the left"),
    "lift": Declared(TIME, "m", "height of the right rail above the left"),
}
COMMON: Schema = {
    "time": Declared(TIME, "s", "time"),
    "distance": Declared(TIME, "m", "distance along the track"),
    "side": Declared(("side",), "", ""),
    "edge": Declared(("edge",), "", ""),
    **TRACK,
    **{f"irregularity_{name}": Declared(TIME, "m", text, needed=False) for name, text in IRREGULARITIES.items()},
    "contact_solves": Declared(("side",), "1", "contact problems solved"),
    "failed_solves": Declared(("side",), "1", "contact problems that failed and were repeated"),
    "newton_iterations": Declared(("side",), "1", "total Newton iterations"),
    "linear_iterations": Declared(("side",), "1", "total linear iterations"),
    "contact_seconds": Declared(("side",), "s", "time for all contact solves"),
}
COMMON_ATTRIBUTES: dict[str, type] = {
    "status": str,
    "scene": str,
    **dict.fromkeys(("speed", "seconds", "steps_accepted", "steps_rejected", "steps_failed", "evaluations"), float),
}


def wheel_schema(by_wheel: tuple[str, ...]) -> Schema:
    """Contact forces on the wheels, their patches and wear; by_wheel: dimensions of a value of each wheel."""
    by_patch = (*by_wheel, "patch")
    forces = {f"{axis}_force": Declared(by_wheel, "N", f"{axis} contact force on the wheel") for axis in AXES}
    about = "moment of the contact force about the centre of the wheelset"
    return {
        **forces,
        **{f"{turn}_moment": Declared(by_wheel, "N m", f"{turn} {about}") for turn in TURNS},
        "approach": Declared(by_wheel, "m", "largest penetration of the undeformed bodies; negative is a gap"),
        "patches": Declared(by_wheel, "1", "number of contact patches"),
        **{name: Declared(by_patch, units, text) for name, (_, _, units, text) in PATCH_VARIABLES.items()},
        **{name: Declared((*by_patch, "edge"), "m", text) for name, text in BANDS.items()},
        "in_contact": Declared(by_wheel, "1", "whether wheel and rail are in contact"),
        "frictional_power": Declared(by_wheel, "W", "frictional power, all patches of a wheel", False),
        "t_gamma": Declared(by_wheel, "N", "T-gamma: frictional energy per metre of track", False),
        "patch_utilisation": Declared(by_patch, "1", "tangential over normal force of the patch", False),
        "patch_load_factor": Declared(by_patch, "1", "peak pressure over the shear yield stress", False),
        "patch_surface_fatigue_index": Declared(
            by_patch, "1", "surface fatigue index, utilisation minus 1 / load factor; above 0: ratcheting", False
        ),
    }


def motion(coordinates: Mapping[str, str], dims: tuple[str, ...]) -> Schema:
    """Coordinates and their rates.

    Parameters:
        coordinates: meanings by name.
        dims: of their values.
    """
    declared: dict[str, Declared] = {}
    for name, text in coordinates.items():
        units = "rad" if name.endswith(("roll", "pitch", "yaw")) else "m"
        declared[name] = Declared(dims, units, text)
        declared[f"{name}_rate"] = Declared(dims, f"{units}/s", f"rate of {text}")
    return declared


WAGON_MOTION = motion(
    {n: n.replace("_", " ") + ", above the nominal height" * n.endswith("z") for n in WAGON_COORDINATES}, TIME
)
BODY_MOTION = motion({f"body_{name}": COORDINATE_TEXTS[name] for name in BODY_COORDINATES}, BY_BODY)
# Names and units of the components of motions.
COMPONENTS: dict[str, tuple[tuple[str, str], ...]] = {
    "hub_component": (("x", "m"), ("y", "m"), ("z", "m"), ("roll", "rad"), ("pitch", "rad"), ("yaw", "rad")),
    "rail_component": (("y", "m"), ("z", "m"), ("roll", "rad")),
    "sleeper_component": (("y", "m"), ("z", "m")),
}
WAGON: Schema = {
    **COMMON,
    **WAGON_MOTION,
    "series_deflection": Declared(
        ("time", "series"),
        "m",
        "outward deflection of the series springs of the Maxwell elements, left side, then right side",
        False,
    ),
    "hub_motion": Declared(
        ("time", "side", "hub_component"),
        "m and rad, x, y, z, then about x, y, z",
        "motion of the hub relative to the line through the journals",
        False,
    ),
    "rail_motion": Declared(
        ("time", "side", "rail_component"),
        "m and rad, y, z, then roll about the foot",
        "motion of the rail on its pads",
        False,
    ),
    "sleeper_motion": Declared(
        ("time", "side", "sleeper_component"),
        "m",
        "motion of the sleepers under the wheel, across and normal to the foot of the rail",
        False,
    ),
    "yaw_reaction": Declared(TIME, "N m", "reaction moment of the constrained yaw of the wheelset"),
    "secondary_deflection": Declared(
        TIME, "m", "displacement of the car body against the bogie at the secondary springs, positive to the left"
    ),
    "bumpstop_deflection": Declared(TIME, "m", "deflection of the lateral bumpstop, positive to the left"),
    "bumpstop_force": Declared(TIME, "N", "force of the bumpstop on the car body, positive to the left"),
    **wheel_schema(("time", "side")),
    "mechanical_energy": Declared(TIME, "J", "kinetic and elastic energy, spin relative to nominal rolling", False),
    "power": Declared(("time", "cause"), "W", "power by cause of change of the mechanical energy", False),
    "work": Declared(("time", "cause"), "J", "work by the same cause since the first sample", False),
    "cause": Declared(("cause",), "", "", False),
}
WAGON_ATTRIBUTES = {**COMMON_ATTRIBUTES, "nominal_radius": float}

BY_WHEEL = ("time", "wheelset", "side")
BY_WHEELSET = ("time", "wheelset")
VEHICLE: Schema = {
    **COMMON,
    "body": Declared(("body",), "", ""),
    "nominal_x": Declared(("body",), "m", "place along the vehicle, forward"),
    "wheelset": Declared(("wheelset",), "", ""),
    "element": Declared(("element",), "", ""),
    "axis": Declared(("axis",), "", ""),
    **BODY_MOTION,
    "series_deflection": Declared(
        ("time", "series"),
        "m",
        "deflection of the series springs of the Maxwell elements, in the order of elements and axes",
        False,
    ),
    **wheel_schema(BY_WHEEL),
    "element_deflection": Declared(
        BY_ELEMENT,
        "m",
        "displacement of the upper point of the element relative to the lower one, in the element's axes",
    ),
    "element_force": Declared(
        BY_ELEMENT, "N", "force of the element on the upper body, static load included, in the element's axes"
    ),
    "applied_torque": Declared(
        BY_WHEELSET, "N m", "torque of motors and brakes on the wheelset about its axle, positive forwards", False
    ),
    "applied_force": Declared(
        ("time", "body", "axis"),
        "N",
        "sum of the applied forces on the body, along the axes of the track section there",
        False,
    ),
    "guiding_force": Declared(BY_WHEEL, "N", "guiding force Y: lateral force on the rail, positive outwards"),
    "derailment_quotient": Declared(BY_WHEEL, "1", "derailment quotient Y/Q; NaN without load"),
    "track_shifting_force": Declared(
        BY_WHEELSET, "N", "sum of Y: lateral force of both wheels on the track, to the right"
    ),
    "axle_load": Declared(BY_WHEELSET, "N", "sum of Q"),
    "wheel_unloading": Declared(BY_WHEEL, "1", "1 - Q / mean static wheel load"),
}
VEHICLE_ATTRIBUTES = {
    **COMMON_ATTRIBUTES,
    "vehicle": str,
    **dict.fromkeys(("nominal_radius", "wheel_y", "mean_wheel_load"), float),
}


def is_of_vehicle(data: Dataset) -> bool:
    """Whether the results are those of a vehicle in three dimensions, with a dimension of wheelsets."""
    return "wheelset" in data.dims


def read_run(file: Path) -> Dataset:
    """Dataset of a run; raises SceneError as `check_run`."""
    data = read(file)
    check_run(data, file)
    return data


def check_run(data: Dataset, file: Path) -> None:
    """Raise SceneError unless a Dataset has what a run writes, naming what is missing or differs.

    Parameters:
        data: Dataset of the file.
        file: for messages.
    """
    if not data.sizes.get("time") or "patches" not in data or not {"body_y", "wheelset_y"} & set(data.variables):
        raise SceneError(f"{file}: must contain results of a run, as run.nc of wheelrail run does")
    of_vehicle = is_of_vehicle(data)
    check(data, file, VEHICLE if of_vehicle else WAGON, VEHICLE_ATTRIBUTES if of_vehicle else WAGON_ATTRIBUTES)
    names = {"side": SIDES, "edge": EDGES, **({"axis": ("x", "y", "z")} if of_vehicle else {})}
    for name, expected in names.items():
        if tuple(data[name].values.tolist()) != tuple(expected):
            raise SceneError(f"{file}: {name}: must be {', '.join(expected)}")
    if not data.sizes["patch"]:
        raise SceneError(f"{file}: patch: without length; must have one place at least")
    time, distance = data["time"].values, data["distance"].values
    if not np.isfinite(time).all() or (np.diff(time) <= 0.0).any():
        raise SceneError(f"{file}: time: must be finite numbers that increase")
    if not (np.abs(distance) <= FARTHEST).all() or (np.diff(distance) < 0.0).any():
        raise SceneError(f"{file}: distance: must be numbers up to {FARTHEST:g} m that do not decrease")
    for name in (*TRACK, *(BODY_MOTION if of_vehicle else WAGON_MOTION)):
        if not np.isfinite(data[name].values).all():
            raise SceneError(f"{file}: {name}: must be finite numbers")
    if of_vehicle:
        _check_names(data, file)


def _check_names(data: Dataset, file: Path) -> None:
    """Raise SceneError unless bodies have names of their own, and wheelsets are among them."""
    bodies, wheelsets = data["body"].values.tolist(), data["wheelset"].values.tolist()
    if len(set(bodies)) < len(bodies):
        raise SceneError(f"{file}: body: must be different names")
    if not wheelsets or not set(wheelsets) <= set(bodies):
        raise SceneError(f"{file}: wheelset: must be names of bodies, one at least")
