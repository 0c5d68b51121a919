"""Compilation of forms by FFCx, one process at a time."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager, suppress
from pathlib import Path
from typing import Any

import dolfinx.jit
from dolfinx import fem
from mpi4py import MPI

from wheelrail.support.cache import cache_folder, one_process

EARLIER = 1.0  # s, by which clocks of files may differ


@contextmanager
def compiling() -> Iterator[None]:
    """One process at a time compiles in the block; what one that was stopped has left half done is removed.

    FFCx waits for 10 s for a form that another process compiles, and so for each one that a killed process was
    compiling. Ranks above zero wait for rank zero. Where files cannot be locked nobody waits.
    """
    if MPI.COMM_WORLD.rank > 0:
        yield
        return
    mark = cache_folder() / "compiling"  # of a process that has not come to the end of the block
    with one_process("forms"):
        with suppress(OSError):
            if mark.exists():
                _remove_unfinished(mark.stat().st_mtime - EARLIER)
            mark.touch()
        yield
        with suppress(OSError):
            mark.unlink()


def _remove_unfinished(since: float) -> None:
    """Remove sources of forms that are newer than a time s and were never compiled."""
    jit = dolfinx.jit
    options = jit.get_options() if hasattr(jit, "get_options") else jit.get_parameters()
    for source in Path(options["cache_dir"]).glob("libffcx_*.c"):
        with suppress(OSError):
            if source.stat().st_mtime >= since and not source.with_suffix(".c.cached").exists():
                source.unlink()


def compiled(form: Any) -> Any:
    """A form of UFL, compiled."""
    with compiling():
        return fem.form(form)
