"""The command under `mpirun`: only the first rank prints, and all ranks end together."""

from __future__ import annotations

import io
import os
import sys
import time
import traceback
from collections.abc import Iterator
from contextlib import contextmanager

# Number of processes in the environment, by Open MPI, MPICH, Slurm. Other variables of MPI are unreliable: they are
# inherited by the child processes of any process that has loaded MPI.
SIZES = ("OMPI_COMM_WORLD_SIZE", "PMI_SIZE", "SLURM_STEP_NUM_TASKS")
GRACE = 2.0  # s for the first rank to print its own error and end all ranks


def several() -> bool:
    """Whether `mpirun` started several processes; MPI is loaded only if the environment shows so."""
    if all(os.environ.get(size, "1") == "1" for size in SIZES):
        return False
    from wheelrail.support.mpi import world

    return world().size > 1


def first() -> bool:
    """Whether this process writes the results of all."""
    if not several():
        return True
    from wheelrail.support.mpi import world

    return world().first


@contextmanager
def on_all_ranks() -> Iterator[None]:
    """Suppress the output of all ranks but the first, and end all ranks with the exit code of a failed one.

    The other ranks may wait for the failed one in a reduction. A failed rank prints its error unless the first rank
    has ended all by then.
    """
    if not several():
        yield
        return
    from wheelrail.support.mpi import world

    ranks, errors, status = world(), io.StringIO(), 0
    if not ranks.first:
        sys.stdout, sys.stderr = io.StringIO(), errors
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
            print(errors.getvalue(), end="", file=sys.stderr)
        sys.stdout.flush()
        sys.stderr.flush()
        ranks.comm.Abort(status)
