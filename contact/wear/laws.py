"""Laws of wear: removed volume per contact area and length of travel of a cell, dimensionless.

Dissipation q is the frictional energy -tau . w of a cell per area and length of travel, Pa, with the slip w over the
speed. Sliding under pressure p |w| is q / mu, also for contacts whose bound of the traction is not mu p (FASTSIM).
"""

from __future__ import annotations

from dataclasses import dataclass, fields
from math import isfinite
from typing import Any, ClassVar

import numpy as np

from wheelrail.support.arrays import Array, Mask

HARDNESS = 2.7e9  # Pa, of wheel steel
DENSITY = 7850.0  # kg/m3
ROUNDED = 0.1  # of a limit between regimes: width over which one goes over into the other
USFD_UNIT = 1e-3  # kg/m3 in 1 ug/(m mm2)

Points = tuple[tuple[float, float], ...]


@dataclass(frozen=True)
class SlidingCells:
    """Loaded cells of a contact.

    Parameters:
        pressure: (n,) Pa.
        dissipation: q (n,) Pa, not negative.
        friction: mu (n,), coefficient of friction; positive.
        velocity: (n,) m/s, of the slip.
        speed: m/s, of travel.
        t_gamma: (n,) N, of the patch of the cell.
    """

    pressure: Array
    dissipation: Array
    friction: Array
    velocity: Array
    speed: float
    t_gamma: Array


@dataclass(frozen=True, kw_only=True)
class Zone:
    """Part of a profile with a factor of its wear, such as a lubricated flange.

    Parameters:
        factor: not negative.
        angle: rad, smallest and largest contact angle, without sign; limits are rounded.
        s: m, smallest and largest arc length on the wheel. Both may be given; one must be.

    Raises ValueError.
    """

    factor: float
    angle: tuple[float, float] | None = None
    s: tuple[float, float] | None = None

    def __post_init__(self) -> None:
        _numbers("zone", self, factor=0.0)
        if self.angle is None and self.s is None:
            raise ValueError("zone: needs angle = [smallest, largest] rad or s = [smallest, largest] m")
        for name, unit, low in (("angle", "rad", 0.0), ("s", "m", -np.inf)):
            limits = getattr(self, name)
            if limits is None:
                continue
            pair = np.shape(limits) == (2,) and all(_number(limit) for limit in limits)
            if not (pair and low <= limits[0] < limits[1]):
                least = "" if low < 0 else " of at least 0"
                raise ValueError(f"zone: {name} = {limits}: must be two ascending numbers{least}, {unit}")

    def factors(self, angle: Array, s: Array, width: Array) -> Array:
        """Factor (m,) of strips at contact angles (m,) rad and arc lengths (m,) m with widths (m,) m."""
        inside = np.ones(len(s))
        if self.angle is not None:
            low, high = self.angle
            inside = (_beyond(angle, low) if low > 0.0 else inside) - _beyond(angle, high)
        if self.s is not None:
            common = np.minimum(s + 0.5 * width, self.s[1]) - np.maximum(s - 0.5 * width, self.s[0])
            inside = inside * np.clip(common / width, 0.0, 1.0)
        return np.asarray(1.0 + (self.factor - 1.0) * inside)


@dataclass(frozen=True, kw_only=True)
class WearLaw:
    """A law of wear.

    Parameters:
        scale: factor of all rates, from calibration.
        zones: factors by place; those that overlap multiply.

    Raises ValueError for coefficients that are not positive numbers. `source` cites the coefficients; `unsure` says
    which ones were not compared with it; `remark` says what its severe branch means. Coefficients are fields.
    """

    scale: float = 1.0
    zones: tuple[Zone, ...] = ()

    source: ClassVar[str] = ""
    unsure: ClassVar[str] = ""
    remark: ClassVar[str] = ""

    def __post_init__(self) -> None:
        names = {part.name for part in fields(self)} - {"zones", "points"}
        _numbers("law", self, **dict.fromkeys(sorted(names), np.nextafter(0.0, 1.0)))

    def rate(self, cells: SlidingCells) -> Array:
        """Removed volume (n,) per contact area and length of travel, without scale and zones."""
        raise NotImplementedError

    def severe(self, cells: SlidingCells) -> Mask:
        """Mask (n,) of cells in the severe branch."""
        return np.zeros(len(cells.pressure), dtype=bool)

    def factors(self, angle: Array, s: Array, width: Array) -> Array:
        """Scale and factors of the zones; parameters as for `Zone.factors`."""
        return np.asarray(self.scale * np.prod([zone.factors(angle, s, width) for zone in self.zones], axis=0))


@dataclass(frozen=True, kw_only=True)
class Archard(WearLaw):
    """Archard's law k p |w| / H.

    Parameters:
        k: coefficient of wear.
        hardness: H, Pa, of the softer body.
    """

    k: float = 5e-4
    hardness: float = HARDNESS

    source: ClassVar[str] = "J. F. Archard, J. Appl. Phys. 24 (1953) 981-988; k: mild range of the KTH map"
    unsure: ClassVar[str] = "k, hardness"

    def rate(self, cells: SlidingCells) -> Array:
        return np.asarray(self.k / self.hardness * cells.dissipation / cells.friction)


@dataclass(frozen=True, kw_only=True)
class Kth(WearLaw):
    """Archard's law with the KTH map: k by pressure and slip velocity, limits rounded over a tenth.

    Parameters:
        mild, sliding, seizure: k below the first and above the second limit of the velocity, between these, and at
            pressures above 0.8 H; middles of the ranges 1 to 10, 30 to 40 and 300 to 400e-4.
        velocities: m/s, the limits.
        hardness: H, Pa.
        limit: Pa, largest pressure that the material bears, by plastic flow; H by default. Elastic pressures above it
            count as this one.
    """

    mild: float = 5.5e-4
    sliding: float = 35e-4
    seizure: float = 350e-4
    slow: float = 0.2
    fast: float = 0.7
    hardness: float = HARDNESS
    limit: float = HARDNESS

    source: ClassVar[str] = "T. Jendel, Wear 253 (2002) 89-99; R. Enblom, TRITA AVE 2004:19"
    unsure: ClassVar[str] = "all ranges of k and their limits"
    remark: ClassVar[str] = (
        "pressures above 0.8 times the hardness: the KTH map has seizure there, but elastic pressures of unworn "
        "profiles that only start to conform reach them, too"
    )

    def __post_init__(self) -> None:
        super().__post_init__()
        if not self.slow < self.fast:
            raise ValueError(f"law: slow = {self.slow} m/s: must be below fast = {self.fast} m/s")

    def coefficient(self, pressure: Array, velocity: Array) -> Array:
        """k (n,) at pressures (n,) Pa and slip velocities (n,) m/s."""
        between = _beyond(velocity, self.slow) - _beyond(velocity, self.fast)
        k = self.mild + (self.sliding - self.mild) * between
        return np.asarray(k + (self.seizure - k) * _beyond(pressure, 0.8 * self.hardness))

    def rate(self, cells: SlidingCells) -> Array:
        borne = np.minimum(cells.pressure, self.limit)
        sliding = cells.dissipation / cells.friction * borne / cells.pressure
        return np.asarray(self.coefficient(borne, cells.velocity) / self.hardness * sliding)

    def severe(self, cells: SlidingCells) -> Mask:
        return np.asarray(np.minimum(cells.pressure, self.limit) > 0.8 * self.hardness)


@dataclass(frozen=True, kw_only=True)
class Energy(WearLaw):
    """Zobory's law: mass proportional to the dissipated energy, with two regimes of its power per area.

    Parameters:
        mild, strong: kg/J, below and above the threshold.
        threshold: W/m2, of q V; rounded.
        density: kg/m3.
    """

    mild: float = 7e-10
    strong: float = 21e-10
    threshold: float = 4e6
    density: float = DENSITY

    source: ClassVar[str] = "I. Zobory, Vehicle System Dynamics 28 (1997) 221-259"
    unsure: ClassVar[str] = "mild, strong, threshold"

    def rate(self, cells: SlidingCells) -> Array:
        beyond = _beyond(cells.dissipation * cells.speed, self.threshold)
        return np.asarray((self.mild + (self.strong - self.mild) * beyond) / self.density * cells.dissipation)


@dataclass(frozen=True, kw_only=True)
class PointLaw(WearLaw):
    """A law by points, linear in between, beyond the last one with the last slope.

    Parameters:
        points: ascending, from (0, 0), which may be left out.
    """

    points: Points

    axes: ClassVar[tuple[str, str]]
    regular: ClassVar[float | None] = None  # largest abscissa that is not severe, if not the last one
    source: ClassVar[str] = "points as given"
    remark: ClassVar[str] = "cells beyond the last point of the law of wear, where its last slope is continued"

    def __post_init__(self) -> None:
        super().__post_init__()
        object.__setattr__(self, "points", _points(self.points, *self.axes))

    @property
    def last(self) -> float:
        """Largest abscissa that is not severe."""
        return self.points[-1][0] if self.regular is None else self.regular

    def at(self, x: Array) -> Array:
        """Ordinates (n,) at abscissas (n,)."""
        at, value = np.array(self.points).T
        slope = (value[-1] - value[-2]) / (at[-1] - at[-2])
        return np.asarray(np.interp(x, at, value) + slope * np.maximum(x - at[-1], 0.0))


@dataclass(frozen=True, kw_only=True)
class WearTable(PointLaw):
    """Specific wear K(q) over the density.

    Parameters:
        points: (q, K), Pa and kg/m3; 1 N/mm2 is 1e6 Pa, 1 ug/(m mm2) is 1e-3 kg/m3.
        density: kg/m3.
    """

    density: float = DENSITY

    axes: ClassVar[tuple[str, str]] = ("q", "K")

    def rate(self, cells: SlidingCells) -> Array:
        return np.asarray(self.at(cells.dissipation) / self.density)

    def severe(self, cells: SlidingCells) -> Mask:
        return np.asarray(cells.dissipation > self.last)


_PLATEAU = 55.0 * USFD_UNIT
_MILD, _SEVERE = 55.0 / 5.3 * 1e6, 77.2e6  # Pa, ends of the linear branch and of the plateau


@dataclass(frozen=True, kw_only=True)
class Usfd(WearTable):
    """Specific wear of wheel steel R8T on rail steel 900A from twin discs, in its continuous form.

    K = 5.3 q up to 55 ug/(m mm2), constant up to q = 77.2 N/mm2, then with a slope of 61.9.
    """

    points: Points = (
        (0.0, 0.0),
        (_MILD, _PLATEAU),
        (_SEVERE, _PLATEAU),
        (_SEVERE + 1e6, _PLATEAU + 61.9 * USFD_UNIT),
    )

    regular: ClassVar[float | None] = _SEVERE
    source: ClassVar[str] = (
        "R. Lewis, R. S. Dwyer-Joyce, Proc. IMechE J 218 (2004) 467-478; F. Braghin et al., Wear 261 (2006) 1253-1264"
    )
    unsure: ClassVar[str] = "branch above 77.2 N/mm2"
    remark: ClassVar[str] = (
        "dissipation above 77.2 N/mm2: published forms of the severe branch of the USFD law differ, here it is "
        "continuous"
    )


@dataclass(frozen=True, kw_only=True)
class TGamma(PointLaw):
    """A global law: volume per length of travel by T-gamma of a patch, over its cells like their dissipation.

    Parameters:
        points: (T-gamma, volume), N and m3 per m.
    """

    axes: ClassVar[tuple[str, str]] = ("T-gamma", "volume")

    def rate(self, cells: SlidingCells) -> Array:
        volume = self.at(cells.t_gamma)
        per_energy = np.divide(volume, cells.t_gamma, out=np.zeros(len(volume)), where=cells.t_gamma > 0.0)
        return np.asarray(per_energy * cells.dissipation)

    def severe(self, cells: SlidingCells) -> Mask:
        return np.asarray(cells.t_gamma > self.last)


_SECTION = np.pi * 1e-12  # m2 of volume per m, of 1 mm2/km times a diameter of 1 mm


@dataclass(frozen=True, kw_only=True)
class PearceSherratt(TGamma):
    """Wear of wheels of British Rail: 0.25 T, 25 and 1.19 T - 154 mm2/km over the diameter in mm, by T-gamma T in N.

    The limits are 100 and 200 N; the jump at 200 N is rounded over a tenth of it.
    """

    points: Points = tuple(
        (t, section * _SECTION)
        for t, section in ((0.0, 0.0), (100.0, 25.0), (190.0, 25.0), (210.0, 95.9), (310.0, 214.9))
    )

    source: ClassVar[str] = "T. G. Pearce, N. D. Sherratt, Wear 144 (1991) 343-351"
    unsure: ClassVar[str] = "all coefficients"
    remark: ClassVar[str] = "T-gamma above 200 N: the severe branch of Pearce and Sherratt's law"
    regular: ClassVar[float | None] = 200.0


def _number(value: object) -> bool:
    return isinstance(value, int | float | np.number) and not isinstance(value, bool) and isfinite(value)


def _numbers(what: str, owner: object, **least: float) -> None:
    """Raise ValueError unless fields are finite numbers of at least the given values."""
    for name, low in least.items():
        value = getattr(owner, name)
        if not (_number(value) and value >= low):
            allowed = "positive" if low > 0.0 else "at least 0"
            raise ValueError(f"{what}: {name} = {value!r}: must be a finite number, {allowed}")


def _points(points: Any, x: str, y: str) -> Points:
    """Points of a law, from (0, 0). Raises ValueError."""
    try:
        values = np.array(points, dtype=float)
    except (TypeError, ValueError):
        values = np.empty(0)
    if values.ndim != 2 or values.shape[1] != 2 or not len(values):
        raise ValueError(f"law: points = {points!r}: must be pairs [{x}, {y}] of numbers")
    if not np.isfinite(values).all() or (values < 0.0).any():
        raise ValueError(f"law: points = {points!r}: {x} and {y} must be finite and not negative")
    if values[0, 0] > 0.0:
        values = np.vstack([np.zeros(2), values])
    if values[0, 1] != 0.0:
        raise ValueError(f"law: points = {points!r}: {y} must be 0 at {x} = 0, without sliding")
    if len(values) < 2 or not (np.diff(values[:, 0]) > 0.0).all():
        raise ValueError(f"law: points = {points!r}: {x} must ascend from point to point, to more than 0")
    if values[-1, 1] < values[-2, 1]:
        raise ValueError(f"law: points = {points!r}: {y} must not fall at the end, where its slope is continued")
    return tuple((float(a), float(b)) for a, b in values)


def _beyond(x: Array, limit: float) -> Array:
    """Share 0 to 1 of the regime beyond a positive limit, smooth over a part `ROUNDED` of this limit."""
    t = np.clip((x / limit - 1.0) / ROUNDED + 0.5, 0.0, 1.0)
    return np.asarray(t * t * (3.0 - 2.0 * t))
