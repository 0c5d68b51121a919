"""What hosts with flexible wheels or tracks count themselves: beams in closed form, and independence of the pads."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.integrate import quad

from wheelrail.contact.laws.material import Material
from wheelrail.contact.structure.pads import RailPads
from wheelrail.contact.structure.rim import rim_compliance
from wheelrail.contact.structure.section_motion import SectionMotion, section_motion
from wheelrail.meshes.bodies.outlines import rail_outline, wheel_outline
from wheelrail.meshes.profiles.named import named_profile

STEEL = Material()
HEAD = 0.172  # m, height of the running surface over the foot


@pytest.fixture(scope="module")
def motion() -> SectionMotion:
    return section_motion(rail_outline(named_profile("UIC60-benchmark")), STEEL, RailPads())


def test_mean_motion_of_the_section_is_that_of_a_beam_on_pads(motion: SectionMotion) -> None:
    # Timoshenko beam on an elastic foundation; 60E1: A = 76.7 cm2, I = 3038 cm4, shear coefficient 0.40 to 0.34.
    area, inertia, stiffness, G = 76.7e-4, 3038e-8, 100e6 / 0.6, STEEL.E / (2 * (1 + STEEL.nu))

    def beam(kappa: float) -> float:
        def at(k: float) -> float:
            return 1.0 / (stiffness + 1.0 / (1.0 / (STEEL.E * inertia * k**4) + 1.0 / (kappa * G * area * k**2)))

        return float(quad(at, 1e-6, 200.0, limit=400)[0] / np.pi)

    low, high = beam(0.40), beam(0.34)
    assert 0.985 * low < motion.beam[1, 1] < 1.015 * high
    # Euler beam sideways, I = 512 cm4, with the roll of the section about its foot left out; roll: free torsion above.
    lateral = (40e6 / 0.6 / (4 * STEEL.E * 512e-8)) ** 0.25 / (2 * 40e6 / 0.6)
    assert motion.beam[0, 0] == pytest.approx(lateral, rel=0.07)
    assert 1.89e-6 < motion.beam[2, 2] < 2.23e-6  # rad/N m; with warping stiffness estimated by hand, and without


def test_local_part_hardly_depends_on_the_pads(motion: SectionMotion) -> None:
    stiff = section_motion(rail_outline(named_profile("UIC60-benchmark")), STEEL, RailPads(500e6, 100e6))
    arm = np.array([1.0, 0.0, -HEAD])  # lateral motion of the head
    assert arm @ stiff.own @ arm == pytest.approx(arm @ motion.own @ arm, rel=0.01)
    assert stiff.own[1, 1] == pytest.approx(motion.own[1, 1], rel=0.03)
    # Head of the clamped rail 1.17e-8 m/N sideways, of which 0.115e-8 is local: another implementation.
    assert arm @ motion.own @ arm == pytest.approx(1.055e-8, rel=0.03)
    assert motion.misfit < 0.006


def test_rim_turns_on_its_web() -> None:
    rim = rim_compliance(wheel_outline(named_profile("S1002"), 0.46), STEEL).rim
    assert rim[3, 3] == pytest.approx(4.45e-8, rel=0.02)  # rad/N m, another implementation
    assert rim[5, 5] == rim[3, 3]
    assert (np.linalg.eigvalsh(rim[np.ix_([0, 1, 2, 3, 5], [0, 1, 2, 3, 5])]) > 0.0).all()
