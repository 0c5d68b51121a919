"""How the loops that NumPy cannot do at once are compiled: kept on disk, without the interpreter's lock."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any, TypeVar, cast

from numba import njit

F = TypeVar("F", bound=Callable[..., Any])


def compiled(function: F) -> F:
    """The function as machine code, made at its first call for every type of arguments.

    Sums may be reordered, but infinities and NaN keep their meaning.
    """
    return cast(F, njit(cache=True, nogil=True, fastmath={"reassoc", "contract", "nsz", "arcp"})(function))
