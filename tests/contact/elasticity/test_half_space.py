"""Closed forms of strips on a half-space: coupling of the normal with the tangential directions."""

from __future__ import annotations

from collections.abc import Callable
from itertools import combinations_with_replacement, pairwise

import numpy as np
import pytest
from scipy.integrate import quad

from wheelrail.bindings._contact import pair_antiderivative, pair_geometry
from wheelrail.contact.elasticity.half_space import strip_flexibility
from wheelrail.support.arrays import Array

NU = 0.3
COUPLING = (1 + NU) * (1 - 2 * NU) / (2 * np.pi)  # times x/r^2: displacement along x by a unit outward force
SIDES = np.array([[0.0, 1.0], [1.0, 1.6], [2.5, 3.0]])  # the first two touch
PAIRS = [(0, 0), (0, 1), (0, 2), (1, 1), (1, 2), (2, 2)]
X_BY_NORMAL, T_BY_NORMAL = 4, 5


def mean(row: Array, column: Array, of: Callable[[float], float]) -> float:
    """Mean over two strips of a function of their lateral distance: a single integral, weighted by the overlap."""

    def overlap(d: float) -> float:
        return max(0.0, min(row[1], column[1] + d) - max(row[0], column[0] + d))

    kinks = sorted(
        {a - b for a in row for b in column} | ({0.0} if row[0] < column[1] and column[0] < row[1] else set())
    )
    whole = sum(
        quad(lambda d: overlap(d) * of(d), a, b, epsabs=1e-13, epsrel=1e-13)[0] for a, b in pairwise(kinks) if b > a
    )
    return float(whole / np.ptp(row) / np.ptp(column))


def antiderivatives(x: Array, sides: Array, nu: float) -> Array:
    """G (pairs, nodes, 6) of pairs i <= j of strips with bounds (S, 2), at distances (nodes,)."""
    pairs = combinations_with_replacement(sides, 2)
    return np.array([[_antiderivative(float(at), row, column, nu) for at in x] for row, column in pairs])


def _antiderivative(x: float, row: Array, column: Array, nu: float) -> Array:
    return np.array(pair_antiderivative(pair_geometry(x, row.tolist(), column.tolist()), nu))


def test_coupling_by_wavenumbers() -> None:
    k = np.array([1e-3, 0.3, 2.0, 9.0, 40.0])
    computed = strip_flexibility(k, SIDES, SIDES, NU, 0.0)
    for i in range(3):
        for j in range(3):
            for m, wavenumber in enumerate(k):
                along = mean(SIDES[i], SIDES[j], lambda d, k=wavenumber: np.exp(-k * abs(d)))
                across = mean(SIDES[i], SIDES[j], lambda d, k=wavenumber: np.sign(d) * np.exp(-k * abs(d)))
                expected = np.pi * COUPLING * np.array([along, across])
                np.testing.assert_allclose(computed[m, i, j, X_BY_NORMAL:], expected, rtol=0, atol=1e-10 * COUPLING)


def test_coupling_is_bounded_at_low_wavenumbers() -> None:
    """The cut-off that the other components need has no effect."""
    k = np.array([0.0, 1e-12, 1e-6, 1.0])
    computed = strip_flexibility(k, SIDES, SIDES, NU, 1.0)[:3, :, :, X_BY_NORMAL:] / (np.pi * COUPLING)
    across = np.sign(np.arange(3)[:, None] - np.arange(3))
    np.testing.assert_allclose(computed[..., 0], 1.0, atol=1e-5)
    np.testing.assert_allclose(computed[..., 1], np.broadcast_to(across, (3, 3, 3)), atol=1e-5)


@pytest.mark.parametrize("x", [0.7, 1.0, 2.9, 7.0])
def test_coupling_of_cells(x: float) -> None:
    """Means over strips and over cells of equal length at a distance x, touching ones included."""
    length = 0.7
    G = antiderivatives(x + length * np.array([-1.0, 0.0, 1.0]), SIDES, NU)
    computed = (G[:, 0] - 2 * G[:, 1] + G[:, 2]) / length**2

    def cells(of: Callable[[float], float]) -> float:
        kinks = (x - length, x, x + length)
        weighted = (
            quad(lambda s: (length - abs(s - x)) * of(s), a, b, epsabs=1e-13, epsrel=1e-13)[0]
            for a, b in pairwise(kinks)
        )
        return float(sum(weighted) / length**2)

    for pair, (i, j) in enumerate(PAIRS):
        along = mean(SIDES[i], SIDES[j], lambda d: cells(lambda s: s / (s * s + d * d)))
        across = mean(SIDES[i], SIDES[j], lambda d: cells(lambda s: d / (s * s + d * d) if d else 0.0))
        expected = COUPLING * np.array([along, across])
        np.testing.assert_allclose(computed[pair, X_BY_NORMAL:], expected, rtol=0, atol=1e-10 * COUPLING)


def test_forms_are_transforms_of_each_other() -> None:
    """C(x) = 1/pi int H(k) sinc^2 (sin or cos)(k x) dk for cells of a length, all components that need no cut-off."""
    length, x = 0.8, 1.1
    G = antiderivatives(x + length * np.array([-1.0, 0.0, 1.0]), SIDES, NU)
    k, step = np.linspace(0.0, 400.0, 80001, retstep=True)
    weight = np.full(len(k), step)
    weight[1:-1:2] *= 4 / 3
    weight[2:-1:2] *= 2 / 3
    weight[[0, -1]] /= 3
    H = strip_flexibility(k, SIDES, SIDES, NU, 1.0)
    filtered = weight * np.sinc(k * length / (2 * np.pi)) ** 2 / np.pi
    for component, phase in ((3, np.sin), (X_BY_NORMAL, np.sin), (T_BY_NORMAL, np.cos)):
        for pair, (i, j) in enumerate(PAIRS):
            cells = (G[pair, 0] - 2 * G[pair, 1] + G[pair, 2])[component] / length**2
            assert filtered * phase(k * x) @ H[:, i, j, component] == pytest.approx(cells, abs=1e-6 * COUPLING)


@pytest.mark.parametrize("nu", [0.0, 0.3, 0.5])
def test_long_strips_contract_under_pressure(nu: float) -> None:
    """In plane strain du_x/dx = -(1 - 2 nu)(1 + nu) p / E (Johnson 1985, eq. 2.24a), and none beside the load.

    Strips 1e5 cells wide lack 1.5e-4.
    """
    step, wide = 1.0, np.array([[-5e4, 5e4]])
    edges = step * np.arange(-2, 3)
    G = antiderivatives(np.arange(-5, 6) * step, wide, nu)[0, :, X_BY_NORMAL] * np.ptp(wide)
    at = {round(x): value for x, value in zip(np.arange(-5, 6), G, strict=True)}

    def displacement(first: float) -> float:
        """Mean over a cell from `first` by unit pressure between the edges, against the outward normal."""
        a, b, c, d = (round(v) for v in (first, first + step, edges[0], edges[-1]))
        return -(at[b - c] - at[a - c] - at[b - d] + at[a - d]) / step

    inside = displacement(0.0) - displacement(-1.0)
    assert inside / step == pytest.approx(-(1 - 2 * nu) * (1 + nu), abs=3e-4)
    assert displacement(-3.0) == pytest.approx(0.5 * 4 * step * (1 - 2 * nu) * (1 + nu), abs=1e-3)
