"""How the loops that NumPy cannot do at once are compiled: kept on disk, without the interpreter's lock."""

from __future__ import annotations

import hashlib
import pickle
import shutil
from collections.abc import Callable, Iterator
from contextlib import contextmanager, suppress
from functools import cache
from pathlib import Path
from typing import Any, TypeVar, cast

from numba import config, njit
from numba.core.caching import FunctionCache, IndexDataCacheFile

SEAL = hashlib.sha256().digest_size
F = TypeVar("F", bound=Callable[..., Any])

HERE = Path(__file__).parent
SOURCES = tuple(HERE.parent / name for name in ("support", "meshes", "contact"))  # packages with compiled functions


class Sealed(FunctionCache):  # type: ignore[misc]
    """Machine code on disk that costs time and nothing else where it is damaged or cannot be written."""

    def load_overload(self, sig: Any, target_context: Any) -> Any:
        try:
            return super().load_overload(sig, target_context)
        except Exception:  # a pickle that is damaged raises almost anything
            return None

    def save_overload(self, sig: Any, data: Any) -> None:
        try:
            super().save_overload(sig, data)
        except Exception:
            with suppress(OSError):  # an index that cannot be read is no longer in the way the next time
                self.flush()


class SealedFile(IndexDataCacheFile):  # type: ignore[misc]
    """Behind every pickled content stands its hash: a flipped bit in machine code would be run."""

    def _dump(self, obj: Any) -> bytes:
        content = bytes(super()._dump(obj))
        return content + hashlib.sha256(content).digest()

    def _load_data(self, name: str) -> Any:
        _check(Path(self._data_path(name)).read_bytes())
        return super()._load_data(name)

    def _load_index(self) -> Any:
        with suppress(FileNotFoundError), open(self._index_path, "rb") as file:
            pickle.load(file)  # Numba's version
            _check(file.read())
        return super()._load_index()


def _check(content: bytes) -> None:
    if hashlib.sha256(content[:-SEAL]).digest() != content[-SEAL:]:
        raise ValueError("damaged")


def compiled(function: F) -> F:
    """The function as machine code, made at its first call for every type of arguments.

    Arithmetic is that of IEEE 754 as written. Were sums reordered, functions that call others would differ in the last
    bits between the process that compiles them and one that loads them, whose copies of the called ones are others.
    """
    with _kept_in(str(folder())):
        made = njit(cache=True, nogil=True)(function)
    made._cache.__class__ = Sealed
    made._cache._cache_file.__class__ = SealedFile
    return cast(F, made)


@cache
def folder() -> Path:
    """Where machine code of these very sources is kept, whose hash is part of its name.

    Numba asks for the file of a function alone, and would go on with what it made of others that the function calls.
    """
    found = hashlib.sha256()
    for source in sorted(file for package in SOURCES for file in package.rglob("*.py")):
        found.update(source.read_bytes())
    place = Path(config.CACHE_DIR or HERE / "__pycache__") / f"compiled-{found.hexdigest()[:12]}"
    if not place.exists():
        for old in place.parent.glob("compiled-*"):
            if old != place:  # which another process may be filling by now
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
