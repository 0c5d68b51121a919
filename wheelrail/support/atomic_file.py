"""Atomic files: written completely, or not at all."""

from __future__ import annotations

import contextlib
import errno
import hashlib
import os
import platform
import re
import shutil
import tempfile
import time
from collections.abc import Iterator
from contextlib import contextmanager
from functools import cache
from pathlib import Path

PART = ".part-"
OF_PROCESS = re.compile(rf"{re.escape(PART)}(\w+)-(\d+)-.*", re.DOTALL)
DAY = 86_400.0  # s
FULL = 65_536  # bytes; a disk with less free space is full


@contextmanager
def atomic_file(path: Path) -> Iterator[Path]:
    """A new, empty file in the folder of path, with the same suffix; it replaces path at the end of the block.

    After an exception it is removed and path is unchanged. Temporaries of dead processes in the folder are removed
    first. Creates the folder; raises OSError where that fails, where path is a folder, and ENOSPC for any exception on
    a full disk, which libraries report as an error of their format.
    """
    path.parent.mkdir(parents=True, exist_ok=True)
    remove_leftovers(path.parent)
    handle, name = tempfile.mkstemp(
        prefix=f"{PART}{_process_space()}-{os.getpid()}-", suffix=path.suffix, dir=path.parent
    )
    os.close(handle)
    try:
        yield Path(name)
        os.chmod(name, 0o666 & ~_umask())
        os.replace(name, path)
    except BaseException as error:
        full = isinstance(error, Exception) and shutil.disk_usage(path.parent).free < FULL
        with contextlib.suppress(OSError):
            os.unlink(name)
        if full:
            raise OSError(errno.ENOSPC, os.strerror(errno.ENOSPC), str(path)) from error
        raise


def check_space(path: Path, size: int) -> None:
    """Raise OSError unless a file of a size, in bytes, can be written in the folder of path: for libraries that neither
    report a full disk nor end in order after one.
    """
    with tempfile.TemporaryFile(dir=path.parent) as file:
        try:
            os.posix_fallocate(file.fileno(), 0, size)
        except OSError as error:
            if error.errno in (errno.ENOSPC, errno.EFBIG, errno.EDQUOT):
                raise OSError(error.errno, os.strerror(error.errno), str(path)) from None


def remove_leftovers(folder: Path) -> None:
    """Remove temporaries of dead processes in a folder, and temporaries of other machines after a day."""
    for part in folder.glob(f"{PART}*"):
        with contextlib.suppress(OSError):
            if _abandoned(part.name) or time.time() - part.stat().st_mtime > DAY:
                part.unlink()


def _abandoned(name: str) -> bool:
    """Whether a temporary is of a process of this machine that has ended."""
    process = OF_PROCESS.fullmatch(name)
    if process is None or process[1] != _process_space():
        return False
    try:
        os.kill(int(process[2]), 0)
    except ProcessLookupError:
        return True
    except (OSError, OverflowError):  # of another user, or no number of a process
        return False
    return False


@cache
def _process_space() -> str:
    """Hash of the space of process numbers: the machine, its start and its container."""
    names = [platform.node()]
    with contextlib.suppress(OSError):  # Linux only
        names += [Path("/proc/sys/kernel/random/boot_id").read_text(), os.readlink("/proc/self/ns/pid")]
    return hashlib.sha256(" ".join(names).encode()).hexdigest()[:8]


def _umask() -> int:
    """Mask of the permissions of new files, readable only by setting a new mask."""
    mask = os.umask(0o077)
    os.umask(mask)
    return mask
