"""Levels of a lattice: strips of half, a quarter, ... of their width for contacts that are narrow.

The level follows the width of the undeformed penetration, the number n of ordinary strips across it, which is a
continuous function of the pose. On level L these are 2^L n. With x the number on a level, from LEAST to 2 LEAST of the
strips asked for, the force is S F_L + (1 - S) F_(L+1), S rising smoothly from 0 at LEAST to 1 at ENOUGH: one level
alone from there on, and the same force from below and above where the level changes.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from wheelrail.contact.models.lattice.solver.newton import LatticeSolution
from wheelrail.contact.models.lattice.system.penetrated_width import maxima, penetrated_width, strips_across
from wheelrail.contact.models.lattice.system.problem import LatticeProblem
from wheelrail.contact.models.lattice.system.surface import motion_data
from wheelrail.support.arrays import Array

LEAST = 3 / 7  # of the strips asked for, across the penetration: an ellipse of half-spaces has 0.7 as many loaded ones
ENOUGH = 4 / 7
SURELY = 1.15  # times ENOUGH by the strips' means, which err by less: no exact width is needed
FINEST = 5  # level, with 14 strips for patches of 0.1 N on a tread; less has fewer strips


@dataclass(frozen=True, eq=False)
class LevelSolutions:
    """Solutions on levels other than the ordinary one, or on two of them."""

    levels: tuple[int, ...]
    solutions: tuple[LatticeSolution | None, ...]

    def on(self, level: int) -> LatticeSolution | None:
        """The solution on a level; None without."""
        return dict(zip(self.levels, self.solutions, strict=True)).get(level)


@dataclass(frozen=True, eq=False)
class LevelShares:
    """Levels that make up the force at a pose.

    Parameters:
        levels: one or two successive ones.
        share: of the first.
        change: computes the derivative (6,) of the share by the pose; None of a single level.
    """

    levels: tuple[int, ...] = (0,)
    share: float = 1.0
    change: Callable[[], Array] | None = None


ORDINARY = LevelShares()


def level_shares(problem: LatticeProblem, strips: int) -> LevelShares:
    """Levels for a pose, from the equations on ordinary strips and their number over a usual patch."""
    if strips_across(problem.depth) > SURELY * ENOUGH * strips:
        return ORDINARY
    data = motion_data(problem.pose, problem.motion, 1.0)
    lattice = problem.surface, data.origin, data.rotation, problem.middle, problem.width
    pieces = maxima(*lattice, problem.depth)
    across, _ = penetrated_width(*lattice, *pieces, False)
    if not across > 0:
        return ORDINARY
    fraction = across / strips
    level = int(np.clip(np.ceil(np.log2(LEAST / fraction)), 0, FINEST))
    at = (2.0**level * fraction - LEAST) / (ENOUGH - LEAST)
    if at >= 1:
        return LevelShares((level,)) if level else ORDINARY
    if at <= 0 or level == FINEST:
        return LevelShares((min(level + 1, FINEST),))

    def change() -> Array:
        by_number = 2.0**level / strips / (ENOUGH - LEAST) * 30 * at**2 * (1 - at) ** 2
        return np.asarray(by_number * penetrated_width(*lattice, *pieces, True)[1])

    return LevelShares((level, level + 1), at**3 * (10 - 15 * at + 6 * at**2), change)
