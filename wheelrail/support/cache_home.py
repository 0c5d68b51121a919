"""A folder for caches where the user's own is missing or cannot be written, as in containers of arbitrary users."""

from __future__ import annotations

import os
import stat
from functools import cache
from pathlib import Path
from tempfile import TemporaryDirectory, TemporaryFile


def writable(folder: Path) -> bool:
    """Whether a folder is writable, after its creation for this user alone if missing."""
    try:
        folder.parent.mkdir(parents=True, exist_ok=True)
        folder.mkdir(mode=0o700, exist_ok=True)
        TemporaryFile(dir=folder).close()
    except OSError:
        return False
    return True


def private(place: Path) -> bool:
    """Whether only this user and the administrator can write to a folder, or replace a folder above.

    A group with the number of its user is the user's own. In folders with the sticky bit, like /tmp, only the owner can
    exchange a folder.
    """
    place = place.resolve()
    for each in (place, *place.parents):
        status = each.stat()
        others = status.st_mode & (0o002 if status.st_gid == status.st_uid else 0o022)
        sticky = each != place and status.st_mode & stat.S_ISVTX
        if status.st_uid not in (0, os.geteuid()) or (others and not sticky):
            return False
    return True


@cache
def provide_cache_home() -> TemporaryDirectory[str] | None:
    """Set HOME and XDG_CACHE_HOME to a temporary folder of this process if unusable; compiled code and results are then
    not kept. Returns the folder, or None.

    DOLFINx cannot be loaded without a home folder, nor compile without a folder for its caches.
    """
    has_home = _has_home()
    if has_home and writable(Path(os.environ.get("XDG_CACHE_HOME") or Path.home() / ".cache")):
        return None
    temporary = TemporaryDirectory(prefix="wheelrail-")
    if not has_home:
        os.environ["HOME"] = temporary.name
    os.environ["XDG_CACHE_HOME"] = temporary.name
    return temporary


def _has_home() -> bool:
    try:
        return Path.home().is_dir()
    except RuntimeError:  # no HOME, and a user without an entry
        return False
