"""Rail on discrete sleepers: beams on point springs in closed form, limits, and another implementation."""

from __future__ import annotations

import numpy as np
import pytest

from wheelrail.contact.laws.material import Material
from wheelrail.contact.structure.pads import RailPads, rail_compliance, wavenumber_samples
from wheelrail.contact.structure.sleepers import Span, SpreadSupport, cosines, sleeper_compliance
from wheelrail.meshes.bodies.outlines import rail_outline
from wheelrail.meshes.profiles.named import named_profile
from wheelrail.support.arrays import Array

BENDING, STIFFNESS = 2.1e11 * 3038.3e-8, 100e6  # N m2, N/m: 60E1 on pads
STEEL, PADS = Material(), RailPads()


def beam_on_springs(spacing: float, place: float, count: int = 41) -> float:
    """Compliance m/N under a load on a long Euler beam on point springs, by Hermite elements, exact at their nodes.

    place: of the load from a spring, m.
    """
    springs = spacing * (np.arange(count) - count // 2)
    nodes = np.unique(np.round(np.concatenate([springs, [place]]), 12))
    K = np.zeros((2 * len(nodes), 2 * len(nodes)))
    for i, h in enumerate(np.diff(nodes)):
        element = np.array(
            [
                [12, 6 * h, -12, 6 * h],
                [6 * h, 4 * h * h, -6 * h, 2 * h * h],
                [-12, -6 * h, 12, -6 * h],
                [6 * h, 2 * h * h, -6 * h, 4 * h * h],
            ]
        )
        K[2 * i : 2 * i + 4, 2 * i : 2 * i + 4] += BENDING / h**3 * element
    supported = 2 * np.searchsorted(nodes, np.round(springs, 12))
    K[supported, supported] += STIFFNESS
    loaded = 2 * int(np.searchsorted(nodes, np.round(place, 12)))
    return float(np.linalg.inv(K)[loaded, loaded])


def beam(spacing: float, length: float) -> Array:
    """Harmonics (1 + 20,) m/N of an Euler beam on springs of a length m; the first is its mean."""
    k, spread = wavenumber_samples(), STIFFNESS / spacing
    compliance = (1.0 / (BENDING * k**4 + spread))[:, None, None]
    by_load = compliance * np.array([[0.0, 1.0, 0.0]])
    inertia, one = np.zeros((len(k), 4, 4)), np.ones(1)
    support = SpreadSupport(k, np.full((1, 1), spread), compliance, by_load, inertia, one, np.zeros((1, 2)))
    span = Span(support, spacing, length)
    harmonics = cosines(span.compliance(span.places(20)))[:, 1, 1]
    harmonics[0] += (spread / (4 * BENDING)) ** 0.25 / (2 * spread)  # Winkler
    return harmonics


@pytest.mark.parametrize("spacing", [0.6, 1.2])
@pytest.mark.parametrize("fraction", [0.0, 0.25, 0.5])
def test_is_that_of_a_beam_on_point_springs(spacing: float, fraction: float) -> None:
    compliance = float(np.cos(2 * np.pi * fraction * np.arange(21)) @ beam(spacing, 0.0))
    assert compliance == pytest.approx(beam_on_springs(spacing, fraction * spacing), rel=1e-4)


def test_pads_over_the_whole_span_are_spread() -> None:
    winkler = (STIFFNESS / 0.6 / (4 * BENDING)) ** 0.25 / (2 * STIFFNESS / 0.6)
    assert beam(0.6, 0.6)[0] == pytest.approx(winkler, rel=1e-12)
    np.testing.assert_allclose(beam(0.6, 0.6)[1:], 0.0, atol=1e-12 * winkler)
    close = beam(0.15, 0.05)  # 7 sleepers in the length of the deflection
    np.testing.assert_allclose(close[1:], 0.0, atol=1e-3 * close[0])


def test_over_a_sleeper_and_between() -> None:
    # Another implementation: receptances of head and foot of the waveguide, pads as uniform forces of 0.18 m on their
    # mean displacement, lines of 4 mm. c_zz 1e-9 m/N, c_yy 1e-8, c_rr 1e-6 rad/N m, c_yr 1e-9 rad/N.
    rail = sleeper_compliance(rail_outline(named_profile("UIC60").inclined(0.025)), STEEL, PADS)
    for place, expected in ((0.0, [5.047, 1.592, 1.378, -2.3]), (0.3, [5.333, 1.653, 1.350, -5.9])):
        c = rail.at(place)
        assert np.array([1e9 * c[1, 1], 1e8 * c[0, 0], 1e6 * c[2, 2]]) == pytest.approx(expected[:3], rel=8e-3)
        assert 1e9 * c[0, 2] == pytest.approx(expected[3], abs=0.4)
        assert np.linalg.eigvalsh(c).min() > 0.0
    np.testing.assert_allclose(rail.at(0.1), rail.at(0.7), rtol=1e-12)
    step = 1e-6
    slope = (rail.at(0.1 + step) - rail.at(0.1 - step)) / (2 * step)
    np.testing.assert_allclose(rail.slope(0.1), slope, atol=1e-6 * np.abs(slope).max())


def test_spread_pads_are_the_same_everywhere() -> None:
    rail = rail_compliance(rail_outline(named_profile("UIC60").inclined(0.025)), STEEL, PADS)
    np.testing.assert_array_equal(rail.at(0.2), rail.matrix)
    np.testing.assert_array_equal(rail.slope(0.2), 0.0)


def test_refuses_pads_longer_than_the_spacing() -> None:
    with pytest.raises(ValueError, match="spacing"):
        sleeper_compliance(rail_outline(named_profile("UIC60-benchmark")), STEEL, PADS, 0.7)
