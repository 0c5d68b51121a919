"""The command `wheelrail`: the app with all its commands."""

from __future__ import annotations

import os

from wheelrail.cli import contact, explore, export, run, study, table, templates, vehicle_tests, view  # noqa: F401 - each registers its commands, in this order
from wheelrail.cli.app import app
from wheelrail.cli.mpi_launcher import on_all_ranks

__all__ = ["app", "main"]


def main() -> None:
    """Run the app, under `mpirun` too.

    One BLAS thread unless set in the environment: the dense blocks are small, and waiting threads cost more.
    """
    for name in ("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS"):
        os.environ.setdefault(name, "1")
    with on_all_ranks():
        app(prog_name="wheelrail")
