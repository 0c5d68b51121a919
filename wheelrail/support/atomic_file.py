"""Atomic files: written completely, or not at all."""

from __future__ import annotations

import contextlib
import os
import tempfile
import time
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

PART = ".part-"
DAY = 86_400.0  # s


@contextmanager
def atomic_file(path: Path) -> Iterator[Path]:
    """A new, empty file in the folder of path, with the same suffix; it replaces path at the end of the block.

    After an exception it is removed and path is unchanged. Temporaries of killed processes are removed by the first
    call a day later. Creates the folder; raises OSError where that fails, or where path is a folder.
    """
    path.parent.mkdir(parents=True, exist_ok=True)
    handle, name = tempfile.mkstemp(prefix=PART, suffix=path.suffix, dir=path.parent)
    os.close(handle)
    try:
        yield Path(name)
        os.chmod(name, 0o644)
        os.replace(name, path)
    except BaseException:
        with contextlib.suppress(OSError):
            os.unlink(name)
        raise
    remove_leftovers(path.parent)


def remove_leftovers(folder: Path) -> None:
    """Remove temporaries in a folder that are at least a day old, of killed processes."""
    for part in folder.glob(f"{PART}*"):
        with contextlib.suppress(OSError):
            if time.time() - part.stat().st_mtime > DAY:
                part.unlink()
