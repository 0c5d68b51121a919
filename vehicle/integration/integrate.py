"""Adaptive time integration with embedded Runge-Kutta pairs, explicit or linearly implicit."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass, field
from typing import Generic

import numpy as np

from wheelrail.support.arrays import Array
from wheelrail.vehicle.integration.explicit import METHODS as EXPLICIT
from wheelrail.vehicle.integration.explicit import ExplicitRungeKutta, Tableau
from wheelrail.vehicle.integration.problem import (
    Damping,
    E,
    Ends,
    Follow,
    Forcing,
    Instant,
    Linearise,
    LongestStep,
    RightHandSide,
    Settle,
    StepFailure,
    StepMethod,
)
from wheelrail.vehicle.integration.rosenbrock import (
    ROSENBROCK,
    ROSENBROCK4,
    ROSENBROCK_ENDS,
    RosenbrockPair,
    RosenbrockW,
)
from wheelrail.vehicle.integration.step_control import StepController, StepStatistics

METHODS: dict[str, Tableau | RosenbrockPair] = {
    **EXPLICIT,
    **{pair.name: pair for pair in (ROSENBROCK, ROSENBROCK_ENDS, ROSENBROCK4)},
}

NextEnd = Callable[[float], float]


class StepTooSmall(RuntimeError):
    """The step length fell below the smallest one allowed."""


@dataclass(frozen=True)
class Step(Generic[E]):
    """An accepted step from (t0, x0) to (t, x).

    Parameters:
        t0, t: start and end of the step, s.
        x0, x: (n,) states there.
        start, end: evaluations there.
        error: estimated, in tolerances; of a step that was shortened to end at a given time, that of the full step.
        following: length of the next step, s.
        forcing: motion from which the difference is integrated; None: zero.
        damping: of stiff parts of changes within the step; None: of none.
        before: time s and state (n,) at the start of the step before; None: of the first step.
    """

    t0: float
    x0: Array
    start: E
    t: float
    x: Array
    end: E
    error: float
    following: float
    forcing: Forcing | None = None
    damping: Damping | None = None
    before: Instant | None = None

    def at(self, time: float) -> Array:
        """State at a time s within the step, by interpolation of the difference from the forcing.

        Stiff parts of what is not linear in the cubic Hermite interpolation are those of a parabola through both ends
        and the start of the step before.
        """
        h = self.t - self.t0
        u = (time - self.t0) / h
        (p0, v0), (p1, v1) = self._forced(self.t0), self._forced(self.t)
        x0, x, rate0, rate = self.x0 - p0, self.x - p1, self.start.rate - v0, self.end.rate - v1
        bow = (1 - 2 * u) * (x - x0) + h * ((u - 1) * rate0 + u * rate)
        if self.damping is not None:
            parabola = self._parabola(x0, x)
            bow = parabola + self.damping(bow - parabola)
        return np.asarray(self._forced(time)[0] + ((1 - u) * x0 + u * x + u * (u - 1) * bow))

    def _forced(self, time: float) -> tuple[Array, Array]:
        """Position and rate (n,) of the forcing."""
        if self.forcing is None:
            return np.zeros_like(self.x), np.zeros_like(self.x)
        position, rate, _ = self.forcing(time)
        return position, rate

    def _parabola(self, x0: Array, x: Array) -> Array:
        """Half its second derivative (n,) times the squared length of the step; zero in the first step."""
        if self.before is None:
            return np.zeros_like(x)
        time, state = self.before
        h, past = self.t - self.t0, self.t0 - time
        earlier = state - self._forced(time)[0]
        return np.asarray(h * h * ((x - x0) / h - (x0 - earlier) / past) / (h + past))


@dataclass(frozen=True)
class StepSettings:
    """Method, tolerances and bounds of adaptive steps.

    Parameters:
        method: a name of METHODS.
        rtol, atol: the tolerance of a component is atol + rtol |x|; each a number or (n,).
        output_tolerance: of the outputs of a linearisation, see `HasDerivatives`.
        max_step, min_step: s.
        control: of the step length.

    Raises ValueError for an unknown method and for values out of bounds.
    """

    method: str = "ode23"
    rtol: float | Array = 1e-3
    atol: float | Array = 1e-6
    output_tolerance: float = np.inf
    max_step: float = np.inf
    min_step: float = 1e-8
    control: StepController = field(default_factory=StepController)

    def __post_init__(self) -> None:
        if self.method not in METHODS:
            raise ValueError(f"method {self.method!r}: must be one of {', '.join(METHODS)}")
        positive = np.all(np.asarray(self.rtol) >= 0.0) and np.all(np.asarray(self.atol) > 0.0)
        if not (positive and 0.0 < self.min_step <= self.max_step):
            raise ValueError("steps: must satisfy rtol >= 0, atol > 0 and 0 < min_step <= max_step")

    @property
    def tableau(self) -> Tableau | RosenbrockPair:
        return METHODS[self.method]

    def scale(self, magnitude: Array) -> Array:
        """Tolerances (n,) of components of a magnitude |x| (n,)."""
        return np.asarray(self.atol + self.rtol * magnitude)

    def in_tolerances(self, error: Array, magnitude: Array, outputs: Array | None) -> float:
        """Largest error, in tolerances.

        Parameters:
            error: (n,) of the state, or (k, n) several.
            magnitude: (n,) of the state.
            outputs: (o, n) derivatives of outputs; None: none.
        """
        largest = float(np.max(np.abs(error) / self.scale(magnitude)))
        if outputs is None or self.output_tolerance == np.inf:
            return largest
        # Sums of all rows in the same order: those of mirrored motions are mirrored bit for bit, other than by BLAS.
        return max(largest, float(np.max(np.abs((outputs * error[..., None, :]).sum(axis=-1)))) / self.output_tolerance)


@dataclass(frozen=True)
class FirstStep(Generic[E]):
    """Initial data of an integration.

    Parameters:
        evaluation: at the initial state; None: computed.
        length: of the first step, s; None: estimated.
        error_before: error of the step before it, in tolerances.
        before: time s and state (n,) at the start of that step; None: there is none.
    """

    evaluation: E | None = None
    length: float | None = None
    error_before: float = 1.0
    before: Instant | None = None


def integrate(
    rhs: RightHandSide[E],
    t0: float,
    x0: Array,
    t1: float,
    settings: StepSettings,
    *,
    jacobian: Linearise[E] | None = None,
    first: FirstStep[E] | None = None,
    counts: StepStatistics | None = None,
    follow: Follow[E] | None = None,
    next_end: NextEnd | None = None,
    longest: LongestStep[E] | None = None,
    settle: Settle | None = None,
    ends: Ends[E] | None = None,
) -> Iterator[Step[E]]:
    """Accepted steps of x' = rhs(t, x, previous).rate from t0 to t1.

    Parameters:
        rhs: right-hand side; `previous` is the evaluation of the previous stage or, for the first stage, of the last
            accepted state: no evaluation of a rejected step is reused. If it raises StepFailure, the step is repeated
            with a shorter length.
        t0, t1: s.
        x0: (n,) initial state.
        settings: method, tolerances and step bounds.
        jacobian: for implicit methods, evaluated once at every accepted state.
        first: evaluation and step length at t0.
        counts: statistics to add to.
        follow: motion from which implicit methods integrate the difference, of each step. Where stiff parts of the
            solution follow it, the stages of a step stay near the solution.
        next_end: the next time s, after a given one, at which a step has to end, such as that of a kink of the
            right-hand side; infinite for none.
        longest: the longest step s from a time, state and evaluation, up to a given one, whose stages do not overlook
            changes of the right-hand side over time; None: any.
        settle: moves internal variables without rates, such as sliders of friction, at the end of a step; None: none.
        ends: solutions at the ends of steps, of implicit methods that ask for them, see `RosenbrockW`; None: none.

    Raises StepTooSmall below the smallest step, ValueError unless t1 > t0.
    """
    if not t1 > t0:
        raise ValueError(f"integrate: t0 = {t0:g} s, t1 = {t1:g} s: must satisfy t1 > t0")
    control, counts = settings.control, counts if counts is not None else StepStatistics()
    trial_step, k = _method(rhs, settings.tableau, jacobian, counts, follow, ends), settings.tableau.error_order + 1
    t, x = t0, np.array(x0, dtype=float)
    first = first or FirstStep()
    start, h, error_before = _initial(rhs, t, x, settings, first, counts)
    before = first.before
    first_trial = True
    reason: StepFailure | None = None
    while t < t1:
        target, proposed = t1 if next_end is None else min(t1, next_end(t)), h
        if t + 1.01 * h >= target:
            h = target - t
        if longest is not None and (bound := longest(t, x, start, h)) < h:
            h, proposed = bound, bound
            reason = reason or StepFailure("the right-hand side changes faster over time")
        if h < settings.min_step and h < target - t:
            raise StepTooSmall(f"step {h:.3g} s < {settings.min_step:.3g} s at t = {t:.9g} s: {reason}") from reason
        try:
            new, errors, last = trial_step(t, x, start, h)
            magnitude, after = np.maximum(np.abs(x), np.abs(new)), target if h == target - t else t + h
            error = settings.in_tolerances(errors, magnitude, trial_step.outputs)
            if error <= 1.0 and settle is not None:
                new, unsettled = settle(t, x, after, new)
                error = max(error, settings.in_tolerances(unsettled, magnitude, None))
            if error <= 1.0:
                end, nonlinear = trial_step.end(after, new, last)
                if settle is not None and end is last:  # of explicit methods, before it settled
                    counts.evaluations += 1
                    end = rhs(after, new, last)
                if nonlinear is not None:
                    error = max(error, settings.in_tolerances(nonlinear, magnitude, trial_step.outputs))
            if error > 1.0:
                counts.rejected += 1
                reason, first_trial = StepFailure(f"error of {error:.3g} tolerances"), False
                h *= max(control.smallest, control.safety * error ** (-1.0 / k))
                continue
        except StepFailure as failure:
            counts.failed += 1
            reason, first_trial = failure, False
            h *= control.retry
            continue
        counts.accepted += 1
        if h < proposed and after < t1:
            error, h = error * (proposed / h) ** k, proposed
        factor = control.factor(error, error_before, k)
        h = min(settings.max_step, h * (factor if first_trial else min(1.0, factor)))
        forcing = None if follow is None else follow(t, x, start)
        step = Step(t, x, start, after, new, end, error, h, forcing, trial_step.damping, before)
        before = t, x
        t, x, start, error_before, first_trial, reason = after, new, end, error, True, None
        yield step


def _method(
    rhs: RightHandSide[E],
    tableau: Tableau | RosenbrockPair,
    jacobian: Linearise[E] | None,
    counts: StepStatistics,
    follow: Follow[E] | None,
    ends: Ends[E] | None,
) -> StepMethod[E]:
    if isinstance(tableau, Tableau):
        return ExplicitRungeKutta(rhs, tableau, counts)
    return RosenbrockW(rhs, tableau, counts, jacobian, follow, ends)


def _initial(
    rhs: RightHandSide[E], t: float, x: Array, settings: StepSettings, first: FirstStep[E], counts: StepStatistics
) -> tuple[E, float, float]:
    """Evaluation at the initial state, length of the first step, and error of the preceding step."""
    start, length = first.evaluation, first.length
    if start is None:
        counts.evaluations += 1
        start = rhs(t, x, None)
    if length is None:
        counts.evaluations += 1
        length = _first_step(rhs, t, x, start, settings.scale(np.abs(x)), settings.tableau.error_order + 1)
    return start, min(length, settings.max_step), first.error_before


def _first_step(rhs: RightHandSide[E], t: float, x: Array, start: E, scale: Array, k: int) -> float:
    """Initial step length s after Hairer, Norsett, Wanner, Solving ODEs I, section II.4."""
    size, slope = np.max(np.abs(x) / scale), np.max(np.abs(start.rate) / scale)
    trial = 0.01 * size / slope if size > 1e-5 and slope > 1e-5 else 1e-6
    try:
        curvature = np.max(np.abs(rhs(t + trial, x + trial * start.rate, start).rate - start.rate) / scale) / trial
    except StepFailure:
        return 0.01 * float(trial)
    steepest = max(slope, curvature)
    best = (0.01 / steepest) ** (1.0 / k) if steepest > 1e-15 else max(1e-6, 1e-3 * trial)
    return float(min(100 * trial, best))
