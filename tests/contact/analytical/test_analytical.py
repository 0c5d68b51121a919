"""Closed forms and tables used as references, each checked by an identity."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

from benchmarks.common.reference_table import reference
from wheelrail.contact.analytical.carter import Carter, carter
from wheelrail.contact.analytical.cattaneo import Cattaneo, cattaneo
from wheelrail.contact.analytical.hertz import axis_stress, von_mises, worst
from wheelrail.contact.analytical.kalker import POISSON, RATIO, TABLE, Name, kalker

NAMES: tuple[Name, ...] = ("C11", "C22", "C23")


@pytest.mark.parametrize("stick", [0.0, 0.3, 0.9])
def test_carters_traction_sums_to_its_force_and_is_bounded(stick: float) -> None:
    one = Carter(2e-3, stick * 2e-3, 1e9, 0.3)
    x = 2e-3 * ((np.arange(40000) + 0.5) / 20000 - 1)
    q, p = one.traction(x), one.pressure(x)
    assert q.sum() / (0.3 * p.sum()) == pytest.approx(one.force, abs=1e-6)
    assert (q <= 0.3 * p + 1e-3).all()
    assert (q >= -1e-3).all()
    slips = x < one.centre - one.stick
    np.testing.assert_allclose(q[slips], 0.3 * p[slips])


def test_carters_stick_zone_moves_rigidly() -> None:
    # strain of two alike half-planes, 2 / (pi E*) times the principal value of q(s) / (x - s): minus the creepage
    a, radius, E_star, friction = 6e-3, 0.46, 1.15e11, 0.3
    peak = 0.5 * a * E_star / radius
    one = carter(a, peak, friction=friction, creepage=-5e-4, radius=radius)
    n = 200000
    s = a * ((np.arange(n) + 0.5) / (n // 2) - 1)
    for t in (-0.6, 0.0, 0.7):
        x = float(s[np.abs(s - one.centre - t * one.stick).argmin()] + a / n)  # midway between two sources
        strain = 2 / (np.pi * E_star) * (one.traction(s) / (x - s)).sum() * 2 * a / n
        assert strain == pytest.approx(5e-4, rel=1e-3)


def test_carter_slides_and_reverses() -> None:
    sliding = carter(2e-3, 1e9, friction=0.3, creepage=-1.0, radius=0.5)
    assert (sliding.stick, sliding.force) == (0.0, 1.0)
    back, forth = (carter(2e-3, 1e9, friction=0.3, creepage=xi, radius=0.5) for xi in (5e-4, -5e-4))
    assert back.force == -forth.force < 0
    with pytest.raises(ValueError, match="stick"):
        Carter(1.0, 1.1, 1.0, 0.3)


@pytest.mark.parametrize("case", reference("carter2d")["cases"], ids=lambda case: case["name"])
def test_carter_against_contact(case: dict[str, Any]) -> None:
    known, finest = case["closed"], case["contact"][-1]
    one = carter(known["a"], known["p0"], friction=case["mu"], creepage=case["creepage"], radius=case["R"])
    assert one.stick == pytest.approx(known["stick"], rel=1e-6)
    assert one.force == pytest.approx(known["force"], rel=1e-6)
    assert one.force == pytest.approx(finest["force"], abs=1e-3)


@pytest.mark.parametrize("stick", [0.0, 0.5, 0.9])
def test_cattaneos_traction_sums_to_its_force_and_is_bounded(stick: float) -> None:
    one = Cattaneo(4e-3, stick * 4e-3, 1e9, 0.3, 8e10, 0.3)
    r = 4e-3 * (np.arange(20000) + 0.5) / 20000
    q = one.traction(r)
    assert (2 * np.pi * r * q).sum() * 4e-3 / 20000 == pytest.approx(one.force, rel=1e-5)
    bound = 0.3 * 1e9 * np.sqrt(1 - (r / 4e-3) ** 2)
    assert (q <= bound * (1 + 1e-12)).all()
    np.testing.assert_allclose(q[r > one.stick], bound[r > one.stick])


def test_cattaneo_starts_as_mindlins_stuck_sphere() -> None:
    # Mindlin: without slip two alike spheres shift by F (2 - nu) / (4 G a)
    one = cattaneo(4e-3, 1e9, friction=0.3, G=8e10, nu=0.3, force=1e-4)
    assert one.shift == pytest.approx(one.force * 1.7 / (4 * 8e10 * 4e-3), rel=1e-4)


def test_cattaneo_by_force_and_by_shift() -> None:
    for case in reference("cattaneo")["cases"]:
        known = case["closed"]
        same = {"friction": case["mu"], "G": case["E"] / (2 + 2 * case["nu"]), "nu": case["nu"]}
        one = cattaneo(known["a"], known["p0"], force=case["force"], **same)
        assert one.stick == pytest.approx(known["stick"], rel=1e-6)
        assert one.shift == pytest.approx(known["shift"], rel=1e-6)
        assert cattaneo(known["a"], known["p0"], shift=one.shift, **same).stick == pytest.approx(one.stick)
        assert case["contact"][-1]["shift"] == pytest.approx(
            one.shift, rel=3e-3
        )  # which neglects a term that CONTACT includes
    with pytest.raises(ValueError, match="share"):
        cattaneo(1.0, 1.0, friction=0.3, G=1.0, nu=0.3, force=1.1)


@pytest.mark.parametrize("nu", [0.0, 0.3, 0.5])
def test_axis_stress_adds_up_to_the_approach(nu: float) -> None:
    # the strain down the axis sums to the sinking of the centre, pi p0 a (1 - nu^2) / (2 E), here with E = 1
    t = np.linspace(0, 1, 200001)[1:-1]
    z = t / (1 - t)
    radial, axial = axis_stress(z, radius=1.0, peak=1.0, nu=nu)
    sinking = -((axial - 2 * nu * radial) / (1 - t) ** 2).sum() * (t[1] - t[0])
    assert sinking == pytest.approx(np.pi / 2 * (1 - nu**2), rel=1e-4)


def test_axis_stress_at_the_surface_and_far_below() -> None:
    radial, axial = axis_stress(np.array([0.0, 300.0]), radius=1.0, peak=1.0, nu=0.3)
    assert axial[0] == -1.0
    assert radial[0] == pytest.approx(-0.5 * (1 + 2 * 0.3))
    assert axial[1] == pytest.approx(-3 * (2 / 3 * np.pi) / (2 * np.pi * 300.0**2), rel=1e-4)  # Boussinesq's point load


def test_maximum_shear_stress() -> None:
    depth, value = worst(radius=2.0, peak=3.0, nu=0.3)
    assert depth / 2.0 == pytest.approx(0.481, abs=1e-3)
    assert value / 3.0 == pytest.approx(0.620, abs=1e-3)
    around = von_mises(depth + np.array([-1e-3, 1e-3]), radius=2.0, peak=3.0, nu=0.3)
    assert (around < value).all()


def test_kalkers_table_is_consistent() -> None:
    for name in NAMES:
        np.testing.assert_array_equal(TABLE[name][0, :, -1], TABLE[name][1, :, -1])  # a = b belongs to both halves
        assert (np.diff(TABLE[name][1], axis=1) < 0).all()
        for i, nu in enumerate(POISSON):
            for j, ratio in enumerate(RATIO):
                assert kalker(name, ratio, nu) == pytest.approx(TABLE[name][0, i, j])
                assert kalker(name, 1 / ratio, nu) == pytest.approx(TABLE[name][1, i, j])
    np.testing.assert_array_equal(TABLE["C11"][:, 0], TABLE["C22"][:, 0])  # no Poisson's ratio, no direction
    # Kalker's limits of a short patch across the rolling direction: pi^2 / 4 / (1 - nu) and pi^2 / 4
    for nu in POISSON:
        assert kalker("C11", 0.1, nu) == pytest.approx(np.pi**2 / 4 / (1 - nu), rel=0.02)
        assert kalker("C22", 0.1, nu) == pytest.approx(np.pi**2 / 4, rel=0.03)


def test_kalker_against_contact() -> None:
    for case in reference("creep_curves")["kalker"]:
        for name in NAMES:
            assert kalker(name, case["ratio"], case["nu"]) == pytest.approx(case[name], rel=0.012)
        if case["nu"] == 0.25:
            assert kalker("C33", case["ratio"], 0.25) == pytest.approx(
                case["C33"], rel=0.16 if case["ratio"] > 2 else 0.03
            )


@pytest.mark.parametrize(("name", "ratio", "nu"), [("C11", 0.05, 0.3), ("C22", 1.0, 0.6), ("C33", 1.0, 0.3)])
def test_kalker_rejects_values_outside_the_table(name: Name, ratio: float, nu: float) -> None:
    with pytest.raises(ValueError, match="tabulated"):
        kalker(name, ratio, nu)
