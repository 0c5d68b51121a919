"""Rail on discrete sleepers on ballast: beams on springs in series solved directly, limits, and elastic rails."""

from __future__ import annotations

import numpy as np
import pytest

from benchmarks.moving_wheel import BED, BENDING, PAD, RAIL, SLEEPER, DirectBeam, beam_track
from wheelrail.contact.laws.material import Material
from wheelrail.contact.structure.ballast import Ballast, co_running_track
from wheelrail.contact.structure.ballasted_sleepers import sleeper_track
from wheelrail.contact.structure.pads import RailPads
from wheelrail.contact.structure.sleepers import sleeper_compliance
from wheelrail.meshes.bodies.outlines import rail_outline
from wheelrail.meshes.profiles.named import named_profile

STEEL, PADS, BALLAST = Material(), RailPads(), Ballast()
OUTLINE = rail_outline(named_profile("UIC60").inclined(0.025))
SHEAR = 0.40 * 2.1e11 / 2.6 * 76.70e-4  # N: kappa G A


@pytest.mark.parametrize("spacing", [0.6, 1.2])
@pytest.mark.parametrize("fraction", [0.0, 0.25, 0.5])
def test_is_that_of_a_beam_on_springs_in_series(spacing: float, fraction: float) -> None:
    place = fraction * spacing
    here, direct = beam_track(spacing).at(place), DirectBeam(spacing, place)
    compliance = direct.receptance(0.0).real
    assert beam_track(spacing).rail.at(place)[1, 1] == pytest.approx(compliance, rel=2e-4)
    assert np.linalg.inv(here.stiffness)[1, 1] == pytest.approx(compliance, rel=2e-4)
    beam, sleepers, pads = direct.ritz()
    assert here.mass[1, 1] == pytest.approx(beam, rel=1e-3)
    assert here.mass[4, 4] == pytest.approx(sleepers, rel=1e-3)
    assert here.pads[1, 4] == pytest.approx(-pads, rel=1e-3)


@pytest.mark.parametrize("fraction", [0.0, 0.5])
@pytest.mark.parametrize(("frequency", "error"), [(10.0, 1e-3), (50.0, 0.01), (70.0, 0.04)])
def test_receptance_over_a_sleeper_and_between(fraction: float, frequency: float, error: float) -> None:
    exact = DirectBeam(0.6, 0.6 * fraction).receptance(frequency)
    assert abs(beam_track().at(0.6 * fraction).receptance(frequency)[1, 1] - exact) < error * abs(exact)


def test_close_sleepers_are_a_layer() -> None:
    # Limit: 9 spans of 0.1 m in the length of the deflection. Closed form of the beam on two layers.
    close, layers = beam_track(0.1, 0.03), PAD * BED / (PAD + BED) / 0.1
    beta = (layers / (4 * BENDING)) ** 0.25
    assert close.rail.matrix[1, 1] == pytest.approx(beta / (2 * layers), rel=1e-3)
    assert close.mass[1, 1] == pytest.approx(RAIL * 1.5 / beta, rel=1e-3)
    assert close.mass[4, 4] == pytest.approx(SLEEPER / 0.1 * 1.5 / beta, rel=2e-3)
    assert close.rest[1, 1] == pytest.approx(0.5 * layers / beta, rel=5e-3)
    np.testing.assert_allclose(close.harmonics, 0.0, atol=2e-3 * close.matrices.max())


def test_rail_on_sleepers_on_ballast() -> None:
    rail, spread = sleeper_track(OUTLINE, STEEL, PADS, BALLAST), co_running_track(OUTLINE, STEEL, PADS, BALLAST)
    at_rest = sleeper_compliance(OUTLINE, STEEL, PADS)
    # A beam in shear on pads 0.18 m long, on ballast and on sleepers at rest. It swings 1.2 times as much over a span,
    # as pads and load act on its axis; on ballast it swings 0.76 times as much as on sleepers at rest.
    beams = [[DirectBeam(0.6, x, SHEAR, 7, bed).receptance(0.0).real for x in (0.0, 0.3)] for bed in (BED, 1e15)]
    swings = [own.at(0.3)[1, 1] - own.at(0.0)[1, 1] for own in (rail.rail, at_rest)]
    assert rail.rail.at(0.0)[1, 1] == pytest.approx(beams[0][0], rel=0.02)
    assert rail.rail.at(0.3)[1, 1] == pytest.approx(beams[0][1], rel=0.02)
    assert swings[0] / swings[1] == pytest.approx(np.ptp(beams[0]) / np.ptp(beams[1]), rel=0.03)
    np.testing.assert_allclose(rail.rail.matrix.diagonal(), spread.rail.matrix.diagonal(), rtol=0.05)
    for frequency in (0.0, 50.0):
        lowest, spread_out, highest = (
            abs(track.receptance(frequency)[1, 1]) for track in (rail.at(0.0), spread, rail.at(0.3))
        )
        assert lowest < spread_out < highest < 1.03 * lowest
    for place in (0.0, 0.17, 0.3):
        here = rail.at(place)
        np.testing.assert_allclose(np.linalg.inv(here.stiffness)[:3, :3], rail.rail.at(place), rtol=1e-3, atol=1e-12)
        for matrix in (here.mass, here.stiffness):
            assert np.linalg.eigvalsh(matrix).min() > 0.0
        for matrix in (here.pads, here.rest, here.damping):
            assert np.linalg.eigvalsh(matrix).min() > -1e-6 * np.abs(matrix).max()
    step = 1e-6
    slope = (rail.at(0.1 + step).matrices - rail.at(0.1 - step).matrices) / (2 * step)
    np.testing.assert_allclose(rail.slope(0.1).matrices, slope, atol=1e-6 * np.abs(slope).max())


def test_stiff_ballast_leaves_sleepers_at_rest() -> None:
    stiff = sleeper_track(OUTLINE, STEEL, PADS, Ballast(vertical=1e14, lateral=1e14))
    at_rest = sleeper_compliance(OUTLINE, STEEL, PADS)
    for place in (0.0, 0.3):
        np.testing.assert_allclose(stiff.rail.at(place), at_rest.at(place), rtol=1e-4, atol=1e-14)


def test_refuses_pads_longer_than_the_spacing() -> None:
    with pytest.raises(ValueError, match="spacing"):
        sleeper_track(OUTLINE, STEEL, PADS, BALLAST, 0.7)
