"""Rates of wear over the rows of a motion, of wheels and rails."""

from __future__ import annotations

import warnings
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field

from wheelrail.contact.kinematics.frames import Side
from wheelrail.contact.laws.parameters import ContactLaws
from wheelrail.contact.results.result import ContactResult
from wheelrail.contact.wear.laws import WearLaw
from wheelrail.contact.wear.strips import Place, ProfileGrid, ProfileRates, profile_rates, total, worn_strips

Weighted = dict[str, list[tuple[float, ProfileRates]]]


@dataclass(frozen=True)
class WornSurface:
    """Surface of a wheel, or of the rail of one side.

    Parameters:
        profile: name, of several wheels where they share one.
        grid: of its new profile.
        place: arc length on the new profile by that of the present one; None: the same.
        friction: law or coefficient of the contact.
    """

    profile: str
    grid: ProfileGrid
    place: Place | None
    friction: ContactLaws | float


@dataclass(frozen=True)
class MeanRates:
    """Mean rates of a motion.

    Parameters:
        wheels: by profile.
        passages: of a wheel, by rail.
        failed_share: of wheels without a result.
        residual: largest unbalanced force of its equilibria over the mean wheel load.
    """

    wheels: Mapping[str, ProfileRates]
    passages: Mapping[str, ProfileRates]
    failed_share: float
    residual: float


@dataclass
class MotionRates:
    """Rates of wheels and rails over the rows of a motion.

    Parameters:
        surfaces: of wheels, by wheelset and side.
        law: of wear.
        rails: those that wear, by side.
        failed: number of wheels without a result.
        wheels: rates of the others with their weights, by profile.
        passages: the same of the rails.
        residual: see `MeanRates`.
    """

    surfaces: Mapping[tuple[str, Side], WornSurface]
    law: WearLaw
    rails: Mapping[Side, WornSurface] = field(default_factory=dict)
    failed: int = 0
    wheels: Weighted = field(default_factory=dict)
    passages: Weighted = field(default_factory=dict)
    residual: float = 0.0

    def add(self, speed: float, contacts: Mapping[str, Mapping[Side, ContactResult]]) -> None:
        """Add a row; rows at equal times count by their distances.

        Parameters:
            speed: of travel, m/s.
            contacts: results by wheelset and side.

        The severe branch of the law is in the rates, without a warning.
        """
        wheels = [(name, *found) for name, sides in contacts.items() for found in sides.items()]
        for name, side, result in wheels:
            if not result.ok:
                self.failed += 1
                continue
            own = self.surfaces[name, side]
            with warnings.catch_warnings():
                warnings.simplefilter("ignore")
                strips = worn_strips(result if side == "left" else result.mirrored(), self.law, own.friction, speed)
            self.wheels.setdefault(own.profile, []).append((speed, profile_rates(strips, own.grid, own.place)))
            if rail := self.rails.get(side):
                self.passages.setdefault(rail.profile, []).append((speed, profile_rates(strips, rail.grid, rail.place)))

    @property
    def means(self) -> MeanRates:
        """Mean rates of wheels and of passages."""
        solved = sum(map(len, self.wheels.values()))
        wheels, passages = (
            {name: _mean(rates) for name, rates in every.items()} for every in (self.wheels, self.passages)
        )
        return MeanRates(wheels, passages, self.failed / max(self.failed + solved, 1), self.residual)


def _mean(rates: Sequence[tuple[float, ProfileRates]]) -> ProfileRates:
    weights = [weight for weight, _ in rates]
    return total([own for _, own in rates], [weight / sum(weights) for weight in weights])
