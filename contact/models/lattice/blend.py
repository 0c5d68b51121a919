"""Result between two levels of a lattice: their forces, patches and fields in proportion to their shares.

Fields are those of both levels side by side, cells with their share of the area: sums over areas are those of the
force. Patches that overlap are one, with means of both; one without a counterpart has its share of area and force.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, fields, replace
from functools import cached_property
from typing import Any

import numpy as np

from wheelrail.contact.models.lattice.levels import LevelShares
from wheelrail.contact.results.result import ContactResult, Fields, LazyFields, LazyPatches, Patch, Statistics
from wheelrail.contact.solvers.tangent import ContactTangent
from wheelrail.support.arrays import Array, Nodes

Value = float | Array | tuple[float, ...]

SUMS = "area", "normal_force", "force", "tangential_force", "stick_area", "frictional_power"


def blended(first: ContactResult, second: ContactResult, shares: LevelShares) -> ContactResult:
    """Result of both levels, in the frame of the rail; the failed one if there is such."""
    for result in (first, second):
        if not result.ok:
            return result
    share, details = shares.share, BlendDetails(first, second, shares.share)
    return ContactResult(
        force=_mean(share, first.force, second.force),
        moment=_mean(share, first.moment, second.moment),
        patches=LazyPatches(lambda: details.patches),
        fields=LazyFields(lambda: details.fields),
        approach=share * first.approach + (1 - share) * second.approach,
        status="converged",
        statistics=_summed(first.statistics, second.statistics),
        force_tangent=ContactTangent(BlendedForce(first, second, shares)),
    )


def _mean(share: float, first: Array, second: Array) -> Array:
    return np.asarray(share * first + (1 - share) * second)


def _summed(first: Statistics, second: Statistics) -> Statistics:
    names = first.seconds | second.seconds
    return Statistics(
        newton=first.newton + second.newton,
        linear=first.linear + second.linear,
        points=first.points + second.points,
        residual=max(first.residual, second.residual),
        seconds={name: first.seconds.get(name, 0.0) + second.seconds.get(name, 0.0) for name in names},
    )


@dataclass(frozen=True, eq=False)
class BlendedForce:
    """Linearised force of two levels, whose shares depend on the pose."""

    first: ContactResult
    second: ContactResult
    shares: LevelShares

    @cached_property
    def matrix(self) -> Array:
        """Derivative (6, 12) of force and moment about the rail's origin."""
        total = _mean(self.shares.share, self.first.tangent(), self.second.tangent())
        assert self.shares.change is not None
        loads = [np.concatenate([result.force, result.moment]) for result in (self.first, self.second)]
        total += np.outer(loads[0] - loads[1], self.shares.change())
        return total


@dataclass(frozen=True, eq=False)
class BlendDetails:
    """Patches and fields of two levels, the first with a share."""

    first: ContactResult
    second: ContactResult
    share: float

    @cached_property
    def pairs(self) -> list[tuple[int, int]]:
        """Patches of both levels that are one; -1 without a counterpart."""
        free = list(range(len(self.second.patches)))
        pairs = []
        for i, patch in enumerate(self.first.patches):
            partner = next((j for j in free if _overlap(patch, self.second.patches[j])), -1)
            if partner >= 0:
                free.remove(partner)
            pairs.append((i, partner))
        return pairs + [(-1, j) for j in free]

    @cached_property
    def patches(self) -> tuple[Patch, ...]:
        """Patches of the blend."""
        return tuple(self._patch(*pair) for pair in self.pairs)

    def _patch(self, i: int, j: int) -> Patch:
        own = [result.patches[k] for k, result in ((i, self.first), (j, self.second)) if k >= 0]
        shares = [share for k, share in ((i, self.share), (j, 1 - self.share)) if k >= 0]
        weights = np.array(shares) / sum(shares)
        values: dict[str, Any] = {
            name: _combined([getattr(patch, name) for patch in own], shares if name in SUMS else weights)
            for name in (part.name for part in fields(Patch))
        }
        return Patch(**values | {"strips": round(values["strips"])})

    @cached_property
    def fields(self) -> Fields:
        """Cells of both levels."""
        parts = []
        for side, (result, share) in enumerate(((self.first, self.share), (self.second, 1 - self.share))):
            own = result.fields
            if own is None:
                continue
            number = {pair[side]: k for k, pair in enumerate(self.pairs)}
            patch: Nodes = np.array([number[k] if k >= 0 else -1 for k in own.patch.tolist()], dtype=int)
            shares = np.full(len(own.area), share)
            parts.append(replace(own, patch=patch, area=share * own.area, share=shares))
        whole = {
            part.name: np.concatenate([getattr(own, part.name) for own in parts])
            for part in fields(Fields)
            if part.name not in ("node", "sticks")
        }
        return Fields(node=np.arange(len(whole["area"])), sticks=None, **whole)


def _overlap(one: Patch, other: Patch) -> bool:
    return one.wheel_band[0] < other.wheel_band[1] and other.wheel_band[0] < one.wheel_band[1]


def _combined(values: Sequence[Value], weights: Sequence[float] | Array) -> Value:
    """Weighted sum of numbers, arrays or tuples."""
    total = np.tensordot(weights, np.array(values, dtype=float), 1)
    if isinstance(values[0], tuple):
        return tuple(total.tolist())
    return np.asarray(total) if isinstance(values[0], np.ndarray) else float(total)
