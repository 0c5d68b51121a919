"""Lower bounds of the cost of a condensed solve: dgesv, assembly of a matrix, dense and FFT products."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from time import perf_counter

import numpy as np
import scipy.fft
import scipy.linalg as la
from numpy.typing import NDArray

from benchmarks.common.measurement import Row
from wheelrail.support.arrays import Array

ENOUGH, MOST = 0.3, 50  # seconds and repeats


def bounds(*, sizes: list[int]) -> Iterator[Row]:
    """A row for every number of contact points, with two tangential components each."""
    for n in sizes:
        yield bound(n)


def bound(n: int) -> Row:
    """Seconds at n points, which fill an ellipse: the FFT's grid is the rectangle around it."""
    random = np.random.default_rng(0)
    side = round(np.sqrt(4 * n / np.pi))
    row: Row = {"points": n, "wanted": n, **_dense(random, n)}
    along = AlongX(random.standard_normal((2 * side - 1, 2 * side, 2 * side)))
    field = random.standard_normal((side, 2 * side))
    row["FFT along x"] = best(lambda: along @ field)
    plane = OverPlane(random.standard_normal((2 * side - 1, 2 * side - 1, 2, 2)))
    flat = random.standard_normal((side, side, 2))
    row["FFT over x and y"] = best(lambda: plane @ flat)
    return row


def _dense(random: np.random.Generator, n: int) -> dict[str, float]:
    """LU of two components and of one, assembly of n^2 numbers from a table, and the product with two components."""
    matrix, vector = random.standard_normal((2 * n, 2 * n)), random.standard_normal(2 * n)
    matrix[np.arange(2 * n), np.arange(2 * n)] += 4 * n
    table, index = matrix[:n, :n].ravel(), np.arange(n * n).reshape(n, n)
    return {
        "dgesv 2n": best(lambda: la.solve(matrix, vector, check_finite=False)),
        "dgesv n": best(lambda: la.solve(matrix[:n, :n], vector[:n], check_finite=False)),
        "gather": best(lambda: table.take(index)),
        "dense": best(lambda: matrix @ vector),
    }


def best(call: Callable[[], object]) -> float:
    """Smallest seconds of repeated calls."""
    times: list[float] = []
    began = perf_counter()
    while not times or (len(times) < MOST and perf_counter() - began < ENOUGH):
        start = perf_counter()
        call()
        times.append(perf_counter() - start)
    return min(times)


class AlongX:
    """Product with a matrix that depends on x - x' only, as for waveguides: kernel (2 nx - 1, m, m) by the rows
    between, from -(nx - 1), m values in a row. nx m^2 a product instead of nx^2 m^2.
    """

    def __init__(self, kernel: Array) -> None:
        self.rows = (len(kernel) + 1) // 2
        self.length = scipy.fft.next_fast_len(2 * self.rows - 1, real=True)
        self._spectrum: NDArray[np.complex128] = scipy.fft.rfft(_wrapped(kernel, 0, self.length), axis=0)

    def __matmul__(self, field: Array) -> Array:
        """Product with values (nx, m)."""
        waves = scipy.fft.rfft(field, self.length, axis=0)
        product = np.matmul(self._spectrum, waves[:, :, None])[:, :, 0]
        return np.asarray(scipy.fft.irfft(product, self.length, axis=0)[: self.rows])


class OverPlane:
    """Product with a matrix that depends on x - x' and y - y' only, as for half-spaces: kernel (2 nx - 1, 2 ny - 1, c,
    c). n log n a product.
    """

    def __init__(self, kernel: Array) -> None:
        self.shape = tuple((size + 1) // 2 for size in kernel.shape[:2])
        self.length = tuple(scipy.fft.next_fast_len(2 * size - 1, real=True) for size in self.shape)
        wrapped = _wrapped(_wrapped(kernel, 0, self.length[0]), 1, self.length[1])
        self._spectrum: NDArray[np.complex128] = np.moveaxis(
            scipy.fft.rfft2(wrapped, axes=(0, 1)), (2, 3), (0, 1)
        ).copy()

    def __matmul__(self, field: Array) -> Array:
        """Product with values (nx, ny, c)."""
        waves = scipy.fft.rfft2(np.moveaxis(field, 2, 0), self.length, axes=(1, 2))
        product = scipy.fft.irfft2((self._spectrum * waves).sum(axis=1), self.length, axes=(1, 2))
        return np.moveaxis(product[:, : self.shape[0], : self.shape[1]], 0, 2)


def _wrapped(kernel: Array, axis: int, length: int) -> Array:
    """Distances from -(n - 1) to n - 1 on a circle of a length, zero distance first."""
    n = (kernel.shape[axis] + 1) // 2
    shape = list(kernel.shape)
    shape[axis] = length - (2 * n - 1)
    padded = np.concatenate([kernel, np.zeros(shape)], axis=axis)
    return np.roll(padded, 1 - n, axis=axis)
