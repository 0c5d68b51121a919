"""Cells of the tables of pairs of strips: polynomials that are continuously differentiable together."""

from __future__ import annotations

import numpy as np

from wheelrail.bindings._contact import CELLS, DEGREE, look_up
from wheelrail.contact.laws.material import Material
from wheelrail.contact.laws.parameters import ContactLaws
from wheelrail.contact.models.builders import wheel_rail_pair
from wheelrail.contact.models.discretisation import Discretisation
from wheelrail.contact.models.lattice.influence.pair_grid import PairGrid, lobatto
from wheelrail.contact.models.lattice.model import LatticeContact
from wheelrail.meshes.profiles.named import named_profile
from wheelrail.support.arrays import Array

START = 1e-3


def values(x: Array) -> Array:
    """Functions (n, 2) that are even in x."""
    return np.column_stack([x**2 * np.log(x + START), np.sqrt(x**2 + START**2)])


def evaluated(coefficients: Array, u: Array) -> tuple[Array, Array]:
    """Values and slopes (n, k, m) at places u (n, k) of the cells."""
    powers = u[..., None] ** np.arange(DEGREE + 1)
    slopes = np.arange(1, DEGREE + 1) * powers[..., :-1]
    return powers @ coefficients, slopes @ coefficients[:, 1:]


def test_cells_are_joined_without_kinks() -> None:
    grid = PairGrid.over(START)
    coefficients = grid.coefficients(values(grid.x), even=True)
    u = grid.width[:, None] * np.linspace(0, 1, 21)
    found, slopes = evaluated(coefficients, u)
    exact = values((START * (grid.lower[:, None] + u - 1)).ravel()).reshape(found.shape)
    np.testing.assert_allclose(slopes[1:, 0], slopes[:-1, -1], rtol=1e-12)
    np.testing.assert_array_equal(slopes[0, 0], 0)
    by_nodes = np.linalg.solve(
        np.vander(lobatto(DEGREE + 1), increasing=True), values(grid.x).reshape(len(u), DEGREE + 1, 2)
    )
    apart, kinks = evaluated(by_nodes, u / grid.width[:, None])
    kinks /= grid.width[:, None, None]
    assert np.abs(kinks[1:, 0] - kinks[:-1, -1]).max() > 1e-11  # without joining
    assert np.abs(found - exact).max() < 2 * np.abs(apart - exact).max()


def test_antiderivatives_of_strips_have_no_kinks() -> None:
    """A jump of a slope would be a step of the displacement beside the strip."""
    profiles = named_profile("S1002"), named_profile("UIC60-benchmark")
    how = Discretisation(1e-3, bodies="half-space", points="lattice")
    model = wheel_rail_pair(profiles, 0.46, (Material(), Material()), ContactLaws(friction=0.3), how)
    assert isinstance(model, LatticeContact)
    strips = np.arange(40, 42)
    near, feet = np.isin(np.arange(len(model.tables.middle)), strips), model.tables.middle
    tables = model.tables.of(strips, near, feet, 0.1)
    for i, j in ((40, 40), (40, 41)):
        pair = tables.pair[i, j]
        count = int(tables.cells[pair]) - 1
        octave, k = np.divmod(np.arange(1, count), CELLS)
        bounds = (2.0**octave * (1 + k / CELLS) - 1) / tables.inverse[pair]
        aside = 1e-12 * (bounds + 1 / tables.inverse[pair])
        sides = []
        for x in (bounds - aside, bounds + aside):
            G, slope = np.empty((len(x), 1, 8)), np.empty((len(x), 1, 8))
            assert look_up(tables, i, j, x, np.zeros(1), G, slope)
            sides.append(slope[:, 0])
        assert (np.abs(sides[1] - sides[0]) <= 1e-10 * np.abs(sides[0]).max(axis=0)).all()
