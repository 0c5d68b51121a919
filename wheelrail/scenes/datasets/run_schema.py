"""Variables of the results of a run: dimensions, units and meanings."""

from __future__ import annotations

from typing import TYPE_CHECKING

from wheelrail.scenes.datasets.declared import Declared, Schema
from wheelrail.scenes.datasets.patches import BANDS, PATCH_VARIABLES
from wheelrail.vehicle.multibody.plane_wagon import HELD

if TYPE_CHECKING:
    from xarray import DataArray, Dataset

AXES = ("longitudinal", "lateral", "vertical")
TURNS = ("roll", "spin", "yaw")
EDGES = ("low", "high")
FORM = 2  # of results, their attribute; those of the plane wagon without it have no bodies, wheelsets and elements
TIME = ("time",)
BY_BODY = ("time", "body")
BY_ELEMENT = ("time", "element", "axis")
BY_WHEEL = ("time", "wheelset", "side")
BY_WHEELSET = ("time", "wheelset")
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
MOTION: Schema = {
    f"body_{name}{rate}": Declared(BY_BODY, units + per, f"rate of {text}" if rate else text)
    for (name, text), units in zip(COORDINATE_TEXTS.items(), 3 * ("m",) + 3 * ("rad",), strict=True)
    for rate, per in (("", ""), ("_rate", "/s"))
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


# Names and units of the components of motions.
COMPONENTS: dict[str, tuple[tuple[str, str], ...]] = {
    "hub_component": (("x", "m"), ("y", "m"), ("z", "m"), ("roll", "rad"), ("pitch", "rad"), ("yaw", "rad")),
    "rail_component": (("y", "m"), ("z", "m"), ("roll", "rad")),
    "sleeper_component": (("y", "m"), ("z", "m")),
}
RUN: Schema = {
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
    "contact_seconds": Declared(("side",), "s", "time for all contact solves, of all threads"),
    "body": Declared(("body",), "", ""),
    "nominal_x": Declared(("body",), "m", "place along the vehicle, forward"),
    "wheelset": Declared(("wheelset",), "", ""),
    "element": Declared(("element",), "", ""),
    "axis": Declared(("axis",), "", ""),
    **MOTION,
    "series_deflection": Declared(
        ("time", "series"),
        "m",
        "deflection of the series springs of the Maxwell elements, in the order of elements and axes",
        False,
    ),
    "hub_motion": Declared(
        (*BY_WHEEL, "hub_component"),
        "m and rad, x, y, z, then about x, y, z",
        "motion of the hub relative to the line through the journals",
        False,
    ),
    "rail_motion": Declared(
        (*BY_WHEEL, "rail_component"),
        "m and rad, y, z, then roll about the foot",
        "motion of the rail on its pads",
        False,
    ),
    "sleeper_motion": Declared(
        (*BY_WHEEL, "sleeper_component"),
        "m",
        "motion of the sleepers under the wheel, across and normal to the foot of the rail",
        False,
    ),
    "yaw_reaction": Declared(BY_WHEELSET, "N m", "reaction moment of the held yaw of the wheelset", False),
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
    "mechanical_energy": Declared(TIME, "J", "kinetic and elastic energy, spin relative to nominal rolling", False),
    "power": Declared(("time", "cause"), "W", "power by cause of change of the mechanical energy", False),
    "work": Declared(("time", "cause"), "J", "work by the same cause since the first sample", False),
    "cause": Declared(("cause",), "", "", False),
}
ATTRIBUTES: dict[str, type] = {
    **dict.fromkeys(("status", "scene", "vehicle"), str),
    **dict.fromkeys(("speed", "seconds", "steps_accepted", "steps_rejected", "steps_failed", "evaluations"), float),
    **dict.fromkeys(("nominal_radius", "wheel_y", "mean_wheel_load"), float),
}


def is_of_wagon(data: Dataset) -> bool:
    """Whether the results are those of the plane wagon of the scene, which have no text of a vehicle file."""
    return not data.attrs["vehicle"]


def of_wagon(data: Dataset, name: str) -> DataArray:
    """Values over time, and side, of a quantity of the plane wagon by its name.

    Parameters:
        data: Dataset of a run.
        name: of a coordinate, as "car_body_y", of a variable of the wheels, or "bumpstop_force".
    """
    body, _, coordinate = name.rpartition("_")
    if name == "bumpstop_force":
        return data["element_force"].sel(element="bumpstop", axis="y", drop=True)
    if body in HELD:
        values = data[f"body_{coordinate}"].sel(body=body, drop=True)
        return values.assign_attrs(long_name=f"{body.replace('_', ' ')}: {values.attrs['long_name']}")
    return data[name].squeeze(["wheelset"] if "wheelset" in data[name].dims else [], drop=True)
