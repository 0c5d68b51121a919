"""The forms against their formulas, and the assembled law node by node."""

from __future__ import annotations

from functools import cache
from typing import Any

import numpy as np
import pytest
import ufl
from dolfinx import fem
from small_pairs import BRICKS, QUADRATIC, QUADRATIC_BRICKS, STEEL, TETRAHEDRA, elastic

from wheelrail.contact.laws.friction import Coulomb
from wheelrail.contact.laws.normal import Penalty, PowerPenalty
from wheelrail.contact.laws.parameters import ContactLaws
from wheelrail.contact.models.full.surface_traction import SurfaceLaw
from wheelrail.forms.elasticity import lame, strain, stress
from wheelrail.forms.traction import frictionless_traction, regularised, traction
from wheelrail.support.arrays import Array, Nodes

MESHES = {
    "tetrahedra": TETRAHEDRA,
    "bricks": BRICKS,
    "quadratic tetrahedra": QUADRATIC,
    "quadratic bricks": QUADRATIC_BRICKS,
}
SIZE = 1e-3


def number(expression: Any) -> float:
    """Value of a form with constant coefficients."""
    return float(expression(()))


def test_lame_constants() -> None:
    λ, μ = lame(210e9, 0.3)
    assert pytest.approx(210e9 / 2.6) == μ
    assert λ + 2 / 3 * μ == pytest.approx(210e9 / 3 / 0.4)  # bulk modulus
    assert lame(1.0, 0.0)[0] == 0.0


def test_strain_and_stress_of_a_linear_field() -> None:
    body = elastic(TETRAHEDRA, STEEL, SIZE)
    gradient = np.array([[1e-3, 2e-3, -1e-3], [0.5e-3, -2e-3, 3e-3], [1e-3, 0.0, 4e-3]])
    u = fem.Function(body.space)
    u.interpolate(lambda x: gradient @ x)
    λ, μ = lame(210e9, 0.3)
    ε = 0.5 * (gradient + gradient.T)
    σ = λ * np.trace(ε) * np.eye(3) + 2 * μ * ε
    for found, expected in ((strain(u), ε), (stress(u, λ, μ), σ)):
        error = found - ufl.as_matrix(expected.tolist())
        form = fem.form(ufl.inner(error, error) * ufl.dx)
        squared = float(fem.assemble_scalar(form)) / body.solid.volume()
        assert np.sqrt(squared) < 1e-11 * np.abs(expected).max()


@pytest.mark.parametrize("name", MESHES)
def test_stiffness_of_rigid_motion_and_uniform_strain(name: str) -> None:
    body = elastic(MESHES[name], STEEL, SIZE)
    stiffness, x = body.stiffness, body.space.tabulate_dof_coordinates()
    free = np.ones(len(x), dtype=bool)
    free[body.fixed] = False

    def forces(displacement: Array) -> Array:
        u, f = stiffness.createVecs()
        u.array[:] = displacement.ravel()
        stiffness.mult(u, f)
        return np.asarray(f.array.reshape(-1, 3))

    low = x[:, 2].min()
    # Far from the clamped nodes, rigid motion and uniform strain cause no internal nodal forces.
    strip = np.zeros(len(x), dtype=bool)
    strip[body.nodes[1:-1, 1:-1].ravel()] = True
    scale = np.abs(stiffness.getDiagonal().array).max() * SIZE
    origin = x - [0.0, 0.0, low]
    for motion in (np.ones_like(x), np.cross([1.0, 2.0, 3.0], origin)):
        assert np.abs(forces(motion)[strip]).max() < 1e-9 * scale * np.abs(motion).max() / SIZE
    # uniaxial stress along z: the forces on the free top are the stress times the area that each node carries
    stretch = origin * [-STEEL.nu, -STEEL.nu, 1.0]
    load = forces(stretch)[body.nodes]
    np.testing.assert_allclose(
        load[1:-1, 1:-1, 2], (STEEL.E * body.grid.weight)[1:-1, 1:-1], rtol=1e-7, atol=1e-7 * STEEL.E * SIZE**2
    )
    np.testing.assert_allclose(load[1:-1, 1:-1, :2], 0.0, atol=1e-7 * STEEL.E * SIZE**2)


@pytest.mark.parametrize("name", MESHES)
def test_clamped_nodes_are_those_at_the_bottom(name: str) -> None:
    body = elastic(MESHES[name], STEEL, SIZE)
    x = body.space.tabulate_dof_coordinates()
    np.testing.assert_array_equal(np.sort(body.fixed), np.flatnonzero(x[:, 2] < x[:, 2].min() + 1e-9))
    np.testing.assert_allclose(x[body.nodes], body.grid.position, atol=1e-12)


@pytest.mark.parametrize("d", [-1e-6, 0.0, 2e-6])
def test_penalty_pressure(d: float) -> None:
    K = 1e15
    assert number(Penalty(K).pressure(ufl.as_ufl(d))) == pytest.approx(K * max(d, 0.0))
    assert number(frictionless_traction(ufl.as_ufl(d), Penalty(K))) == pytest.approx(-K * max(d, 0.0))
    assert number(PowerPenalty(K, 1.5).pressure(ufl.as_ufl(d))) == pytest.approx(K * max(d, 0.0) ** 1.5)


@pytest.mark.parametrize("s", [(0.0, 0.0), (3e-6, -4e-6), (1e-3, 0.0), (-3e-3, 4e-3)])
def test_regularised_coulomb(s: tuple[float, float]) -> None:
    p, μ, ε = 8e8, 0.3, 1e-5
    q = regularised(ufl.as_vector(s), ufl.as_ufl(μ * p), ε)
    found = np.array([number(q[0]), number(q[1])])
    np.testing.assert_allclose(found, -μ * p * np.array(s) / max(np.hypot(*s), ε), rtol=1e-12)
    assert np.hypot(*found) <= μ * p * (1 + 1e-12)
    z = ufl.as_vector((8e-7, *s))
    whole = traction(z, Penalty(1e15), Coulomb(μ), speed=ufl.as_ufl(1.0), ε=ε)
    np.testing.assert_allclose([number(whole[i]) for i in range(3)], [-p, *found], rtol=1e-12)


@cache
def law(name: str, friction: float) -> SurfaceLaw:
    body = elastic(MESHES[name], STEEL, SIZE)
    return SurfaceLaw(body.solid, body.grid, body.degree, ContactLaws(1e13, friction, 1e-4))


def sample(name: str) -> tuple[Nodes, Array]:
    """Nodes with contact points, with penetrations of both signs and slips of all magnitudes."""
    grid = elastic(MESHES[name], STEEL, SIZE).grid
    rng = np.random.default_rng(0)
    nodes = rng.permutation(np.flatnonzero(grid.weight.ravel() > 0))[:20]
    z = np.column_stack([rng.normal(size=20) * 1e-5, *rng.normal(size=(2, 20)) * 10.0 ** rng.uniform(-6, -2, 20)])
    return nodes, z


@pytest.mark.parametrize("name", MESHES)
def test_assembled_law_is_the_law_times_the_area(name: str) -> None:
    grid = elastic(MESHES[name], STEEL, SIZE).grid
    nodes, z = sample(name)
    area = grid.weight.ravel()[nodes]
    p = 1e13 * np.maximum(z[:, 0], 0.0)
    q = -0.3 * p[:, None] * z[:, 1:] / np.maximum(np.hypot(*z[:, 1:].T), 1e-4)[:, None]
    expected = np.column_stack([-p, q]) * area[:, None]
    np.testing.assert_allclose(law(name, 0.3).force(nodes, z), expected, rtol=1e-9, atol=1e-9 * np.abs(expected).max())
    pushed = law(name, 0.0).force(nodes, z[:, :1])
    assert pushed.shape == (20, 1)
    np.testing.assert_allclose(pushed[:, 0], -p * area, rtol=1e-9)


@pytest.mark.parametrize("name", MESHES)
def test_tangent_of_the_assembled_law(name: str) -> None:
    nodes, z = sample(name)
    surface = law(name, 0.3)
    exact = surface.tangent(nodes, z)
    for j, step in enumerate((1e-9, 1e-9, 1e-9)):
        shift = np.zeros_like(z)
        shift[:, j] = step
        slope = (surface.force(nodes, z + shift) - surface.force(nodes, z - shift)) / (2 * step)
        np.testing.assert_allclose(exact[:, :, j], slope, rtol=1e-4, atol=1e-4 * np.abs(slope).max())


def test_regularisation_changes_without_recompilation() -> None:
    nodes, z = sample("tetrahedra")
    z[:, 0], z[:, 1:] = 1e-6, [3e-5, 4e-5]
    surface = law("tetrahedra", 0.3)
    blunt = np.hypot(*surface.force(nodes, z)[:, 1:].T)
    surface.regularisation = 1e-5
    sharp = np.hypot(*surface.force(nodes, z)[:, 1:].T)
    surface.regularisation = 1e-4
    np.testing.assert_allclose(sharp / blunt, 2.0, rtol=1e-9)


def test_the_whole_strip_at_once() -> None:
    # constant penetration: the forces sum to pressure times area for all elements
    for name, mesh in MESHES.items():
        grid = elastic(mesh, STEEL, SIZE).grid
        nodes = np.flatnonzero(grid.weight.ravel() > 0)
        forces = law(name, 0.0).force(nodes, np.full((len(nodes), 1), 1e-6))
        assert forces.sum() == pytest.approx(-1e13 * 1e-6 * grid.weight.sum(), rel=1e-12)


def test_dolfinx_reports_errors_only() -> None:
    import dolfinx.log

    import wheelrail.forms.compat  # noqa: F401 - sets the level

    assert dolfinx.log.get_log_level() == dolfinx.log.LogLevel.ERROR
