"""The command `wheelrail`, all of it."""

from __future__ import annotations

if __name__ == "__main__":  # python -m scenes.cli
    from scenes import entry

    entry.main()
    raise SystemExit

import os

from scenes.commands import contacts, runs, studies, texts, views  # noqa: F401 - they join the app, in this order
from scenes.commands.app import app
from scenes.launcher import as_one

__all__ = ["app", "main"]


def main() -> None:
    """Entry point.

    One BLAS thread unless the environment says otherwise: the dense blocks are small, threads that wait cost more.
    """
    for name in ("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS"):
        os.environ.setdefault(name, "1")
    with as_one():
        app()
