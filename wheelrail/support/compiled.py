"""Loops compiled by Numba, without the interpreter's lock; machine code is cached on disk for each state of sources."""

from __future__ import annotations

import hashlib
import json
import os
import shutil
from collections.abc import Callable, Iterator
from contextlib import contextmanager, suppress
from functools import cache
from pathlib import Path
from tempfile import TemporaryFile
from typing import Any, TypeVar, cast

from numba import config, njit

from wheelrail.support.atomic_file import atomic_file
from wheelrail.support.cache import cache_folder, source_digest

F = TypeVar("F", bound=Callable[..., Any])

HERE = Path(__file__).parent
SOURCES = tuple(HERE.parent / name for name in ("support", "meshes", "contact"))  # packages with compiled functions

CHECKSUMS = "checksums.json"
ROOM = 2**20  # bytes that must be free to cache machine code: the largest function takes 0.4 MB, all take 6 MB


def compiled(function: F) -> F:
    """The function as machine code, compiled at its first call for every type of arguments.

    Arithmetic is that of IEEE 754 as written. Were sums reordered, functions that call others would differ in the last
    bits between the process that compiles them and one that loads them, whose copies of the called ones are others.
    """
    place = folder()
    if place is None:
        return cast(F, njit(nogil=True)(function))
    with _cached_in(place):
        return cast(F, njit(cache=True, nogil=True)(function))


@cache
def folder() -> Path | None:
    """Cache folder of machine code of these very sources, whose hash is part of its name; None where none can be
    written.

    Numba checks the source file of a function alone, and would go on with old code of others that the function calls.
    Damaged files are removed, and compiled again. What is not guarded: a disk that fills up later raises OSError, and
    damage before a process first meets a file is noticed only where the file was cut off or blanked at its end.
    """
    name = f"compiled-{source_digest(*SOURCES)}"
    for parent in _parents():
        place = parent / name
        new = not place.exists()
        if _writable(place):
            if new:
                _remove_others(place)
            _remove_damaged(place)
            return place
    return None


def _parents() -> Iterator[Path]:
    """Folders to try in turn; the second one is asked for, at some cost, only where the first does not do."""
    yield Path(config.CACHE_DIR or HERE / "__pycache__")
    yield cache_folder()


def _writable(place: Path) -> bool:
    try:
        place.mkdir(parents=True, exist_ok=True)
        with TemporaryFile(dir=place) as file:
            file.write(bytes(ROOM))
    except OSError:
        return False
    return True


def _remove_others(place: Path) -> None:
    """Remove machine code of older sources."""
    for old in place.parent.glob("compiled-*"):
        if old != place:  # which another process may be filling by now
            shutil.rmtree(old, ignore_errors=True)


def _remove_damaged(place: Path) -> None:
    """Remove files whose content has changed since their checksum was recorded, while their time of writing has not,
    and those that do not end as a pickle does; record the checksums of the others.

    Other processes may write meanwhile: Numba replaces files as a whole, and does without those that are gone.
    """
    record = place / CHECKSUMS
    try:
        before = dict(json.loads(record.read_bytes()))
    except (OSError, ValueError, TypeError):
        before = {}
    checksums = {}
    for path in sorted(place.rglob("*.nb[ic]")):  # indices and data
        with suppress(OSError):
            with path.open("rb") as file:
                written, content = os.fstat(file.fileno()).st_mtime_ns, file.read()
            key, checksum = f"{path.parent.name}/{path.name} {written}", hashlib.sha256(content).hexdigest()
            if content.endswith(b".") and before.get(key, checksum) == checksum:
                checksums[key] = checksum
            else:
                path.unlink()
    if checksums != before:
        with suppress(OSError), atomic_file(record) as part:
            part.write_text(json.dumps(checksums), encoding="utf-8")


@contextmanager
def _cached_in(place: Path) -> Iterator[None]:
    """Numba takes the folder of its cache from here when a function is decorated; others who use Numba are not
    concerned.
    """
    before, config.CACHE_DIR = config.CACHE_DIR, str(place)
    try:
        yield
    finally:
        config.CACHE_DIR = before
