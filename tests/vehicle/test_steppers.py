"""The Runge-Kutta loop: orders, step control, failures, output between steps."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
import pytest
from scipy.integrate import RK23, RK45, solve_ivp

from wheelrail.vehicle.integration.explicit import METHODS, ODE23, ODE45, Tableau
from wheelrail.vehicle.integration.integrate import FirstStep, StepSettings, StepTooSmall, integrate
from wheelrail.vehicle.integration.problem import StepFailure
from wheelrail.vehicle.integration.step_control import StepController, StepStatistics

PAIRS = [(ODE23, RK23), (ODE45, RK45)]
STANDARD = StepController(proportional=1.0, integral=0.0)
TIGHT = StepSettings("ode45", 1e-12, 1e-13)


@dataclass(frozen=True)
class Rate:
    rate: np.ndarray


def plain(function):  # type: ignore[no-untyped-def]
    return lambda t, x, previous: Rate(np.asarray(function(t, x)))


def rotor(t: float, x: np.ndarray) -> np.ndarray:
    """Jacobi's elliptic functions sn, cn, dn with m = 0.51: free rotation of a rigid body."""
    return np.array([x[1] * x[2], -x[0] * x[2], -0.51 * x[0] * x[1]])


START = np.array([0.0, 1.0, 1.0])


@pytest.fixture(scope="module")
def at_eight() -> np.ndarray:
    found = solve_ivp(rotor, (0.0, 8.0), START, method="DOP853", rtol=1e-13, atol=1e-14)
    return np.asarray(found.y[:, -1])


@pytest.mark.parametrize(("tableau", "theirs"), PAIRS)
def test_coefficients_agree_with_scipy(tableau: Tableau, theirs: type) -> None:
    for i, row in enumerate(tableau.rows[:-1], start=1):
        np.testing.assert_allclose(row, theirs.A[i, :i], rtol=1e-14)  # type: ignore[attr-defined]
    np.testing.assert_allclose(tableau.rows[-1], theirs.B, rtol=1e-14)  # type: ignore[attr-defined]
    np.testing.assert_allclose(np.abs(tableau.error), np.abs(theirs.E), rtol=1e-12)  # type: ignore[attr-defined]


@pytest.mark.parametrize("tableau", METHODS.values())
def test_fitted_order_with_fixed_steps(tableau: Tableau, at_eight: np.ndarray) -> None:
    lengths = 8.0 / np.array([32, 64, 128, 256])
    errors, estimates = [], []
    for h in lengths:
        steps = list(
            integrate(
                plain(rotor),
                0.0,
                START,
                8.0,
                StepSettings(tableau.name, atol=1e9, max_step=h, min_step=h / 2),
                first=FirstStep(length=h),
            )
        )
        assert len(steps) == round(8.0 / h)
        errors.append(np.abs(steps[-1].x - at_eight).max())
        estimates.append(max(step.error for step in steps))
    assert np.polyfit(np.log(lengths), np.log(errors), 1)[0] == pytest.approx(tableau.order, abs=0.3)
    assert np.polyfit(np.log(lengths), np.log(estimates), 1)[0] == pytest.approx(tableau.error_order + 1, abs=0.2)


@pytest.mark.parametrize(("tableau", "theirs"), PAIRS)
@pytest.mark.parametrize("rtol", [1e-3, 1e-6])
def test_adaptive_steps_like_scipy(tableau: Tableau, theirs: type, rtol: float, at_eight: np.ndarray) -> None:
    """Ours bounds the largest component, scipy's the mean: as many steps within 40 %, errors within a factor of 5."""
    counts = StepStatistics()
    steps = list(
        integrate(
            plain(rotor),
            0.0,
            START,
            8.0,
            StepSettings(tableau.name, rtol, rtol * 1e-2, control=STANDARD),
            counts=counts,
        )
    )
    other = solve_ivp(rotor, (0.0, 8.0), START, method=theirs, rtol=rtol, atol=rtol * 1e-2)
    assert 0.9 < counts.evaluations / other.nfev < 1.4
    ours, reference = np.abs(steps[-1].x - at_eight).max(), np.abs(other.y[:, -1] - at_eight).max()
    assert ours < 5 * reference
    assert steps[-1].t == 8.0
    assert counts.accepted == len(steps)
    assert counts.evaluations == 2 + tableau.stages - 1 + (counts.accepted + counts.rejected - 1) * (tableau.stages - 1)


@pytest.mark.parametrize("tableau", METHODS.values())
def test_error_follows_the_tolerance(tableau: Tableau, at_eight: np.ndarray) -> None:
    errors = []
    tolerances = 10.0 ** -np.arange(3, 9)
    for tol in tolerances:
        *_, last = integrate(plain(rotor), 0.0, START, 8.0, StepSettings(tableau.name, tol, tol))
        errors.append(np.abs(last.x - at_eight).max())
    assert np.polyfit(np.log(tolerances), np.log(errors), 1)[0] > 0.8 * tableau.error_order / (tableau.error_order + 1)
    assert errors[-1] < 1e-6


def test_states_between_steps_are_of_fourth_order() -> None:
    lengths, errors = 4.0 / np.array([8, 16, 32, 64]), []
    for h in lengths:
        worst = 0.0
        fixed = StepSettings("ode45", atol=1e9, max_step=h)
        for s in integrate(plain(rotor), 0.0, START, 4.0, fixed, first=FirstStep(length=h)):
            np.testing.assert_allclose(s.at(s.t0), s.x0, atol=1e-15)
            np.testing.assert_allclose(s.at(s.t), s.x, atol=1e-15)
            middle = s.t0 + 0.4 * h
            exact = list(integrate(plain(rotor), s.t0, s.x0, middle, TIGHT))[-1].x
            worst = max(worst, np.abs(s.at(middle) - exact).max())
        errors.append(worst)
    assert np.polyfit(np.log(lengths), np.log(errors), 1)[0] == pytest.approx(4.0, abs=0.3)


def test_step_control_at_the_limit_of_stability() -> None:
    def stiff(t: float, x: np.ndarray) -> np.ndarray:
        return -1000.0 * (x - np.cos(t)) - np.sin(t)

    counts = {}
    for name, control in (("smooth", StepController()), ("standard", STANDARD)):
        counts[name] = StepStatistics()
        settings = StepSettings("ode23", control=control)
        *_, last = integrate(plain(stiff), 0.0, np.array([1.5]), 2.0, settings, counts=counts[name])
        assert last.x[0] == pytest.approx(np.cos(2.0), abs=2e-3)
    assert counts["smooth"].rejected < 0.25 * counts["standard"].rejected
    assert counts["smooth"].evaluations < counts["standard"].evaluations


def test_a_failure_shortens_the_step() -> None:
    """x' = -x^2 from a large value: the right-hand side fails for arguments of long steps."""
    refused = []

    def wall(t: float, x: np.ndarray, previous: Rate | None) -> Rate:
        if x[0] < 0.05:
            refused.append(x[0])
            raise StepFailure("behind the wall")
        return Rate(-(x**2))

    counts, settings = StepStatistics(), StepSettings("ode45", 1e-6, 1e-9)
    steps = list(integrate(wall, 0.0, np.array([4.0]), 2.0, settings, first=FirstStep(length=2.0), counts=counts))
    assert counts.failed == len(refused) >= 1
    assert steps[0].t - steps[0].t0 <= 0.5
    assert steps[-1].x[0] == pytest.approx(1 / (0.25 + 2.0), rel=1e-5)


def test_repeated_failure_is_an_error_with_its_reason() -> None:
    reached: list[float] = []

    def cliff(t: float, x: np.ndarray, previous: Rate | None) -> Rate:
        if t > 1.0:
            raise StepFailure("no contact beyond 1 s")
        return Rate(np.ones(1))

    counts, settings = StepStatistics(), StepSettings("ode23", min_step=1e-6)
    steps = integrate(cliff, 0.0, np.zeros(1), 2.0, settings, first=FirstStep(length=0.1), counts=counts)
    with pytest.raises(StepTooSmall, match="no contact beyond 1 s"):
        reached.extend(step.t for step in steps)
    assert 1.0 - 1e-5 < reached[-1] <= 1.0
    assert counts.failed > 5


def test_non_finite_rates_and_jumps_are_rejected() -> None:
    holes = plain(lambda t, x: np.full(1, np.nan if t > 0.5 else 1.0))
    with pytest.raises(StepTooSmall, match="not finite"):
        list(integrate(holes, 0.0, np.zeros(1), 1.0, StepSettings("ode23")))
    blow_up = plain(lambda t, x: x**2)
    with pytest.raises(StepTooSmall, match="tolerances"):
        list(integrate(blow_up, 0.0, np.ones(1), 2.0, StepSettings("ode45", min_step=1e-6)))


def test_each_evaluation_receives_the_previous_one() -> None:
    """Stages get the stage before; the first stage of a step, also of one that is tried again, the accepted state."""
    calls: list[tuple[float, Rate | None, Rate]] = []

    def rhs(t: float, x: np.ndarray, previous: Rate | None) -> Rate:
        result = Rate(np.array([np.cos(40 * t)]))
        calls.append((t, previous, result))
        return result

    counts, first = StepStatistics(), FirstStep[Rate](length=0.5)
    steps = list(integrate(rhs, 0.0, np.zeros(1), 1.0, StepSettings("ode23"), first=first, counts=counts))
    assert counts.rejected > 0
    assert calls[0][1] is None
    accepted = {id(steps[0].start), *(id(s.end) for s in steps)}
    tries = [calls[i : i + 3] for i in range(1, len(calls), 3)]
    ends = iter([*steps, None])
    current, step = steps[0].start, next(ends)
    for first, second, third in tries:
        assert first[1] is current
        assert second[1] is first[2]
        assert third[1] is second[2]
        if id(third[2]) in accepted:
            assert step is not None
            assert third[2] is step.end
            current, step = step.end, next(ends)
    assert step is None


def test_invalid_input_is_rejected() -> None:
    for wrong in ({"method": "euler"}, {"rtol": -1.0}, {"atol": 0.0}, {"min_step": 0.0}, {"max_step": 1e-9}):
        with pytest.raises(ValueError):
            StepSettings(**wrong)  # type: ignore[arg-type]
    with pytest.raises(ValueError):
        list(integrate(plain(rotor), 1.0, START, 1.0, StepSettings("ode23")))
    with pytest.raises(ValueError):
        replace(ODE23, error=(0.1, 0.0, 0.0, 0.0))
    with pytest.raises(ValueError):
        replace(ODE23, rows=ODE23.rows[:2])
