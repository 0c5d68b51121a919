"""Profiles that wear: one step of the distance removes material by the rates at its start."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace
from functools import cached_property, partial

import numpy as np

from wheelrail.contact.wear.strips import Place, ProfileGrid, ProfileRates, total
from wheelrail.meshes.profiles.profile import Profile
from wheelrail.meshes.profiles.worn import new_arc_length, worn_arc_length
from wheelrail.support.arrays import Array
from wheelrail.vehicle.wear.smoothing import Step, step

REACHED = 1e-6  # of the depth of a step: rounding of passages
LEAST_WIDTH = 0.1  # of that of a new cell: of a worn one at edges, where normals meet
CHORD = 1e-3  # m
LOST = 1e-6  # of the removed volume: largest part beyond the ends of a profile


class OffTheProfile(ValueError):
    """A contact wears beyond the ends of its profile."""


@dataclass(frozen=True)
class WearingProfile:
    """A new profile of a wheel or a rail, and the section removed from its cells.

    Parameters:
        new: profile.
        grid: cells of its arc length.
        removed: (n,) m2.
    """

    new: Profile
    grid: ProfileGrid
    removed: Array

    @classmethod
    def unworn(cls, new: Profile, radius: float) -> WearingProfile:
        """A new wheel of a nominal radius m."""
        grid = ProfileGrid.wheel(new, radius)
        return cls(new, grid, np.zeros(len(grid.bounds) - 1))

    @classmethod
    def unworn_rail(cls, new: Profile) -> WearingProfile:
        """A new rail."""
        grid = ProfileGrid.rail(new)
        return cls(new, grid, np.zeros(len(grid.bounds) - 1))

    @property
    def width(self) -> float:
        """Width m of a cell."""
        return float(np.ptp(self.grid.bounds)) / len(self.removed)

    @property
    def depth(self) -> Array:
        """Mean depth (n,) m of the cells."""
        return self.removed / self.width

    @cached_property
    def present(self) -> Profile:
        """The worn profile. Raises ValueError where it does not fit on the new one."""
        try:
            return self.new.worn(self.grid.bounds, self.removed)
        except ValueError as error:
            raise ValueError(f"{self.new.name}: {error}") from None

    @cached_property
    def bounds(self) -> Array:
        """Bounds (n + 1,) m of the cells on the worn profile."""
        same = self.present is self.new
        return self.grid.bounds if same else worn_arc_length(self.new, self.present, self.grid.bounds)

    @property
    def widths(self) -> Array:
        """Widths (n,) m of the cells on the worn profile: deeper hollows are longer."""
        return np.maximum(np.diff(self.bounds), LEAST_WIDTH * self.width)

    @property
    def groove(self) -> float:
        """Least concave radius m where the profile is worn, of circles through points `CHORD` apart; NaN without."""
        s = 0.5 * (self.bounds[1:] + self.bounds[:-1])[self.removed > 0.0] + np.array([[-CHORD], [0.0], [CHORD]])
        first, second = np.diff(self.present.point(np.clip(s, *self.present.s_range)) @ [1.0, 1j], axis=0)
        curvature = 2.0 * (first.conj() * second).imag / np.abs(first * second * (first + second))
        return 1.0 / most if (most := float(curvature.max(initial=0.0))) > 0.0 else np.nan

    @property
    def place(self) -> Place | None:
        """Arc length on the new profile by that of the present one; None where they are the same."""
        return None if self.present is self.new else partial(new_arc_length, self.new, self.present)

    def step(self, rates: ProfileRates, modulus: float, depth: float, distance: float) -> Step:
        """The step whose largest smoothed depth m is given, at most over a distance m.

        Parameters:
            rates: of the profile.
            modulus: E*, Pa.
            depth: m.
            distance: m; infinite: no limit.

        Raises OffTheProfile, and ValueError where nothing wears over an infinite distance.
        """
        removed = np.maximum(rates.removed, 0.0)
        if rates.outside > LOST * (removed.sum() + rates.outside):
            share = rates.outside / (removed.sum() + rates.outside)
            raise OffTheProfile(f"{100 * share:.2g} % of the wear lies beyond the ends of {self.new.name}")
        rate = np.where(rates.pressed > 0.0, removed, 0.0) / self.widths
        return step(rate, rates.pressure, modulus=modulus, width=self.widths, depth=depth, distance=distance)

    def after(self, step: Step) -> WearingProfile:
        """The profile after a step."""
        return replace(self, removed=self.removed + step.depth * self.widths)


@dataclass(frozen=True)
class WearingRail:
    """A rail, and the material removed since its last step.

    Parameters:
        profile: on which wheels run.
        waiting: sums over the passages since; None: nothing.
    """

    profile: WearingProfile
    waiting: ProfileRates | None = None

    def passages(self, rates: ProfileRates, depth: float) -> float:
        """Passages at given rates until a depth m waits somewhere; infinite without wear."""
        waiting = np.zeros(len(rates.removed)) if self.waiting is None else self.waiting.removed
        rest = np.maximum(depth * self.profile.width - waiting, 0.0)
        worn = rates.removed > 0.0
        return float((rest[worn] / rates.removed[worn]).min(initial=np.inf))

    def after(self, rates: ProfileRates, passages: float, *, modulus: float, depth: float) -> WearingRail:
        """The rail after passages, with a step where depth m is reached.

        Parameters:
            rates: of the rail.
            passages: number.
            modulus: E*, Pa.
            depth: m; 0: in any case.

        Raises OffTheProfile.
        """
        parts = [(rates, passages)] if self.waiting is None else [(self.waiting, 1.0), (rates, passages)]
        waiting = total([own for own, _ in parts], [weight for _, weight in parts])
        if waiting.removed.max() < (1.0 - REACHED) * depth * self.profile.width:
            return replace(self, waiting=waiting)
        return WearingRail(self.profile.after(self.profile.step(waiting, modulus, np.inf, 1.0)))


def wear_step(
    profiles: Mapping[str, WearingProfile],
    rates: Mapping[str, ProfileRates],
    *,
    modulus: float,
    depth: float,
    distance: float,
) -> dict[str, Step]:
    """Steps of all profiles over one distance, the longest with at most the given depth on each.

    Parameters:
        profiles, rates: by name.
        modulus: E*, Pa.
        depth: largest of the step after smoothing, m.
        distance: longest, m.

    Raises as `WearingProfile.step`.
    """
    common = min(own.step(rates[name], modulus, depth, distance).distance for name, own in profiles.items())
    return {name: own.step(rates[name], modulus, np.inf, common) for name, own in profiles.items()}
