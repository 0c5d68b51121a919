"""Machine code on disk: its folder, the statements that each file belongs to, and one process at a time that makes it.

A file's name has a hash of its function's statements and of all that these name: constants, and compiled functions at
any depth. Comments and docstrings do not count. One folder serves all copies and versions of the package.
"""

from __future__ import annotations

import fcntl
import hashlib
import logging
import os
import shutil
from collections.abc import Callable, Iterator
from contextlib import contextmanager, suppress
from functools import cache
from pathlib import Path
from time import monotonic, time
from types import CodeType, FunctionType, ModuleType
from typing import Any

import numpy as np
from numba import config
from numba.core.caching import CompileResultCacheImpl, FunctionCache, IndexDataCacheFile, _CacheLocator
from numba.core.compiler_lock import global_compiler_lock
from numba.core.dispatcher import Dispatcher
from numba.core.extending import _Intrinsic

from wheelrail.support.cache import cache_folder
from wheelrail.support.cache_home import private, writable
from wheelrail.support.interrupts import answered_interrupts

FOLDER = "machine-code"
UNUSED = 30 * 86400.0  # s, after which a file that was not read is removed
REPORT = 15.0  # s between messages while functions are compiled
log = logging.getLogger(__name__)


@cache
def folder() -> Path | None:
    """Folder of machine code, in $NUMBA_CACHE_DIR or the cache; None if there is none that this user, and nobody else,
    can write: Numba unpickles its files.
    """
    for parent in _parents():
        place = parent / FOLDER
        if writable(place) and private(place):
            return place
    return None


def _parents() -> Iterator[Path]:
    """Candidate folders in order; the second is determined, at some cost, only if the first cannot be written."""
    if config.CACHE_DIR:
        yield Path(config.CACHE_DIR)
    yield cache_folder()


def digest(function: FunctionType) -> str:
    """Hash of a function's statements, its options as machine code aside, and of the values that these name."""
    if function not in _digests:
        _digests[function] = ""  # of a function that calls itself
        checksum = hashlib.sha256()
        for code in _codes(function.__code__):
            checksum.update(code.co_code)
            checksum.update(repr((code.co_names, code.co_varnames, code.co_freevars)).encode())
            constants = (c for c in code.co_consts if not isinstance(c, CodeType) and c != function.__doc__)
            for value in (*constants, *_named(function, code.co_names)):
                checksum.update(_description(value).encode())
        for cell in function.__closure__ or ():
            with suppress(ValueError):  # that is empty
                checksum.update(_description(cell.cell_contents).encode())
        _digests[function] = checksum.hexdigest()[:16]
    return _digests[function]


_digests: dict[FunctionType, str] = {}


def _codes(code: CodeType) -> Iterator[CodeType]:
    yield code
    for constant in code.co_consts:
        if isinstance(constant, CodeType):
            yield from _codes(constant)


def _named(function: FunctionType, names: tuple[str, ...]) -> Iterator[Any]:
    """Values of global names, and of attributes of modules of this package."""
    for name in names:
        value = function.__globals__.get(name)
        yield value
        if isinstance(value, ModuleType) and value.__name__.startswith("wheelrail"):
            yield from (getattr(value, attribute, None) for attribute in names)


def _description(value: Any) -> str:
    """Text that changes with what a value means to machine code, the same in every process."""
    if isinstance(value, Dispatcher):
        return f"{digest(value.py_func)} {sorted(value.targetoptions.items())}"
    if isinstance(value, _Intrinsic):
        return digest(value._defn)
    if isinstance(value, FunctionType):
        return digest(value)
    if isinstance(value, np.ndarray):
        return f"{value.dtype} {value.shape} {hashlib.sha256(value.tobytes()).hexdigest()}"
    if isinstance(value, tuple | frozenset):
        parts = [_description(part) for part in value]
        return str(parts if isinstance(value, tuple) else sorted(parts))
    if isinstance(value, type):
        return f"{value.__qualname__} {getattr(value, '_fields', ())}"
    if value is None or isinstance(value, bool | int | float | complex | str | bytes):
        return repr(value)
    return f"{type(value).__qualname__} {getattr(value, '__name__', '')}"


class PackageLocator(_CacheLocator):  # type: ignore[misc]
    """Place of the machine code of functions whose file name is relative: those of this package and generated ones.

    Parameters:
        function: in Python.
        place: folder of machine code.
    """

    def __init__(self, function: FunctionType, place: Path) -> None:
        self._py_file = function.__code__.co_filename  # of Numba's messages
        self._place = place
        self._version = digest(function)

    def get_cache_path(self) -> str:
        return str(self._place)

    def get_source_stamp(self) -> str:
        """Constant: the file's name has the hash of the statements."""
        return "in the name"

    def get_disambiguator(self) -> str:
        return self._version

    @classmethod
    def from_function(cls, function: FunctionType, file: str) -> PackageLocator | None:
        """Locator of a function, None where others have to find a place."""
        if Path(file).is_absolute():
            return None
        locator = cls(function, Path(config.CACHE_DIR))
        try:
            locator.ensure_cache_path()
        except OSError:
            return None
        return locator


class MovableCode(CompileResultCacheImpl):  # type: ignore[misc]
    """Serialised machine code in a place that does not depend on the folder of the package."""

    _locator_classes = (PackageLocator, *CompileResultCacheImpl._locator_classes)


class SealedFiles(IndexDataCacheFile):  # type: ignore[misc]
    """Files that begin with a hash of their content: damaged ones are not read."""

    def _dump(self, obj: Any) -> bytes:
        content: bytes = super()._dump(obj)
        return hashlib.sha256(content).digest() + content

    def _load_index(self) -> dict[Any, str]:
        try:
            stamp, overloads = self._opened(self._index_path)
        except (OSError, ValueError):
            return {}
        return overloads if stamp == self._source_stamp else {}

    def _save_index(self, overloads: dict[Any, str]) -> None:
        with self._open_for_write(self._index_path) as file:
            file.write(self._dump((self._source_stamp, overloads)))

    def _load_data(self, name: str) -> Any:
        try:
            return self._opened(self._data_path(name))
        except ValueError as error:
            raise OSError(error) from error  # as a file that is missing

    @staticmethod
    def _opened(path: str) -> Any:
        """Content of a file. Raises OSError, ValueError for a damaged one."""
        import pickle

        sealed = Path(path).read_bytes()
        if hashlib.sha256(sealed[32:]).digest() != sealed[:32]:
            raise ValueError(f"{path} is damaged")
        return pickle.loads(sealed[32:])


class TolerantCache(FunctionCache):  # type: ignore[misc]
    """Numba's cache of the machine code of a function, where files that cannot be read or written cost time only."""

    _impl_class = MovableCode

    def __init__(self, function: Callable[..., Any]) -> None:
        super().__init__(function)
        self._cache_file.__class__ = SealedFiles
        Compilation.present.files.add(self._impl.filename_base)

    def load_overload(self, sig: Any, target_context: Any) -> Any:
        try:
            overload = super().load_overload(sig, target_context)
        except Exception:  # of a pickle of another version: almost any
            overload = None
        if overload is None:
            Compilation.present.begun()
        return overload

    def save_overload(self, sig: Any, data: Any) -> None:
        with suppress(Exception):
            super().save_overload(sig, data)
        Compilation.present.compiled += 1


class Compilation:
    """Functions that this process compiles, and messages about it."""

    present: Compilation

    def __init__(self) -> None:
        self.known = 0  # functions that may be compiled
        self.compiled = 0
        self.files: set[str] = set()  # first parts of the names of all functions' files
        self._start = self._said = -1.0

    def begun(self) -> None:
        """Log that machine code is compiled, at the first function and after times of REPORT."""
        now = monotonic()
        if self._start < 0:
            self._start = self._said = now
            _remove_unused()
            if (place := folder()) is not None and not any(place.glob("*.nbi")):
                log.info("compiling machine code: up to some minutes, only this once")
        elif now - self._said >= REPORT:
            self._said = now
            log.info(
                "compiling machine code: %d functions in %.0f s, of at most %d; only this once",
                *(self.compiled, now - self._start, self.known),
            )


Compilation.present = Compilation()


def copy_present(target: Path) -> None:
    """Copy the machine code of the functions that this process knows. Raises OSError."""
    place = folder()
    if place is None:
        raise OSError("no folder for machine code can be written; set NUMBA_CACHE_DIR to one")
    target.mkdir(parents=True, exist_ok=True)
    for file in place.glob("*.nb[ic]"):
        if any(file.name.startswith(f"{name}.") for name in Compilation.present.files):
            shutil.copy2(file, target)


def _remove_unused() -> None:
    """Remove machine code that no process has read for a month."""
    place, now = folder(), time()
    for file in place.glob("*") if place is not None else ():
        with suppress(OSError):
            status = file.stat()
            if file.is_file() and now - max(status.st_atime, status.st_mtime) > UNUSED:
                file.unlink()


_held: set[str] = set()


@contextmanager
def made_once(kept: Any) -> Iterator[None]:
    """One process at a time loads or compiles a function; others wait and load what it made.

    A function's callees are locked while it is, in the order of calls, which has no circle.

    Parameters:
        kept: cache of the function.
    """
    place = folder()
    if place is None or not isinstance(kept, TolerantCache) or (name := kept._impl.filename_base) in _held:
        yield
        return
    with global_compiler_lock, answered_interrupts():  # of threads: before that of processes
        lock = None
        with suppress(OSError):
            lock = os.open(place / f"{name[:200]}.lock", os.O_CREAT | os.O_RDWR, 0o600)
            fcntl.flock(lock, fcntl.LOCK_EX)
        _held.add(name)
        try:
            yield
        finally:
            _held.discard(name)
            if lock is not None:
                os.close(lock)
