"""How the loops that NumPy cannot do at once are compiled: kept on disk, without the interpreter's lock."""

from __future__ import annotations

import hashlib
import shutil
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from functools import cache
from pathlib import Path
from typing import Any, TypeVar, cast

from numba import config, njit

F = TypeVar("F", bound=Callable[..., Any])

HERE = Path(__file__).parent
SOURCES = (HERE, HERE.parent / "contact")  # folders with compiled functions


def compiled(function: F) -> F:
    """The function as machine code, made at its first call for every type of arguments.

    Sums may be reordered, but infinities and NaN keep their meaning.
    """
    with _kept_in(str(folder())):
        return cast(F, njit(cache=True, nogil=True, fastmath={"reassoc", "contract", "nsz", "arcp"})(function))


@cache
def folder() -> Path:
    """Where machine code of these very sources is kept, whose hash is part of its name.

    Numba asks for the file of a function alone, and would go on with what it made of others that the function calls.
    """
    found = hashlib.sha256()
    for source in sorted(file for package in SOURCES for file in package.glob("*.py")):
        found.update(source.read_bytes())
    place = Path(config.CACHE_DIR or HERE / "__pycache__") / f"compiled-{found.hexdigest()[:12]}"
    if not place.exists():
        for old in place.parent.glob("compiled-*"):
            shutil.rmtree(old, ignore_errors=True)
    return place


@contextmanager
def _kept_in(place: str) -> Iterator[None]:
    """Numba asks where to when it is told to compile; others who use it are not concerned."""
    before, config.CACHE_DIR = config.CACHE_DIR, place
    try:
        yield
    finally:
        config.CACHE_DIR = before
