"""Tables of vehicle files: bodies, suspension elements, rotational springs, vehicles of a train."""

from __future__ import annotations

from math import inf
from typing import Annotated, Literal

from pydantic import AllowInfNan, Field, Strict

from wheelrail.scenes.schema import quantities as q
from wheelrail.scenes.schema.tables import SceneTable

# Keys of an element that are those of `SuspensionElement`.
ELEMENT_VALUES = {
    "upper", "lower", "series_stiffness", "turn", "friction", "friction_coefficient", "friction_stiffness",
    "surge_mass", "surge_exponent",
}  # fmt: skip

Mass = Annotated[q.Finite, q.Range(1.0, 1e6, "kg", "1 t is 1000", usual=(100.0, 2e5))]
Inertia = Annotated[q.Finite, q.Range(1.0, 1e9, "kg m2")]
Along = Annotated[q.Finite, q.Range(-2000.0, 2000.0, "m", "forward of the vehicle's reference point")]
Across = Annotated[q.Finite, q.Range(-5.0, 5.0, "m", "to the left")]
Height = Annotated[q.Finite, q.Range(0.05, 5.0, "m", "above top of rail")]
Point = Annotated[tuple[Along, Across, Height], Strict(False)]
LawPoint = Annotated[tuple[q.Finite, q.Finite], Strict(False)]
LawPoints = Annotated[tuple[LawPoint, ...], Strict(False), Field(min_length=2), q.AtMost(1000)]
Stiffness = Annotated[q.Finite, q.Range(0.0, 1e11, "N/m", "or points [m, N]")]
Damping = Annotated[q.Finite, q.Range(0.0, 1e9, "N s/m", "or points [m/s, N]")]
Series = Annotated[float, Strict(), AllowInfNan(True), q.Range(1e3, inf, "N/m, in series with the damper; inf is none")]
Friction = Annotated[q.Finite, q.Range(0.0, 1e7, "N, at which a slider moves")]
FrictionCoefficient = Annotated[q.Finite, q.Range(0.0, 10.0, "of the vertical spring force, in addition to friction")]
FrictionStiffness = Annotated[q.Finite, q.Range(0.0, 1e11, "N/m, in series with the slider")]
SurgeMass = Annotated[q.Finite, q.Range(0.0, 1e6, "kg, between damper and series_stiffness")]
Exponent = Annotated[q.Finite, q.Range(1.0, 3.0, "of the velocity of surge_mass in the force of the damper")]
RotationalDamping = Annotated[q.Finite, q.Range(0.0, 1e9, "N m s/rad")]
Rotational = Annotated[q.Finite, q.Range(0.0, 1e10, "N m/rad")]
TorsionDamping = Annotated[q.Finite, q.Range(0.0, 1e9, "N m s/rad")]


Coordinate = Literal["x", "y", "z", "roll", "pitch", "yaw"]


class VehicleBodyTable(SceneTable):
    """A rigid body: mass, kg, inertia about x, y and z, kg m2, place of its centre, m.

    The height of a wheelset is its rolling radius. Independent wheels turn by themselves, with a spring, N m/rad, and a
    damper, N m s/rad, between them as torsion. Held coordinates follow the track at constant speed.
    """

    mass: Mass
    inertia: Annotated[tuple[Inertia, Inertia, Inertia], Strict(False)]
    x: Along
    height: Height
    wheelset: bool = False
    independent: bool = False
    torsion: Annotated[tuple[Rotational, TorsionDamping], Strict(False)] = (0.0, 0.0)
    held: Annotated[tuple[Coordinate, ...], Strict(False)] = ()


class AirSpringTable(SceneTable):
    """Air spring on a reservoir behind a pipe, which adds to the vertical values of an element.

    Absolute pressure, Pa, effective area, m2, volumes, m3, length, m, and area, m2, of the pipe, and its loss of
    pressure over the dynamic pressure.
    """

    pressure: Annotated[q.Finite, q.Range(1e5, 2e6, "Pa, absolute")]
    area: Annotated[q.Finite, q.Range(1e-3, 2.0, "m2")]
    volume: Annotated[q.Finite, q.Range(1e-4, 1.0, "m3, of the bag")]
    reservoir: Annotated[q.Finite, q.Range(1e-4, 2.0, "m3")]
    pipe_length: Annotated[q.Finite, q.Range(0.01, 20.0, "m")]
    pipe_area: Annotated[q.Finite, q.Range(1e-6, 0.1, "m2")]
    loss: Annotated[q.Finite, q.Range(0.0, 1e4, "of pressure, over the dynamic pressure in the pipe")]


class ElementTable(SceneTable):
    """Equal springs and dampers between two bodies, one at each point, m; values along x, y and z.

    Rods go from a point of `lower_points` to one of `points`; their first values act along them. A bushing has moments,
    N m/rad and N m s/rad about the axes of the lower body, too.
    """

    upper: str
    lower: str
    points: Annotated[tuple[Point, ...], Strict(False), Field(min_length=1), q.AtMost(1000)]
    stiffness: Annotated[tuple[Stiffness | LawPoints, Stiffness | LawPoints, Stiffness | LawPoints], Strict(False)] = (
        0.0,
        0.0,
        0.0,
    )
    damping: Annotated[tuple[Damping | LawPoints, Damping | LawPoints, Damping | LawPoints], Strict(False)] = (
        0.0,
        0.0,
        0.0,
    )
    series_stiffness: Annotated[tuple[Series, Series, Series], Strict(False)] = (inf, inf, inf)
    turn: q.Share = 0.0
    friction: Annotated[tuple[Friction, Friction, Friction], Strict(False)] = (0.0, 0.0, 0.0)
    friction_coefficient: Annotated[
        tuple[FrictionCoefficient, FrictionCoefficient, FrictionCoefficient], Strict(False)
    ] = (0.0, 0.0, 0.0)
    friction_stiffness: Annotated[tuple[FrictionStiffness, FrictionStiffness, FrictionStiffness], Strict(False)] = (
        0.0,
        0.0,
        0.0,
    )
    surge_mass: Annotated[tuple[SurgeMass, SurgeMass, SurgeMass], Strict(False)] = (0.0, 0.0, 0.0)
    surge_exponent: Annotated[tuple[Exponent, Exponent, Exponent], Strict(False)] = (1.0, 1.0, 1.0)
    lower_points: Annotated[tuple[Point, ...], Strict(False), q.AtMost(1000)] = ()
    rotational_stiffness: Annotated[tuple[Rotational, Rotational, Rotational], Strict(False)] = (0.0, 0.0, 0.0)
    rotational_damping: Annotated[tuple[RotationalDamping, RotationalDamping, RotationalDamping], Strict(False)] = (
        0.0,
        0.0,
        0.0,
    )
    air_spring: AirSpringTable | None = None


class RotationalSpringTable(SceneTable):
    """Moments about the axes of the lower body, N m/rad and N m s/rad about x, y and z."""

    upper: str
    lower: str
    stiffness: Annotated[tuple[Rotational, Rotational, Rotational], Strict(False)]
    damping: Annotated[tuple[RotationalDamping, RotationalDamping, RotationalDamping], Strict(False)] = (0.0, 0.0, 0.0)


class SpeedHoldTable(SceneTable):
    """Spring, N/m, and damper, N s/m, along the track that keep a body at its place in the reference motion."""

    body: str
    stiffness: Stiffness = 2e5
    damping: Damping = 1e5


class CoupledVehicleTable(SceneTable):
    """A vehicle of a train: its file, and the place of its reference point, m; turned end for end or not."""

    file: str
    x: Annotated[q.Finite, q.Range(-2000.0, 2000.0, "m", "forward of the train's reference point")]
    turned: bool = False


class VehicleFileTable(SceneTable):
    """A vehicle file after its types have been filled in.

    Parts of `vehicles` have the name of their vehicle ahead of theirs. Texts of their files may stand in `files`.
    """

    vehicles: dict[str, CoupledVehicleTable] = Field(default_factory=dict)
    files: dict[str, str] = Field(default_factory=dict)
    bodies: dict[str, VehicleBodyTable]
    elements: dict[str, ElementTable]
    rotational_springs: dict[str, RotationalSpringTable] = Field(default_factory=dict)
    speed_hold: SpeedHoldTable | None = None
    wheel_y: Annotated[q.Finite, q.Range(0.2, 1.5, "m", "half the distance of the rolling circles")] = 0.75
    gravity: Annotated[q.Finite, q.Range(0.0, 30.0, "m/s2")] = 9.81
