"""Static equilibrium on straight track, or steady position in a curve of constant radius and cant."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace
from functools import partial

import numpy as np

from wheelrail.support.arrays import Array
from wheelrail.vehicle.dynamics.equations import Contacts, Dynamics
from wheelrail.vehicle.dynamics.static_residual import StaticResidual, size_of
from wheelrail.vehicle.integration.integrate import StepTooSmall
from wheelrail.vehicle.integration.problem import StepFailure
from wheelrail.vehicle.steady.continuation import is_curved, transient_into_curve
from wheelrail.vehicle.track.track import Track


class EquilibriumError(RuntimeError):
    """The iteration for the equilibrium did not converge."""


@dataclass(frozen=True)
class Equilibrium:
    """Equilibrium of the wagon.

    Parameters:
        state: (20 + m + k,) as in `wheelrail.vehicle.dynamics.state`.
        contacts: results by side.
        iterations: Newton steps.
        residual: largest unbalanced force over the axle load.
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
    """State without acceleration at constant speed, curvature, cant and gradient on smooth rails.

    Parameters:
        dynamics: equations of motion.
        time: s, at which speed, curvature, cant and gradient are taken.
        guess: (20 + m + k,) initial state; None: upright bodies at the static height.
        tolerance: of the residual.
        acceptable: residual that is accepted when the iteration stalls, limited by the accuracy of the contact.
        max_iterations: Newton steps.

    Damped Newton with the contact's tangent or, without one, with four differences of the contact. The damping
    decreases with the residual (pseudo-transient continuation), to pass the steep rise of the force at a flange. If the
    iteration fails from both starts, as between tread and flange, a transient run into the curve gives the initial
    guess. Raises EquilibriumError.
    """
    equations = StaticResidual(dynamics, dynamics.frame(time).steady())
    starts: list[Callable[[], Array]] = [equations.static]
    if guess is not None:
        starts.insert(0, partial(equations.unknown, guess))
    if is_curved(dynamics, time):
        straight = replace(dynamics, track=Track(), speed=dynamics.speed_profile(time).speed)
        starts.append(lambda: equations.unknown(transient_into_curve(dynamics, time, equilibrium(straight).state)))
    for number, start in enumerate(starts, start=1):
        try:
            return _newton(equations, start(), tolerance, acceptable, max_iterations)
        except (StepFailure, StepTooSmall, EquilibriumError) as error:
            if number == len(starts):
                raise EquilibriumError(f"no equilibrium: {error}") from error
    raise AssertionError("no start")


def _newton(
    equations: StaticResidual, unknown: Array, tolerance: float, acceptable: float, max_iterations: int
) -> Equilibrium:
    """Newton's method from one start. Raises EquilibriumError, or StepFailure when no step reduces the residual."""
    contacts = equations.contacts(unknown, None)
    residual = equations.residual(unknown, contacts)
    damping, best = 0.0, Equilibrium(equations.state(unknown), contacts, 0, size_of(residual))
    for iteration in range(1, max_iterations + 1):
        stalled = best.residual <= acceptable and iteration > best.iterations + 4
        if best.residual <= tolerance or stalled:
            return best
        unknown, contacts, new, damping = _step(equations, unknown, contacts, residual, damping)
        damping *= min(0.5, size_of(new) / size_of(residual))
        residual = new
        if size_of(residual) < best.residual:
            best = Equilibrium(equations.state(unknown), contacts, iteration, size_of(residual))
    if best.residual <= acceptable:
        return best
    raise EquilibriumError(f"residual of {best.residual:.3g} axle loads after {max_iterations} Newton steps")


def _step(
    equations: StaticResidual, unknown: Array, contacts: Contacts, residual: Array, damping: float
) -> tuple[Array, Contacts, Array, float]:
    """The next unknown, contacts, residual and damping.

    The residual may temporarily increase up to threefold: a monotonic decrease stalls where a second contact begins.
    Raises StepFailure when no damping satisfies this bound.
    """
    jacobian, size = equations.jacobian(unknown, contacts, residual), size_of(residual)
    while damping < 1e6:
        try:
            change = np.linalg.solve(damping * np.diag(1.0 / equations.large) - jacobian, residual)
            change /= max(1.0, size_of(change / equations.large))
            new_contacts = equations.contacts(unknown + change, contacts)
            new = equations.residual(unknown + change, new_contacts)
            if size_of(new) < 3.0 * size:
                return unknown + change, new_contacts, new, damping
        except (StepFailure, np.linalg.LinAlgError):  # singular, e.g. without friction: the spin is undetermined
            pass
        damping = max(4.0 * damping, 1e-2 * size)
    raise StepFailure(f"Newton's method stalled at a residual of {size:.3g} axle loads")
