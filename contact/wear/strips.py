"""Rates of wear along the arc length of a profile, from the cells of contacts.

Cells of a patch are balanced: their slips get a common factor with which they dissipate the frictional power of the
patch, of which sums over cells miss up to a third, where the slip rises between the middles of the last ones.
"""

from __future__ import annotations

import warnings
from collections.abc import Callable, Sequence
from dataclasses import dataclass, fields
from functools import partial
from typing import Literal

import numpy as np
from scipy.interpolate import CubicHermiteSpline, CubicSpline

from wheelrail.contact.laws.parameters import ContactLaws
from wheelrail.contact.results.result import ContactResult, Fields
from wheelrail.contact.wear.fatigue import ratcheting, whole_life_rail_damage
from wheelrail.contact.wear.laws import SlidingCells, WearLaw
from wheelrail.meshes.profiles.profile import Profile
from wheelrail.meshes.profiles.worn import CELL, cell_bounds
from wheelrail.support.arrays import Array, Mask, Nodes

SHEAR_YIELD = 300e6  # Pa
TRIMMED = 5  # strips of a row, at least, whose outer ones are narrowed to the contact
APART = 1e-9  # m, least distance of the bounds of strips on a profile

Body = Literal["wheel", "rail"]
Place = Callable[[Array], Array]


@dataclass(frozen=True)
class WornStrips:
    """Strips of a contact, m in k patches, with sums over cells per length of travel.

    Parameters:
        wheel_s, rail_s: (m,) m, arc length on the profiles.
        width: (m,) m.
        tiling: (m,) number of the row of adjacent strips; strips of a row have ascending places.
        share: (m,) of the row in the result, as `Fields.share`.
        patch: (m,).
        pressure: (m,) Pa, mean over the cells.
        volume: (m,) m2 (m3 per m), removed.
        severe: (m,) m2, part of the volume in the severe branch of the law.
        energy: (m,) N (J per m), dissipated.
        traction: (m, 2) N, of the tractions on the wheel times the size of the slip, forward and to the field side.
        t_gamma: (k,) N, frictional power of the patches over the speed.
        unbalanced: (k,) N, the same as sums over the cells before they are balanced.
        fatigue_index: (k,) of the patches, 0 where they do not ratchet.
    """

    wheel_s: Array
    rail_s: Array
    width: Array
    tiling: Nodes
    share: Array
    patch: Nodes
    pressure: Array
    volume: Array
    severe: Array
    energy: Array
    traction: Array
    t_gamma: Array
    unbalanced: Array
    fatigue_index: Array

    def bounds(self, row: Mask, body: Body) -> Array:
        """Bounds (j + 1,) m on a body of the j strips of a row, in a mask (m,).

        Strips are tiles, those at Gauss points interlace with their summed widths. Outer ones reach beyond the contact:
        their bounds are where the dissipation ends that falls linearly from that between their neighbours. Bounds on
        the rail are interpolated.
        """
        width, s = self.width[row], self.wheel_s[row]
        whole = width.sum()
        bounds = width @ s / whole - 0.5 * whole + np.concatenate([[0.0], np.cumsum(width)])
        if len(s) >= TRIMMED:
            for outer, own, inner in ((0, slice(3), 1), (-1, slice(-1, -4, -1), -2)):
                bounds[outer] = bounds[inner] + (2 * outer + 1) * -_reach(width[own], self.energy[row][own])
        if body == "wheel":
            return np.asarray(bounds)
        inside = np.clip(bounds, s[0], s[-1])
        return np.asarray(np.interp(inside, s, self.rail_s[row]) + bounds - inside)


def _reach(width: Array, energy: Array) -> float:
    """Width m in contact of an outer strip, from widths (3,) m and energies (3,) N of three strips, this one first."""
    inner, beyond = energy[1:] / width[1:]
    density = inner + (inner - beyond) * width[1] / (width[1] + width[2])  # at their common bound
    return float(min(2.0 * energy[0] / density, width[0])) if density > 0.0 else float(width[0])


def worn_strips(
    result: ContactResult,
    law: WearLaw,
    friction: ContactLaws | float,
    speed: float,
    shear_yield: float = SHEAR_YIELD,
) -> WornStrips:
    """Strips of a contact with removed volume and energy; none of a separated one.

    Parameters:
        result: of a model with fields, in steady rolling.
        law: of wear.
        friction: law or coefficient of the contact.
        speed: of travel, m/s.
        shear_yield: Pa, for the fatigue index.

    A patch without slip in its cells has its energy where its pressure is. Patches of negative power (Polach's formula)
    wear nothing. Warns of cells in the severe branch of the law. Raises ValueError for a failed result, a model without
    cells, and a speed that is not positive.
    """
    if not speed > 0.0:
        raise ValueError(f"speed = {speed}: must be positive, m/s")
    if not result.ok:
        raise ValueError(f"the contact has no result: {result.status}")
    at, patches = result.fields, result.patches
    if result.status == "separated":
        none, numbers = np.zeros(0), np.zeros(0, dtype=int)
        return WornStrips(
            none, none, none, numbers, none, numbers, none, none, none, none, np.zeros((0, 2)), none, none, none
        )
    if at is None or at.wheel_s is None or at.rail_s is None:
        raise ValueError("the contact has no cells on the profiles, as tables of forces have none")
    loaded = (at.pressure > 0.0) & (at.patch >= 0)
    area, patch, traction = at.area[loaded], at.patch[loaded], at.traction[loaded]
    t_gamma = np.array([max(own.frictional_power, 0.0) for own in patches]) / speed
    dissipation = np.maximum(-(traction * at.slip[loaded]).sum(axis=1), 0.0)
    unbalanced = _sums(patch, dissipation * area, len(patches))
    cells, slip = _balanced(at, loaded, t_gamma, dissipation, friction, speed)
    removed, severe = law.rate(cells) * area, law.severe(cells) & (cells.dissipation > 0.0)
    share = np.ones(len(area)) if at.share is None else at.share[loaded]
    strips, first, strip = _groups(np.column_stack([share, patch, at.wheel_s[loaded]]))
    summed = partial(_sums, strip, count=len(strips))
    number = summed(np.ones(len(area)))
    width, normal = summed(at.width[loaded]) / number, at.axes[np.flatnonzero(loaded)[first], 2]
    factors = law.factors(np.arctan2(np.abs(normal[:, 1]), -normal[:, 2]), strips[:, 2], width)
    if severe.any():
        warnings.warn(law.remark, stacklevel=2)
    return WornStrips(
        wheel_s=strips[:, 2],
        rail_s=summed(at.rail_s[loaded]) / number,
        width=width,
        tiling=_groups(strips[:, :2])[2],
        share=strips[:, 0],
        patch=strips[:, 1].astype(int),
        pressure=summed(at.pressure[loaded] * area) / summed(area),
        volume=summed(removed) * factors,
        severe=summed(np.where(severe, removed, 0.0)) * factors,
        energy=summed(cells.dissipation * area),
        traction=np.column_stack([summed(slip * part * area) for part in traction.T]),
        t_gamma=t_gamma,
        unbalanced=unbalanced,
        fatigue_index=ratcheting(patches, shear_yield),
    )


def _balanced(
    at: Fields, loaded: Mask, t_gamma: Array, dissipation: Array, friction: ContactLaws | float, speed: float
) -> tuple[SlidingCells, Array]:
    """Loaded cells in a mask, and sizes (n,) of slips.

    Dissipation (n,) Pa and slip of a patch get a common factor, with which its cells sum to its T-gamma (k,) N.
    """
    area, pressure, patch = at.area[loaded], at.pressure[loaded], at.patch[loaded]
    stuck = _sums(patch, dissipation * area, len(t_gamma))[patch] <= 0.0
    dissipation = np.where(stuck, pressure, dissipation)
    factor = (t_gamma / _sums(patch, dissipation * area, len(t_gamma)))[patch]
    slip = np.hypot(*at.slip[loaded].T) * np.where(stuck, 1.0, factor)
    mu = _friction(friction, slip * speed, pressure)
    return SlidingCells(pressure, dissipation * factor, mu, slip * speed, speed, t_gamma[patch]), slip


def _groups(keys: Array) -> tuple[Array, Nodes, Nodes]:
    """Different rows (m, c) of keys (n, c) in order, index (m,) of the first of each, and group (n,) of each row.

    Equal rows mostly follow one another: those of a run are sorted as one.
    """
    begins = np.concatenate([[True], (keys[1:] != keys[:-1]).any(axis=1)])
    starts = np.flatnonzero(begins)
    groups, first, run = np.unique(keys[starts], axis=0, return_index=True, return_inverse=True)
    return groups, starts[first], run.ravel()[np.cumsum(begins) - 1]


def _sums(number: Nodes, values: Array, count: int) -> Array:
    """Sums (count,) of values (n,) by number (n,)."""
    return np.asarray(np.bincount(number, values, count), dtype=float)


def _friction(friction: ContactLaws | float, velocity: Array, pressure: Array) -> Array:
    """Coefficient of friction (n,) at slip velocities (n,) m/s and pressures (n,) Pa."""
    if not (friction.frictional if isinstance(friction, ContactLaws) else friction):
        return np.ones(len(pressure))  # any: nothing is dissipated
    if not isinstance(friction, ContactLaws):
        return np.full(len(pressure), friction)
    return np.asarray(friction.pointwise_friction.coefficient(velocity, pressure))


@dataclass(frozen=True)
class ProfileGrid:
    """Cells (n) along the arc length of the new profile of a body.

    Parameters:
        body: whose places count.
        bounds: (n + 1,) m, ascending.
        per_passage: (n,) m of travel per passage of the surface through the contact: a wheel's circumference; 1 for a
            rail, whose rates are per passage of a wheel.
    """

    body: Body
    bounds: Array
    per_passage: Array

    @classmethod
    def wheel(cls, profile: Profile, radius: float, cell: float = CELL) -> ProfileGrid:
        """Cells of about a size m on a wheel with a nominal radius m."""
        bounds = cell_bounds(profile, cell)
        heights = profile.point(0.5 * (bounds[1:] + bounds[:-1]))[:, 1]
        return cls("wheel", bounds, 2.0 * np.pi * (radius + heights))

    @classmethod
    def rail(cls, profile: Profile, cell: float = CELL) -> ProfileGrid:
        """Cells of about a size m on a rail."""
        bounds = cell_bounds(profile, cell)
        return cls("rail", bounds, np.ones(len(bounds) - 1))

    def rows(self, strips: WornStrips, place: Place | None) -> list[tuple[Mask, Array]]:
        """Masks (m,) of rows of strips, and their ascending bounds (j + 1,) m on the new profile.

        Parameters:
            strips: m of them.
            place: arc length on the new profile by that of the profile in contact; None: the same.
        """
        masks = [strips.tiling == number for number in range(strips.tiling.max(initial=-1) + 1)]
        parts = [strips.bounds(row, self.body) for row in masks]
        if place is not None and parts:
            parts = np.split(place(np.concatenate(parts)), np.cumsum([len(part) for part in parts[:-1]]))
        steps = [APART * np.arange(len(part)) for part in parts]
        ascending = [np.maximum.accumulate(part - step) + step for part, step in zip(parts, steps, strict=True)]
        return list(zip(masks, ascending, strict=True))

    def deposited(self, rows: Sequence[tuple[Mask, Array]], values: Array) -> Array:
        """Sums (n, c) in the cells of sums (m, c) over strips in rows.

        They are differences of a monotone cubic through the cumulative sums at the bounds of strips: nothing is lost
        but what lies beyond the grid.
        """
        cumulative = np.zeros((len(self.bounds), values.shape[1]))
        for row, bounds in rows:
            sums = np.vstack([np.zeros(values.shape[1]), np.cumsum(values[row], axis=0)])
            first, last = np.searchsorted(self.bounds, bounds[[0, -1]])
            cumulative[first:last] += _monotone(bounds, sums)(self.bounds[first:last])
            cumulative[last:] += sums[-1]
        return np.diff(cumulative, axis=0)

    def covered(self, rows: Sequence[tuple[Mask, Array]], strips: WornStrips, values: Array) -> Array:
        """Sums (n,) of values (k,) of patches, times the part of a cell that the strips of each in rows cover."""
        found = np.zeros(len(self.bounds) - 1)
        for row, bounds in rows:
            part = np.diff(np.clip(self.bounds, bounds[0], bounds[-1])) / np.diff(self.bounds)
            found += strips.share[row][0] * values[strips.patch[row][0]] * part
        return found


def _monotone(x: Array, sums: Array) -> CubicHermiteSpline:
    """Curves through sums (m, c) at x (m,), level at the ends, monotone where the sums are: slopes are those of the
    cubic spline, of the sign of the differences beside them and at most three times as steep (Fritsch and Carlson).
    """
    steep = np.diff(sums, axis=0) / np.diff(x)[:, None]
    sign = np.where(np.sign(steep[1:]) == np.sign(steep[:-1]), np.sign(steep[1:]), 0.0)
    limit = 3.0 * np.minimum(np.abs(steep[1:]), np.abs(steep[:-1]))
    slopes = np.zeros_like(sums)
    slopes[1:-1] = sign * np.clip(sign * CubicSpline(x, sums, bc_type="clamped")(x[1:-1], 1), 0.0, limit)
    return CubicHermiteSpline(x, sums, slopes)


@dataclass(frozen=True)
class ProfileRates:
    """Wear and fatigue in the n cells of a profile, per m of travel of a wheel, per passage of a wheel on a rail.

    Parameters:
        removed: (n,) m2, area of the section; over the width of the cell it is a depth.
        pressed: (n,) N, the same times the mean pressures of the strips.
        severe: (n,) m2, part of it in the severe branch of the law.
        energy: (n,) J per m of circumference or rail.
        fatigue_index: (n,), sum of the surface fatigue index of passing patches that ratchet.
        damage: (n,), sum of the T-gamma damage of passing patches, each over its strips like their energy.
        traction: (n, 2) N, see `WornStrips`; its angle is `wheelrail.contact.wear.fatigue.direction`.
        outside: m2 (m3 per m), volume beyond the ends of the profile, which is in none of the cells.
        t_gamma, unbalanced: N, of all patches, see `WornStrips`.
    """

    removed: Array
    pressed: Array
    severe: Array
    energy: Array
    fatigue_index: Array
    damage: Array
    traction: Array
    outside: float
    t_gamma: float
    unbalanced: float

    @classmethod
    def of_sections(cls, removed: Array, pressed: Array, outside: float) -> ProfileRates:
        """Rates for a step; others are NaN."""
        nothing = np.full(len(removed), np.nan)
        traction = np.full((len(removed), 2), np.nan)
        return cls(removed, pressed, nothing, nothing, nothing, nothing, traction, outside, np.nan, np.nan)

    @property
    def pressure(self) -> Array:
        """Mean pressure (n,) Pa weighted by the removed area; 0 where nothing is removed."""
        return np.divide(self.pressed, self.removed, out=np.zeros(len(self.removed)), where=self.removed > 0.0)


def profile_rates(strips: WornStrips, grid: ProfileGrid, place: Place | None = None) -> ProfileRates:
    """Rates of a contact on one of its profiles.

    Parameters:
        strips: of the contact.
        grid: of the new profile.
        place: arc length on the new profile by that of the profile in contact; None: the same.
    """
    dissipated = _sums(strips.patch, strips.energy, len(strips.t_gamma))[strips.patch]
    of_patch = np.divide(strips.energy, dissipated, out=np.zeros(len(dissipated)), where=dissipated > 0.0)
    damage = np.maximum(whole_life_rail_damage(strips.t_gamma), 0.0)[strips.patch] * of_patch
    values = np.column_stack(
        [strips.volume, strips.volume * strips.pressure, strips.severe, strips.energy, damage, strips.traction]
    )
    rows = grid.rows(strips, place)
    cells = grid.deposited(rows, values)
    outside = float(strips.volume.sum() - cells[:, 0].sum())
    removed, pressed, severe, energy, damaged, *traction = (cells / grid.per_passage[:, None]).T
    return ProfileRates(
        removed=removed,
        pressed=pressed,
        severe=np.minimum(severe, removed),  # curves through both differ between the bounds of strips
        energy=energy,
        fatigue_index=grid.covered(rows, strips, strips.fatigue_index) / grid.per_passage,
        damage=damaged,
        traction=np.stack(traction, axis=1),
        outside=outside,
        t_gamma=float(strips.t_gamma.sum()),
        unbalanced=float(strips.unbalanced.sum()),
    )


def total(rates: Sequence[ProfileRates], weights: Sequence[float]) -> ProfileRates:
    """Weighted sum of rates on the same grid."""
    names = [part.name for part in fields(ProfileRates)]
    return ProfileRates(
        **{name: sum(weight * getattr(own, name) for own, weight in zip(rates, weights, strict=True)) for name in names}
    )
