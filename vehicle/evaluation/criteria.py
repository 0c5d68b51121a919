"""Test zones, assessed quantities and limits of EN 14363:2016 for vehicles on bogies, each with its source.

The text of the standard was not available. GENSYS (gensys.se/course/UIC518_tests.html) lists filters and percentiles,
railwaynews.net the limits of the sum of Y and of Y/Q, the abstract of CEN/TS 17843 that radii below 250 m are a zone 5
outside EN 14363. All else is from memory and says "not confirmed".
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import Literal, NamedTuple

from wheelrail.vehicle.evaluation.running_safety import QUOTIENT_LIMIT, largest_wheel_load, track_shifting_limit
from wheelrail.vehicle.evaluation.section_statistics import LOADING, QUASI_STATIC, SAFETY

UNCONFIRMED = "not confirmed"
GENSYS = "gensys.se/course/UIC518_tests.html"
RAILWAYNEWS = "railwaynews.net, pages on EN 14363 and UIC 518"
ZONE_5 = "abstract of CEN/TS 17843"
STRAIGHT = 0.040  # m, largest cant deficiency of zone 1 with a radius above that of zone 3; not confirmed
Unit = Literal["N", "1", "m/s2"]


class Zone(NamedTuple):
    """Test zone by the radius of curves.

    Parameters:
        text: meaning.
        smallest: radius, m; a curve belongs to the first zone whose radius it reaches.
        sections: needed number.
        source: of radii and numbers.
    """

    text: str
    smallest: float
    sections: int
    source: str


ZONES: Mapping[str, Zone] = {
    "1": Zone("straight track and curves of very large radius", 600.0, 25, UNCONFIRMED),
    "2": Zone("curves of large radius", 600.0, 25, UNCONFIRMED),
    "3": Zone("curves of small radius, 400 to 600 m", 400.0, 50, UNCONFIRMED),
    "4": Zone("curves of very small radius, 250 to 400 m", 250.0, 25, f"250 m: {ZONE_5}; all else {UNCONFIRMED}"),
    "5": Zone("curves below 250 m, outside EN 14363", 0.0, 25, ZONE_5),
}
CURVES = frozenset("2345")
ALL = frozenset(ZONES)


def zone_of(curvature: float, deficiency: float) -> str:
    """Zone by curvature 1/m and cant deficiency m."""
    radius = 1.0 / abs(curvature) if curvature else float("inf")
    if radius > ZONES["2"].smallest:
        return "1" if abs(deficiency) <= STRAIGHT else "2"
    return next(name for name in "345" if radius >= ZONES[name].smallest)


def section_length(zone: str, speed: float) -> float:
    """Length m of sections by zone and speed m/s; not confirmed."""
    fast = 3.6 * speed
    if zone == "1":
        return 250.0 if fast <= 220.0 else 500.0
    if zone == "2":
        return 100.0 if fast <= 160.0 else 250.0 if fast <= 220.0 else 500.0
    return 100.0 if zone == "3" else 70.0


class Conditions(NamedTuple):
    """Conditions that limits depend on.

    Parameters:
        wheel_load: static load of a wheel, N.
        alpha: factor of the limit of the sum of Y: 1, for freight wagons 0.85.
        speed: highest of the sections, m/s.
        radius: mean of the sections, m; inf without curves.
    """

    wheel_load: float
    alpha: float
    speed: float
    radius: float


def _quasi_static_guiding(at: Conditions) -> float:
    return 30e3 + 10500e3 / at.radius if at.radius < 400.0 else 60e3


@dataclass(frozen=True)
class Criterion:
    """Assessed quantity.

    Parameters:
        group: what the quantity is assessed for.
        label: name.
        unit: SI.
        of: signals of which the quantity is taken: one for each wheelset, for each wheel, or for each point of a body.
        kind: value of a section: the percentiles 0.15 and 99.85 %, the median, the largest value or the root of the
            mean square.
        factor: k of the one-dimensional estimate, mean + k s of the section values.
        limit: by conditions.
        source: of the limit.
        method: source of filter and kind.
        zones: in which the quantity is assessed.
    """

    group: Literal["running safety", "track loading", "ride characteristics"]
    label: str
    unit: Unit
    of: Literal["wheelset", "wheel", "point"]
    kind: Literal["percentiles", "median", "largest", "rms"]
    factor: float
    limit: Callable[[Conditions], float]
    source: str
    method: str = GENSYS
    zones: frozenset[str] = ALL

    @property
    def confirmed(self) -> bool:
        """Whether the limit has a public source."""
        return UNCONFIRMED not in self.source


CRITERIA: Mapping[str, Criterion] = {
    "track_shifting": Criterion(
        "running safety",
        "sum of Y, mean over 2 m",
        "N",
        "wheelset",
        "percentiles",
        SAFETY,
        lambda at: track_shifting_limit(at.wheel_load, at.alpha),
        RAILWAYNEWS,
    ),
    "quotient": Criterion(
        "running safety",
        "Y/Q, mean over 2 m",
        "1",
        "wheel",
        "percentiles",
        SAFETY,
        lambda _: QUOTIENT_LIMIT,
        RAILWAYNEWS,
    ),
    "instability": Criterion(
        "running safety",
        "rms of the sum of Y over 100 m",
        "N",
        "wheelset",
        "largest",
        SAFETY,
        lambda at: 0.5 * track_shifting_limit(at.wheel_load, at.alpha),
        UNCONFIRMED,
        f"{GENSYS}: within 2 Hz of the main frequency; window {UNCONFIRMED}",
    ),
    "load": Criterion(
        "track loading",
        "Q",
        "N",
        "wheel",
        "percentiles",
        LOADING,
        lambda at: min(90e3 + at.wheel_load, largest_wheel_load(at.speed)),
        UNCONFIRMED,
    ),
    "quasi_static_guiding": Criterion(
        "track loading",
        "quasi-static Y",
        "N",
        "wheel",
        "median",
        QUASI_STATIC,
        _quasi_static_guiding,
        UNCONFIRMED,
        zones=frozenset("345"),
    ),
    "quasi_static_load": Criterion(
        "track loading",
        "quasi-static Q",
        "N",
        "wheel",
        "median",
        QUASI_STATIC,
        lambda _: 145e3,
        UNCONFIRMED,
        zones=CURVES,
    ),
    "lateral_acceleration": Criterion(
        "ride characteristics",
        "lateral acceleration, 0.4 to 10 Hz",
        "m/s2",
        "point",
        "percentiles",
        LOADING,
        lambda _: 2.5,
        UNCONFIRMED,
    ),
    "vertical_acceleration": Criterion(
        "ride characteristics",
        "vertical acceleration, 0.4 to 10 Hz",
        "m/s2",
        "point",
        "percentiles",
        LOADING,
        lambda _: 2.5,
        UNCONFIRMED,
    ),
    "lateral_rms": Criterion(
        "ride characteristics",
        "lateral acceleration, 0.4 to 10 Hz, rms",
        "m/s2",
        "point",
        "rms",
        LOADING,
        lambda _: 0.5,
        UNCONFIRMED,
    ),
    "vertical_rms": Criterion(
        "ride characteristics",
        "vertical acceleration, 0.4 to 10 Hz, rms",
        "m/s2",
        "point",
        "rms",
        LOADING,
        lambda _: 0.75,
        UNCONFIRMED,
    ),
    "quasi_static_acceleration": Criterion(
        "ride characteristics",
        "quasi-static lateral acceleration",
        "m/s2",
        "point",
        "median",
        QUASI_STATIC,
        lambda _: 1.5,
        UNCONFIRMED,
        zones=CURVES,
    ),
}
