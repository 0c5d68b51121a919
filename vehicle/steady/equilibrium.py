"""Rest position of the wagon on straight track, or its steady position in a curve of constant radius and cant."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace
from functools import partial

import numpy as np

from wheelrail.support.arrays import Array
from wheelrail.vehicle.dynamics.equations import Contacts, Dynamics
from wheelrail.vehicle.dynamics.static_residual import LARGE, StaticResidual, size_of
from wheelrail.vehicle.integration.integrate import StepTooSmall
from wheelrail.vehicle.integration.problem import StepFailure
from wheelrail.vehicle.steady.continuation import bends, run_in
from wheelrail.vehicle.track.track import Track


class EquilibriumError(RuntimeError):
    """No equilibrium was found."""


@dataclass(frozen=True)
class Equilibrium:
    """state (20 + m,) as in `wheelrail.vehicle.dynamics.state`; contacts by side; Newton steps; residual: force left
    over axle load.
    """

    state: Array
    contacts: Contacts
    iterations: int
    residual: float


def equilibrium(
    dynamics: Dynamics,
    *,
    time: float = 0.0,
    guess: Array | None = None,
    tolerance: float = 1e-6,
    acceptable: float = 1e-4,
    max_iterations: int = 30,
) -> Equilibrium:
    """State without acceleration for the speed, curvature and cant at the given time s, taken as constant, on smooth
    rails; guess: a state.

    Damped Newton with the contact's tangent or, without one, with four differences of the contact. The damping fades
    with the residual (pseudo-transient continuation), so that it works through the sharp rise at a flange. Where that
    does not end from the guess or from rest, as between tread and flange, a run into the curve shows the way. tolerance
    of the residual; an acceptable one is taken when a contact that is not exact allows no better. Raises
    EquilibriumError.
    """
    balance = StaticResidual(dynamics, dynamics.frame(time).steady())
    starts: list[Callable[[], Array]] = [balance.settled]
    if guess is not None:
        starts.insert(0, partial(balance.unknown, guess))
    if bends(dynamics, time):
        straight = replace(dynamics, track=Track(), speed=dynamics.drive(time).speed)
        starts.append(lambda: balance.unknown(run_in(dynamics, time, equilibrium(straight).state)))
    for place, start in enumerate(starts, start=1):
        try:
            return _newton(balance, start(), tolerance, acceptable, max_iterations)
        except (StepFailure, StepTooSmall, EquilibriumError) as error:
            if place == len(starts):
                raise EquilibriumError(f"no equilibrium: {error}") from error
    raise AssertionError("one start at least")


def _newton(
    balance: StaticResidual, unknown: Array, tolerance: float, acceptable: float, max_iterations: int
) -> Equilibrium:
    """Raises EquilibriumError, and StepFailure where it is stuck."""
    contacts = balance.contacts(unknown)
    residual = balance.residual(unknown, contacts)
    damping, best = 0.0, Equilibrium(balance.state(unknown), contacts, 0, size_of(residual))
    for iteration in range(1, max_iterations + 1):
        stalled = best.residual <= acceptable and iteration > best.iterations + 4
        if best.residual <= tolerance or stalled:
            return best
        unknown, contacts, new, damping = _step(balance, unknown, contacts, residual, damping)
        damping *= min(0.5, size_of(new) / size_of(residual))
        residual = new
        if size_of(residual) < best.residual:
            best = Equilibrium(balance.state(unknown), contacts, iteration, size_of(residual))
    if best.residual <= acceptable:
        return best
    raise EquilibriumError(f"{best.residual:.3g} of the axle load left after {max_iterations} steps")


def _step(
    balance: StaticResidual, unknown: Array, contacts: Contacts, residual: Array, damping: float
) -> tuple[Array, Contacts, Array, float]:
    """The next unknown, contacts, residual and damping.

    The residual may grow for a while: insisting on descent gets stuck where a second contact begins. Raises StepFailure
    when no damping keeps it in bounds.
    """
    jacobian, size = balance.jacobian(unknown, contacts, residual), size_of(residual)
    while damping < 1e6:
        try:
            change = np.linalg.solve(damping * np.diag(1.0 / LARGE) - jacobian, residual)
            change /= max(1.0, size_of(change / LARGE))
            there = balance.contacts(unknown + change)
            left = balance.residual(unknown + change, there)
            if size_of(left) < 3.0 * size:
                return unknown + change, there, left, damping
        except (StepFailure, np.linalg.LinAlgError):  # singular: without friction, say, any spin will do
            pass
        damping = max(4.0 * damping, 1e-2 * size)
    raise StepFailure(f"stuck with {size:.3g} of the axle load left")
