"""Estimates over the sections of a zone after EN 14363, and their limits."""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np

from wheelrail.vehicle.evaluation.criteria import CRITERIA, Conditions
from wheelrail.vehicle.evaluation.on_track import Section
from wheelrail.vehicle.evaluation.section_statistics import estimated_maximum, target_estimate

LEAST_SPREAD = 1e-3  # m of cant deficiency, between sections of a regression
CONFIDENCE = {"running safety": 0.99, "track loading": 0.95, "ride characteristics": 0.95}  # not confirmed


class Estimate(NamedTuple):
    """Estimate of a criterion over the sections of a zone, for the signal of the largest one.

    Parameters:
        zone, criterion, signal: names.
        number: of sections.
        mean, deviation: of the section values; deviation NaN for one section.
        one: mean and k standard deviations; of one section its value.
        two: upper end of the prediction interval of a regression on the cant deficiency, at its target; NaN without.
        limit: of the estimate.
        largest: largest section value.
        run, place: of the largest one, m along the track.
    """

    zone: str
    criterion: str
    signal: str
    number: int
    mean: float
    deviation: float
    one: float
    two: float
    limit: float
    largest: float
    run: str
    place: float

    @property
    def assessed(self) -> float:
        """The two-dimensional estimate where there is one, otherwise the one-dimensional one."""
        return self.two if np.isfinite(self.two) else self.one

    @property
    def passed(self) -> bool:
        return bool(self.assessed <= self.limit)


def estimates_of(
    sections: Sequence[Section], wheel_load: float, alpha: float = 1.0, deficiency: float | None = None
) -> list[Estimate]:
    """Estimates of all criteria in all zones that have sections, each for its most critical signal.

    Parameters:
        sections: of one or several runs.
        wheel_load: static one, N.
        alpha: factor of the limit of the sum of Y.
        deficiency: of cant, m, at which curves are estimated by the two-dimensional method; None: one-dimensional only.
    """
    found = list[Estimate]()
    for zone in sorted({section.zone for section in sections}):
        inside = [section for section in sections if section.zone == zone]
        radii = [section.radius for section in inside if section.curvature]
        at = Conditions(
            wheel_load, alpha, max(section.speed for section in inside), float(np.mean(radii)) if radii else np.inf
        )
        for key, criterion in CRITERIA.items():
            signals = dict.fromkeys(name for section in inside for name in section.values.get(key, {}))
            every = [_estimate(inside, zone, key, signal, criterion.limit(at), deficiency) for signal in signals]
            if every:
                found.append(max(every, key=lambda own: own.assessed))
    return found


def _estimate(
    sections: Sequence[Section], zone: str, key: str, signal: str, limit: float, deficiency: float | None
) -> Estimate:
    own = [(section, section.values[key][signal]) for section in sections if signal in section.values.get(key, {})]
    criterion, values = CRITERIA[key], np.array([value.value for _, value in own])
    mean, several = float(values.mean()), len(values) > 1
    one = estimated_maximum(values, criterion.factor) if several else mean
    two, conditions = float("nan"), np.array([section.deficiency for section, _ in own])
    if deficiency is not None and zone != "1" and len(values) > 2 and np.ptp(conditions) > LEAST_SPREAD:
        regression = target_estimate(conditions, values, deficiency, CONFIDENCE[criterion.group])
        two = regression.bound if criterion.factor else regression.mean
    section, worst = own[int(np.argmax(values))]
    return Estimate(
        zone,
        key,
        signal,
        len(values),
        mean,
        float(values.std(ddof=1)) if several else float("nan"),
        one,
        two,
        limit,
        worst.value,
        section.run,
        worst.place,
    )
