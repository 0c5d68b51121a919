"""Tasks that fill a table: plain numbers, which can be sent to other processes and stored."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np

from wheelrail.contact.tables.samples import TableContactPoint, TableSampler
from wheelrail.support.arrays import Array


@dataclass(frozen=True)
class NormalTask:
    """Values (loads, 9) of a `NormalTable` at one position.

    Parameters:
        y, roll, yaw: of the tread.
        loads: vertical, N.
    """

    y: float
    roll: float
    yaw: float
    loads: tuple[float, ...]

    def rows(self, sampler: TableSampler) -> Array:
        """NaN for loads that are not found."""
        return sampler.normal_rows(self.y, self.roll, self.yaw, self.loads)


@dataclass(frozen=True)
class ForceTask:
    """Force and moment (n, 6) about the rail's origin at one position; NaN where the model fails.

    Parameters:
        at: contact without friction.
        creepages: n pairs over their scale; none: one row without friction.
        turn: further rotation rate about z over speed, 1/m.
    """

    at: TableContactPoint
    creepages: tuple[tuple[float, float], ...]
    turn: float = 0.0

    def rows(self, sampler: TableSampler) -> Array:
        """Each solve starts from the one before."""
        pose = sampler.frame.pose(*self.at.position)
        if not self.creepages:
            result = sampler.frictionless(pose, sampler.rolling(pose), None)
            return np.concatenate([result.force, result.moment])[None] if result.ok else np.full((1, 6), np.nan)
        rows, guess = np.full((len(self.creepages), 6), np.nan), None
        for row, creepage in zip(rows, self.creepages, strict=True):
            result = sampler.solved(pose, sampler.motion(self.at, creepage, self.turn), guess)
            if result.ok:
                row[:3], row[3:], guess = result.force, result.moment, result
        return rows


Task = NormalTask | ForceTask
Solve = Callable[[Sequence[Task], str], list[Array]]  # tasks, and what they are for -> rows of each
