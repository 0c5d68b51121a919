"""Shakedown map: stress below line contact by quadrature, Johnson's limits, the surface fatigue index."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.integrate import quad

from wheelrail.contact.stress.shakedown import (
    load_factor,
    shakedown_limit,
    surface_fatigue_index,
    surface_shear,
    utilisation,
)


@pytest.mark.parametrize(("x", "z"), [(0.3, 0.5), (-0.7, 0.2), (1.4, 0.6), (0.0, 1.0)])
@pytest.mark.parametrize("friction", [0.0, 0.3])
def test_shear_is_that_of_flamants_line_loads(x: float, z: float, friction: float) -> None:
    def shear(s: float) -> float:
        loaded = np.sqrt(1.0 - s * s) * -2.0 / np.pi * (x - s) * z / ((x - s) ** 2 + z * z) ** 2
        return float(loaded * (z + friction * (x - s)))

    expected = quad(shear, -1.0, 1.0, limit=200, epsabs=1e-11)[0]
    assert float(surface_shear(x, z, friction)) == pytest.approx(expected, abs=1e-9)


def test_shear_at_the_surface_is_the_traction() -> None:
    x = np.linspace(-0.9, 0.9, 7)
    assert surface_shear(x, np.zeros(7), 0.4) == pytest.approx(-0.4 * np.sqrt(1 - x * x))


def test_limit_is_johnsons() -> None:
    """4 k without friction, the surface from 0.367 on (Contact Mechanics, section 9.2)."""
    assert shakedown_limit(0.0) == pytest.approx(4.0, rel=1e-9)
    assert shakedown_limit(0.36) < 0.99 / 0.36
    for friction in (0.37, 0.5, 0.8):
        assert shakedown_limit(friction) == pytest.approx(1.0 / friction, rel=1e-9)
    limits = [shakedown_limit(f) for f in np.linspace(0.0, 0.7, 29)]
    assert np.all(np.diff(limits) < 0.0)
    with pytest.raises(ValueError, match="friction = "):
        shakedown_limit(-0.1)


def test_index_vanishes_where_the_surface_starts_to_ratchet() -> None:
    used = utilisation(np.array([10.0, 0.0]), np.array([[3.0, 4.0], [0.0, 0.0]]))
    assert used == pytest.approx([0.5, 0.0])
    assert load_factor(np.array([600e6]), 300e6) == pytest.approx([2.0])
    assert surface_fatigue_index(used[:1], np.array([2.0])) == pytest.approx([0.0])
