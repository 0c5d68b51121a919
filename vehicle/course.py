"""A quantity given along the track: constant pieces joined by smooth ramps."""

from __future__ import annotations

from bisect import bisect_right
from dataclasses import dataclass
from itertools import pairwise
from typing import Literal

Shape = Literal["quintic", "clothoid"]


def quintic(u: float) -> tuple[float, float, float]:
    """10 u3 - 15 u4 + 6 u5 on 0..1 with first and second derivative: both vanish at the ends."""
    return u**3 * (10 + u * (6 * u - 15)), 30 * u**2 * (1 - u) ** 2, 60 * u * (1 - u) * (1 - 2 * u)


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


@dataclass(frozen=True)
class Course:
    """A function of distance s through (stations, values), constant outside, with its first two derivatives.

    stations m, rising strictly. shape "quintic" has no jump up to the second derivative; "clothoid" is the straight
    ramp with its corners rounded over `corner` m (a sharp one would need an infinite roll acceleration of the track
    frame). Raises ValueError for stations that do not rise or corners that do not fit into the ramps.
    """

    stations: tuple[float, ...]
    values: tuple[float, ...]
    shape: Shape = "quintic"
    corner: float = 3.0

    def __post_init__(self) -> None:
        s, v = self.stations, self.values
        if len(s) != len(v) or not s:
            raise ValueError("a course needs as many values as stations, one at least")
        lengths = [b - a for a, b in pairwise(s)]
        if any(length <= 0.0 for length in lengths):
            raise ValueError(f"stations must rise strictly: {s}")
        if self.shape not in ("quintic", "clothoid"):
            raise ValueError(f"shape {self.shape!r}: quintic or clothoid")
        ramps = [d for d, a, b in zip(lengths, v, v[1:], strict=False) if a != b]
        if self.shape == "clothoid" and not all(0.0 < self.corner <= 0.5 * d for d in ramps):
            raise ValueError(f"corner {self.corner} m: positive and at most half of each ramp {ramps}")

    @classmethod
    def constant(cls, value: float) -> Course:
        return cls((0.0,), (value,))

    @property
    def breaks(self) -> tuple[float, ...]:
        """Where one smooth piece ends and the next begins, m."""
        if self.shape == "quintic":
            return self.stations
        inner = (s + d for s in self.stations for d in (-self.corner, 0.0, self.corner))
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
        u = (s - start) / length
        value, slope, bend = quintic(u) if self.shape == "quintic" else rounded(u, self.corner / length)
        return base + rise * value, rise * slope / length, rise * bend / length**2
