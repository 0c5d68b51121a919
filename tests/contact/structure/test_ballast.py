"""Track that moves along with a wheel: beam on two layers in closed form, statics, limits."""

from __future__ import annotations

from dataclasses import replace
from functools import cache

import numpy as np
import pytest

from wheelrail.contact.laws.material import Material
from wheelrail.contact.structure.ballast import (
    Ballast,
    CoRunningTrack,
    Layers,
    co_running,
    co_running_track,
    of_both_sides,
)
from wheelrail.contact.structure.pads import RailCompliance, RailPads, rail_compliance, wavenumber_samples
from wheelrail.meshes.bodies.outlines import rail_outline
from wheelrail.meshes.profiles.named import named_profile

BENDING, RAIL, SPACING = 2.1e11 * 3038.3e-8, 7850 * 76.70e-4, 0.6  # N m2, kg/m, m: 60E1
ACROSS = 2.1e11 * 512.3e-8  # N m2, of bending across
PADS, BALLAST = RailPads(), Ballast()
PAD, BED, SLEEPERS = 100e6 / SPACING, 80e6 / SPACING, 150.0 / SPACING  # N/m2, kg/m
TIMES = 30e3 / 100e6, 60e3 / 80e6  # s


def euler_beam(frequency: float, times: tuple[float, float] = TIMES) -> complex:
    """Receptance m/N of an infinite Euler beam on pads, sleepers and ballast, in closed form; frequency: Hz."""
    omega = 2 * np.pi * frequency
    pad, bed = PAD * (1 + 1j * omega * times[0]), BED * (1 + 1j * omega * times[1]) - omega**2 * SLEEPERS
    return complex(1 / (2 * np.sqrt(2) * BENDING**0.25 * (pad * bed / (pad + bed) - omega**2 * RAIL) ** 0.75))


@cache
def reduced_beam() -> CoRunningTrack:
    """The same beam in all directions, reduced."""
    k = wavenumber_samples()
    series = PAD * BED / (PAD + BED)
    compliance = (1 / (BENDING * k**4 + series))[:, None, None] * np.eye(3)
    foot = compliance[:, :2, :]
    inertia, squared = RAIL * compliance**2, compliance**2
    strain = PAD * squared
    both = np.full(2, PAD), np.full(2, BED)
    layers = Layers(k, *both, np.full(2, SLEEPERS), compliance, inertia, strain, foot)
    matrix = layers.along(compliance)
    return co_running(layers, RailCompliance(matrix, np.zeros(2), 0.0), TIMES)


@cache
def track() -> CoRunningTrack:
    return co_running_track(rail_outline(named_profile("UIC60").inclined(0.025)), Material(), PADS, BALLAST)


def test_masses_and_stiffness_of_a_beam() -> None:
    # Ritz with the static deflection: masses and layers count over a length of 3 / (2 beta), the rail bends with 1/4.
    beam = reduced_beam()
    series = PAD * BED / (PAD + BED)
    beta = (series / (4 * BENDING)) ** 0.25
    length, whole = 1.5 / beta, 2 * series / beta
    assert beam.mass[1, 1] == pytest.approx(RAIL * length, rel=1e-4)
    assert beam.mass[4, 4] == pytest.approx(SLEEPERS * length, rel=1e-4)
    assert beam.pads[1, 1] == pytest.approx(PAD * length, rel=1e-4)
    assert beam.pads[1, 4] == pytest.approx(-PAD * length, rel=1e-4)
    assert beam.ballast[4, 4] == pytest.approx(BED * length, rel=1e-4)
    assert beam.rest[1, 1] == pytest.approx(0.25 * whole, rel=1e-3)


@pytest.mark.parametrize(("frequency", "error"), [(0.0, 1e-5), (10.0, 3e-4), (20.0, 1e-3), (50.0, 0.01), (70.0, 0.04)])
def test_receptance_of_a_beam_on_two_layers(frequency: float, error: float) -> None:
    exact = euler_beam(frequency)
    assert abs(reduced_beam().receptance(frequency)[1, 1] - exact) < error * abs(exact)


def test_errors_begin_with_the_fourth_power_of_the_frequency() -> None:
    none = (0.0, 0.0)
    undamped = replace(reduced_beam(), pad_time=0.0, ballast_time=0.0)

    def error(frequency: float) -> float:
        ratio = undamped.receptance(frequency)[1, 1] / euler_beam(frequency, none)
        return float(abs(ratio - undamped.receptance(0.0)[1, 1] / euler_beam(0.0, none)))

    assert 12.0 < error(40.0) / error(20.0) < 24.0


def test_statics_of_the_rail() -> None:
    loads = np.linalg.inv(track().stiffness)
    np.testing.assert_allclose(loads[:3, :3], track().rail.matrix, rtol=1e-9, atol=1e-14)
    for matrix in (track().mass, track().stiffness):
        assert np.linalg.eigvalsh(matrix).min() > 0.0
    for matrix in (track().pads, track().rest, track().damping):
        assert np.linalg.eigvalsh(matrix).min() > -1e-9 * np.abs(matrix).max()


def test_stiff_ballast_leaves_the_rail_on_pads() -> None:
    outline = rail_outline(named_profile("UIC60").inclined(0.025))
    stiff = co_running_track(outline, Material(), PADS, Ballast(vertical=1e14, lateral=1e14))
    np.testing.assert_allclose(stiff.rail.matrix, rail_compliance(outline, Material(), PADS).matrix, rtol=1e-4)
    # Its mass is that of a beam on its pads, 7850 kg/m3 * 76.7 cm2 * 3 / (2 beta), less in shear.
    beta = (PAD / (4 * BENDING)) ** 0.25
    assert stiff.mass[1, 1] == pytest.approx(RAIL * 1.5 / beta, rel=0.08)


def test_rail_on_ballast_is_near_a_beam_in_shear() -> None:
    # Timoshenko beam on two layers, kappa 0.38: 10.69e-9 m/N at 50 Hz, with the compliance of the clamped rail, which
    # the track leaves to the contact.
    assert abs(track().receptance(50.0)[1, 1]) == pytest.approx(10.69e-9, rel=0.03)


@pytest.mark.parametrize("name", ["sleeper_mass", "vertical", "lateral", "pad_damping", "damping"])
def test_refuses_what_is_not_positive(name: str) -> None:
    with pytest.raises(ValueError, match=name):
        Ballast(**{name: 0.0})


def lateral_beam(ballast: Ballast) -> CoRunningTrack:
    """Euler beams with the lateral bending stiffness of a rail, in all directions."""
    k, pads, bed = wavenumber_samples(), np.array(PADS.per_length[1:]), ballast.per_length(PADS)
    flexibility = 1 / (ACROSS * k[:, None] ** 4 + pads * bed / (pads + bed))
    compliance = flexibility[:, [0, 1, 1], None] * np.eye(3)
    strain = pads[[0, 1, 1], None] * compliance**2
    layers = Layers(k, pads, bed, ballast.masses / SPACING, compliance, RAIL * compliance**2, strain, compliance[:, :2])
    return co_running(layers, RailCompliance(layers.along(compliance), np.zeros(2), 0.0), TIMES)


def test_rigid_sleepers_hold_the_gauge_as_in_closed_form() -> None:
    same, mirrored = (lateral_beam(own) for own in BALLAST.rigid(2.6, 0.75))
    stiffness = of_both_sides([same.stiffness] * 2, [mirrored.stiffness] * 2)
    left, right = 9750.0, 12910.0  # N outwards
    moved = np.linalg.solve(stiffness, [left, 0, 0, 0, 0, right, 0, 0, 0, 0])

    def compliance(layer: float) -> float:
        return float(1 / (2 * np.sqrt(2) * ACROSS**0.25 * layer**0.75))

    pads, bed = (stiffness / SPACING for stiffness in (PADS.lateral, BALLAST.lateral))
    held, free = compliance(pads), compliance(pads * bed / (pads + bed))
    assert moved[0] + moved[5] == pytest.approx(held * (left + right), rel=1e-4)  # 0.337 mm, 0.567 mm on halves
    assert moved[0] - moved[5] == pytest.approx(free * (left - right), rel=1e-4)
    assert moved[3] == pytest.approx(-moved[8], rel=1e-3)  # the sleeper moves across as a whole
    assert abs(moved[3]) > 1e-5


def test_sleepers_of_a_length_roll_as_halves_do() -> None:
    """A uniform sleeper of sqrt(12) y has the inertia of halves under the rails, and the same stiffness of ballast."""
    rolling, _ = BALLAST.rigid(np.sqrt(12.0) * 0.75, 0.75)
    assert rolling.inertia == pytest.approx(1.0, rel=1e-15)
    assert rolling.vertical == pytest.approx(BALLAST.vertical, rel=1e-15)
    shorter, _ = BALLAST.rigid(2.4, 0.75)
    assert shorter.inertia == pytest.approx(2.4**2 / 6.75)
    assert shorter.times(PADS) == pytest.approx(BALLAST.times(PADS))
