"""Errors of steps on stiff contacts: wheels on moving rails."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
import pytest
from scipy.integrate import solve_ivp

from wheelrail.vehicle.integration.integrate import FirstStep, Step, StepSettings, integrate
from wheelrail.vehicle.integration.problem import Forcing
from wheelrail.vehicle.integration.rosenbrock import ROS3PL, ROS34PW2
from wheelrail.vehicle.integration.step_control import StepStatistics
from wheelrail.vehicle.multibody.jacobian import VehicleLinearisation


@dataclass(frozen=True)
class Rate:
    rate: np.ndarray


MASS, DEPTH, LOAD = 1800.0, 6e-5, 110e3  # kg, m and N: a wheelset on two wheels, whose contacts yield by 60 um


def rail(t: float) -> np.ndarray:
    """Height m of a rail, 1e-3 sin(8 pi t)^4, and its first three derivatives by time."""
    a, b = 16.0 * np.pi, 32.0 * np.pi
    return 1e-3 * np.array(
        [
            3 / 8 - np.cos(a * t) / 2 + np.cos(b * t) / 8,
            a * np.sin(a * t) / 2 - b * np.sin(b * t) / 8,
            a**2 * np.cos(a * t) / 2 - b**2 * np.cos(b * t) / 8,
            -(a**3) * np.sin(a * t) / 2 + b**3 * np.sin(b * t) / 8,
        ]
    )


def motion(t: float) -> np.ndarray:
    """State of a wheelset on the rail, and its first two derivatives."""
    return np.stack([rail(t)[i : i + 2] for i in range(3)])


def force(t: float, x: np.ndarray) -> float:
    """Of a Hertzian contact, N."""
    return LOAD * max(0.0, (DEPTH + rail(t)[0] - x[0]) / DEPTH) ** 1.5


def on_rail(forcing: Forcing | None, tolerance: float, method: str = "rosenbrock") -> tuple[StepStatistics, np.ndarray]:
    """Half a second with a first step of 60 ms: statistics, and errors of the force at the steps over the load."""

    def rhs(t: float, x: np.ndarray, previous: Rate | None) -> Rate:
        return Rate(np.array([x[1], (force(t, x) - LOAD) / MASS]))

    def jacobian(t: float, x: np.ndarray, at: Rate) -> VehicleLinearisation:
        stiffness = 1.5 * LOAD / DEPTH * (force(t, x) / LOAD) ** (1 / 3)
        by_state = np.array([[0.0, 1.0], [-stiffness / MASS, 0.0]])
        by_time = np.array([0.0, stiffness / MASS * rail(t)[1]])
        return VehicleLinearisation(by_state, by_time, outputs=np.array([[-stiffness, 0.0]]))

    settings = StepSettings(method, 3e-3, np.array([3e-5, 3e-3]), output_tolerance=tolerance)
    counts = StepStatistics()
    steps = list(
        integrate(
            rhs,
            0.0,
            np.zeros(2),
            0.5,
            settings,
            jacobian=jacobian,
            first=FirstStep(length=0.06),
            counts=counts,
            follow=None if forcing is None else lambda t, x, start: forcing,
        )
    )
    exact = [LOAD + MASS * rail(step.t)[2] for step in steps]
    return counts, np.array([force(step.t, step.x) - f for step, f in zip(steps, exact, strict=True)]) / LOAD


def test_steps_on_a_moving_rail() -> None:
    """A wheelset on a rail that moves with 8 and 16 Hz, and vibrates on its contacts with 196 Hz."""
    counts, errors = on_rail(motion, 0.03 * LOAD)
    assert counts.accepted < 60
    assert np.abs(errors).max() < 0.03
    slow, still = on_rail(None, 0.03 * LOAD)
    assert slow.accepted > 2 * counts.accepted
    assert np.abs(still).max() < 0.1


def test_errors_of_the_method_of_order_4_count_in_forces() -> None:
    """Steps that only resolve positions lift and press the wheel, by up to 2.5 loads, and are more of them."""
    counts, errors = on_rail(None, 0.03 * LOAD, "rosenbrock4")
    blind, large = on_rail(None, np.inf, "rosenbrock4")
    assert np.abs(errors).max() < 0.15
    assert np.abs(large).max() > 1.0
    assert counts.accepted < blind.accepted


def test_the_end_of_a_step_shows_a_lost_contact(monkeypatch: pytest.MonkeyPatch) -> None:
    """Without that evaluation, stages can move a wheel in the air by its static deflection only, an error of 60 um."""
    assert on_rail(None, 0.03 * LOAD)[1].min() > -0.1
    for method in (ROS3PL, ROS34PW2):
        monkeypatch.setitem(vars(method), "stiffly_accurate", False)
    assert on_rail(None, np.inf)[1].min() < -0.5


def test_interpolation_follows_a_forcing() -> None:
    """The difference from it is interpolated, here none, with a step of more than its period."""
    (x0, v0, _), (x, v, _) = motion(0.0), motion(0.13)
    step = Step(0.0, x0, Rate(v0), 0.13, x, Rate(v), 0.0, 0.1, motion)
    np.testing.assert_allclose(step.at(0.05), motion(0.05)[0], rtol=1e-12, atol=1e-15)


def decaying(rate: float, error: float, end: float) -> list[Step[Rate]]:
    """Steps of a pendulum x'' = -sin(x), and of a component that decays towards its angle from some error."""

    def rhs(t: float, x: np.ndarray, previous: Rate | None) -> Rate:
        return Rate(np.array([x[1], -np.sin(x[0]), -rate * (x[2] - x[0]) + x[1]]))

    def jacobian(t: float, x: np.ndarray, at: Rate) -> VehicleLinearisation:
        return VehicleLinearisation(
            np.array([[0.0, 1.0, 0.0], [-np.cos(x[0]), 0.0, 0.0], [rate, 1.0, -rate]]), np.zeros(3)
        )

    settings, first = StepSettings("rosenbrock", 1.0, 1.0), FirstStep[Rate](length=end)
    return list(integrate(rhs, 0.0, np.array([1.0, 0.0, 1.0 + error]), end, settings, jacobian=jacobian, first=first))


def test_states_within_a_step_are_of_the_order_of_the_step() -> None:
    errors = []
    for h in (0.4, 0.2):
        (step,) = decaying(1.0, 0.0, h)
        exact = solve_ivp(lambda t, x: [x[1], -np.sin(x[0])], (0.0, 0.7 * h), [1.0, 0.0], rtol=1e-12, atol=1e-14).y[
            :, -1
        ]
        errors.append(np.abs(step.at(0.7 * h)[:2] - exact).max())
        np.testing.assert_allclose(step.at(h), step.x, rtol=1e-14, atol=1e-15)
        np.testing.assert_allclose(step.at(0.0), step.x0, rtol=1e-14, atol=1e-15)
    assert errors[0] > 12.0 * errors[1]


def test_states_within_a_step_do_not_multiply_stiff_errors() -> None:
    """As those of the spin of a wheelset, 1/ms; rates at both ends multiply them by a part of the decays in a step."""
    (step,) = decaying(1e3, 1e-6, 0.4)
    by_rates = replace(step, damping=None)
    for states, least, largest in ((step, 0.0, 2e-6), (by_rates, 4e-5, 1e-3)):
        inside = np.array([states.at(t) for t in np.linspace(0.05, 0.35, 7)])
        assert least <= np.abs(inside[:, 2] - inside[:, 0]).max() <= largest


def test_stiff_parts_bend_as_their_motion_does() -> None:
    """A stiff component that follows sin(x): the parabola through three ends errs by a tenth of a straight line."""
    stiffness = 1e3

    def rhs(t: float, x: np.ndarray, previous: Rate | None) -> Rate:
        return Rate(np.array([1.0, -stiffness * (x[1] - np.sin(x[0])) + np.cos(x[0])]))

    def jacobian(t: float, x: np.ndarray, at: Rate) -> VehicleLinearisation:
        slope = stiffness * np.cos(x[0]) - np.sin(x[0])
        return VehicleLinearisation(np.array([[0.0, 0.0], [slope, -stiffness]]), np.zeros(2))

    h = 0.1
    settings = StepSettings("rosenbrock", 1.0, 1.0, max_step=h)
    start, first = np.array([1.0, np.sin(1.0)]), FirstStep[Rate](length=h)
    steps = list(integrate(rhs, 0.0, start, 0.5, settings, jacobian=jacobian, first=first))
    assert steps[0].before is None
    for step, last in zip(steps[1:], steps[:-1], strict=True):
        time, state = step.before or (np.nan, start)
        assert (time, *state) == (last.t0, *last.x0)
        inside = np.linspace(step.t0, step.t, 9)[1:-1]
        parabola, line = (
            np.abs([s[1] - np.sin(s[0]) for s in map(of.at, inside)]).max() for of in (step, replace(step, before=None))
        )
        assert parabola < 0.1 * line


KINK, WIDTH, STIFFNESS = 0.12, 1 / 3000, 2e9  # m/s, s and N/m: 4 mrad at 30 m/s, rounded over 1 cm


def kinked(t: float) -> np.ndarray:
    """A rail whose slope changes at 0.04 s: height, rate, acceleration and its rate."""
    u = (t - 0.04) / WIDTH
    if abs(u) >= 1.0:
        return KINK * np.array([WIDTH * max(0.0, u), float(u > 0.0), 0.0, 0.0])
    a, s = abs(u), np.sign(u) or 1.0
    rise = np.array([u / 2 + a**2 / 2 - a**3 / 6 + 1 / 6, 0.5 + s * (a - a**2 / 2), 1.0 - a, -s])
    return np.asarray(KINK * rise * WIDTH ** np.array([1, 0, -1, -2]))


def largest_force_behind_the_kink(start: float, method: str) -> float:
    """Of a wheelset on linear contacts, over its exact value: both without the load."""
    by_state = np.array([[0.0, 1.0], [-STIFFNESS / MASS, 0.0]])

    def rhs(t: float, x: np.ndarray, previous: Rate | None) -> Rate:
        return Rate(by_state @ (x - [kinked(t)[0], 0.0]))

    def jacobian(t: float, x: np.ndarray, at: Rate) -> VehicleLinearisation:
        by_time = np.array([0.0, STIFFNESS / MASS * kinked(t)[1]])
        return VehicleLinearisation(by_state, by_time, outputs=np.array([[-STIFFNESS, 0.0]]))

    def followed(t: float) -> np.ndarray:
        return np.stack([kinked(t)[i : i + 2] for i in range(3)])

    settings = StepSettings(method, 3e-3, np.array([3e-5, 3e-3]), output_tolerance=0.03 * LOAD, max_step=1e-3)
    options = {"jacobian": jacobian, "first": FirstStep[Rate](length=3e-4), "follow": lambda t, x, start: followed}
    *_, last = integrate(rhs, start, np.zeros(2), 0.0415, settings, **options)
    omega = np.sqrt(STIFFNESS / MASS)
    amplitude = STIFFNESS * np.hypot(last.x[0] - kinked(last.t)[0], (last.x[1] - KINK) / omega)
    pulse = (np.sin(omega * WIDTH / 2) / (omega * WIDTH / 2)) ** 2  # of the rounded kink against a sharp one
    return float(amplitude / (STIFFNESS * KINK * pulse / omega))


@pytest.mark.parametrize("method", ["rosenbrock", "rosenbrock4"])
def test_the_blow_of_a_kinked_rail_does_not_depend_on_where_steps_end(method: str) -> None:
    """Between stages a kink is a blow that none of their differences shows: its integral is known."""
    blows = np.array([largest_force_behind_the_kink(start, method) for start in 0.03 + 4e-5 * np.arange(40)])
    assert np.sqrt(np.mean((blows - 1.0) ** 2)) < 0.01
    np.testing.assert_allclose(blows, 1.0, atol=0.035)
