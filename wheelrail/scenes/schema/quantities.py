"""Quantities of a scene: strict numbers in SI units, each with its plausible range.

A range detects wrong units and typing errors; it is no engineering limit. What is allowed, but unusual, is listed in a
warning.
"""

from __future__ import annotations

from dataclasses import dataclass
from math import inf, isnan
from typing import Annotated, Any, Literal, TypeVar

from pydantic import AllowInfNan, GetCoreSchemaHandler, Strict
from pydantic_core import CoreSchema, PydanticCustomError, core_schema

T = TypeVar("T")


def reject(message: str, key: str = "") -> PydanticCustomError:
    """Validation error of an entry; message: what is allowed, key: of the entry."""
    return PydanticCustomError("scene", "{allowed}", {"allowed": message, "key": key})


SHARPEST = 15.0  # m, radius of a track's curve


@dataclass(frozen=True)
class Range:
    """Numbers from low to high in a unit (ends excluded if open), with a hint at the common mistake; usual: narrower
    range, outside which a value is listed as unusual.
    """

    low: float
    high: float
    unit: str = ""
    hint: str = ""
    open: bool = False
    whole: bool = False
    usual: tuple[float, float] = (-inf, inf)

    def __str__(self) -> str:
        if self.low == 0.0 and self.high == inf:
            text = f"greater than 0 {self.unit}"
        elif self.open:
            text = f"between {self.low:g} and {self.high:g} {self.unit}".rstrip() + ", ends excluded"
        else:
            text = f"from {self.low:g} to {self.high:g} {self.unit}"
        kind = "a whole number " if self.whole else "a number "
        return kind + text.rstrip() + (f" ({self.hint})" if self.hint else "")

    def remark(self, value: float) -> str:
        """Text about an unusual value; empty for a usual one."""
        low, high = self.usual
        if low <= value <= high:
            return ""
        text = f"at most {high:g}" if low == -inf else f"from {low:g} to {high:g}"
        return f"unusual, mostly {text} {self.unit}".rstrip() + (f" ({self.hint})" if self.hint else "")

    def check(self, value: float) -> float:
        if self.low < value < self.high or (not self.open and value in (self.low, self.high)):
            return value
        raise reject(f"must be {self}")

    def __get_pydantic_core_schema__(self, source: Any, handler: GetCoreSchemaHandler) -> CoreSchema:
        return core_schema.no_info_after_validator_function(self.check, handler(source))


@dataclass(frozen=True)
class Principal(Range):
    """A principal radius of curvature."""

    def __str__(self) -> str:
        return "a radius with magnitude from 1e-4 to 100 m: inf is straight, negative is concave"

    def check(self, value: float) -> float:
        if isnan(value) or not (1e-4 <= abs(value) <= 100.0 or abs(value) == inf):
            raise reject(f"must be {self}")
        return value


@dataclass(frozen=True)
class CurveRadii(Range):
    """The radius of a track's curve."""

    def __str__(self) -> str:
        return f"a radius with magnitude at least {SHARPEST:g} m, positive to the left"

    def check(self, value: float) -> float:
        if not abs(value) >= SHARPEST:
            raise reject(f"must be {self}")
        return value


@dataclass(frozen=True)
class OrExact(Range):
    """A constant of a regularised law, or its limit, the exact law."""

    exact: float = 0.0

    def __str__(self) -> str:
        return f"{super().__str__()}; or {self.exact:g}, the exact law"

    def check(self, value: float) -> float:
        return value if value == self.exact else super().check(value)


@dataclass(frozen=True)
class AtMost:
    """Arrays of at most so many values, whose cost is proportional to their number."""

    count: int

    def __get_pydantic_core_schema__(self, source: Any, handler: GetCoreSchemaHandler) -> CoreSchema:
        return core_schema.no_info_before_validator_function(self.check, handler(source))

    def check(self, values: T) -> T:
        if isinstance(values, list | tuple) and len(values) > self.count:
            raise reject(f"has {len(values)} values: must have at most {self.count}")
        return values


class WholeNumber:
    """Whole numbers only: `Literal[1, 2]` alone admits true and 2.0, which are equal to one of its values."""

    def __get_pydantic_core_schema__(self, source: Any, handler: GetCoreSchemaHandler) -> CoreSchema:
        return core_schema.no_info_before_validator_function(self.check, handler(source))

    def check(self, value: Any) -> Any:
        return value if type(value) is int or value is None else repr(value)


Finite = Annotated[float, Strict(), AllowInfNan(False)]

Young = Annotated[Finite, Range(1e9, 1e13, "Pa", "steel is 2.1e11; not in GPa or MPa")]
Poisson = Annotated[Finite, Range(-1.0, 0.5, open=True)]
ShearYield = Annotated[Finite, Range(5e7, 2e9, "Pa", "rail steel is about 300e6")]
Friction = Annotated[Finite, Range(0.0, 2.0, hint="0 skips the tangential problem", usual=(-inf, 0.8))]
SurfaceSize = Annotated[Finite, Range(5e-5, 1e-2, "m", "half a millimetre is 0.5e-3")]
BlockWidth = Annotated[Finite, Range(1e-3, 1e2, "m", "about 40 semi-axes of the patch")]
Growth = Annotated[Finite, Range(0.02, 2.0, hint="0.2 is fine, 1 is coarse")]
MergeDistance = Annotated[Finite, Range(1e-4, 5e-2, "m", "4 mm is 4e-3")]
StiffnessPerArea = Annotated[float, Strict(), AllowInfNan(True), OrExact(1e10, 1e20, "N/m3", exact=inf)]
Regularisation = Annotated[Finite, OrExact(1e-9, 1e-2, hint="a creepage")]
Share = Annotated[Finite, Range(0.0, 1.0)]
FallingRate = Annotated[Finite, Range(0.0, 100.0, "s/m", "per slip velocity, some tenths for dry rails")]
Shift = Annotated[Finite, Range(-1e-3, 1e-3, "m", "2 µm is 2e-6")]
Creepage = Annotated[Finite, Range(-1.0, 1.0, hint="slip velocity over rolling speed", usual=(-0.1, 0.1))]
Spin = Annotated[Finite, Range(-1e3, 1e3, "rad/m")]
Load = Annotated[Finite, Range(1e-3, 1e8, "N")]
WheelLoad = Annotated[Finite, Range(1.0, 1e6, "N", "57 kN is 57e3", usual=(20e3, 300e3))]
AxleLoad = Annotated[Finite, Range(1.0, 2e6, "N", "114 kN is 114e3", usual=(40e3, 600e3))]
Approach = Annotated[Finite, Range(1e-10, 5e-3, "m", "25 µm is 25e-6")]
Speed = Annotated[Finite, Range(1e-3, 200.0, "m/s", "162 km/h is 45 m/s", usual=(-inf, 100.0))]
KickVelocity = Annotated[Finite, Range(-5.0, 5.0, "m/s", "to the left")]
RunSpeed = Annotated[Finite, Range(0.1, 200.0, "m/s", "162 km/h is 45 m/s", usual=(-inf, 100.0))]
Radius = Annotated[float, Strict(), AllowInfNan(True), Principal(-inf, inf)]
WheelRadius = Annotated[
    Finite, Range(0.1, 1.0, "m", "a wheel diameter of 920 mm is a radius of 0.46", usual=(0.15, 0.7))
]
Offset = Annotated[Finite, Range(-0.1, 0.1, "m", "2 mm is 0.002")]
Diameter = Annotated[Finite, Range(0.02, 0.5, "m", "160 mm is 0.160")]
Bore = Annotated[Finite, Range(0.0, 0.3, "m", "of a hollow axle: 30 mm is 0.030; 0 is solid")]
AxlePlace = Annotated[Finite, Range(0.0, 2.0, "m", "from the middle of the axle", open=True)]
PadStiffness = Annotated[Finite, Range(1e5, 1e12, "N/m", "of one pad: 100 kN/mm is 100e6")]
SleeperLength = Annotated[Finite, Range(1.0, 5.0, "m")]
SleeperMass = Annotated[Finite, Range(1.0, 1e4, "kg", "of half a sleeper")]
BallastStiffness = Annotated[Finite, Range(1e5, 1e12, "N/m", "under half a sleeper: 80 kN/mm is 80e6")]
TrackDamping = Annotated[Finite, Range(1.0, 1e8, "N s/m", "30 kN s/m is 30e3")]
PadLength = Annotated[Finite, Range(0.0, 2.0, "m", "along the rail: 18 cm is 0.18", open=True)]
SleeperPlace = Annotated[Finite, Range(0.0, 2.0, "m", "from a sleeper along the track")]
PadSpacing = Annotated[Finite, Range(0.05, 2.0, "m", "of the sleepers: 60 cm is 0.6")]
TableWidth = Annotated[Finite, Range(1e-3, 2e-2, "m", "5 mm is 5e-3: before the flange")]
TableAngle = Annotated[Finite, Range(5e-4, 5e-2, "rad", "5 mrad is 5e-3")]
TableLoad = Annotated[Finite, Range(1e3, 1e6, "N", "of a wheel: 200 kN is 200e3")]
TableTolerance = Annotated[Finite, Range(1e-3, 0.1)]
Angle = Annotated[Finite, Range(-0.2, 0.2, "rad", "1/40 is 0.025")]
Rate = Annotated[Finite, Range(-1e3, 1e3, "per second")]
Curvature = Annotated[Finite, Range(-0.067, 0.067, "1/m", "1/radius, positive to the left")]
Gauge = Annotated[Finite, Range(0.5, 2.0, "m", "1435 mm is 1.435")]
GaugeHeight = Annotated[Finite, Range(0.0, 0.05, "m", "below the top of the rail: 14 mm is 0.014", open=True)]
FlangeBackDistance = Annotated[Finite, Range(0.4, 2.0, "m", "1360 mm is 1.360")]
FlangeBack = Annotated[Finite, Range(-0.2, -0.01, "m", "from the rolling circle, negative to the flange side")]
Noise = Annotated[Finite, Range(0.0, 1e-3, "m", "5 µm is 5e-6; 0 interpolates")]
RollingCircle = Annotated[Finite, Range(-0.5, 0.5, "m", "70 mm is 0.07")]
PointScale = Annotated[Finite, Range(1e-6, 1e6, hint="factor of the points of a file")]
PointShift = Annotated[Finite, Range(-10.0, 10.0, "m", "10 mm is 0.01")]
Section = Annotated[int, Strict(), Range(1, 1000, whole=True)]
Cant = Annotated[Finite, Range(-0.25, 0.25, "m", "60 mm is 0.06; positive raises the outer rail")]
Flangeway = Annotated[Finite, Range(0.02, 0.2, "m", "41 mm is 0.041", usual=(-inf, 0.08))]
CheckRailHeight = Annotated[Finite, Range(-0.03, 0.1, "m", "above the top of the running rail: 20 mm is 0.02")]
EdgeRounding = Annotated[Finite, Range(1e-3, 0.05, "m", "10 mm is 0.010")]
BackHeight = Annotated[Finite, Range(0.0, 0.05, "m", "beyond the rolling circle: 9.5 mm is 0.0095")]
CheckRailStiffness = Annotated[
    float, Strict(), AllowInfNan(True), OrExact(1e5, 1e12, "N/m", "50 kN/mm is 50e6", exact=inf)
]
Widening = Annotated[Finite, Range(0.0, 0.05, "m", "of the gauge: 15 mm is 0.015")]
Distance = Annotated[Finite, Range(0.0, 1e5, "m", "along the track")]
FrictionFactor = Annotated[Finite, Range(0.01, 10.0, hint="on the coefficient of friction: a third is 0.33")]
CantBase = Annotated[Finite, Range(0.5, 2.5, "m", "1.5 for standard gauge")]
Slope = Annotated[Finite, Range(-0.1, 0.1, hint="rise over run: 10 per mille is 0.01")]
Length = Annotated[Finite, Range(0.0, 1e5, "m")]
Depth = Annotated[Finite, Range(5e-5, 0.1, "m", "below the surface: 2 mm is 2e-3")]
OneOrTwo = Annotated[Literal[1, 2], WholeNumber()]
Threads = Annotated[int, Strict(), Range(1, 64, whole=True)]
Strips = Annotated[int, Strict(), Range(4, 64, whole=True)]
Cells = Annotated[int, Strict(), Range(6, 64, whole=True)]
Steps = Annotated[int, Strict(), Range(0, 100_000, whole=True)]
Tolerance = Annotated[Finite, Range(1e-12, 0.1)]
CurveRadius = Annotated[Finite, CurveRadii(-inf, inf)]
VerticalRadius = Annotated[Finite, Range(100.0, 1e6, "m")]
Wavelength = Annotated[Finite, Range(0.1, 1e3, "m")]
JointAngle = Annotated[Finite, Range(1e-4, 0.05, "rad", "between the rails' ends: 4 mrad is 4e-3", open=True)]
JointLength = Annotated[Finite, Range(0.05, 5.0, "m", "on either side")]
Fade = Annotated[Finite, Range(1e-3, 1e3, "m", "over which irregularities are faded in")]
Chord = Annotated[Finite, Range(0.1, 100.0, "m")]
Seed = Annotated[int, Strict(), Range(0, 2**63, whole=True)]
Time = Annotated[Finite, Range(0.0, 1e5, "s")]
TimeAndSpeed = Annotated[tuple[Time, RunSpeed], Strict(False)]
