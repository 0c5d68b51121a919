"""Construction of a table: contact without friction, then friction, each refined until tests of intervals pass."""

from __future__ import annotations

import logging
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from itertools import product

import numpy as np

from wheelrail.contact.models.table.force_table import ForceTable, FrictionTable, NormalTable
from wheelrail.contact.tables.errors import TableErrors, table_errors
from wheelrail.contact.tables.nodes import Nodes, Trial
from wheelrail.contact.tables.samples import TableSampler
from wheelrail.contact.tables.table_range import TableRange
from wheelrail.contact.tables.tasks import ForceTask, NormalTask, Solve
from wheelrail.support.arrays import Array

log = logging.getLogger(__name__)

# At the start:
LEVELS, CREEPAGES = 6, 7  # nodes of the load without friction, and of each creepage
SPACING, SPACING_FRICTION = 5e-4, 1e-3  # m, of nodes over y
SAMPLES = 200  # fresh points after the tests
TURN = 5e-3  # 1/m, largest rotation rate about z over speed there: a curve of 200 m, or 0.1 rad/s at 20 m/s
ROUNDS, MARGIN = 5, 0.9  # of tests; threshold of the next one, over that in proportion to the error


class NoSolution(RuntimeError):
    """Contact model with too many failures for a table."""


@dataclass(frozen=True)
class TableBuilder:
    """Builds the table of one side.

    Parameters:
        sampler: of the contact model.
        ranges: of the variables.
        tolerance: of the root mean square of the force's error over the vertical load.
        solve: returns the rows of tasks.
    """

    sampler: TableSampler
    ranges: TableRange
    tolerance: float
    solve: Solve

    def build(self) -> tuple[ForceTable, TableErrors]:
        """Table, and its errors at fresh random points; the tolerance is not met where ROUNDS are not enough.

        Raises NoSolution where the model fails too often.
        """
        table = self._without_friction(self._refined_normal())
        if not self.sampler.coefficient > 0.0:
            return table, self.errors(table, 0)
        nodes, rows = self._friction_nodes(table.normal), dict[tuple[float, ...], Array]()
        threshold = self.tolerance / np.sqrt(len(nodes.axes))  # squares of the errors of all axes add up
        for count in range(ROUNDS):
            table = self._refined_friction(table.normal, nodes, rows, threshold, count)
            errors = self.errors(table, count)
            log.info(
                "error at %d fresh points: %.2g %% of the load RMS, %.2g %% worst",
                SAMPLES,
                100.0 * errors.rms,
                100.0 * errors.worst,
            )
            if errors.rms <= self.tolerance:
                break
            threshold *= MARGIN * self.tolerance / errors.rms
            nodes.sound.clear()
        return table, errors

    def errors(self, table: ForceTable, seed: int) -> TableErrors:
        """Errors at random points: uniform in positions, load^(2/3), rotation rate about z, and asinh of creepages."""
        random, ranges = np.random.default_rng([1, seed]), self.ranges
        tasks = []
        for _ in range(SAMPLES):
            ends = ranges.y, ranges.roll, ranges.yaw, ranges.levels
            at = self.sampler.at_level(table.normal, *(float(random.uniform(*pair)) for pair in ends))
            longitudinal, lateral = np.sinh(random.uniform(*ranges.creepages, 2)).tolist()
            creepages = ((longitudinal, lateral),) if table.friction.coefficient > 0.0 else ()
            tasks.append(ForceTask(at, creepages, float(random.uniform(-TURN, TURN))))
        rows = self.solve(tasks, f"{SAMPLES} fresh points")
        return table_errors(self.sampler, table, self._without_friction(table.normal), tasks, rows)

    def _refined_normal(self) -> NormalTable:
        ranges = self.ranges
        axes = {
            "y": _spaced(ranges.y, SPACING),
            "roll": np.linspace(*ranges.roll, 3),
            "yaw": np.linspace(*ranges.yaw, 3),
            "level": np.linspace(*ranges.levels, LEVELS),
        }
        ends = {"y": ranges.y, "roll": ranges.roll, "yaw": ranges.yaw, "level": ranges.levels}
        nodes, random = Nodes(axes, ends), np.random.default_rng(2)
        rows: dict[tuple[float, ...], Array] = {}
        while True:
            table = self._normal(nodes, rows)
            trials = nodes.trials(random)
            errors = self._errors_of_trials(self._without_friction(table), trials)
            if not nodes.refine(trials, errors, 0.5 * self.tolerance / np.sqrt(len(nodes.axes))):
                return table

    def _normal(self, nodes: Nodes, rows: dict[tuple[float, ...], Array]) -> NormalTable:
        """Table at the nodes; the height of first contact is extrapolated from the two smallest loads.

        Parameters:
            nodes: of all axes.
            rows: (9,) by node, to which those of new nodes are added.
        """
        y, roll, yaw, level = nodes.axes.values()
        places = list(product(y.tolist(), roll.tolist(), yaw.tolist()))
        tasks = []
        for place in places:
            loads = tuple(value**1.5 for value in level.tolist() if (*place, value**1.5) not in rows)
            tasks += [NormalTask(*place, loads)] if loads else []
        for task, solved in zip(tasks, self.solve(tasks, f"without friction, {len(tasks)} positions"), strict=True):
            rows |= {(task.y, task.roll, task.yaw, load): row for load, row in zip(task.loads, solved, strict=True)}
        values = np.array([[rows[*place, value**1.5] for value in level.tolist()] for place in places])
        values = np.array([completed(rows_of_place, level) for rows_of_place in values])
        touch = values[:, 0].copy()
        touch[:, 0] += (values[:, 0, 0] - values[:, 1, 0]) * level[0] / (level[1] - level[0])
        values = np.concatenate([touch[:, None], values], axis=1)
        return NormalTable(y, roll, yaw, np.concatenate([[0.0], level]), values.ravel())

    def _without_friction(self, normal: NormalTable) -> ForceTable:
        node = np.zeros(1)
        return ForceTable(
            self.sampler.frame, normal, FrictionTable(node, node, node, node, node, node, np.zeros(6), 0.0)
        )

    def _friction_nodes(self, normal: NormalTable) -> Nodes:
        """Nodes at the start: one roll and yaw, three loads."""
        ranges = self.ranges
        creepages = np.linspace(*ranges.creepages, CREEPAGES)
        axes = {
            "y": _spaced(ranges.y, SPACING_FRICTION),
            "roll": np.array([0.5 * sum(ranges.roll)]),
            "yaw": np.array([0.5 * sum(ranges.yaw)]),
            "level": normal.level[[1, len(normal.level) // 2, -1]],
            "longitudinal": creepages,
            "lateral": creepages,
        }
        ends = {"y": ranges.y, "roll": ranges.roll, "yaw": ranges.yaw, "level": ranges.levels}
        return Nodes(axes, {**ends, "longitudinal": ranges.creepages, "lateral": ranges.creepages})

    def _refined_friction(
        self, normal: NormalTable, nodes: Nodes, rows: dict[tuple[float, ...], Array], threshold: float, seed: int
    ) -> ForceTable:
        random = np.random.default_rng([3, seed])
        while True:
            table = replace(self._without_friction(normal), friction=self._friction(normal, nodes, rows))
            trials = nodes.trials(random)
            if not nodes.refine(trials, self._errors_of_trials(table, trials), threshold):
                return table

    def _friction(self, normal: NormalTable, nodes: Nodes, rows: dict[tuple[float, ...], Array]) -> FrictionTable:
        """Table at the nodes.

        Parameters:
            normal: contact without friction.
            nodes: of all axes.
            rows: force and moment (6,) by node, to which those of new nodes are added.
        """
        y, roll, yaw, level, longitudinal, lateral = nodes.axes.values()
        path = to_and_fro(longitudinal, lateral)
        places = list(product(y.tolist(), roll.tolist(), yaw.tolist(), level.tolist()))
        new = {place: own for place in places if (own := [pair for pair in path if (*place, *pair) not in rows])}
        points = {place: self.sampler.at_level(normal, *place) for place in places}
        tasks = [
            ForceTask(points[place], tuple((float(np.sinh(a)), float(np.sinh(b))) for a, b in pairs))
            for place, pairs in new.items()
        ]
        results = self.solve(tasks, f"with friction, {_times(nodes.shape)} points")
        for (place, pairs), forces in zip(new.items(), results, strict=True):
            rows |= {(*place, *pair): force for pair, force in zip(pairs, forces, strict=True)}
        values = []
        for place in places:
            for a in longitudinal.tolist():
                line = completed(np.array([rows[*place, a, b] for b in lateral.tolist()]), lateral)
                values += [self.sampler.friction_row(points[place], force) for force in line]
        return FrictionTable(
            y, roll, yaw, level, longitudinal, lateral, np.concatenate(values), self.sampler.coefficient
        )

    def _errors_of_trials(self, table: ForceTable, trials: Sequence[Trial]) -> Array:
        """Lengths (n,) of the errors at trials; zero where the model failed."""
        tasks = [self._trial_task(table.normal, trial.point) for trial in trials]
        if not tasks:
            return np.zeros(0)
        rows = self.solve(tasks, f"{len(tasks)} tests of intervals")
        errors = table_errors(self.sampler, table, self._without_friction(table.normal), tasks, rows)
        return np.nan_to_num(errors.lengths)

    def _trial_task(self, normal: NormalTable, point: Mapping[str, float]) -> ForceTask:
        at = self.sampler.at_level(normal, point["y"], point["roll"], point["yaw"], point["level"])
        if "lateral" not in point:
            return ForceTask(at, ())
        return ForceTask(at, ((float(np.sinh(point["longitudinal"])), float(np.sinh(point["lateral"]))),))


def completed(rows: Array, nodes: Array) -> Array:
    """Rows (n, m) with failed solves, NaN, interpolated between their neighbours.

    Parameters:
        rows: values at n nodes.
        nodes: (n,), increasing; beyond the last rows with values the line through the nearest two continues.

    Raises NoSolution for less than two rows with values.
    """
    solved = ~np.isnan(rows).any(axis=1)
    if solved.all():
        return rows
    if solved.sum() < 2:
        raise NoSolution(f"the model has solutions at {solved.sum()} of {len(rows)} values of a variable")
    known, values = nodes[solved], rows[solved]
    place = np.clip(np.searchsorted(known, nodes) - 1, 0, len(known) - 2)
    fraction = ((nodes - known[place]) / (known[place + 1] - known[place]))[:, None]
    between = (1.0 - fraction) * values[place] + fraction * values[place + 1]
    return np.where(solved[:, None], rows, between)


def to_and_fro(inner: Array, outer: Array) -> list[tuple[float, float]]:
    """Boustrophedon order of the pairs of nodes, so that each solve starts from its neighbour.

    The lateral creepage, the outer one, moves the patch of a flange: it changes least often.
    """
    return [(a, b) for i, b in enumerate(outer.tolist()) for a in inner[:: -1 if i % 2 else 1].tolist()]


def _spaced(ends: tuple[float, float], spacing: float) -> Array:
    """Nodes from end to end, at most a spacing apart, at least three."""
    return np.linspace(*ends, max(3, int(np.ceil((ends[1] - ends[0]) / spacing)) + 1))


def _times(numbers: Sequence[int]) -> str:
    return " x ".join(map(str, numbers))
