"""Levels of a lattice: strips of half, a quarter, ... of their width for contacts that are narrow.

The level follows the width of the undeformed penetration, the number n of ordinary strips across it, which is a
continuous function of the pose. Strips count less where patches are longer than wide: less of the penetration is loaded
there. On level L there are 2^L n. With x the number on a level, from LEAST to 2 LEAST, the force is
S F_L + (1 - S) F_(L+1), S rising smoothly from 0 at LEAST to 1 at ENOUGH: one level alone from there on, and the same
force from below and above where the level changes. LEAST is FEWEST strips or more: on fewer loaded ones forces err by
per cents, and peak pressures by tens of them.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from wheelrail.bindings._contact import maxima, penetrated_width, strips_across
from wheelrail.contact.models.lattice.bulk_displacement import NONE, BulkDisplacement
from wheelrail.contact.models.lattice.solver.newton import LatticeSolution
from wheelrail.contact.models.lattice.system.problem import LatticeProblem
from wheelrail.contact.models.lattice.system.surface import motion_data
from wheelrail.contact.solvers.tangent import CHANGES
from wheelrail.support.arrays import Array

LEAST = 1 / 2  # of the strips asked for, across the penetration: an ellipse of half-spaces has 0.7 as many loaded ones
ENOUGH = 4 / 3  # times LEAST
FEWEST = 2.5  # strips, of LEAST
SURELY = 1.15  # times that by the strips' means, which err by less: no exact width is needed
FINEST = 5  # level, with 14 strips for patches of 0.1 N on a tread; less has fewer strips


@dataclass(frozen=True, eq=False)
class LevelSolutions:
    """Solutions on levels other than the ordinary one, or on two of them.

    Parameters:
        levels: one or two, whose forces count.
        solutions: on these; None without load.
        ordinary: of finite bodies, on the ordinary level, from which their displacement is.
    """

    levels: tuple[int, ...]
    solutions: tuple[LatticeSolution | None, ...]
    ordinary: LatticeSolution | None = None

    def on(self, level: int) -> LatticeSolution | None:
        """The solution on a level; None without."""
        return dict(zip((0, *self.levels), (self.ordinary, *self.solutions), strict=True)).get(level)


@dataclass(frozen=True, eq=False)
class LevelShares:
    """Levels that make up the force at a pose.

    Parameters:
        levels: one or two successive ones.
        share: of the first.
        change: computes the derivative (12,) of the share by pose and motion; None of a single level.
    """

    levels: tuple[int, ...] = (0,)
    share: float = 1.0
    change: Callable[[], Array] | None = None


ORDINARY = LevelShares()


def least_strips(strips: int) -> float:
    """LEAST across the penetration for a number of strips over a usual patch."""
    return max(LEAST * strips, FEWEST)


def level_shares(problem: LatticeProblem, strips: int, bulk: BulkDisplacement | None = None) -> LevelShares:
    """Levels for a pose.

    Parameters:
        problem: equations on ordinary strips.
        strips: their number over a usual patch.
        bulk: displacement of finite bodies in their solution; None of half-spaces, and without a load.
    """
    least, slender = least_strips(strips), problem.tables.slenderness
    across = strips_across(problem.depth, slender) if bulk is None else bulk.strips_across
    if across > SURELY * ENOUGH * least:
        return ORDINARY
    depth, lift = problem.depth, NONE
    if bulk is not None:
        lift = bulk.lift
        depth = depth - np.interp(problem.middle, *lift)
    data = motion_data(problem.pose, problem.motion, 1.0)
    surfaces, lattice = (problem.surface, data.origin, data.rotation, lift), (problem.middle, problem.width)
    pieces = maxima(*surfaces, *lattice, depth)
    counted = problem.middle, problem.width * slender
    across, _ = penetrated_width(*surfaces, *counted, *pieces, False)
    if not across > 0:
        return ORDINARY
    part = across / least
    level = int(np.clip(np.ceil(-np.log2(part)), 0, FINEST))
    at = (2.0**level * part - 1.0) / (ENOUGH - 1.0)
    if at >= 1:
        return LevelShares((level,)) if level else ORDINARY
    if at <= 0 or level == FINEST:
        return LevelShares((min(level + 1, FINEST),))

    def change() -> Array:
        by_number = 2.0**level / least / (ENOUGH - 1.0) * 30 * at**2 * (1 - at) ** 2
        _, slopes = penetrated_width(*surfaces, *counted, *pieces, True)
        total = np.zeros(CHANGES)
        total[:6] = slopes[:6]
        if bulk is not None:
            total += bulk.changes(slopes[6:])
        return by_number * total

    return LevelShares((level, level + 1), at**3 * (10 - 15 * at + 6 * at**2), change)
