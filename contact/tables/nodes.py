"""Nodes of the axes of a table, refined by the interpolation error."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field
from itertools import pairwise

import numpy as np

from wheelrail.support.arrays import Array

DRAWS = 3  # random values of the other coordinates for every test, on the axis with most intervals
FINEST = 512  # smallest interval: this part of the axis


@dataclass(frozen=True)
class Trial:
    """Test point between two nodes of one axis, at nodes of all other axes.

    Parameters:
        axis: name.
        interval: lower and upper end; equal ends: of an axis with one node.
        point: coordinates by axis.
    """

    axis: str
    interval: tuple[float, float]
    point: Mapping[str, float]


@dataclass
class Nodes:
    """Nodes of each axis of a tensor product.

    Parameters:
        axes: increasing nodes by name.
        ends: range of each axis; an axis of one node, at which values are constant, is tested at its ends.
        sound: intervals that have been tested and are fine.
    """

    axes: dict[str, Array]
    ends: Mapping[str, tuple[float, float]]
    sound: set[tuple[str, float, float]] = field(default_factory=set)

    @property
    def shape(self) -> tuple[int, ...]:
        return tuple(len(nodes) for nodes in self.axes.values())

    def trials(self, random: np.random.Generator) -> list[Trial]:
        """Trials of all intervals that are not known to be sound.

        All axes have as many: errors in a small part of the other axes are found on short and long ones alike.
        """
        intervals = {axis: list(self._intervals(axis)) for axis in self.axes}
        most = max(map(len, intervals.values()))
        return [
            Trial(axis, (low, high), {**self._random_nodes(random), axis: middle})
            for axis, own in intervals.items()
            for low, high, middle in own
            if (axis, low, high) not in self.sound
            for _ in range(DRAWS * most // len(own))
        ]

    def refine(self, trials: list[Trial], errors: Array, threshold: float) -> bool:
        """Bisect the intervals of trials with errors above a threshold, RMS; returns whether there are any.

        One node becomes the two ends.
        """
        squares: dict[tuple[str, float, float], list[float]] = {}
        for trial, error in zip(trials, errors, strict=True):
            squares.setdefault((trial.axis, *trial.interval), []).append(float(error) ** 2)
        new: dict[str, set[float]] = {}
        for (axis, low, high), own in squares.items():
            first, last = self.ends[axis]
            if sum(own) <= threshold**2 * len(own) or high - low <= (last - first) / FINEST:
                self.sound.add((axis, low, high))
            else:
                new.setdefault(axis, set()).add(0.5 * (low + high))
        for axis, points in new.items():
            own = self.axes[axis].tolist()
            self.axes[axis] = np.array(sorted({*own, *points}) if len(own) > 1 else self.ends[axis])
        return bool(new)

    def _intervals(self, axis: str) -> Iterator[tuple[float, float, float]]:
        """Ends and test point of each interval of an axis."""
        nodes = self.axes[axis].tolist()
        if len(nodes) > 1:
            yield from ((low, high, 0.5 * (low + high)) for low, high in pairwise(nodes))
        elif self.ends[axis][0] < self.ends[axis][1]:
            first, last = self.ends[axis]
            yield from ((first, nodes[0], first), (nodes[0], last, last))

    def _random_nodes(self, random: np.random.Generator) -> dict[str, float]:
        return {axis: float(random.choice(nodes)) for axis, nodes in self.axes.items()}
