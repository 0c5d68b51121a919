"""Loops compiled by Numba, without the interpreter's lock; machine code is kept on disk, see `machine_code`."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from contextlib import contextmanager, suppress
from pathlib import Path
from typing import Any, Literal, TypeVar, cast

from numba import config, njit, types
from numba.core.caching import NullCache
from numba.core.ccallback import CFunc
from numba.core.sigutils import normalize_signature
from numba.extending import intrinsic

from wheelrail.support.machine_code import Compilation, TolerantCache, folder, made_once

F = TypeVar("F", bound=Callable[..., Any])

HERE = Path(__file__).parent


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
    dispatcher = njit(nogil=True, error_model=error_model, _nrt=counts, inline=inline)(_movable(function))
    dispatcher.compile = _kept(dispatcher)
    Compilation.present.known += 1
    return cast(F, dispatcher)


def _kept(dispatcher: Any) -> Callable[[Any], Any]:
    """The dispatcher's compilation, by one process at a time, or what an earlier one left on disk.

    What the function names is known at its first call.
    """
    compile_for = dispatcher.compile

    def compile_once(sig: Any) -> Any:
        if isinstance(sig, tuple) and sig in dispatcher.overloads:
            return dispatcher.overloads[sig].entry_point
        if isinstance(dispatcher._cache, NullCache):
            dispatcher._cache = stored(dispatcher.py_func)
        with made_once(dispatcher._cache):
            return compile_for(sig)

    return compile_once


def stored(function: Callable[..., Any]) -> Any:
    """Cache on disk of the machine code of a function, as njit(cache=True) has it."""
    path = folder()
    if path is not None:
        with _cached_in(path), suppress(OSError):  # the file of generated source could not be written
            return TolerantCache(function)
    return NullCache()


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
        c_function._cache = stored(function)
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


@contextmanager
def _cached_in(place: Path) -> Iterator[None]:
    """Set Numba's cache folder while a function is decorated, without effect on other users of Numba."""
    before, config.CACHE_DIR = config.CACHE_DIR, str(place)
    try:
        yield
    finally:
        config.CACHE_DIR = before
