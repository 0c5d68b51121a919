"""Types of arrays: `Array` of floats, `Single` in single precision, `Complex`, `Nodes` (indices), `Mask` (booleans)."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]
Single = NDArray[np.float32]
Complex = NDArray[np.complex128]
Nodes = NDArray[np.int64]
Mask = NDArray[np.bool_]

LINE = 64  # bytes of a line of the cache


def aligned(shape: tuple[int, ...]) -> Array:
    """Uninitialised array that begins at a line of the cache: vectors of eight then lie in one line, where those of
    NumPy's arrays lie in two, which takes up to a third longer to read.
    """
    count, item = int(np.prod(shape)), np.dtype(np.float64).itemsize
    values = np.empty(count + LINE // item - 1)
    first = -values.ctypes.data % LINE // item
    return values[first : first + count].reshape(shape)
