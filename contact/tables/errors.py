"""Differences between the forces of a table and of the contact model."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from wheelrail.contact.models.table.force_table import ForceTable
from wheelrail.contact.tables.samples import TableSampler
from wheelrail.contact.tables.tasks import ForceTask
from wheelrail.support.arrays import Array

VARIABLES = ("y", "z", "roll", "yaw", "load", "longitudinal", "lateral")


@dataclass(frozen=True, eq=False)
class TableErrors:
    """Force of a table less that of the model, over the vertical load, at points between the nodes.

    Parameters:
        points: (n, 7): y, z, roll, yaw, vertical load without friction N, creepages over their scale.
        force: (n, 3); NaN where the model failed.
        moment: (n, 3) m, about the point of contact.
    """

    points: Array
    force: Array
    moment: Array

    @property
    def lengths(self) -> Array:
        """Length (n,) of the difference of the forces."""
        return np.asarray(np.linalg.norm(self.force, axis=1))

    @property
    def rms(self) -> float:
        """Root mean square of the lengths."""
        return float(np.sqrt(np.nanmean(self.lengths**2)))

    @property
    def worst(self) -> float:
        """Largest length."""
        return float(np.nanmax(self.lengths))

    @property
    def failed(self) -> int:
        """Number of points at which the model failed."""
        return int(np.isnan(self.force[:, 0]).sum())


def table_errors(
    sampler: TableSampler,
    table: ForceTable,
    frictionless: ForceTable,
    tasks: Sequence[ForceTask],
    rows: Sequence[Array],
) -> TableErrors:
    """Errors at the points of tasks with one row each.

    Parameters:
        sampler: of the model.
        table: of forces; frictionless: the same without friction, for tasks without creepages.
        tasks: points.
        rows: (1, 6) force and moment of the model for every task.
    """
    points, force, moment = np.zeros((len(tasks), len(VARIABLES))), np.zeros((len(tasks), 3)), np.zeros((len(tasks), 3))
    for k, (task, solved) in enumerate(zip(tasks, rows, strict=True)):
        at, pose = task.at, sampler.frame.pose(*task.at.position)
        creepage = task.creepages[0] if task.creepages else (0.0, 0.0)
        motion = sampler.motion(at, creepage, task.turn) if task.creepages else sampler.rolling(pose)
        difference = (table if task.creepages else frictionless).force(pose, motion).values - solved[0]
        points[k] = *at.position, at.load, *creepage
        force[k] = difference[:3] / at.load
        moment[k] = (difference[3:] - np.cross(at.point, difference[:3])) / at.load
    return TableErrors(points, force, moment)
