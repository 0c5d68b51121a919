"""Data of the Manchester wagon, its scaling and its suspension."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from plane import suspension
from standin_contact import CONTACT

from wheelrail.vehicle.multibody.plane_wagon import wagon_dynamics
from wheelrail.vehicle.track.track import Track
from wheelrail.vehicle.wagon.components import Scaling
from wheelrail.vehicle.wagon.force_law import ForceLaw
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


def energy(wagon: Wagon, position: np.ndarray) -> float:
    """Potential of springs, static loads, couples and bumpstop, from the points' positions written out one by one."""
    w = wagon.plane
    bodies = (w.car_body, w.bogie, w.wheelset)
    couples = np.array([w.roll_bar + 2 * w.secondary.bending_stiffness, 2 * w.primary.bending_stiffness])
    total = 0.5 * float(couples @ (position[:2, 2] - position[1:, 2]) ** 2)

    def gap(upper: int, y: float, height: float, turn: float) -> complex:
        points = []
        for body in (upper, upper + 1):
            across, up, roll = position[body]
            arm = (y + 1j * (height - bodies[body].height)) * np.exp(1j * roll)
            points.append(across + 1j * (up + bodies[body].height) + arm)
        lean = turn * position[upper, 2] + (1 - turn) * position[upper + 1, 2]
        return complex((points[0] - points[1]) * np.exp(-1j * lean))

    for upper, stage, mass in (
        (0, w.secondary, w.car_body.mass),
        (1, w.primary, w.car_body.mass + w.bogie.mass),
    ):
        for y in (stage.spring_y, -stage.spring_y):
            x = gap(upper, y, stage.spring_height, stage.turn)
            total += 0.5 * stage.lateral_stiffness * x.real**2 + 0.5 * stage.vertical_stiffness * x.imag**2  # type: ignore[operator]
            total -= 0.5 * mass * w.gravity * x.imag
    deflection = gap(0, 0.0, w.bumpstop_height, w.secondary.turn).real
    kinks = np.array([d for d, _ in w.bumpstop.points])
    x = np.append(kinks[kinks < abs(deflection)], abs(deflection))
    f = np.array([w.bumpstop(v) for v in x])
    return total + float(np.sum(0.5 * (f[1:] + f[:-1]) * np.diff(x)))


@pytest.mark.parametrize("turn", [0.0, 0.5, 1.0])
def test_spring_forces_derive_from_a_potential_and_cancel(turn: float) -> None:
    """At large rolls: minus the gradient of the energy; force and moment on all bodies add up to zero."""
    primary = replace(Wagon().primary, turn=turn, bending_stiffness=3e4)
    wagon = replace(Wagon(), primary=primary, secondary=replace(SECONDARY, turn=turn))
    dynamics = wagon_dynamics(wagon, Track(), CONTACT, 30.0)
    position = np.array([[-0.01, -0.01, 0.05], [-0.005, 0.004, -0.02], [0.003, 0.001, 0.01]])
    rate = np.array([[0.3, -0.2, 0.1], [0.2, 0.4, -0.3], [-0.1, 0.2, 0.15]])
    found = suspension(dynamics, position, np.zeros((3, 3))).on_bodies
    gradient, h = np.zeros((3, 3)), 1e-5
    for index in np.ndindex(3, 3):
        moved = np.zeros((3, 3))
        moved[index] = h
        up, down = (energy(wagon, position + sign * moved) for sign in (1, -1))
        gradient[index] = (up - down) / (2 * h)
    np.testing.assert_allclose(found, -gradient, rtol=1e-6, atol=0.05)

    moving = suspension(dynamics, position, rate).on_bodies
    heights = np.array([b.height for b in (wagon.car_body, wagon.bogie, wagon.wheelset)])
    y, z = position[:, 0], position[:, 1] + heights
    assert np.abs(moving[:, :2].sum(0)).max() < 1e-9
    assert abs((moving[:, 2] + y * moving[:, 1] - z * moving[:, 0]).sum()) < 1e-9 * 1e5
    assert ((moving - found) * rate).sum() < 0.0  # dampers dissipate energy


def test_nominal_position_is_in_equilibrium() -> None:
    dynamics = wagon_dynamics(Wagon(), Track(), CONTACT, 30.0)
    on_bodies = suspension(dynamics, np.zeros((3, 3)), np.zeros((3, 3))).on_bodies
    p = Wagon().plane
    np.testing.assert_allclose(on_bodies[:2, 1], [p.car_body.mass * 9.81, p.bogie.mass * 9.81], rtol=1e-13)
    assert np.abs(on_bodies[:, [0, 2]]).max() < 1e-9
