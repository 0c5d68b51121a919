"""Deviation of a body from a half-space: coefficients that are read from the cache."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from wheelrail.contact.elasticity.waveguide.bodies import block_waveguide
from wheelrail.contact.elasticity.waveguide.influence import ElementInfluence
from wheelrail.contact.laws.material import Material
from wheelrail.contact.models.lattice.influence.body_correction import BodyCorrection
from wheelrail.support.arrays import Array

SIZE, HALF_CELLS = 1e-3, 8


def correction(E: float = 210e9, nu: float = 0.3) -> BodyCorrection:
    """Of a small block on coarse triangles."""
    steel = Material(E, nu)
    body, _ = block_waveguide((4, HALF_CELLS), steel, size=SIZE, half_width=24.0, degree=1, tolerance=3e-2)
    lines = np.column_stack([SIZE * (np.arange(2 * HALF_CELLS + 1) - HALF_CELLS), np.zeros(2 * HALF_CELLS + 1)])
    return BodyCorrection(ElementInfluence.of_waveguide(body, lines, lines[:, 0], steel, 1, unit=SIZE), 1.0)


def coefficients(deviation: BodyCorrection) -> Array:
    return deviation.finite_body(False).coefficients(-0.5 * SIZE, 0.5 * SIZE)


@pytest.fixture
def stored(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Array:
    """Coefficients that have been computed and stored in an empty cache."""
    monkeypatch.setenv("WHEELRAIL_CACHE", str(tmp_path))
    return coefficients(correction())


def test_stored_coefficients_are_the_computed_ones(stored: Array, monkeypatch: pytest.MonkeyPatch) -> None:
    def computed(*given: object) -> None:
        raise AssertionError("computed again")

    monkeypatch.setattr(ElementInfluence, "correction", computed)
    np.testing.assert_array_equal(coefficients(correction()), stored)
    softer = coefficients(correction(E=70e9))  # one set of coefficients serves all moduli
    np.testing.assert_allclose(softer, 3 * stored, rtol=0.0, atol=1e-14 * np.abs(softer).max())
    assert np.abs(stored).max() > 0


def test_coefficients_of_another_material_are_computed(stored: Array) -> None:
    other = coefficients(correction(nu=0.25))
    assert np.abs(other - stored).max() > 1e-3 * np.abs(stored).max()
