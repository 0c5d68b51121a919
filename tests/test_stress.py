"""Stress inside bodies under given tractions: Hertz on the axis, point loads, wheels, von Mises and principal."""

from __future__ import annotations

import numpy as np
import pytest

from contact.laws import Steel
from contact.pose import Array
from contact.section import Section
from contact.stress import CellLoads, Gradients, stress
from contact.waveguides import block_body
from forms.stress import principal, von_mises
from meshes.solids import block_section
from meshes.triangulate import Grading, triangulate

STEEL = Steel(1.0, 0.3)
HALF = 12


@pytest.fixture(scope="module")
def body() -> Section:
    return block_body(HALF, STEEL, size=1.0, half_width=512.0)


def cells(pressure: Array, force: tuple[float, float, float], *, middle: float = 0.0) -> CellLoads:
    """Loads on the cells of a square patch, proportional to the pressure (n, n), about the middle of the surface."""
    n = len(pressure) // 2
    i, j = np.nonzero(pressure)
    loads = pressure[i, j][:, None] * np.array(force)
    return CellLoads(middle + (i - n).astype(float), j - n + HALF, loads, 1.0)


def hertz_cells(a: float) -> Array:
    """Mean over unit cells of sqrt(1 - r^2 / a^2)."""
    g, sub = np.arange(-11, 12), (np.arange(12) + 0.5) / 12 - 0.5
    place = (g[:, None] + sub).ravel()
    fine = np.sqrt(np.maximum(1 - (place[:, None] ** 2 + place**2) / a**2, 0))
    return fine.reshape(23, 12, 23, 12).mean(axis=(1, 3))


def on_axis(s: Array, nu: float = 0.3) -> tuple[Array, Array]:
    """Radial and vertical stress over p0 at depth s a on the axis (Johnson, Contact Mechanics, 1985, eq. 3.45)."""
    return -(1 + nu) * (1 - s * np.arctan(1 / s)) + 0.5 / (1 + s * s), -1 / (1 + s * s)


def test_hertz_on_the_axis(body: Section) -> None:
    """20 cells across: von Mises maximum 0.62 p0 and its depth 0.48 a within 2 %, all components within 0.5 % of p0."""
    a, s = 10.0, np.linspace(0.1, 1.2, 45)
    σ = stress(body, cells(hertz_cells(a), (0.0, 0.0, -1.0)), np.outer(s * a, [0.0, 0.0, -1.0]))
    radial, vertical = on_axis(s)
    exact = np.einsum("am,ab->mab", [radial, radial, vertical], np.eye(3))
    assert np.abs(σ - exact).max() < 5e-3
    fine = np.linspace(0.2, 0.9, 7001)
    mises = np.abs(np.subtract(*on_axis(fine)))
    assert mises.max() == pytest.approx(0.62, abs=1e-3)
    near = np.abs(s - 0.48) < 0.15
    q = np.polyfit(s[near], von_mises(σ)[near], 3)
    top = fine[np.polyval(q, fine)[np.abs(fine - 0.48) < 0.1].argmax() + int((np.abs(fine - 0.48) < 0.1).argmax())]
    assert top == pytest.approx(fine[mises.argmax()], rel=0.02)
    assert np.polyval(q, top) == pytest.approx(mises.max(), rel=5e-3)


@pytest.mark.parametrize("middle", [0.0, 7.0])
def test_loads_in_all_directions(middle: float) -> None:
    """Tractions on horizontal planes of a half-space are radial, whatever the force (Johnson, eqs. 3.19 and 3.76)."""
    body = block_body(HALF, STEEL, size=1.0, half_width=512.0, grading=Grading(0.5, 0.25))
    force = (0.4, -0.3, -1.0)
    loads = cells(np.outer(*2 * [np.cos(np.pi * np.arange(-4, 5) / 10) ** 2]), force, middle=middle)
    places = np.array([[0, 0, -2], [3, -2, -3], [-5, 4, -4], [1, 6, -6], [-2.3, -1.7, -1.5]], dtype=float)
    places[:, 0] += middle
    sub = (np.arange(6) + 0.5) / 6 - 0.5
    dx, dy = (v.ravel() for v in np.meshgrid(sub, sub))
    points = np.stack([loads.x[:, None] + dx, loads.line[:, None] - HALF + dy, np.zeros((len(loads.x), 36))], axis=-1)
    r = places[:, None, None] - points
    distance = np.linalg.norm(r, axis=-1)
    share = -3 * np.einsum("mnsa,na->mns", r, loads.force / 36) * r[..., 2] / (2 * np.pi * distance**5)
    exact = np.einsum("mns,mnsa->ma", share, r)
    found = stress(body, loads, places)
    np.testing.assert_allclose(found, found.swapaxes(1, 2), atol=1e-14)
    assert np.abs(found[:, 2] - exact).max() < 3e-3 * np.abs(exact).max()
    # every component is a linear function of the load
    double = CellLoads(loads.x, loads.line, 2 * loads.force, loads.step)
    np.testing.assert_allclose(stress(body, double, places), 2 * found, rtol=1e-9, atol=1e-12)


def test_a_looser_tolerance_takes_fewer_wavenumbers_and_costs_no_more_than_it_says(body: Section) -> None:
    loads, places = cells(hertz_cells(6.0), (0.3, 0.1, -1.0)), np.array([[0.0, 0.0, -2.0], [4.0, 1.0, -3.0]])

    told: dict[float, list[int]] = {0.05: [], 1e-5: []}
    σ = {t: stress(body, loads, places, tolerance=t, progress=lambda i, _, t=t: told[t].append(i)) for t in told}
    assert len(told[0.05]) < len(told[1e-5])
    assert np.abs(σ[0.05] - σ[1e-5]).max() < 0.05


def revolved(radius: float) -> Section:
    surface, rest, clamped = block_section(HALF, 1.0, 128.0, 128.0)
    lift = np.array([0.0, radius])
    mesh = triangulate(surface + lift, rest + lift, clamped, size=1.0, grading=Grading(1.0, 0.4, 32.0))
    return Section(mesh, STEEL, degree=2, radius=radius)


def test_stress_in_a_wheel() -> None:
    """A drum turned with its load carries the turned stress; one of a large radius is nearly a block."""
    loads = cells(hertz_cells(6.0), (0.2, 0.3, 1.0))  # the wheel's contact points down, loads push up
    places = np.array([[0.0, 0.0, 3.0], [2.0, -1.0, 2.5], [-4.0, 2.0, 5.0]])
    flat = block_body(HALF, STEEL, size=1.0, half_width=128.0)
    mirror = np.diag([1.0, 1.0, -1.0])
    down = CellLoads(loads.x, loads.line, loads.force @ mirror, 1.0)
    block = mirror @ stress(flat, down, places @ mirror) @ mirror
    difference = []
    for radius in (1e3, 8e3):
        drum = revolved(radius)
        at = places + np.array([0.0, 0.0, -radius])
        σ = stress(drum, loads, at)
        difference.append(np.abs(σ - block).max() / np.abs(block).max())
    assert difference[0] < 0.05
    assert difference[1] < 0.01
    shift = 300.0
    c, s = np.cos(shift / radius), np.sin(shift / radius)
    T = np.array([[c, 0, -s], [0, 1, 0], [s, 0, c]])
    moved = CellLoads(loads.x + shift, loads.line, loads.force @ T.T, 1.0)
    np.testing.assert_allclose(stress(drum, moved, at @ T.T), T @ σ @ T.T, atol=1e-6 * np.abs(σ).max())


def test_gradients_of_cubics_are_exact(body: Section) -> None:
    y, z = body.points.T
    U = np.column_stack([y * z, y**3 - z**2, z**3 + y]).ravel()
    at = np.array([[0.0, -0.4], [3.3, -2.0], [-40.0, -60.0]])
    G, k = Gradients(body, at)(U.astype(complex), 0.7), 0.7
    (a, b), one = at.T, np.ones(3)
    exact = [
        [k * a * b, -1j * b, -1j * a],
        [1j * k * (a**3 - b**2), 3 * a**2, -2 * b],
        [1j * k * (b**3 + a), one, 3 * b**2],
    ]
    np.testing.assert_allclose(np.moveaxis(G, 0, -1), exact, rtol=1e-8, atol=1e-8)


def test_scalars() -> None:
    turn, _ = np.linalg.qr(np.random.default_rng(0).normal(size=(3, 3)))
    σ = turn @ np.diag([3.0, -1.0, 1.0]) @ turn.T
    np.testing.assert_allclose(principal(σ), [3, 1, -1])
    assert von_mises(σ) == pytest.approx(np.sqrt(0.5 * (16 + 4 + 4)))
    assert von_mises(np.array([[0, 2.0, 0], [2.0, 0, 0], [0, 0, 0]])) == pytest.approx(2 * np.sqrt(3))
    assert von_mises(np.eye(3)) == pytest.approx(0.0)


def test_what_does_not_fit_is_refused(body: Section) -> None:
    loads = cells(np.ones((1, 1)), (0.0, 0.0, 1.0))
    with pytest.raises(ValueError, match="outside"):
        stress(body, loads, np.array([[0.0, 0.0, 1.0]]))
    with pytest.raises(ValueError, match="must be"):
        CellLoads(np.zeros(2), np.zeros(2, dtype=int), np.zeros((3, 3)), 1.0)
    with pytest.raises(ValueError, match="finite"):
        CellLoads(np.zeros(1), np.zeros(1, dtype=int), np.full((1, 3), np.nan), 1.0)
