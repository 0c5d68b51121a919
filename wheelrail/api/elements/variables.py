"""Numbers that a host program exchanges with the contact element of a wheelset: one table for arrays, C and FMI.

The order of a list is the order in arrays; a name is a valid identifier in C, Fortran and Python.
"""

from __future__ import annotations

from dataclasses import dataclass

from wheelrail.contact.kinematics.frames import SIDES
from wheelrail.contact.kinematics.wheelset_state import WheelsetState


@dataclass(frozen=True)
class Variable:
    """A number with its unit.

    Parameters:
        name: in all languages.
        unit: SI; "1" for numbers without unit.
        description: one sentence without full stop.
    """

    name: str
    unit: str
    description: str


_COORDINATES = (
    Variable("y", "m", "lateral position of the wheelset's centre, to the left"),
    Variable("z", "m", "height of the wheelset's centre above the nominal one"),
    Variable("roll", "rad", "rotation about the x axis after yaw"),
    Variable("yaw", "rad", "rotation about z"),
    Variable("y_rate", "m/s", "time derivative of y"),
    Variable("z_rate", "m/s", "time derivative of z"),
    Variable("roll_rate", "rad/s", "time derivative of roll"),
    Variable("yaw_rate", "rad/s", "time derivative of yaw"),
    Variable("pitch_rate", "rad/s", "spin about the axle, positive when rolling forward"),
)
assert tuple(variable.name for variable in _COORDINATES) == WheelsetState.coordinates

INPUTS = (
    *_COORDINATES,
    Variable("speed", "m/s", "of the track frame along the track"),
    *(Variable(f"frame_rate_{axis}", "rad/s", f"of the track frame about its axis {axis}") for axis in "xyz"),
    *(
        Variable(f"{side}_rail_{axis}", "m", f"displacement of the {side} rail along {axis} by irregularities")
        for side in SIDES
        for axis in "yz"
    ),
)

FORCES = tuple(
    Variable(f"{side}_{kind}{axis}", unit, f"{text} along {axis} on the {side} wheel, in the axes of the track{about}")
    for side in SIDES
    for kind, unit, text, about in (
        ("F", "N", "contact force", ""),
        ("M", "N.m", "moment of the contact force", ", about the wheelset's centre"),
    )
    for axis in "xyz"
)
OUTPUTS = (
    *FORCES,
    *(
        Variable(f"{side}_approach", "m", f"largest penetration of the undeformed {side} pair, negative is a gap")
        for side in SIDES
    ),
)

# Of the patch with the largest normal force of a side.
PATCH = (
    Variable("count", "1", "number of patches of the side"),
    Variable("area", "m2", "area of the patch"),
    Variable("max_pressure", "Pa", "largest pressure"),
    Variable("normal_force", "N", "normal force"),
    Variable("tangential_x", "N", "longitudinal force in the plane of contact"),
    Variable("tangential_y", "N", "lateral force in the plane of contact"),
    Variable("semi_axis_x", "m", "semi-axis along x of the ellipse with the same second moments of pressure"),
    Variable("semi_axis_y", "m", "semi-axis across x"),
    Variable("contact_angle", "rad", "rotation of the plane of contact about x"),
    Variable("wheel_y", "m", "lateral position on the wheel's profile, positive to the field side"),
    Variable("rail_y", "m", "lateral position on the rail's profile, positive to the field side"),
    Variable("stick_area", "m2", "area of adhesion"),
    Variable("frictional_power", "W", "power of the tractions over the rigid slip"),
)

PARAMETERS = tuple(Variable(f"{side}_friction", "1", f"coefficient of friction of the {side} pair") for side in SIDES)
