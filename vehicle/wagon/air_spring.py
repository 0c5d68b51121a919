"""Air spring with a surge reservoir behind a pipe: stiffness, mass and damping of its mechanical equivalent."""

from __future__ import annotations

from dataclasses import dataclass, fields

from wheelrail.vehicle.wagon.components import check

AIR = 287.05 * 293.15  # J/kg, gas constant times 20 degrees Celsius
POLYTROPIC = 1.4  # exponent, without exchange of heat


@dataclass(frozen=True)
class AirSpring:
    """A bag of air on a reservoir behind a pipe, small motions about the static load.

    Parameters:
        pressure: of the air, absolute, Pa.
        area: effective, of the bag, m2: its force by the pressure.
        volume, reservoir: of bag and reservoir, m3.
        pipe_length, pipe_area: m and m2.
        loss: of pressure in pipe and orifice, over density times squared velocity / 2.

    The change of force by the area, which changes with height, is not part of it. Equivalent after M. Berg, Vehicle
    System Dynamics 33 S1 (1999) 528-539, DOI 10.1080/00423114.1999.12063109: a spring beside one in series with a mass
    on a damper. Raises InvalidParameter for values that are not positive, but the loss.
    """

    pressure: float
    area: float
    volume: float
    reservoir: float
    pipe_length: float
    pipe_area: float
    loss: float

    def __post_init__(self) -> None:
        check(self, positive=tuple(f.name for f in fields(self) if f.name != "loss"))

    @property
    def stiffness(self) -> float:
        """With air that passes freely, N/m."""
        return POLYTROPIC * self.pressure * self.area**2 / (self.volume + self.reservoir)

    @property
    def series_stiffness(self) -> float:
        """In addition, with air that does not pass, N/m."""
        return self.stiffness * self.reservoir / self.volume

    @property
    def density(self) -> float:
        """Of the air, kg/m3."""
        return self.pressure / AIR

    @property
    def ratio(self) -> float:
        """Velocity in the pipe over that of the equivalent mass."""
        return self.area / self.pipe_area * self.reservoir / (self.volume + self.reservoir)

    @property
    def mass(self) -> float:
        """Equivalent of the air in the pipe, kg."""
        return self.density * self.pipe_length * self.pipe_area * self.ratio**2

    @property
    def damping(self) -> float:
        """Force over the squared velocity of the mass, N s2/m2."""
        return 0.5 * self.density * self.loss * self.pipe_area * self.ratio**3
