"""Measures of worn wheels (EN 15313) and rails, as roots on the curve: flange, hollow tread, height, side, section.

Definitions and limits are from memory of the standards: `LIMITS` says so.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np
from scipy.optimize import brentq

from wheelrail.meshes.curves.curve import Curve
from wheelrail.meshes.profiles.worn import removed_section
from wheelrail.support.arrays import Array

DENSITY = 7850.0  # kg/m3
ACTIVE = 10e-3  # m above the tread at y = 0: height of the flange's thickness
BELOW_TIP = 2e-3  # m below the tip of the flange: upper end of its active face
FLANGE = 12e-3  # m, least height of a flange above the tread
GAUGE_HEIGHT = 14e-3  # m below the top of the new rail: height of the side wear
SPACING = 5e-5  # m, of samples between which roots are searched
END = 1e-4  # m, of arc length, within which the highest point is an end


@dataclass(frozen=True)
class Limit:
    """Range of a measure in service, m, and its source."""

    least: float
    most: float
    source: str


_EN = "EN 15313, wheels of more than 840 mm, from memory: check before use"
LIMITS = {
    "Sh": Limit(27.5e-3, 36e-3, _EN),
    "Sd": Limit(22e-3, 33e-3, _EN),
    "qR": Limit(6.5e-3, np.inf, _EN),
    "hollow": Limit(0.0, 2e-3, "usual in operation, from memory: check before use"),
}


_UNITS = {"removed_section": (1e6, "mm²"), "removed_mass": (1.0, "kg")}  # others: mm


def outside_limits(values: Mapping[str, Any], limits: Mapping[str, Limit] = LIMITS) -> dict[str, str]:
    """Words on values m outside their limits, both by name."""
    return {
        name: f"{name} = {1e3 * value:.2f} mm, limits {1e3 * limit.least:g} to {1e3 * limit.most:g} ({limit.source})"
        for name, limit in limits.items()
        if (value := values.get(name, np.nan)) < limit.least or value > limit.most
    }


class _Measures:
    """Numbers in m, m2 and kg, NaN with a remark where a shape has none."""

    remarks: tuple[str, ...]

    def __str__(self) -> str:
        numbers = (
            f"{name} {scale * value:.4g} {unit}"
            for name, value in vars(self).items()
            if name != "remarks"
            for scale, unit in [_UNITS.get(name, (1e3, "mm"))]
        )
        return "; ".join([", ".join(numbers), *self.remarks])

    def beyond(self, limits: Mapping[str, Limit] = LIMITS) -> list[str]:
        """Words on measures outside their limits, by name."""
        return list(outside_limits(vars(self), limits).values())


@dataclass(frozen=True)
class WheelMeasures(_Measures):
    """Measures of a wheel's profile.

    Parameters:
        Sh: height of the flange's tip above the tread at y = 0, m.
        Sd: thickness of the flange 10 mm above the tread, from its back, m.
        qR: lateral distance of that point from the one 2 mm below the tip on the same face, m.
        hollow: highest rise of the tread towards the field side, m: depth of a hollow below its field side.
        rolling_radius: at y = 0, m.
        removed_section: between this and the new profile, m2.
        removed_mass: of this section around the wheel, kg.
        remarks: on measures that the shape does not have.
    """

    Sh: float
    Sd: float
    qR: float
    hollow: float
    rolling_radius: float
    removed_section: float
    removed_mass: float
    remarks: tuple[str, ...] = ()


@dataclass(frozen=True)
class RailMeasures(_Measures):
    """Wear of a rail's profile against a new one in the same frame.

    Parameters:
        W1: vertical wear on the new rail's axis, along it, m.
        W3: side wear on the gauge side 14 mm below the top of the new rail, horizontal, m.
        removed_section: m2.
        removed_mass: kg per m of rail.
        remarks: on measures that the shape does not have.
    """

    W1: float
    W3: float
    removed_section: float
    removed_mass: float
    remarks: tuple[str, ...] = ()


def wheel_measures(
    wheel: Curve, new: Curve | None = None, *, radius: float = 0.46, flange_back: float = -0.070
) -> WheelMeasures:
    """Measures of a wheel.

    Parameters:
        wheel: its profile.
        new: new profile in the same frame, for the removed section; None: NaN.
        radius: of the rolling circle of the new wheel, z = 0, m.
        flange_back: y of the flange's back, m.
    """
    level = float(wheel.point(origin := float(wheel.s_at_y(0.0)))[1])
    remarks: list[str] = []
    Sh = Sd = qR = np.nan
    tip = _tip(wheel, origin)
    height = np.nan if tip is None else float(wheel.point(tip)[1]) - level
    if tip is None or height < FLANGE:
        remarks.append(f"no flange: nothing rises {1e3 * FLANGE:g} mm above y = 0")
        tip = None
    elif tip < wheel.s_range[0] + END:
        remarks.append("the profile ends before the flange's tip: no Sh, no qR")
    else:
        Sh = height
    if tip is not None:
        face = _first(wheel, lambda p: p[..., 1] - level - ACTIVE, tip, origin)
        Sd = face - flange_back
        if not np.isnan(Sh):
            qR = face - _first(wheel, lambda p: p[..., 1] - level - Sh + BELOW_TIP, tip, origin)
    section, z = (np.nan, np.nan) if new is None else removed_section(new, wheel)
    mass = 0.0 if section == 0.0 else DENSITY * 2.0 * np.pi * (radius + z) * section
    return WheelMeasures(Sh, Sd, qR, _hollow(wheel), radius + level, section, mass, tuple(remarks))


def rail_measures(rail: Curve, new: Curve, axis: tuple[Array, Array]) -> RailMeasures:
    """Wear of a rail.

    Parameters:
        rail: its profile.
        new: new profile in the same frame.
        axis: crown of the new rail (2,) m and direction (2,) of its axis, upwards.
    """
    crown, up = axis
    across = np.array([up[1], -up[0]])
    remarks: list[str] = []

    def root(of: Curve, offset: Callable[[Array], Array], start: float, stop: float, what: str) -> Array:
        roots = _roots(of, offset, start, stop)
        if not len(roots):
            remarks.append(f"the profile does not reach {what}")
            return np.full(2, np.nan)
        return of.point(min(roots, key=abs))  # of the head, not of the lip of a groove

    on_axis = (lambda p: (p - crown) @ across), *rail.s_range, "the rail's axis"
    W1 = float((crown - root(rail, *on_axis)) @ up)
    top = float(new.point(new.samples(SPACING))[:, 1].max())
    sides = [
        root(curve, lambda p: p[..., 1] - top + GAUGE_HEIGHT, curve.s_range[0], 0.0, f"{1e3 * GAUGE_HEIGHT:g} mm deep")
        for curve in (new, rail)
    ]
    section = removed_section(new, rail).area
    return RailMeasures(W1, float(sides[1][0] - sides[0][0]), section, DENSITY * section, tuple(remarks))


def _roots(curve: Curve, offset: Callable[[Array], Array], start: float, stop: float) -> list[float]:
    """Arc lengths m, increasing, at which an offset (n,) of points (n, 2) m changes its sign."""
    s = curve.samples(SPACING, start, stop)
    sign = offset(curve.point(s)) > 0.0
    places = np.flatnonzero(sign[1:] != sign[:-1])
    return [brentq(lambda at: offset(curve.point(at)), s[i], s[i + 1], xtol=1e-15) for i in places]


def _first(curve: Curve, offset: Callable[[Array], Array], start: float, stop: float) -> float:
    """y m of the first root; NaN without."""
    roots = _roots(curve, offset, start, stop)
    return float(curve.point(roots[0])[0]) if roots else np.nan


def _extremes(curve: Curve, start: float, stop: float) -> Array:
    """Arc lengths (n,) m of both ends and of level tangents between."""
    s = curve.samples(SPACING, start, stop)
    rises = curve.tangent(s)[:, 1] > 0.0
    places = np.flatnonzero(rises[1:] != rises[:-1])
    level = [brentq(lambda at: float(curve.tangent(at)[1]), s[i], s[i + 1], xtol=1e-15) for i in places]
    return np.array([start, *level, stop])


def _tip(wheel: Curve, origin: float) -> float | None:
    """Arc length m of the highest point before y = 0; None where the tread itself is the highest."""
    s = _extremes(wheel, wheel.s_range[0], origin)
    highest = int(np.argmax(wheel.point(s)[:, 1]))
    return None if highest == len(s) - 1 else float(s[highest])


def _hollow(wheel: Curve) -> float:
    """Highest rise m of the profile towards the field side, beyond its highest point: that of the flange."""
    z = wheel.point(_extremes(wheel, *wheel.s_range))[:, 1]
    z = z[int(np.argmax(z)) :]
    return float((z - np.minimum.accumulate(z)).max())
