"""Friction in the cells of strips: the mean of a law over a bound that varies linearly, and its slopes."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from scipy.special import roots_legendre
from test_laws import LAWS, Points

from wheelrail.bindings._contact import ResidualCode, friction_bounds, friction_residual, friction_slopes
from wheelrail.contact.laws.pointwise import friction_functions
from wheelrail.support.arrays import Array


def code_of(law: str, eps: float) -> ResidualCode:
    functions = friction_functions(LAWS[law])
    return ResidualCode(functions.code, functions.parameters, eps)


def mean_over_cells(law: str, x: Points, ends: Array, eps: float) -> tuple[Array, Array]:
    """Mean residuals (2, n) and their slopes (n, 14) with pressures (2, n) at the ends of cells."""
    code = code_of(law, eps)
    return tuple(of(code, x.q, x.s, ends, x.rho, x.speed) for of in (friction_residual, friction_slopes))  # type: ignore[return-value]


@pytest.mark.parametrize("law", ["coulomb", "polach", "stribeck", "own, rising"])
def test_mean_residual_is_that_of_a_linear_bound(law: str) -> None:
    """Against the mean of the law at many pressures; some of the cells slip in part."""
    x, functions = Points.sample(400, 3), friction_functions(LAWS[law])
    half = np.random.default_rng(4).uniform(-0.9, 0.9, 400) * x.p
    F, _ = mean_over_cells(law, x, np.stack([x.p - half, x.p + half]), 0.0)
    places, weights = roots_legendre(400)
    residuals = [functions.residual(x.q, x.s, x.p + t * half, x.rho, x.speed, 0.0)[1] for t in places]
    expected = np.tensordot(0.5 * weights, residuals, 1)
    np.testing.assert_allclose(F, expected, atol=1e-5 * np.abs(x.q).max())
    sticks = np.hypot(*(x.rho * x.q - x.s)) < x.rho * x.bound(law) * (1 + np.stack([-1.0, 1.0])[:, None] * half / x.p)
    assert (sticks[0] != sticks[1]).sum() > 30


@pytest.mark.parametrize("law", LAWS)
def test_bounds_are_those_of_the_law(law: str) -> None:
    x, code = Points.sample(50, 6), code_of(law, 0.0)
    np.testing.assert_allclose(friction_bounds(code, x.s, x.p, x.speed), x.bound(law), rtol=1e-12)


@pytest.mark.parametrize("law", LAWS)
@pytest.mark.parametrize("eps", [0.0, 1e-5])
def test_mean_residual_of_constant_pressure_is_the_law(law: str, eps: float) -> None:
    x, functions = Points.sample(200, 5), friction_functions(LAWS[law])
    F, slopes = mean_over_cells(law, x, np.stack([x.p, x.p]), eps)
    np.testing.assert_allclose(
        F, functions.residual(x.q, x.s, x.p, x.rho, x.speed, eps)[1], atol=1e-12 * np.abs(x.q).max()
    )
    expected = functions.slopes(np.arange(200), x.q, x.s, x.p, x.rho, x.speed, eps)
    np.testing.assert_allclose(slopes[:, :8], expected[:, :8], rtol=1e-9, atol=1e-9 * np.abs(expected[:, :8]).max())
    np.testing.assert_allclose(slopes[:, 8:10] + slopes[:, 10:12], expected[:, 8:10], atol=1e-9)
    np.testing.assert_allclose(slopes[:, 12:], expected[:, 10:], rtol=1e-9, atol=1e-9 * np.abs(expected[:, 10:]).max())


@pytest.mark.parametrize("law", LAWS)
def test_slopes_of_mean_residuals_do_not_jump(law: str) -> None:
    """From sticking to slipping cells by growing tractions: halved steps halve the changes of the slopes."""
    x = Points.sample(100, 6)
    direction = x.q / np.hypot(*x.q)
    ends, slip = np.stack([0.4 * x.p, 1.6 * x.p]), -0.05 * x.rho * x.p * direction
    changes, sizes = [], []
    for count in (200, 400):
        grown = [replace(x, q=factor * x.p * direction, s=slip) for factor in np.linspace(0.0, 2.0, count)]
        F, slopes = (
            np.array(parts) for parts in zip(*(mean_over_cells(law, z, ends, 0.0) for z in grown), strict=True)
        )
        along = np.einsum("knij,jn->kin", slopes[:, :, :4].reshape(-1, 100, 2, 2), direction * x.p)
        difference, step = np.diff(F, axis=0), 2.0 / (count - 1)
        np.testing.assert_allclose(difference / x.p, 0.5 * (along[1:] + along[:-1]) * step / x.p, atol=step**2)
        changes.append(np.abs(np.diff(along, axis=0) / x.p).max())
        sizes.append(np.abs(along / x.p).max())
    assert changes[1] < 0.6 * changes[0]
    assert sizes[1] > 0.9
