"""Rail on discrete sleepers on ballast: beams on springs in series solved directly, limits, and elastic rails."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cache

import numpy as np
import pytest

from wheelrail.contact.laws.material import Material
from wheelrail.contact.structure.ballast import Ballast, CoRunningTrack, co_running_track
from wheelrail.contact.structure.ballasted_sleepers import ballasted_sleepers, loaded_tracks
from wheelrail.contact.structure.pads import RailCompliance, RailPads, wavenumber_samples
from wheelrail.contact.structure.sleepers import Span, SpreadSupport, cosines, sleeper_compliance
from wheelrail.meshes.bodies.outlines import rail_outline
from wheelrail.meshes.profiles.named import named_profile
from wheelrail.support.arrays import Array

BENDING, RAIL = 2.1e11 * 3038.3e-8, 7850 * 76.70e-4  # N m2, kg/m: 60E1
PAD, BED, SLEEPER, COUNT = 100e6, 80e6, 150.0, 41  # N/m and kg, of one pad and half a sleeper
TIMES = 30e3 / PAD, 60e3 / BED  # s
STEEL, PADS, BALLAST = Material(), RailPads(), Ballast()
OUTLINE = rail_outline(named_profile("UIC60").inclined(0.025))
INERTIA = np.array([[156, 22, 54, -13], [22, 4, 13, -3], [54, 13, 156, -22], [-13, -3, -22, 4]]) / 420
SHEAR = 0.40 * 2.1e11 / 2.6 * 76.70e-4  # N: kappa G A


@dataclass(frozen=True)
class DirectBeam:
    """A long beam on pads, sleepers and ballast, by Hermite elements of a fifth of a span at most, statically exact.

    Parameters: spacing of the sleepers and place of the load from one, m; shear: stiffness N, infinite: an Euler beam;
    springs: of a pad 0.18 m long, 1: at a point; ballast: stiffness under half a sleeper, N/m.
    """

    spacing: float
    place: float
    shear: float = np.inf
    springs: int = 1
    ballast: float = BED

    def matrices(self) -> tuple[Array, Array, Array, Array, int]:
        """Stiffness of beam, pads and ballast, mass, all with the sleepers last, and the coordinate of the load."""
        sleepers = self.spacing * (np.arange(COUNT) - COUNT // 2)
        seats = sleepers[:, None] + 0.18 * ((np.arange(self.springs) + 0.5) / self.springs - 0.5)
        fine = np.linspace(seats[0, 0], seats[-1, -1], 5 * (COUNT - 1) + 1) if self.springs == 1 else seats.ravel()
        x = np.unique(np.round(np.concatenate([fine, seats.ravel(), [self.place]]), 10))
        size = 2 * len(x)
        K, P, B, M = np.zeros((4, size + COUNT, size + COUNT))
        for i, h in enumerate(np.diff(x)):
            scale, at, phi = np.array([1.0, h, 1.0, h]), slice(2 * i, 2 * i + 4), 12 * BENDING / self.shear / h**2
            f, g = 4 + phi, 2 - phi
            unit = np.array([[12, 6, -12, 6], [6, f, -6, g], [-12, -6, 12, -6], [6, g, -6, f]]) / (1 + phi)
            K[at, at] += BENDING / h**3 * unit * np.outer(scale, scale)
            M[at, at] += RAIL * h * INERTIA * np.outer(scale, scale)
        own = size + np.arange(COUNT)
        for seat in seats.T:
            on = 2 * np.searchsorted(x, np.round(seat, 10))
            for first, second, sign in ((own, own, 1), (on, on, 1), (own, on, -1), (on, own, -1)):
                P[first, second] += sign * PAD / self.springs
        B[own, own], M[own, own] = self.ballast, SLEEPER
        return K, P, B, M, 2 * int(np.searchsorted(x, np.round(self.place, 10)))

    def receptance(self, frequency: float) -> complex:
        """Motion m/N under the load; frequency: Hz."""
        K, P, B, M, load = self.matrices()
        omega = 2 * np.pi * frequency
        dynamic = K + P * (1 + 1j * omega * TIMES[0]) + B * (1 + 1j * omega * TIMES[1]) - omega**2 * M
        return complex(np.linalg.solve(dynamic, np.eye(len(K))[load])[load])

    def ritz(self) -> tuple[float, float, float]:
        """Masses kg of the beam and the sleepers, and stiffness N/m of the pads between beam and sleepers, by the shape
        under the load, sleepers interpolated there by sinc functions.
        """
        K, P, B, M, load = self.matrices()
        u = np.linalg.solve(K + P + B, np.eye(len(K))[load])
        sleepers = np.arange(len(K)) >= len(K) - COUNT
        beam, beds = np.where(sleepers, 0.0, u), np.where(sleepers, u, 0.0)
        distance = np.arange(COUNT) - COUNT // 2 - self.place / self.spacing
        under = float(u[sleepers] @ np.sinc(distance))
        return beam @ M @ beam / u[load] ** 2, beds @ M @ beds / under**2, -(beam @ P @ beds) / u[load] / under


@cache
def track(spacing: float = 0.6, length: float = 0.0) -> CoRunningTrack:
    """The same beam, alike in all directions, by Floquet's theorem."""
    k, pads, bed = wavenumber_samples(), PAD / spacing, np.full(2, BED / spacing)
    compliance = (1 / (BENDING * k**4 + pads))[:, None, None]
    by_load = compliance * np.eye(2, 3)
    shapes = np.concatenate([np.eye(3, 2), np.eye(3)], axis=1)
    inertia = RAIL * compliance**2 * (shapes.T @ shapes)
    support = SpreadSupport(k, pads * np.eye(2), compliance * np.eye(2), by_load, inertia, np.ones(2), np.eye(2))
    span, winkler = Span(support, spacing, length, bed), (pads / (4 * BENDING)) ** 0.25 / (2 * pads)
    loaded = loaded_tracks(span, span.places(20), winkler * np.eye(3))
    mean, *varying = cosines(np.stack([one.compliance for one in loaded]))
    rail = RailCompliance(mean, np.zeros(2), 0.0, np.stack(varying), spacing)
    matrices, *others = cosines(np.stack([one.reduced(np.full(2, pads), bed, SLEEPER / spacing) for one in loaded]))
    return CoRunningTrack(rail, matrices, *TIMES, np.stack(others))


@pytest.mark.parametrize("spacing", [0.6, 1.2])
@pytest.mark.parametrize("fraction", [0.0, 0.25, 0.5])
def test_is_that_of_a_beam_on_springs_in_series(spacing: float, fraction: float) -> None:
    place = fraction * spacing
    here, direct = track(spacing).at(place), DirectBeam(spacing, place)
    compliance = direct.receptance(0.0).real
    assert track(spacing).rail.at(place)[1, 1] == pytest.approx(compliance, rel=2e-4)
    assert np.linalg.inv(here.stiffness)[1, 1] == pytest.approx(compliance, rel=2e-4)
    beam, sleepers, pads = direct.ritz()
    assert here.mass[1, 1] == pytest.approx(beam, rel=1e-3)
    assert here.mass[4, 4] == pytest.approx(sleepers, rel=1e-3)
    assert here.pads[1, 4] == pytest.approx(-pads, rel=1e-3)


@pytest.mark.parametrize("fraction", [0.0, 0.5])
@pytest.mark.parametrize(("frequency", "error"), [(10.0, 1e-3), (50.0, 0.01), (70.0, 0.04)])
def test_receptance_over_a_sleeper_and_between(fraction: float, frequency: float, error: float) -> None:
    exact = DirectBeam(0.6, 0.6 * fraction).receptance(frequency)
    assert abs(track().at(0.6 * fraction).receptance(frequency)[1, 1] - exact) < error * abs(exact)


def test_close_sleepers_are_a_layer() -> None:
    # Limit: 9 spans of 0.1 m in the length of the deflection. Closed form of the beam on two layers.
    close, layers = track(0.1, 0.03), PAD * BED / (PAD + BED) / 0.1
    beta = (layers / (4 * BENDING)) ** 0.25
    assert close.rail.matrix[1, 1] == pytest.approx(beta / (2 * layers), rel=1e-3)
    assert close.mass[1, 1] == pytest.approx(RAIL * 1.5 / beta, rel=1e-3)
    assert close.mass[4, 4] == pytest.approx(SLEEPER / 0.1 * 1.5 / beta, rel=2e-3)
    assert close.rest[1, 1] == pytest.approx(0.5 * layers / beta, rel=5e-3)
    np.testing.assert_allclose(close.harmonics, 0.0, atol=2e-3 * close.matrices.max())


def test_rail_on_sleepers_on_ballast() -> None:
    rail, spread = ballasted_sleepers(OUTLINE, STEEL, PADS, BALLAST), co_running_track(OUTLINE, STEEL, PADS, BALLAST)
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
    stiff = ballasted_sleepers(OUTLINE, STEEL, PADS, Ballast(vertical=1e14, lateral=1e14))
    at_rest = sleeper_compliance(OUTLINE, STEEL, PADS)
    for place in (0.0, 0.3):
        np.testing.assert_allclose(stiff.rail.at(place), at_rest.at(place), rtol=1e-4, atol=1e-14)


def test_refuses_pads_longer_than_the_spacing() -> None:
    with pytest.raises(ValueError, match="spacing"):
        ballasted_sleepers(OUTLINE, STEEL, PADS, BALLAST, 0.7)
