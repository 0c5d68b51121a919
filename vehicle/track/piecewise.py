"""Piecewise functions of distance or time: constant pieces joined by smooth ramps."""

from __future__ import annotations

from bisect import bisect_right
from dataclasses import dataclass
from functools import cached_property
from itertools import accumulate, pairwise
from typing import Literal, get_args

Shape = Literal["quintic", "clothoid", "bloss"]
SHORTEST = 1e-6  # m or s, of a ramp: squares of much shorter ones vanish


def quintic(u: float) -> tuple[float, float, float]:
    """10 u3 - 15 u4 + 6 u5 on 0..1 with first and second derivative: both vanish at the ends."""
    return u**3 * (10 + u * (6 * u - 15)), 30 * u**2 * (1 - u) ** 2, 60 * u * (1 - u) * (1 - 2 * u)


def bloss(u: float) -> tuple[float, float, float]:
    """3 u2 - 2 u3 on 0..1 with first and second derivative: the first vanishes at the ends, the second jumps by 6."""
    return u * u * (3 - 2 * u), 6 * u * (1 - u), 6 - 12 * u


def rounded(u: float, corner: float) -> tuple[float, float, float]:
    """Linear ramp on 0..1 with first and second derivative; over `corner` (up to 0.5) at both ends the slope varies as
    3 x2 - 2 x3.
    """
    if u > 0.5:
        value, slope, curvature = rounded(1.0 - u, corner)
        return 1.0 - value, slope, -curvature
    steep = 1.0 / (1.0 - corner)
    if u >= corner:
        return steep * (u - 0.5 * corner), steep, 0.0
    x = u / corner
    return steep * corner * x**3 * (1 - 0.5 * x), steep * x * x * (3 - 2 * x), steep * 6 * x * (1 - x) / corner


def ramp_integral(u: float, shape: Shape, corner: float) -> float:
    """Integral of a ramp from 0 to u; 1/2 at u = 1, as every ramp is antisymmetric about its middle.

    Parameters:
        u: 0 to 1.
        shape: of the ramp.
        corner: of a clothoid, as in `rounded`.
    """
    if shape == "quintic":
        return u**4 * (2.5 + u * (u - 3))
    if shape == "bloss":
        return u**3 * (1 - 0.5 * u)
    if u > 0.5:
        return u - 0.5 + ramp_integral(1.0 - u, shape, corner)
    steep = 1.0 / (1.0 - corner)
    if u >= corner:
        return steep * (corner**2 * (0.25 - 0.1) + 0.5 * (u - corner) * u)
    x = u / corner
    return steep * corner**2 * x**4 * (0.25 - 0.1 * x)


@dataclass(frozen=True)
class PiecewiseFunction:
    """A function of distance through (stations, values), constant outside, with its first two derivatives.

    Parameters:
        stations: (n,) m (s for functions of time), strictly increasing.
        values: (n,).
        shape: of all ramps, or (n - 1,) of each. "quintic": continuous second derivative; "bloss": finite jumps of the
            second derivative, hence of the roll acceleration of the track frame, a step of the load that the
            integrator resolves; "clothoid": linear ramp with rounded corners (sharp ones would imply an infinite roll
            acceleration).
        corner: length of the rounded corners of a "clothoid", m.

    Raises ValueError for stations that do not increase, ramps below a micrometre, or corners longer than half a ramp.
    """

    stations: tuple[float, ...]
    values: tuple[float, ...]
    shape: Shape | tuple[Shape, ...] = "quintic"
    corner: float = 3.0

    def __post_init__(self) -> None:
        for name in ("stations", "values"):  # of compiled functions the type decides
            object.__setattr__(self, name, tuple(float(x) for x in getattr(self, name)))
        s, v = self.stations, self.values
        if len(s) != len(v) or not s:
            raise ValueError(f"{len(v)} values for {len(s)} stations: must be as many, one at least")
        lengths = [b - a for a, b in pairwise(s)]
        if any(length <= 0.0 for length in lengths):
            raise ValueError(f"stations {s}: must increase strictly")
        for i, length in enumerate(lengths):
            if length < SHORTEST and v[i] != v[i + 1]:
                raise ValueError(f"a ramp of {length:g}: must be at least {SHORTEST:g}")
        if isinstance(self.shape, tuple) and len(self.shape) != len(lengths):
            raise ValueError(f"{len(self.shape)} shapes for {len(lengths)} ramps: must be one for all, or one for each")
        for shape in self.shape if isinstance(self.shape, tuple) else (self.shape,):
            if shape not in get_args(Shape):
                raise ValueError(f"shape {shape!r}: must be {', '.join(get_args(Shape)[:-1])} or {get_args(Shape)[-1]}")
        ramps = [d for i, d in enumerate(lengths) if self.shape_of(i) == "clothoid" and v[i] != v[i + 1]]
        if not all(0.0 < self.corner <= 0.5 * d for d in ramps):
            raise ValueError(f"corner {self.corner} m: must be positive and at most half of each ramp, {ramps} m")

    @classmethod
    def constant(cls, value: float) -> PiecewiseFunction:
        return cls((0.0,), (value,))

    def shape_of(self, ramp: int) -> Shape:
        return self.shape[ramp] if isinstance(self.shape, tuple) else self.shape

    @property
    def breaks(self) -> tuple[float, ...]:
        """Boundaries between smooth pieces, m."""
        breaks = set(self.stations)
        for i, (a, b) in enumerate(pairwise(self.stations)):
            if self.shape_of(i) == "clothoid":
                breaks |= {a + self.corner, b - self.corner}
        return tuple(sorted(breaks))

    def __call__(self, s: float) -> tuple[float, float, float]:
        """Value, first and second derivative at s."""
        i = bisect_right(self.stations, s)
        if i in (0, len(self.stations)):
            return self.values[max(i - 1, 0)], 0.0, 0.0
        start, length = self.stations[i - 1], self.stations[i] - self.stations[i - 1]
        base, rise = self.values[i - 1], self.values[i] - self.values[i - 1]
        if rise == 0.0:
            return base, 0.0, 0.0
        u, shape = (s - start) / length, self.shape_of(i - 1)
        if shape == "clothoid":
            value, slope, curvature = rounded(u, self.corner / length)
        else:
            value, slope, curvature = quintic(u) if shape == "quintic" else bloss(u)
        return base + rise * value, rise * slope / length, rise * curvature / length**2

    def integral(self, s: float) -> float:
        """Exact integral from 0 to s."""
        return self.values[0] * s if len(self.stations) == 1 else self._area(s) - self._area(0.0)

    @cached_property
    def _areas(self) -> list[float]:
        """Integrals from the first station to each: every ramp has the mean of its ends."""
        lengths = [b - a for a, b in pairwise(self.stations)]
        means = [0.5 * (a + b) for a, b in pairwise(self.values)]
        return list(accumulate((d * mean for d, mean in zip(lengths, means, strict=True)), initial=0.0))

    def _area(self, s: float) -> float:
        """Integral from the first station to s."""
        stations, v = self.stations, self.values
        i = bisect_right(stations, s)
        if i == 0:
            return v[0] * (s - stations[0])
        distance, start = s - stations[i - 1], v[i - 1]
        if i == len(stations):
            return self._areas[-1] + start * distance
        width, rise = stations[i] - stations[i - 1], v[i] - start
        ramp = ramp_integral(distance / width, self.shape_of(i - 1), self.corner / width) if rise else 0.0
        return self._areas[i - 1] + start * distance + rise * width * ramp
