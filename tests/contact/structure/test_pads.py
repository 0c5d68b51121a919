"""Rail on pads: statics, and beams on an elastic foundation in closed form."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
import pytest
import scipy.sparse as sp
import scipy.sparse.linalg as sl
import ufl
from dolfinx import fem
from scipy.integrate import quad

from wheelrail.contact.elasticity.waveguide.spectrum import interpolation, quadrature
from wheelrail.contact.laws.material import Material
from wheelrail.contact.structure import pads as pads_module
from wheelrail.contact.structure.padded_section import PaddedSection
from wheelrail.contact.structure.pads import RailPads, rail_compliance
from wheelrail.forms import compat
from wheelrail.meshes.bodies.outlines import rail_outline
from wheelrail.meshes.bodies.solids import Strip, section
from wheelrail.meshes.bodies.triangulation import Grading
from wheelrail.meshes.profiles.named import named_profile
from wheelrail.support.arrays import Array

STEEL, PADS, SPACING = Material(), RailPads(), 0.6
OUTLINE = rail_outline(named_profile("UIC60").inclined(0.025))
# 60E1: area m2, second moments about the horizontal and the vertical axis m4 (EN 13674-1), torsion constant m4
AREA, INERTIA, LATERAL_INERTIA, TORSION = 76.70e-4, 3038.3e-8, 512.3e-8, 2.1e-6


def padded(pads: RailPads) -> PaddedSection:
    strip = Strip.on(OUTLINE, half_length=4e-3, size=4e-3)
    return PaddedSection(section(OUTLINE, strip, grading=Grading(1.0, 0.4, 8e-3)), STEEL, pads.per_length)


def solver(body: PaddedSection, k: float) -> Callable[[Array], Array]:
    pointer, columns, _ = body.matrices
    size = 3 * len(body.points)
    return sl.splu(sp.csc_matrix(sp.csr_matrix((body.stiffness(k), columns, pointer), shape=(size, size)))).solve


def mean_compliance(body: PaddedSection) -> Array:
    """Mean motion (y, z, roll about the foot's middle) of the section at x = 0 by loads spread likewise over it."""
    U, V = ufl.TrialFunction(body.space), ufl.TestFunction(body.space)
    pointer, columns, values = compat.assemble_csr(fem.form(ufl.inner(U, V) * ufl.dx))
    y, z = (body.points - body.foot.mean(axis=0)).T
    R = np.zeros((len(y), 3, 3))
    R[:, 1, 0] = R[:, 2, 1] = 1.0
    R[:, 1, 2], R[:, 2, 2] = -z, y
    R = R.reshape(-1, 3)
    MR = sp.csr_matrix((values, columns, pointer)) @ R
    D = MR @ np.linalg.inv(R.T @ MR)
    samples = np.concatenate([[0.0], np.geomspace(0.03, 60.0, 30)])
    H = np.stack([D.T @ solver(body, k)(D) for k in samples])
    k, weight = quadrature(samples, 0.0)
    return np.einsum("k,kab->ab", weight / np.pi @ interpolation(samples, 1.0, k), H)


@pytest.fixture(scope="module")
def mean() -> Array:
    return mean_compliance(padded(PADS))


def test_the_pads_carry_the_load() -> None:
    # Statics at k = 0: the resultant on the support of a unit load on the rail's surface is that load.
    body = padded(PADS)
    first, last = body.foot
    t = (last - first) / np.hypot(*(last - first))
    n = np.array([-t[1], t[0]])
    place = (body.points - first) @ t
    nodes = np.flatnonzero(np.abs((body.points - first) @ n) < 1e-9)
    nodes = nodes[np.argsort(place[nodes])]
    ends = place[nodes][::2]
    weights = np.zeros(len(nodes))
    for part, weight in enumerate((1 / 6, 4 / 6, 1 / 6)):
        weights[part : part + 2 * (len(ends) - 1) : 2] += weight * np.diff(ends)
    weights /= weights.sum()
    load = np.zeros(3 * len(body.points))
    load[3 * body.surface[len(body.surface) // 2] + 2] = 1.0
    u = weights @ solver(body, 0.0)(load).reshape(-1, 3)[nodes, 1:]
    _, lateral, vertical = PADS.per_length
    np.testing.assert_allclose(vertical * (u @ n) * n + lateral * (u @ t) * t, [0.0, 1.0], atol=1e-9)


def test_deflects_as_a_timoshenko_beam_on_a_foundation(mean: Array) -> None:
    # Closed form: (1/pi) int dk / (k_n + 1 / (1/EI k^4 + 1/kappa G A k^2)), kappa 0.40 to 0.34.
    k_n, G = PADS.vertical / SPACING, STEEL.E / 2 / (1 + STEEL.nu)

    def beam(kappa: float) -> float:
        def H(k: float) -> float:
            return 1 / (k_n + 1 / (1 / (STEEL.E * INERTIA * k**4) + 1 / (kappa * G * AREA * k**2)))

        return (quad(H, 1e-9, 30, limit=400)[0] + quad(H, 30, 300, limit=800)[0]) / np.pi

    beta = (k_n / (4 * STEEL.E * INERTIA)) ** 0.25
    assert beta / 2 / k_n == pytest.approx(4.796e-9, rel=1e-3)  # Winkler, without shear
    assert mean[1, 1] == pytest.approx(0.5 * (beam(0.40) + beam(0.34)), rel=0.015)
    assert mean[1, 1] > 1.05 * beta / 2 / k_n


def test_bends_laterally_as_a_beam_on_a_foundation(mean: Array) -> None:
    k_t = PADS.lateral / SPACING
    beta = (k_t / (4 * STEEL.E * LATERAL_INERTIA)) ** 0.25
    assert 1.0 < mean[0, 0] / (beta / 2 / k_t) < 1.08  # the centre lies above the pads: it also turns the rail


def test_rolls_as_a_bar_in_torsion_with_warping(mean: Array) -> None:
    # Free torsion is an upper bound; torsion coupled with lateral bending and warping, 3.4e3 N m4, a lower one.
    k_roll, G = PADS.vertical / SPACING * 0.146**2 / 12, STEEL.E / 2 / (1 + STEEL.nu)
    free = 1 / (2 * np.sqrt(G * TORSION * k_roll))
    assert 0.84 * free < mean[2, 2] < free


def test_motion_of_the_section_on_the_clamped_rail() -> None:
    # Another implementation on its own mesh: c_zz 1e-9 m/N, c_yy 1e-8, c_rr 1e-6 rad/N m.
    units = [1e8, 1e9, 1e6]
    for pads, expected, tolerance in (
        (PADS, [1.591, 5.086, 1.297], 2e-3),
        (RailPads(60e6, 30e6), [1.949, 7.377, 1.854], 5e-3),
        (RailPads(500e6, 100e6), [0.835, 1.599, 0.376], 5e-3),
    ):
        rail = rail_compliance(OUTLINE, STEEL, pads)
        assert np.diag(rail.matrix) * units == pytest.approx(expected, rel=tolerance)
        assert rail.misfit < 5e-3
        assert np.linalg.eigvalsh(rail.matrix).min() > 0.0
        assert 1e3 * rail.foot == pytest.approx([-3.2, -172.0], abs=0.1)


def test_stiff_pads_clamp_the_rail() -> None:
    stiff = rail_compliance(OUTLINE, STEEL, RailPads(1e12, 1e12, 1e12))
    soft = rail_compliance(OUTLINE, STEEL, PADS)
    assert (np.diag(stiff.matrix) < 0.005 * np.diag(soft.matrix)).all()


def test_wavenumbers_suffice(monkeypatch: pytest.MonkeyPatch) -> None:
    coarse = rail_compliance(OUTLINE, STEEL, PADS)
    monkeypatch.setattr(pads_module, "SAMPLES", 2 * pads_module.SAMPLES)
    monkeypatch.setattr(pads_module, "LARGEST", 2 * pads_module.LARGEST)
    fine = rail_compliance(OUTLINE, STEEL, PADS)
    np.testing.assert_allclose(np.diag(coarse.matrix), np.diag(fine.matrix), rtol=1e-5)


@pytest.mark.parametrize("name", ["vertical", "lateral", "longitudinal", "spacing"])
def test_refuses_pads_without_stiffness(name: str) -> None:
    with pytest.raises(ValueError, match=name):
        RailPads(**{name: 0.0})
