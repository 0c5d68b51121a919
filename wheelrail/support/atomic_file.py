"""Files that are there whole, or not at all, whatever ends their writer."""

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
    """A new, empty file beside path, of the same suffix, to write to: it becomes path when the block ends well.

    Else it goes, and what was at path stays. One that a writer was killed over goes with the first of a day later.
    Makes the folder; raises OSError where none can be, or where path is a folder.
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
    """Remove what killed writers left in a folder a day ago or earlier."""
    for part in folder.glob(f"{PART}*"):
        with contextlib.suppress(OSError):
            if time.time() - part.stat().st_mtime > DAY:
                part.unlink()
