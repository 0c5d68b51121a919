"""A quantity given along the track, or over time: constant pieces joined by smooth ramps."""

from __future__ import annotations

from bisect import bisect_right
from dataclasses import dataclass
from itertools import accumulate, pairwise
from typing import Literal, get_args

Shape = Literal["quintic", "clothoid", "bloss"]


def quintic(u: float) -> tuple[float, float, float]:
    """10 u3 - 15 u4 + 6 u5 on 0..1 with first and second derivative: both vanish at the ends."""
    return u**3 * (10 + u * (6 * u - 15)), 30 * u**2 * (1 - u) ** 2, 60 * u * (1 - u) * (1 - 2 * u)


def bloss(u: float) -> tuple[float, float, float]:
    """3 u2 - 2 u3 on 0..1 with first and second derivative: the slope vanishes at the ends, the bend jumps by 6."""
    return u * u * (3 - 2 * u), 6 * u * (1 - u), 6 - 12 * u


def rounded(u: float, corner: float) -> tuple[float, float, float]:
    """Straight ramp on 0..1 whose slope grows and fades as 3 x2 - 2 x3 over `corner` (up to 0.5) at both ends."""
    if u > 0.5:
        value, slope, bend = rounded(1.0 - u, corner)
        return 1.0 - value, slope, -bend
    steep = 1.0 / (1.0 - corner)
    if u >= corner:
        return steep * (u - 0.5 * corner), steep, 0.0
    x = u / corner
    return steep * corner * x**3 * (1 - 0.5 * x), steep * x * x * (3 - 2 * x), steep * 6 * x * (1 - x) / corner


def below(u: float, shape: Shape, corner: float) -> float:
    """Area under a ramp from 0 to u; every ramp is odd about its middle, so that it is 1/2 in all."""
    if shape == "quintic":
        return u**4 * (2.5 + u * (u - 3))
    if shape == "bloss":
        return u**3 * (1 - 0.5 * u)
    if u > 0.5:
        return u - 0.5 + below(1.0 - u, shape, corner)
    steep = 1.0 / (1.0 - corner)
    if u >= corner:
        return steep * (corner**2 * (0.25 - 0.1) + 0.5 * (u - corner) * u)
    x = u / corner
    return steep * corner**2 * x**4 * (0.25 - 0.1 * x)


@dataclass(frozen=True)
class PiecewiseFunction:
    """A function of distance s through (stations, values), constant outside, with its first two derivatives.

    stations m, rising strictly; shape of all ramps, or of each. "quintic" has no jump up to the second derivative;
    "bloss" has a finite one in the second, which the track frame's roll acceleration follows: a stepper sees it as a
    step of the load and needs nothing else; "clothoid" is the straight ramp with its corners rounded over `corner` m (a
    sharp one would need an infinite roll acceleration). Over time, read s for m. Raises ValueError for stations that do
    not rise or corners that do not fit into the ramps.
    """

    stations: tuple[float, ...]
    values: tuple[float, ...]
    shape: Shape | tuple[Shape, ...] = "quintic"
    corner: float = 3.0

    def __post_init__(self) -> None:
        s, v = self.stations, self.values
        if len(s) != len(v) or not s:
            raise ValueError("a course needs as many values as stations, one at least")
        lengths = [b - a for a, b in pairwise(s)]
        if any(length <= 0.0 for length in lengths):
            raise ValueError(f"stations must rise strictly: {s}")
        if isinstance(self.shape, tuple) and len(self.shape) != len(lengths):
            raise ValueError("a course needs one shape, or one between any two stations")
        for shape in self.shape if isinstance(self.shape, tuple) else (self.shape,):
            if shape not in get_args(Shape):
                raise ValueError(f"shape {shape!r}: {', '.join(get_args(Shape)[:-1])} or {get_args(Shape)[-1]}")
        ramps = [d for i, d in enumerate(lengths) if self.shape_of(i) == "clothoid" and v[i] != v[i + 1]]
        if not all(0.0 < self.corner <= 0.5 * d for d in ramps):
            raise ValueError(f"corner {self.corner} m: positive and at most half of each ramp {ramps}")

    @classmethod
    def constant(cls, value: float) -> PiecewiseFunction:
        return cls((0.0,), (value,))

    def shape_of(self, ramp: int) -> Shape:
        return self.shape[ramp] if isinstance(self.shape, tuple) else self.shape

    @property
    def breaks(self) -> tuple[float, ...]:
        """Where one smooth piece ends and the next begins, m."""
        inner = set(self.stations)
        for i, (a, b) in enumerate(pairwise(self.stations)):
            if self.shape_of(i) == "clothoid":
                inner |= {a + self.corner, b - self.corner}
        return tuple(sorted(inner))

    def __call__(self, s: float) -> tuple[float, float, float]:
        """Value, first and second derivative by s."""
        i = bisect_right(self.stations, s)
        if i in (0, len(self.stations)):
            return self.values[max(i - 1, 0)], 0.0, 0.0
        start, length = self.stations[i - 1], self.stations[i] - self.stations[i - 1]
        base, rise = self.values[i - 1], self.values[i] - self.values[i - 1]
        if rise == 0.0:
            return base, 0.0, 0.0
        u, shape = (s - start) / length, self.shape_of(i - 1)
        if shape == "clothoid":
            value, slope, bend = rounded(u, self.corner / length)
        else:
            value, slope, bend = quintic(u) if shape == "quintic" else bloss(u)
        return base + rise * value, rise * slope / length, rise * bend / length**2

    def integral(self, s: float) -> float:
        """Exact integral from 0 to s."""
        return self.values[0] * s if len(self.stations) == 1 else self._area(s) - self._area(0.0)

    def _area(self, s: float) -> float:
        """Integral from the first station to s."""
        stations, v = self.stations, self.values
        i = bisect_right(stations, s)
        if i == 0:
            return v[0] * (s - stations[0])
        widths = [b - a for a, b in pairwise(stations)]
        done = list(accumulate((0.5 * d * (a + b) for d, a, b in zip(widths, v, v[1:], strict=False)), initial=0.0))
        part, start = s - stations[i - 1], v[i - 1]
        if i == len(stations):
            return done[-1] + start * part
        width, rise = widths[i - 1], v[i] - start
        ramp = below(part / width, self.shape_of(i - 1), self.corner / width) if rise else 0.0
        return done[i - 1] + start * part + rise * width * ramp
