"""The command under `mpirun`: the first rank speaks for all, and all end together."""

from __future__ import annotations

import io
import os
import sys
import time
import traceback
from collections.abc import Iterator
from contextlib import contextmanager

# Number of processes in the environment, by Open MPI, MPICH, Slurm. Other signs of MPI tell nothing: they pass to
# whatever is started by a process that has loaded MPI by itself.
SIZES = ("OMPI_COMM_WORLD_SIZE", "PMI_SIZE", "SLURM_STEP_NUM_TASKS")
GRACE = 2.0  # s that the first rank has to end all with its own words


def several() -> bool:
    """Whether `mpirun` started more than this process; MPI is loaded only where there are signs of it."""
    if all(os.environ.get(size, "1") == "1" for size in SIZES):
        return False
    from wheelrail.support.mpi import everyone

    return everyone().size > 1


def first() -> bool:
    """Whether this process writes what all have found."""
    if not several():
        return True
    from wheelrail.support.mpi import everyone

    return everyone().first


@contextmanager
def as_one() -> Iterator[None]:
    """Nothing but the first rank's words on both outputs; a failure of any rank, told by it if the first has none to
    tell, ends all with its exit code: the others may wait for it in the middle of a sum.
    """
    if not several():
        yield
        return
    from wheelrail.support.mpi import everyone

    ranks, aside, status = everyone(), io.StringIO(), 0
    if not ranks.first:
        sys.stdout, sys.stderr = io.StringIO(), aside
    try:
        yield
    except SystemExit as end:
        status = end.code if isinstance(end.code, int) else int(end.code is not None)
    except BaseException:
        traceback.print_exc()
        status = 1
    if status:
        if not ranks.first:
            time.sleep(GRACE)
            sys.stderr = sys.__stderr__
            print(aside.getvalue(), end="", file=sys.stderr)
        sys.stdout.flush()
        sys.stderr.flush()
        ranks.comm.Abort(status)
