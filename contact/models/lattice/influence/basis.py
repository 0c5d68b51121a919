"""Shape functions of one strip between its ends: pressure modes, traction cells, and moments of the gap.

With xi from -1 (trailing end) to 1 (leading end) the pressure is sqrt(1 - xi^2) sum_m c_m U_m(xi), U_m Chebyshev's
polynomials of the second kind: it vanishes at both ends as a square root and has no inverse square root there. The gap
is weighted by T_k(xi) / sqrt(1 - xi^2); the two moments more than modes determine the ends.
"""

from __future__ import annotations

from functools import lru_cache
from typing import Literal

import numpy as np
from scipy.special import roots_legendre

from wheelrail.bindings._contact import MODES, MOMENTS, PARTS, STATIONS, StripBasis
from wheelrail.support.arrays import Array

ORDER = 16  # of the Gauss rules below
LEADING = 0.35  # fraction of the cells' grading towards the leading end alone


AHEAD = 2  # cells in front of a strip, of the length of its first, in the upstream difference of the slip


def upstream(x: Array) -> tuple[Array, Array, Array]:
    """Weights (S, M) of u in -du/dx, second order, at the cell and the next two upstream; means at x (S, M + 2) m."""
    near, far = x[:, 1:-1] - x[:, :-2], x[:, 2:] - x[:, :-2]
    return (near + far) / (near * far), -far / (near * (far - near)), near / (far * (far - near))


Tangential = Literal["none", "rolling", "shift"]  # problem: none, steady rolling, one step of displacement from none


@lru_cache(maxsize=16)
def strip_basis(cells: int, tangential: Tangential) -> StripBasis:
    """Basis of strips of a number of cells, refined towards both ends."""
    if tangential == "rolling":
        return _basis(rolling_marks(cells), tangential)
    return _basis(0.5 - 0.5 * np.cos(np.pi * np.linspace(0, 1, cells + 1)), tangential)


@lru_cache(maxsize=16)
def equal_cells(cells: int, tangential: Tangential = "none") -> StripBasis:
    """Basis of strips of a number of equal cells."""
    return _basis(np.linspace(0.0, 1.0, cells + 1), tangential)


def rolling_marks(cells: int) -> Array:
    """Cell boundaries (cells + 1,) of a strip in rolling, from 0 to 1.

    The traction grows as a square root from the leading end and, under full stick, as an inverse square root towards
    the trailing end: cells shrink quadratically towards both, more towards the first.
    """
    t = np.linspace(0.0, 1.0, cells + 1, dtype=np.float64)
    return np.asarray(LEADING * (1 - (1 - t) ** 2) + (1 - LEADING) * 0.5 * (1 - np.cos(np.pi * t)))


def _basis(edges: Array, tangential: Tangential) -> StripBasis:
    """Basis for cell boundaries (M + 1,) from 0 to 1."""
    lead = edges[-1] - edges[-2]
    row_marks = np.concatenate([edges, 1.0 + lead * np.arange(1, AHEAD + 1)])
    t, w = _angles(edges)
    moment = np.arange(MOMENTS)
    mean = _mode_means(edges)
    half = 0.0 if tangential == "shift" else _mode_variations(edges, mean)  # no scale of partial slip without rolling
    ends = np.stack([mean - half, mean + half], axis=1)
    moments = np.einsum("rg,rgk->kr", w, np.cos(moment * t[..., None])) / np.pi
    middle = 0.5 * (row_marks[1:] + row_marks[:-1])
    stations = 0.5 - 0.5 * np.cos(np.pi * (np.arange(STATIONS) + 0.5) / STATIONS)
    means = _cell_means_of_lagrange(edges, stations)
    shifts = tangential == "shift"
    here = np.outer([1.0, 0.0, 0.0], np.ones(len(edges) - 1))
    difference = here if shifts else np.stack(upstream(middle[None]))[:, 0]
    fixed, loads = np.ascontiguousarray, _loads(edges, mean)  # loops take addresses
    load_edges = _jumps(loads)
    split_marks, split_edges = _split(edges, load_edges)
    slip_edges = fixed(_slip_edges(difference, np.diff(row_marks)))
    moment_edges = fixed(_edge_weights(moments / np.diff(edges)))
    return StripBasis(
        edges,
        row_marks,
        fixed(mean),
        fixed(ends),
        fixed(loads),
        fixed(load_edges),
        fixed(moments),
        moment_edges,
        fixed(moment_edges.T),
        slip_edges,
        1 if shifts else 2,
        np.diff(edges) if shifts else _own_slip(row_marks, slip_edges),
        stations,
        fixed(moments @ means),
        fixed(means),
        float(np.diff(edges).max()),
        split_marks,
        split_edges,
    )


def _split(edges: Array, load_edges: Array) -> tuple[Array, Array]:
    """`StripBasis.split_marks` and `StripBasis.split_edges` for cell boundaries (M + 1,) with jumps (M + 1, MODES)."""
    changes, before, finest = [], (1, load_edges), PARTS[-1]
    for parts in PARTS:
        within = np.arange(parts) / parts
        marks = np.append((edges[:-1, None] + np.diff(edges)[:, None] * within).ravel(), 1.0)
        jumps = _jumps(_loads(marks, _mode_means(marks)))
        change = np.zeros((finest * (len(edges) - 1) + 1, MODES))
        change[:: finest // parts] = jumps
        change[:: finest // before[0]] -= before[1]
        changes.append(change)
        before = parts, jumps
    return marks, np.stack(changes)


def _angles(edges: Array) -> tuple[Array, Array]:
    """Quadrature points (M, ORDER) of all cells as angles, and quadrature weights."""
    place, weight = roots_legendre(ORDER)
    theta = np.arccos(np.clip(2 * edges - 1, -1.0, 1.0))
    low, high = theta[1:, None], theta[:-1, None]
    return 0.5 * (high + low) + 0.5 * (high - low) * place, 0.5 * (high - low) * weight


def _mode_means(edges: Array) -> Array:
    """Means (M, MODES) of the pressure modes over the cells."""
    t, w = _angles(edges)
    means = np.einsum("rg,rgm->rm", w * np.sin(t), np.sin((np.arange(MODES) + 1) * t[..., None]))
    return np.asarray(means / (2 * np.diff(edges)[:, None]))


def _mode_variations(edges: Array, mean: Array) -> Array:
    """Half the changes (M, MODES) over the cells of linear functions with the first moments of the pressure modes."""
    t, w = _angles(edges)
    middle, length = edges[1:] + edges[:-1] - 1, 2 * np.diff(edges)
    place = (np.cos(t) - middle[:, None]) / length[:, None]  # from -1/2 to 1/2
    first = np.einsum("rg,rgm->rm", w * np.sin(t) * place, np.sin((np.arange(MODES) + 1) * t[..., None]))
    return np.asarray(6 * first / length[:, None])


def _loads(edges: Array, mean: Array) -> Array:
    """`StripBasis.loads` from the means (M, MODES).

    Pressure that is constant in a cell of length h differs from p by p' (x - x_m), which acts like the load
    -(h^2 p' / 12)' on a smooth compliance: its negative is added, without change of the total load.
    """
    theta, length = np.arccos(2 * edges[1:-1] - 1), 2 * np.diff(edges)
    mode = np.arange(1, MODES + 1)
    slope = -mode * np.cos(mode * theta[:, None]) / np.sin(theta[:, None])
    flux = (length[1:] * length[:-1])[:, None] / 12 * slope
    zero = np.zeros((1, MODES))
    return np.asarray(mean - np.diff(np.vstack([zero, flux, zero]), axis=0) / length[:, None])


def _jumps(loads: Array) -> Array:
    """Jumps (M + 1, MODES) at the boundaries of cells with loads (M, MODES)."""
    return np.diff(loads, axis=0, prepend=0.0, append=0.0)


def _edge_weights(cells: Array) -> Array:
    """Weights (n, M + 1) at boundaries from weights (n, M) of the differences over cells."""
    zero = np.zeros((len(cells), 1))
    return np.hstack([zero, cells]) - np.hstack([cells, zero])


def _slip_edges(weight: Array, length: Array) -> Array:
    """`StripBasis.slip_edges` from weights (3, M) of the means over cells of lengths (M + 2,)."""
    M = weight.shape[1]
    edges = np.zeros((M, 4))
    for k in range(3):
        part = weight[k] / length[k : k + M]
        edges[:, k] -= part
        edges[:, k + 1] += part
    return edges


def _own_slip(row_marks: Array, slip_edges: Array) -> Array:
    """`StripBasis.own_slip` (M,): -ln |x| integrated twice is x^2 (3 - 2 ln |x|) / 4."""
    M = len(slip_edges)
    here = np.arange(M)[:, None] + np.arange(4)
    x = row_marks[here][..., None] - np.stack([row_marks[:M], row_marks[1 : M + 1]], axis=1)[:, None]
    square = np.maximum(x**2, np.finfo(float).tiny)
    twice = 0.25 * square * (3 - np.log(square))
    return np.asarray(np.einsum("rk,rk->r", slip_edges, twice[..., 0] - twice[..., 1]))


def _cell_means_of_lagrange(edges: Array, stations: Array) -> Array:
    """Means (M, n) over cells with boundaries (M + 1,) of the Lagrange polynomials of n stations."""
    place, weight = roots_legendre(len(stations))
    middle, half = 0.5 * (edges[1:] + edges[:-1]), 0.5 * np.diff(edges)
    powers = np.vander(2 * stations - 1, increasing=True)
    at = 2 * (middle[:, None] + half[:, None] * place) - 1
    values = at[..., None] ** np.arange(len(stations))
    return np.asarray(np.einsum("g,rgk->rk", 0.5 * weight, values) @ np.linalg.inv(powers))
