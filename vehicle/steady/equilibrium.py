"""Steady position of a vehicle on straight track or in a curve of constant radius and cant."""

from __future__ import annotations

from collections.abc import Callable, Iterable
from dataclasses import dataclass, replace
from functools import partial

import numpy as np

from wheelrail.support.arrays import Array
from wheelrail.vehicle.integration.integrate import StepTooSmall
from wheelrail.vehicle.integration.problem import StepFailure
from wheelrail.vehicle.multibody.coordinates import X
from wheelrail.vehicle.multibody.equations import VehicleDynamics, WheelContacts
from wheelrail.vehicle.steady.continuation import is_curved, transient_into_curve
from wheelrail.vehicle.steady.static_start import StaticStart
from wheelrail.vehicle.steady.steady_problem import SteadyProblem
from wheelrail.vehicle.track.track import Track

TO_AND_FRO = 4.0  # damping of Newton's method over the residual: steps of at most a quarter of the largest ones
NEWTON_STEPS = 60


class EquilibriumError(RuntimeError):
    """The iteration for the equilibrium did not converge."""


@dataclass(frozen=True)
class Equilibrium:
    """Steady position of a vehicle.

    Parameters:
        dynamics: equations of motion, at constant speed on a smooth track of constant curvature, cant and gradient.
        time: s, that of its distance along this track.
        state: (2 c + m + k,).
        contacts: results by wheelset and side.
        iterations: Newton steps.
        residual: largest unbalanced force over the mean wheel load.
    """

    dynamics: VehicleDynamics
    time: float
    state: Array
    contacts: WheelContacts
    iterations: int
    residual: float


def equilibrium(
    dynamics: VehicleDynamics,
    *,
    time: float = 0.0,
    guess: Array | None = None,
    near: WheelContacts | None = None,
    tolerance: float = 1e-7,
    acceptable: float = 1e-4,
) -> Equilibrium:
    """State without acceleration at constant speed, curvature, cant, gradient, torques and forces on smooth rails.

    Parameters:
        dynamics: equations of motion.
        time: s, at which speed, curvature, cant, gradient, torques and forces are taken.
        guess: (2 c + m + k,) initial state; None: upright bodies at the height at which the contacts carry them.
        near: results of contacts near the guess, from which theirs start.
        tolerance: of the residual.
        acceptable: residual that is accepted when the iteration stalls, limited by the accuracy of the contact.

    Damped Newton with the contact's tangent or, without one, with differences of the contact. The damping decreases
    with the residual (pseudo-transient continuation), to pass the steep rise of the force at a flange. If the iteration
    fails from both starts, as between tread and flange, a transient run into the curve gives the initial guess.
    Friction of elements is that after motion from the nominal position in one direction. Raises EquilibriumError, also
    where the position along the track is undetermined.
    """
    if dynamics.vehicle.speed_hold is None and not dynamics.coordinates.held[:, X].any():
        raise EquilibriumError("no equilibrium: without a speed_hold the position along the track is undetermined")
    dynamics = dynamics.with_constant_loads(time)
    problem = SteadyProblem.of(dynamics, time)
    starts: list[Callable[[], Array]] = [StaticStart(problem)]
    if guess is not None:
        starts.insert(0, partial(problem.at_rest, guess))
    if is_curved(dynamics, time):
        straight = replace(dynamics, track=Track(), speed=dynamics.speed_profile(time).speed)
        starts.append(lambda: problem.at_rest(transient_into_curve(dynamics, time, equilibrium(straight).state)))
    for number, start in enumerate(starts, start=1):
        contacts = near if number == 1 and guess is not None else None
        try:
            found = _newton(problem, start(), contacts, tolerance, acceptable)
            return replace(found, state=problem.settled(found.state))
        except (StepFailure, StepTooSmall, EquilibriumError) as error:
            if number == len(starts):
                raise EquilibriumError(f"no equilibrium: {error}") from error
    raise AssertionError("no start")


def equilibria(dynamics: VehicleDynamics, speeds: Iterable[float]) -> list[Equilibrium]:
    """Steady positions at speeds, m/s, on the track of the dynamics, each the initial guess of the next one.

    Raises EquilibriumError naming the speed.
    """
    found = list[Equilibrium]()
    for speed in speeds:
        try:
            guess, near = (found[-1].state, found[-1].contacts) if found else (None, None)
            found.append(equilibrium(replace(dynamics, speed=speed), guess=guess, near=near))
        except EquilibriumError as error:
            raise EquilibriumError(f"{error}, at {speed:g} m/s") from error
    return found


def equilibrium_near(
    dynamics: VehicleDynamics,
    time: float,
    guess: Array,
    near: WheelContacts,
    tolerance: float = 1e-6,
    acceptable: float = 1e-3,
) -> Equilibrium:
    """State without acceleration near a known one, by Newton's method alone.

    Parameters:
        dynamics: with constant loads, on track of constant curvature, cant and gradient; or on irregular rails at a
            speed so low that their slopes do not matter, which do not change while the vehicle stands.
        time: s.
        guess: state (n,), near the result.
        near: contacts at the guess.
        tolerance, acceptable: as for `equilibrium`.

    Raises EquilibriumError, StepFailure.
    """
    return _newton(SteadyProblem(dynamics, time), guess, near, tolerance, acceptable)


def _newton(
    problem: SteadyProblem, state: Array, near: WheelContacts | None, tolerance: float, acceptable: float
) -> Equilibrium:
    """Newton's method from one start, with contacts from nearby results.

    Raises EquilibriumError, or StepFailure when no step reduces the residual.
    """
    contacts = problem.contacts(state, near)
    residual = problem.residual(state, contacts)
    damping, best = 0.0, Equilibrium(problem.dynamics, problem.time, state, contacts, 0, _size(residual))
    for iteration in range(1, NEWTON_STEPS + 1):
        stalled = best.residual <= acceptable and iteration > best.iterations + 4
        if best.residual <= tolerance or stalled:
            return best
        if iteration > best.iterations + 2:
            # Tangents of friction near its limit lead from one limit to the other and back.
            damping = max(damping, TO_AND_FRO * _size(residual))
        try:
            state, contacts, new, damping = _step(problem, state, contacts, residual, damping)
        except StepFailure:
            if best.residual <= acceptable:
                return best
            raise
        damping *= min(0.5, _size(new) / _size(residual))
        residual = new
        if _size(residual) < best.residual:
            best = replace(best, state=state, contacts=contacts, iterations=iteration, residual=_size(residual))
    if best.residual <= acceptable:
        return best
    raise EquilibriumError(f"residual of {best.residual:.3g} wheel loads after {NEWTON_STEPS} Newton steps")


def _step(
    problem: SteadyProblem, state: Array, contacts: WheelContacts, residual: Array, damping: float
) -> tuple[Array, WheelContacts, Array, float]:
    """The next state, contacts, residual and damping.

    The residual may temporarily increase up to threefold: a monotonic decrease stalls where a second contact begins.
    Raises StepFailure when no damping satisfies this bound.
    """
    jacobian, size = problem.jacobian(state, contacts), _size(residual)
    while damping < 1e6:
        try:
            change = np.linalg.solve(damping * np.diag(1.0 / problem.largest) - jacobian, residual)
            change /= max(1.0, _size(change / problem.largest))
            new_state = state.copy()
            new_state[problem.unknowns] += change
            new_contacts = problem.contacts(new_state, contacts)
            new = problem.residual(new_state, new_contacts)
            if _size(new) < 3.0 * size:
                return new_state, new_contacts, new, damping
        except (StepFailure, np.linalg.LinAlgError):  # singular, e.g. without friction: the spin is undetermined
            pass
        damping = max(4.0 * damping, 1e-2 * size)
    raise StepFailure(f"Newton's method stalled at a residual of {size:.3g} wheel loads")


def _size(vector: Array) -> float:
    return float(np.max(np.abs(vector)))
