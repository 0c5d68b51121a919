"""The processes that share a solve under `mpirun`: sums over their parts, values that are the same on all of them.

Meshes, matrices and displacements are split; contact points, their law and all results are known everywhere. What
decides where the program goes next is a `total` or `shared`, so that no rank takes another way than the rest.
"""

from __future__ import annotations

import sys
from collections.abc import Callable
from dataclasses import dataclass
from functools import cache
from types import TracebackType
from typing import Any, TypeVar

import numpy as np
from mpi4py import MPI

from wheelrail.support.arrays import Array

T = TypeVar("T")


@dataclass(frozen=True)
class Ranks:
    """Processes of a communicator; every method is called by all of them."""

    comm: Any

    @property
    def size(self) -> int:
        return int(self.comm.size)

    @property
    def first(self) -> bool:
        return int(self.comm.rank) == 0

    def total(self, part: Array) -> Array:
        """Sum of every rank's array, the same to the last bit on all."""
        if self.size == 1:
            return part
        part, whole = np.asarray(part, dtype=float, order="C"), np.empty(part.shape)
        self.comm.Reduce(part, whole)
        self.comm.Bcast(whole)
        return whole

    def norm(self, part: Array) -> float:
        """Euclidean norm of a vector that is split over the ranks."""
        return float(np.sqrt(self.total(np.array(part @ part))))

    def shared(self, make: Callable[[], T]) -> T:
        """What the first rank makes, on all of them; an error there is raised on all of them."""
        if self.size == 1:
            return make()
        value: T | None = None
        error: Exception | None = None
        if self.first:
            try:
                value = make()
            except Exception as raised:
                error = raised
        value, error = self.comm.bcast((value, error))
        if error is not None:
            raise error
        return value  # type: ignore[return-value]

    def ahead(self, make: Callable[[], T]) -> T:
        """What every rank makes for itself, the first before the others: they find its compiled forms on disk."""
        if self.first:
            made = make()
        self.comm.Barrier()
        return made if self.first else make()


ALONE = Ranks(MPI.COMM_SELF)


@cache
def everyone() -> Ranks:
    """All processes that `mpirun` started; from now on an error that nobody catches on one of them ends all."""
    ranks = Ranks(MPI.COMM_WORLD)
    if ranks.size > 1:
        before = sys.excepthook

        def end_all(kind: type[BaseException], error: BaseException, trace: TracebackType | None) -> None:
            before(kind, error, trace)
            sys.stderr.flush()
            ranks.comm.Abort(1)  # the others wait for this one in the middle of a sum

        sys.excepthook = end_all
    return ranks
