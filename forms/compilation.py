"""Compilation of forms by FFCx, one process at a time."""

from __future__ import annotations

import fcntl
from collections.abc import Iterator
from contextlib import ExitStack, contextmanager, suppress
from pathlib import Path
from typing import Any

import dolfinx.jit
from dolfinx import fem
from mpi4py import MPI

from wheelrail.support.cache import cache_folder

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
    with ExitStack() as stack:
        busy: Any = None
        with suppress(OSError):
            path = cache_folder() / "forms.lock"
            path.parent.mkdir(parents=True, exist_ok=True)
            file = stack.enter_context(path.open("a+"))
            fcntl.flock(file, fcntl.LOCK_EX)  # which ends with the process
            if path.stat().st_size > 0:
                _remove_unfinished(path.stat().st_mtime - EARLIER)
            file.truncate(0)
            file.write("compiling")
            file.flush()
            busy = file
        yield
        if busy is not None:
            busy.truncate(0)


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
