"""Data of the Manchester wagon, its scaling and its suspension."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from wheelrail.vehicle.wagon.components import Scaling
from wheelrail.vehicle.wagon.force_law import ForceLaw
from wheelrail.vehicle.wagon.suspension import Assembly
from wheelrail.vehicle.wagon.wagon import BUMPSTOP, CAR_BODY, SECONDARY, Wagon


def test_masses_and_static_wheel_load() -> None:
    w = Wagon()
    whole = w.car_body.mass + 2 * w.bogie.mass + 4 * w.wheelset.mass
    assert whole == 44482.0
    assert w.wheel_load == pytest.approx(54546.05, abs=0.01)
    assert w.wheel_load == pytest.approx(whole * w.gravity / 8, rel=1e-14)


def test_scaling_of_tables_1_and_2() -> None:
    p = Wagon().plane
    assert (p.car_body.mass, p.car_body.roll_inertia) == (8000.0, 14200.0)
    assert (p.bogie.mass, p.bogie.roll_inertia) == (1307.5, 861.0)
    assert (p.wheelset.mass, p.wheelset.roll_inertia, p.wheelset.pitch_inertia) == (1813.0, 1120.0, 112.0)
    assert (p.secondary.lateral_stiffness, p.secondary.vertical_stiffness) == (80e3, 215e3)
    assert (p.secondary.lateral_damping, p.secondary.vertical_damping) == (16e3, 10e3)
    assert (p.secondary.bending_stiffness, p.roll_bar) == (5.25e3, 470e3)
    assert (p.primary.lateral_stiffness, p.primary.vertical_damping) == (3.884e6, 4e3)
    assert p.bumpstop(0.05) == 5790.0
    assert p.plane == p
    assert p.wheel_load == Wagon().wheel_load


def test_any_value_can_be_changed_and_is_checked() -> None:
    heavy = replace(Wagon(), car_body=replace(CAR_BODY, mass=40000.0), scaling=replace(Scaling(), secondary=0.25))
    assert heavy.plane.car_body.mass == 10000.0
    assert heavy.plane.roll_bar == 235e3
    for wrong in (
        lambda: replace(CAR_BODY, mass=0.0),
        lambda: replace(CAR_BODY, height=float("nan")),
        lambda: replace(SECONDARY, lateral_damping=-1.0),
        lambda: replace(SECONDARY, turn=1.5),
        lambda: replace(Scaling(), bogie=0.0),
        lambda: replace(Wagon(), roll_bar=-1.0),
        lambda: replace(Wagon(), bumpstop=ForceLaw(((-0.1, -1.0), (0.0, 0.0), (0.1, 1.0)))),
        lambda: replace(SECONDARY, lateral_series_stiffness=0.0),
        lambda: replace(SECONDARY, lateral_damping=0.0, lateral_series_stiffness=6e6),
        lambda: replace(
            SECONDARY, vertical_damping=ForceLaw(((0, 0), (0.1, 1e3), (1, 1e3))), vertical_series_stiffness=6e6
        ),
    ):
        with pytest.raises(ValueError):
            wrong()


def test_bumpstop_law_in_both_directions_and_beyond() -> None:
    for d, f in BUMPSTOP.points:
        assert BUMPSTOP(d) == pytest.approx(f)
        assert BUMPSTOP(-d) == pytest.approx(-f)
    assert BUMPSTOP(0.0325) == pytest.approx(1180.0)
    assert BUMPSTOP(0.070) == pytest.approx(230e3 + (230e3 - 29.2e3))


def energy(assembly: Assembly, wagon: Wagon, position: np.ndarray) -> float:
    """Potential of springs, preloads, couple and bumpstop, from the points' positions written out one by one."""
    heights = [b.height for b in (wagon.car_body, wagon.bogie, wagon.wheelset)]
    total = 0.5 * float(assembly.couple @ (position[:2, 2] - position[1:, 2]) ** 2)
    last = len(assembly.attachments.turn) - 1
    for i, (u, l) in enumerate(assembly.attachments.ends.T):
        points = []
        for row, body in ((0, u), (1, l)):
            y, z, roll = position[body]
            arm = (assembly.attachments.across[row, i] + 1j * assembly.attachments.above[row, i]) * np.exp(1j * roll)
            points.append(y + 1j * (z + heights[body]) + arm)
        lean = assembly.attachments.turn[i] * position[u, 2] + (1 - assembly.attachments.turn[i]) * position[l, 2]
        gap = (points[0] - points[1]) * np.exp(-1j * lean)
        ky, kz = assembly.laws.stiffness[i]
        total += 0.5 * ky * gap.real**2 + 0.5 * kz * gap.imag**2 - assembly.preload[i] * gap.imag
        if i == last:
            stop = wagon.plane.bumpstop
            kinks = np.array([d for d, _ in stop.points])
            x = np.append(kinks[kinks < abs(gap.real)], abs(gap.real))
            f = np.array([stop(v) for v in x])
            total += float(np.sum(0.5 * (f[1:] + f[:-1]) * np.diff(x)))
    return float(total)


@pytest.mark.parametrize("turn", [0.0, 0.5, 1.0])
def test_spring_forces_derive_from_a_potential_and_cancel(turn: float) -> None:
    """At large rolls: minus the gradient of the energy; force and moment on all bodies add up to zero."""
    primary = replace(Wagon().primary, turn=turn, bending_stiffness=3e4)
    wagon = replace(Wagon(), primary=primary, secondary=replace(SECONDARY, turn=turn))
    assembly = Assembly.of(wagon)
    position = np.array([[-0.01, -0.01, 0.05], [-0.005, 0.004, -0.02], [0.003, 0.001, 0.01]])
    rate = np.array([[0.3, -0.2, 0.1], [0.2, 0.4, -0.3], [-0.1, 0.2, 0.15]])
    found = assembly.forces(position, np.zeros((3, 3))).on_bodies
    gradient, h = np.zeros((3, 3)), 1e-5
    for index in np.ndindex(3, 3):
        moved = np.zeros((3, 3))
        moved[index] = h
        up, down = (energy(assembly, wagon, position + sign * moved) for sign in (1, -1))
        gradient[index] = (up - down) / (2 * h)
    np.testing.assert_allclose(found, -gradient, rtol=1e-6, atol=0.05)

    moving = assembly.forces(position, rate).on_bodies
    heights = np.array([b.height for b in (wagon.car_body, wagon.bogie, wagon.wheelset)])
    y, z = position[:, 0], position[:, 1] + heights
    assert np.abs(moving[:, :2].sum(0)).max() < 1e-9
    assert abs((moving[:, 2] + y * moving[:, 1] - z * moving[:, 0]).sum()) < 1e-9 * 1e5
    assert ((moving - found) * rate).sum() < 0.0  # dampers dissipate energy


def test_nominal_position_is_in_equilibrium() -> None:
    on_bodies = Assembly.of(Wagon()).forces(np.zeros((3, 3)), np.zeros((3, 3))).on_bodies
    p = Wagon().plane
    np.testing.assert_allclose(on_bodies[:2, 1], [p.car_body.mass * 9.81, p.bogie.mass * 9.81], rtol=1e-13)
    assert np.abs(on_bodies[:, [0, 2]]).max() < 1e-9
