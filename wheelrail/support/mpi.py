"""Communicator of a solve under `mpirun`: all-reduce and broadcast.

Meshes, matrices and displacements are distributed; contact points, their law and all results are replicated. Branches
of the program depend only on values of `all_reduce` or `broadcast`, so that all ranks take the same.
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
    """Processes of a communicator; all methods are collective."""

    comm: Any

    @property
    def size(self) -> int:
        return int(self.comm.size)

    @property
    def first(self) -> bool:
        return int(self.comm.rank) == 0

    def all_reduce(self, part: Array) -> Array:
        """Sum of the arrays of all ranks, bitwise the same on all (all-reduce)."""
        if self.size == 1:
            return part
        part, total = np.asarray(part, dtype=float, order="C"), np.empty(part.shape)
        self.comm.Reduce(part, total)
        self.comm.Bcast(total)
        return total

    def norm(self, part: Array) -> float:
        """Euclidean norm of a vector that is distributed over the ranks."""
        return float(np.sqrt(self.all_reduce(np.array(part @ part))))

    def broadcast(self, make: Callable[[], T]) -> T:
        """Result of a function on the first rank, broadcast to all; an exception there is raised on all of them."""
        if self.size == 1:
            return make()
        value: T | None = None
        error: Exception | None = None
        if self.first:
            try:
                value = make()
            except Exception as exception:
                error = exception
        value, error = self.comm.bcast((value, error))
        if error is not None:
            raise error
        return value  # type: ignore[return-value]

    def first_then_all(self, make: Callable[[], T]) -> T:
        """Result of a function on every rank, first on rank 0; other ranks then load its compiled forms."""
        if self.first:
            value = make()
        self.comm.Barrier()
        return value if self.first else make()


SELF = Ranks(MPI.COMM_SELF)


@cache
def world() -> Ranks:
    """All processes started by `mpirun`; after the first call an uncaught exception on one of them aborts all."""
    ranks = Ranks(MPI.COMM_WORLD)
    if ranks.size > 1:
        hook = sys.excepthook

        def end_all(kind: type[BaseException], error: BaseException, trace: TracebackType | None) -> None:
            hook(kind, error, trace)
            sys.stderr.flush()
            ranks.comm.Abort(1)  # the others wait for this one in a collective call

        sys.excepthook = end_all
    return ranks
