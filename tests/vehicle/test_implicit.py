"""The Rosenbrock method: order conditions, inexact Jacobians, the wagon's Jacobian, contact noise, two processes."""

from __future__ import annotations

from dataclasses import dataclass, field, replace

import numpy as np
import pytest
from pydantic import ValidationError
from scipy.integrate import solve_ivp
from standin_contact import CONTACT, MOUNTING, FunctionContact, SmoothContact

from wheelrail.contact.kinematics.frames import Pose, RigidMotion, Side
from wheelrail.contact.kinematics.wheelset_state import WheelsetState
from wheelrail.contact.models.wheelset import WheelsetContact
from wheelrail.contact.results.result import ContactResult
from wheelrail.contact.results.vehicle_contact import VehicleContact
from wheelrail.scenes.runs.progress import costs
from wheelrail.scenes.schema.tables import SolverTable
from wheelrail.vehicle.integration.integrate import FirstStep, StepSettings, integrate
from wheelrail.vehicle.integration.rosenbrock import ROS3PL, ROS34PW2, SHAMPINE4
from wheelrail.vehicle.integration.step_control import StepStatistics
from wheelrail.vehicle.multibody.contact_differences import REUSED
from wheelrail.vehicle.multibody.equations import VehicleDynamics
from wheelrail.vehicle.multibody.jacobian import VehicleJacobian, VehicleLinearisation
from wheelrail.vehicle.multibody.plane_wagon import wagon_dynamics
from wheelrail.vehicle.simulation.contact_cost import CountedContact
from wheelrail.vehicle.simulation.history import History
from wheelrail.vehicle.simulation.simulate import simulate, step_settings
from wheelrail.vehicle.track.track import Track
from wheelrail.vehicle.wagon.wagon import Wagon

V = 45.0
CURVE = Track.curve(curvature=1 / 1200, cant=0.06, tangent=20.0, transition=60.0, length=1000.0)


@dataclass(frozen=True)
class Rate:
    rate: np.ndarray


def test_order_conditions_with_the_exact_jacobian() -> None:
    """Order 3 and 2 of the companion, for stiff problems too: x' = k (x - t^2) + 2 t is solved without error by both
    (Hairer, Wanner, Solving ODEs II, sections IV.7 and IV.15).
    """
    for m in (ROS3PL, ROS34PW2):
        b, alpha, beta, one = np.array(m.weights), m.nodes, m.full_alpha + m.full_gamma, np.ones(m.stages)
        other = np.array(m.companion)
        third = [(b @ alpha**2, 1 / 3), (b @ beta @ beta @ one, 1 / 6)]
        for left, right in [(b.sum(), 1.0), (b @ beta @ one, 0.5), *third]:
            assert left == pytest.approx(right, abs=1e-13)
        assert [other.sum(), other @ beta @ one] == pytest.approx([1.0, 0.5], abs=1e-13)
        assert abs(other @ alpha**2 - 1 / 3) > 0.05  # the companion is not of order 3
        defect = alpha**2 - 2 * beta @ beta @ one
        stiff = [weights @ np.linalg.matrix_power(beta, k) @ defect for weights in (b, other) for k in range(m.stages)]
        np.testing.assert_allclose(stiff, 0.0, atol=1e-13)
    assert (ROS34PW2.repeats, ROS3PL.repeats) == ((False,) * 4, (False, False, False, True))


def test_both_methods_agree_on_linear_problems() -> None:
    """Functions of stability of solution and companion; L-stable, stiffly accurate."""
    z = np.concatenate([1j * np.logspace(-2, 4, 400), [-1e12]])
    functions = []
    for m in (ROS3PL, ROS34PW2):
        beta, one = m.full_alpha + m.full_gamma, np.ones(m.stages)
        np.testing.assert_allclose(beta[-1], m.weights, atol=1e-14)  # stiffly accurate ..
        assert m.nodes[-1] == pytest.approx(1.0)
        ends = np.array([m.weights, m.companion])
        functions.append([1 + s * ends @ np.linalg.solve(np.eye(m.stages) - s * beta, one) for s in z])
    np.testing.assert_allclose(*functions, atol=1e-11)
    growth = np.abs(functions[0])[:, 0]
    assert growth.max() <= 1 + 1e-12  # .. stable on the imaginary axis, hence on its left
    assert growth[-1] < 1e-9


def test_order_conditions_of_order_four() -> None:
    """Of solution and companion, with the exact Jacobian (Hairer, Wanner, Solving ODEs II, table IV.7.1); A-stable."""
    m = SHAMPINE4
    alpha, beta, one = m.nodes, m.full_alpha + m.full_gamma, np.ones(m.stages)
    third = [(one, 1.0), (beta @ one, 1 / 2), (alpha**2, 1 / 3), (beta @ beta @ one, 1 / 6)]
    fourth = [alpha**3, alpha * (m.full_alpha @ beta @ one), beta @ alpha**2, beta @ beta @ beta @ one]
    for vector, value in [*third, *zip(fourth, (1 / 4, 1 / 8, 1 / 12, 1 / 24), strict=True)]:
        assert m.weights @ vector == pytest.approx(value, abs=1e-15)
    for vector, value in third:
        assert m.companion @ vector == pytest.approx(value, abs=1e-15)
    z = 1j * np.logspace(-2, 6, 400)
    growth = [1 + s * np.array(m.weights) @ np.linalg.solve(np.eye(m.stages) - s * beta, one) for s in z]
    assert np.abs(growth).max() <= 1 + 1e-12
    assert abs(growth[-1]) == pytest.approx(1 / 3, abs=1e-4)
    assert m.repeats == (False, False, False, True)


def test_order_conditions_with_any_matrix() -> None:
    """Order 3 (Hairer, Wanner, Solving ODEs II, section IV.7)."""
    m = ROS34PW2
    b, a, g, one = np.array(m.weights), m.full_alpha, m.full_gamma, np.ones(m.stages)
    third = [(b @ (a @ one) ** 2, 1 / 3), (b @ a @ a @ one, 1 / 6)]
    mixed = [b @ g @ one, b @ a @ g @ one, b @ g @ a @ one, b @ g @ g @ one]
    for left, right in [(b.sum(), 1.0), (b @ a @ one, 0.5), *third, *((x, 0.0) for x in mixed)]:
        assert left == pytest.approx(right, abs=1e-13)
    other = np.array(m.companion)
    assert [other.sum(), other @ (a + g) @ one] == pytest.approx([1.0, 0.5], abs=1e-13)


def test_coefficients_are_checked() -> None:
    with pytest.raises(ValueError, match="sum to 1"):
        replace(ROS3PL, weights=(0.25, 0.25, 0.25, 0.2))
    with pytest.raises(ValueError, match="rows"):
        replace(ROS3PL, alpha=ROS3PL.alpha[:2])
    with pytest.raises(ValueError, match="jacobian"):
        list(integrate(lambda t, x, p: Rate(-x), 0.0, np.ones(1), 1.0, StepSettings("rosenbrock")))


def driven(t: float, x: np.ndarray, previous: Rate | None = None) -> Rate:
    return Rate(np.array([x[1] * x[2], -x[0] * x[2] + np.sin(2 * t), -0.51 * x[0] * x[1] + np.cos(t)]))


def slope(t: float, x: np.ndarray) -> VehicleLinearisation:
    by_state = np.array([[0, x[2], x[1]], [-x[2], 0, -x[0]], [-0.51 * x[1], -0.51 * x[0], 0]])
    return VehicleLinearisation(by_state, np.array([0.0, 2 * np.cos(2 * t), -np.sin(t)]))


@pytest.mark.parametrize(
    ("method", "share", "order"),
    [("rosenbrock", 1.0, 3), ("rosenbrock", 0.6, 3), ("rosenbrock", 0.0, 3), ("rosenbrock4", 1.0, 4)],
)
def test_order_whatever_the_jacobian(method: str, share: float, order: int) -> None:
    """Exact, 40 % off, or zero, with respect to state and time."""
    start = np.array([0.0, 1.0, 1.0])
    solution = solve_ivp(lambda t, x: driven(t, x).rate, (0, 4), start, method="DOP853", rtol=1e-13, atol=1e-14)

    def jacobian(t: float, x: np.ndarray, at: Rate) -> VehicleLinearisation:
        full = slope(t, x)
        return VehicleLinearisation(share * full.by_state, share * full.by_time, exact=share == 1.0)

    lengths, errors = 4.0 / np.array([32, 64, 128, 256]), []
    for h in lengths:
        fixed = StepSettings(method, atol=1e9, max_step=h, min_step=h / 2)
        *_, last = integrate(driven, 0.0, start, 4.0, fixed, jacobian=jacobian, first=FirstStep(length=h))
        errors.append(np.abs(last.x - solution.y[:, -1]).max())
    assert np.polyfit(np.log(lengths), np.log(errors), 1)[0] == pytest.approx(order, abs=0.25)


def test_the_method_damps_an_oscillation_as_it_says() -> None:
    """x'' = -w^2 x in fixed steps: the decay of energy, and the step at which it is 0.01 1/s."""
    w = 39.4
    matrix = np.array([[0.0, w], [-w, 0.0]])
    longest = ROS34PW2.longest_step(w, 0.01)
    assert ROS34PW2.damping(w, longest) == pytest.approx(0.01, rel=1e-6)
    assert ROS34PW2.longest_step(w, 1e3) == pytest.approx(np.pi / w)
    for h in (0.02, longest):
        fixed = StepSettings("rosenbrock", atol=1e9, max_step=h, min_step=h / 2)
        *_, last = integrate(
            lambda t, x, previous: Rate(matrix @ x),
            0.0,
            np.array([1.0, 0.0]),
            50 * h,
            fixed,
            jacobian=lambda t, x, at: VehicleLinearisation(matrix, np.zeros(2)),
            first=FirstStep(length=h),
        )
        decay = -np.log(np.hypot(*last.x)) / (50 * h)
        assert decay == pytest.approx(ROS34PW2.damping(w, h), rel=1e-6)


def test_stiffness_does_not_bound_the_step() -> None:
    """x' = -s (x - cos t) - sin t: as many steps at s = 1e3 as at 1e8, and the solution is cos t."""
    taken = []
    for stiff in (1e3, 1e8):
        counts = StepStatistics()

        def rhs(t: float, x: np.ndarray, previous: Rate | None, s: float = stiff) -> Rate:
            return Rate(-s * (x - np.cos(t)) - np.sin(t))

        def jacobian(t: float, x: np.ndarray, at: Rate, s: float = stiff) -> VehicleLinearisation:
            return VehicleLinearisation(np.array([[-s]]), np.array([-s * np.sin(t) - np.cos(t)]))

        settings = StepSettings("rosenbrock", 1e-4, 1e-4, min_step=1e-14)
        *_, last = integrate(rhs, 0.0, np.array([1.5]), 6.0, settings, jacobian=jacobian, counts=counts)
        assert last.x[0] == pytest.approx(np.cos(6.0), abs=1e-4)
        assert counts.jacobians == 0  # counted where they are computed
        assert counts.factorisations == counts.accepted + counts.rejected
        assert counts.evaluations == 2 + 3 * counts.accepted + 2 * counts.rejected
        taken.append(counts.accepted)
    assert taken[1] < 1.5 * taken[0] < 150


@dataclass(frozen=True)
class Tangential(VehicleContact):
    """The smooth contact with a tangent by differences, as a model with its own."""

    inner: WheelsetContact = CONTACT

    def __call__(self, state: WheelsetState, side: Side, guess: ContactResult | None = None) -> ContactResult:
        return self.inner(state, side, guess)

    def tangent(self, state: WheelsetState, side: Side, result: ContactResult) -> np.ndarray:
        found = np.zeros((6, len(WheelsetState.coordinates)))
        for column, name in enumerate(WheelsetState.coordinates):
            ends = [replace(state, **{name: getattr(state, name) + d}) for d in (-1e-7, 1e-7)]
            low, high = (self.inner(end, side) for end in ends)
            found[:, column] = np.concatenate([high.force - low.force, high.moment - low.moment]) / 2e-7
        return found


def curving(contact=CONTACT) -> tuple[VehicleDynamics, float, np.ndarray]:  # type: ignore[no-untyped-def]
    state = 1e-3 * np.random.default_rng(3).normal(size=20) * np.tile([5, 1, 2, 2, 1, 2, 2, 0.0, 0.0, 1], 2)
    state[7] = -1e-4
    return wagon_dynamics(Wagon(), CURVE, contact, V), 50.0 / V, state


@pytest.mark.parametrize(("contact", "within"), [(Tangential(), 1e-5), (CONTACT, 2e-2)])
def test_the_wagons_jacobian(contact, within: float) -> None:  # type: ignore[no-untyped-def]
    """Against central differences of the complete equations of motion, row by row."""
    d, t, x = curving(contact)
    counts = StepStatistics()
    linear = VehicleJacobian(d, counts)(t, x, d(t, x))
    steps = 1e-6 * np.eye(20)
    expected = np.stack([(d(t, x + e).rate - d(t, x - e).rate) / 2e-6 for e in steps], axis=1)
    scale = np.abs(expected).max(axis=1, keepdims=True) + 1e-9
    np.testing.assert_allclose(linear.by_state / scale, expected / scale, atol=within)
    assert (counts.jacobians, counts.differences) == (1, 0 if within < 1e-3 else 11)


def test_the_wagons_derivative_by_time() -> None:
    """At constant contact forces; exact without contact forces."""
    d, t, x = curving(FunctionContact(lambda state, side, guess: ContactResult.separated()))
    linear = VehicleJacobian(d, StepStatistics())(t, x, d(t, x))
    expected = (d(t + 1e-4, x).rate - d(t - 1e-4, x).rate) / 2e-4
    np.testing.assert_allclose(linear.by_time, expected, atol=1e-3 * np.abs(expected).max())


def run(contact=CONTACT, span: tuple[float, float] = (0.0, 2.0), **options) -> History:  # type: ignore[no-untyped-def]
    settings = StepSettings(**{"method": "rosenbrock", **options})
    return simulate(wagon_dynamics(Wagon(), CURVE, contact, V), span, steps=settings)


@pytest.fixture(scope="module")
def tight() -> History:
    return run(rtol=1e-5, atol=1e-8)


@pytest.fixture(scope="module")
def plain() -> History:
    return run(Tangential())


def off(history: History, reference: History) -> tuple[float, float]:
    """Wheelset's lateral position, mm, largest; vertical force, RMS over 54.5 kN, of accepted steps after the first."""
    from scipy.interpolate import CubicSpline

    keep = np.append(True, np.diff(reference.time) > 1e-9)
    position = CubicSpline(reference.time[keep], reference.state[keep, 6])(history.time)
    force = CubicSpline(reference.time[keep], reference.force[:, 0][keep, :, 2])(history.time)
    weight = np.gradient(history.time)[:, None] / history.time[-1]
    rms = np.sqrt((weight * (history.force[:, 0, :, 2] - force) ** 2).sum(axis=0)).max()
    return 1e3 * float(np.abs(history.state[:, 6] - position).max()), float(rms / 54.5e3)


def test_accuracy_and_cost_of_a_run(plain: History, tight: History) -> None:
    """Required: 0.01 mm and 0.5 %."""
    position, force = off(plain, tight)
    assert position < 5e-3
    assert force < 2e-3
    steps, left = plain.cost.steps, plain.cost.contact["left"]
    assert steps.evaluations < 350
    assert steps.differences == 0
    assert left.tangents - 2 == steps.jacobians == steps.accepted  # two tangents of the equilibrium
    assert steps.evaluations <= left.solves <= steps.evaluations + 25
    explicit = run(method="ode23", span=(0.0, 0.5))
    assert explicit.cost.steps.evaluations > 10 * run(span=(0.0, 0.5)).cost.steps.evaluations


def test_method_in_a_scene(plain: History) -> None:
    asked = SolverTable(method="rosenbrock", workers=2)
    assert (asked.method, asked.workers, SolverTable().workers) == ("rosenbrock", 2, 1)
    for wrong in ({"workers": 0}, {"workers": 65}, {"method": "radau"}):
        with pytest.raises(ValidationError):
            SolverTable(**wrong)  # type: ignore[arg-type]
    assert f"{plain.cost.steps.jacobians} Jacobians" in costs(plain).note


def test_errors_follow_the_tolerance(plain: History, tight: History) -> None:
    coarse, fine = run(Tangential(), rtol=1e-2, atol=1e-5), run(Tangential(), rtol=1e-4, atol=1e-7)
    errors = np.array([off(h, tight) for h in (coarse, plain, fine)])
    assert (errors[1:] < 0.5 * errors[:-1]).all()
    end = tight.state[-1, :9]
    np.testing.assert_allclose(fine.state[-1, :9], end, rtol=0.0, atol=1e-4 * np.abs(end).max())


def test_without_a_tangent_differences_are_shared(tight: History) -> None:
    history = run()
    steps = history.cost.steps
    assert steps.differences == 11 * -(-steps.jacobians // REUSED)
    assert history.cost.contact["right"].tangents == 0
    assert off(history, tight)[0] < 5e-3
    assert steps.evaluations < 350


@dataclass(frozen=True)
class Rough:
    """The smooth contact with noise in its force, jumps whenever the wheel has shifted by another period, and states
    in a band of lateral speed where it fails.
    """

    noise: float = 1e-4
    jump: float = 2e-3
    period: float = 4e-4
    fails: float = np.inf

    def __call__(self, pose: Pose, motion: RigidMotion, guess: ContactResult | None = None) -> ContactResult:
        u, z, speed = float(pose.origin[1]), float(pose.origin[2]), float(motion.wheel.velocity[1])
        smooth = SmoothContact()(pose, motion)
        if abs(speed) > self.fails:
            return replace(smooth, status="failed: 20 Newton steps")
        factor = 1.0 + self.noise * np.sin(1e9 * u + 3e9 * z + 2e6 * speed) + self.jump * np.floor(u / self.period)
        return replace(smooth, force=factor * smooth.force, moment=factor * smooth.moment)


@pytest.mark.parametrize("rough", [Rough(jump=0.0), Rough(noise=0.0), Rough()], ids=["noise", "jumps", "both"])
def test_noise_and_jumps_do_not_collapse_the_step(rough: Rough, plain: History, tight: History) -> None:
    """Jumps of 0.2 %, one of them right where the wheelset rests."""
    history = run(WheelsetContact(rough, MOUNTING))
    assert history.status == "completed"
    steps = history.cost.steps
    assert steps.accepted + steps.rejected < 1.7 * (plain.cost.steps.accepted + plain.cost.steps.rejected)
    assert np.abs(np.interp(plain.time, history.time, history.state[:, 6]) - plain.state[:, 6]).max() < 5e-5


def test_steps_avoid_states_where_the_contact_fails(tight: History) -> None:
    """The largest lateral speed of the run, and not much more, is allowed: what long steps try is beyond."""
    fastest = np.abs(tight.state[:, 16]).max()
    history = run(WheelsetContact(Rough(0.0, 0.0, fails=1.05 * fastest), MOUNTING), rtol=1e-2, atol=1e-4)
    assert history.status == "completed"
    assert history.cost.steps.failed > 0
    assert abs(history.state[-1, 6] - tight.state[-1, 6]) < 1e-4
    ended = run(WheelsetContact(Rough(0.0, 0.0, fails=0.5 * fastest), MOUNTING))
    assert ended.status.startswith("failed: ")
    assert "20 Newton steps" in ended.status
    assert np.abs(ended.state[:, 16]).max() <= 0.5 * fastest
    assert np.isfinite(ended.state).all()


def test_each_evaluation_receives_the_previous_one() -> None:
    calls: list[tuple[Rate | None, Rate]] = []

    def rhs(t: float, x: np.ndarray, previous: Rate | None) -> Rate:
        calls.append((previous, Rate(np.cos(40 * t) - x)))
        return calls[-1][1]

    def jacobian(t: float, x: np.ndarray, at: Rate) -> VehicleLinearisation:
        return VehicleLinearisation(-np.eye(1), np.array([-40 * np.sin(40 * t)]))

    counts, settings, first = StepStatistics(), StepSettings("rosenbrock"), FirstStep[Rate](length=0.5)
    steps = list(integrate(rhs, 0.0, np.zeros(1), 1.0, settings, jacobian=jacobian, first=first, counts=counts))
    assert counts.rejected > 0
    known = {id(result): i for i, (_, result) in enumerate(calls)}
    accepted = {id(steps[0].start), *(id(s.end) for s in steps)}
    jumps = [(previous, i) for i, (previous, _) in enumerate(calls[1:], start=1) if known[id(previous)] != i - 1]
    assert len(jumps) == counts.rejected
    assert all(id(previous) in accepted for previous, _ in jumps)


def test_tolerances_of_rates() -> None:
    """100 times those of coordinates; no force depends on the angle of rolling."""
    d, own = wagon_dynamics(Wagon(), CURVE, CONTACT, V), np.full(20, 1e-5)

    def atol(method: str, value: float | np.ndarray) -> float | np.ndarray:
        return step_settings(d, StepSettings(method, atol=value)).atol

    expected = [1e-6] * 9 + [1e6] + [1e-4] * 10
    np.testing.assert_allclose(atol("rosenbrock", 1e-6), expected, rtol=1e-12)
    assert atol("rosenbrock", own) is own
    assert atol("ode23", 1e-6) == 1e-6


def test_interrupted_implicit_run_returns_its_history() -> None:
    @dataclass
    class Impatient(VehicleContact):
        calls: list[Side] = field(default_factory=list)

        def __call__(self, state: WheelsetState, side: Side, guess: ContactResult | None = None) -> ContactResult:
            self.calls.append(side)
            if len(self.calls) == 300:
                raise KeyboardInterrupt
            return CONTACT(state, side, guess)

    history = run(Impatient())
    assert history.status == "interrupted"
    assert len(history) == history.cost.steps.accepted + 1 > 5


def test_counted_contact_without_tangent_raises() -> None:
    state = WheelsetState(z=-6e-5, pitch_rate=V / 0.46, speed=V)
    counted = CountedContact(FunctionContact(CONTACT))
    result = counted(state, "left")
    with pytest.raises(ValueError, match="no tangent"):
        counted.tangent(state, "left", result)
    assert counted.costs["left"].tangents == 0
