"""Loops compiled by Numba, without the interpreter's lock; machine code is cached on disk by a hash of the sources.

Nothing in the cache names the folder of the package: it can be moved, and serves all copies of the same sources.
"""

from __future__ import annotations

import hashlib
import json
import logging
import os
import shutil
import stat
from collections.abc import Callable, Iterator
from contextlib import contextmanager, suppress
from functools import cache
from pathlib import Path
from typing import Any, Literal, TypeVar, cast

from numba import config, njit, types
from numba.core.caching import CompileResultCacheImpl, FunctionCache, _CacheLocator
from numba.core.ccallback import CFunc
from numba.core.sigutils import normalize_signature
from numba.extending import intrinsic

from wheelrail.support.atomic_file import atomic_file
from wheelrail.support.cache import cache_folder, source_digest
from wheelrail.support.cache_home import writable

F = TypeVar("F", bound=Callable[..., Any])

HERE = Path(__file__).parent
COMPILED = ("support", "forms", "meshes", "contact", "vehicle/multibody/compiled")  # folders of compiled functions
SOURCES = tuple(HERE.parent / name for name in COMPILED)

OWN = "package"  # folder of the machine code of these sources, without generated ones and those of users
CHECKSUMS = "checksums.json"
log = logging.getLogger(__name__)


class PackageLocator(_CacheLocator):  # type: ignore[misc]
    """Place of the machine code of functions whose file name is relative: those of this package and generated ones.

    Parameters:
        function: in Python.
        file: its source.
    """

    def __init__(self, function: Callable[..., Any], file: Path) -> None:
        self._py_file = str(file)  # of Numba's messages
        self._line = function.__code__.co_firstlineno
        folders = file.parent.parts[1:]  # without that of the package; generated sources have none
        self._place = Path(config.CACHE_DIR, *([OWN, "-".join(folders)] if folders else ["generated"]))

    def get_cache_path(self) -> str:
        return str(self._place)

    def get_source_stamp(self) -> str:
        """Constant: the folder's name has the hash of all sources, that of a generated source its own."""
        return "in the name"

    def get_disambiguator(self) -> str:
        return str(self._line)

    @classmethod
    def from_function(cls, function: Callable[..., Any], file: str) -> PackageLocator | None:
        """Locator of a function, None where others have to find a place."""
        if Path(file).is_absolute():
            return None
        locator = cls(function, Path(file))
        try:
            locator.ensure_cache_path()
        except OSError:
            return None
        return locator


class MovableCode(CompileResultCacheImpl):  # type: ignore[misc]
    """Serialised machine code in a place that does not depend on the folder of the package."""

    _locator_classes = (PackageLocator, *CompileResultCacheImpl._locator_classes)


class TolerantCache(FunctionCache):  # type: ignore[misc]
    """Numba's cache of the machine code of a function, where files that cannot be read or written cost time only."""

    _impl_class = MovableCode

    def load_overload(self, sig: Any, target_context: Any) -> Any:
        try:
            overload = super().load_overload(sig, target_context)
        except Exception:  # of a pickle that was cut off: almost any
            overload = None
        if overload is None:
            announce_first_compilation()
        return overload

    def save_overload(self, sig: Any, data: Any) -> None:
        try:
            super().save_overload(sig, data)
        except Exception:
            with suppress(OSError):  # an index that cannot be read is replaced by an empty one
                self.flush()


def compiled(
    function: F,
    *,
    error_model: Literal["python", "numpy"] = "python",
    counts: bool = True,
    inline: Literal["never", "always"] = "never",
) -> F:
    """The function as machine code, compiled at its first call for every type of arguments.

    Parameters:
        function: in Python.
        error_model: Numba's; "numpy": a division by zero gives inf or NaN, as in C, instead of an exception.
        counts: whether references to arrays are counted.
        inline: "always": compiled functions that call it contain its statements.

    Arithmetic is IEEE 754 in the order of the source. With reordered sums, functions that call others would differ in
    the last bits between the process that compiles them and one that loads them from the cache.
    """
    dispatcher, path = (
        njit(nogil=True, error_model=error_model, _nrt=counts, inline=inline)(_movable(function)),
        folder(),
    )
    if path is not None:
        with _cached_in(path), suppress(OSError):  # the file of generated source could not be written
            dispatcher._cache = TolerantCache(function)  # as njit(cache=True) does with Numba's own, which raises
    return cast(F, dispatcher)


def unchecked(function: F) -> F:
    """As `compiled`; divisions by zero give inf or NaN: checks for them cost time, and keep loops from vector
    instructions.
    """
    return compiled(function, error_model="numpy")


def inlined(function: F) -> F:
    """As `compiled`, of a function with one caller, which contains its statements: optimising both, and all that they
    call, takes twice as long.
    """
    return compiled(function, inline="always")


def borrowing(function: F) -> F:
    """As `unchecked`, of a function that neither makes nor returns arrays: references to them are not counted.

    Otherwise a call counts every array of its arguments, those in named tuples included, up and down in atomic
    instructions of some nanoseconds each, more than a small function takes. Arrays that were returned would be freed
    while they are used (`tests/project/test_borrowed_arrays.py`); making one is an error of the compiler.
    """
    return compiled(function, error_model="numpy", counts=False)


def address(function: Callable[..., Any], signature: Any) -> int:
    """Address of a C function with a Numba signature, compiled from a function in Python; it lives until the end.

    Compiled code that is called with it works with functions that were unknown when it was compiled.
    """
    key = f"{function.__module__}.{function.__qualname__}"
    if key not in _c_functions:
        c_function: Any = CFunc(_movable(function), normalize_signature(signature), {}, {"nopython": True})
        path = folder()
        if path is not None:
            with _cached_in(path), suppress(OSError):
                c_function._cache = TolerantCache(function)
        c_function.compile()
        _c_functions[key] = c_function
    return int(_c_functions[key].address)


_c_functions: dict[str, Any] = {}


def _movable(function: F) -> F:
    """The function with the name of its file relative to the package's parent folder, as machine code holds it.

    Tracebacks still show its source: they look for relative names in sys.path.
    """
    file = Path(function.__code__.co_filename)
    if file.is_relative_to(HERE.parent):
        name = str(file.relative_to(HERE.parents[1]))
        function.__code__ = function.__code__.replace(co_filename=name)
    return function


@intrinsic  # type: ignore[untyped-decorator]
def call(context: Any, at: Any, arguments: Any) -> Any:
    """Compiled: call of the function at an address without a result; its arguments are addresses (tuple of integers),
    those of arrays `array.ctypes.data`.
    """

    def generate(ctx: Any, builder: Any, _: Any, values: Any) -> Any:
        from llvmlite import ir  # type: ignore[import-untyped]

        pointer = ir.IntType(8).as_pointer()
        function = ir.FunctionType(ir.VoidType(), [pointer] * len(arguments)).as_pointer()
        given = [builder.inttoptr(builder.extract_value(values[1], i), pointer) for i in range(len(arguments))]
        builder.call(builder.inttoptr(values[0], function), given)
        return ctx.get_dummy_value()

    return types.void(at, arguments), generate


@intrinsic  # type: ignore[untyped-decorator]
def fma(context: Any, a: Any, b: Any, c: Any) -> Any:
    """Compiled: a * b + c with one rounding, an instruction of the processor where it has one."""

    def generate(_: Any, builder: Any, __: Any, values: Any) -> Any:
        return builder.fma(*values)

    return types.float64(types.float64, types.float64, types.float64), generate


@cache
def announce_first_compilation() -> None:
    """Log that machine code is compiled, if there is none of these sources yet: for strips it takes minutes."""
    place = folder()
    if place is not None and not any(place.rglob("*.nbi")):
        log.info("compiling machine code: up to some minutes, only this once")


@cache
def folder() -> Path | None:
    """Cache folder of machine code, with a hash of the sources in its name; None if there is none that this user, and
    nobody else, can write: Numba unpickles its files.

    Numba checks only the source file of a function itself, and would use old code of the functions that it calls.
    Damaged files are removed; bits that flip before a file's checksum is first recorded are not detected.
    """
    name = f"compiled-{source_digest(*SOURCES)}"
    for parent in _parents():
        place = parent / name
        new = not place.exists()
        if writable(place) and private(place):
            if new:
                _remove_others(place)
            _remove_damaged(place)
            return place
    return None


def _parents() -> Iterator[Path]:
    """Candidate folders in order; the second is determined, at some cost, only if the first cannot be written."""
    yield Path(config.CACHE_DIR or HERE / "__pycache__")
    yield cache_folder()


def private(place: Path) -> bool:
    """Whether only this user and the administrator can put files into a folder, or exchange one that it is in.

    A group with the number of its user is the user's own. In folders with the sticky bit, like /tmp, only the owner can
    exchange a folder.
    """
    place = place.resolve()
    for folder in (place, *place.parents):
        status = folder.stat()
        others = status.st_mode & (0o002 if status.st_gid == status.st_uid else 0o022)
        sticky = folder != place and status.st_mode & stat.S_ISVTX
        if status.st_uid not in (0, os.geteuid()) or (others and not sticky):
            return False
    return True


def _remove_others(place: Path) -> None:
    """Remove machine code of older sources."""
    for old in place.parent.glob("compiled-*"):
        if old != place:  # another process may be writing to place
            shutil.rmtree(old, ignore_errors=True)


def _remove_damaged(place: Path) -> None:
    """Remove files whose content has changed since their checksum was recorded while their modification time has not;
    record the checksums of new ones.

    Other processes may write at the same time: Numba replaces files atomically and recompiles missing ones.
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
            if before.get(key, checksum) == checksum:
                checksums[key] = checksum
            else:
                path.unlink()
    if checksums != before:
        with suppress(OSError), atomic_file(record) as part:
            part.write_text(json.dumps(checksums), encoding="utf-8")


@contextmanager
def _cached_in(place: Path) -> Iterator[None]:
    """Set Numba's cache folder while a function is decorated, without effect on other users of Numba."""
    before, config.CACHE_DIR = config.CACHE_DIR, str(place)
    try:
        yield
    finally:
        config.CACHE_DIR = before
