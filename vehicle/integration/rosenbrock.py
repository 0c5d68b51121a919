"""Linearly implicit Runge-Kutta (Rosenbrock) methods: one factorisation a step, no iteration."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field
from functools import cached_property
from itertools import pairwise
from typing import Any, Generic

import numpy as np

from wheelrail.support.arrays import Array
from wheelrail.vehicle.integration.problem import (
    Damping,
    E,
    Ends,
    EndSolution,
    Follow,
    HasDerivatives,
    Linearise,
    RightHandSide,
    require_finite,
)
from wheelrail.vehicle.integration.step_control import StepStatistics

Rows = tuple[tuple[float, ...], ...]
DAMPED = 3  # times that stiff parts of changes within a step are reduced: others change in the order of h^3


@dataclass(frozen=True)
class RosenbrockCoefficients:
    """Coefficients of k_i = f(t + a_i h, x + h sum_j<i a_ij k_j) + h A sum_j<=i g_ij k_j + h g_i f_t; solution x + h
    b.k; A: any approximation of the Jacobian.

    Parameters:
        name: of the method.
        order, error_order: of the solution and of the embedded companion.
        diagonal: g_ii, the same for all stages.
        alpha, gamma: rows a_ij and g_ij (j < i) of stages 2 to s.
        weights, companion: (s,) weights b of the solution and of the companion.

    Raises ValueError for rows of wrong lengths, or weights that do not sum to one.
    """

    name: str
    order: int
    error_order: int
    diagonal: float
    alpha: Rows
    gamma: Rows
    weights: tuple[float, ...]
    companion: tuple[float, ...]

    def __post_init__(self) -> None:
        lengths = list(range(1, self.stages))
        if [len(r) for r in self.alpha] != lengths or [len(r) for r in self.gamma] != lengths:
            raise ValueError(f"{self.name}: rows must have 1 to {self.stages - 1} coefficients")
        if len(self.companion) != self.stages or any(abs(sum(w) - 1.0) > 1e-12 for w in (self.weights, self.companion)):
            raise ValueError(f"{self.name}: weights must be as many as stages and sum to 1")

    @property
    def stages(self) -> int:
        return len(self.weights)

    @cached_property
    def nodes(self) -> Array:
        """(s,) times of the stages within the step."""
        return np.asarray(self.full_alpha.sum(axis=1))

    @cached_property
    def repeats(self) -> tuple[bool, ...]:
        """Whether each stage has the state of its predecessor, and needs no evaluation."""
        return (False, *(after == (*before, 0.0) for before, after in pairwise([(), *self.alpha])))

    @cached_property
    def within(self) -> list[int]:
        """Stages that are evaluated within the step."""
        return [i for i, node in enumerate(self.nodes) if 0.0 < node < 1.0 and not self.repeats[i]]

    @cached_property
    def stiffly_accurate(self) -> bool:
        """Whether the solution is the last stage: infinitely stiff parts of its error vanish."""
        return bool(np.allclose(self.full_alpha[-1] + self.full_gamma[-1], self.weights, rtol=0.0, atol=1e-12))

    @cached_property
    def full_alpha(self) -> Array:
        """(s, s), strictly lower triangular."""
        return _square(self.alpha)

    @cached_property
    def full_gamma(self) -> Array:
        """(s, s), lower triangular."""
        return _square(self.gamma) + self.diagonal * np.eye(self.stages)

    @cached_property
    def sums(self) -> Array:
        """(s,) row sums of gamma: factors of the time derivative."""
        return np.asarray(self.full_gamma.sum(axis=1))

    @cached_property
    def inverse(self) -> Array:
        """(s, s) inverse of gamma: the unknowns u = h gamma k avoid products with the Jacobian."""
        return np.asarray(np.linalg.inv(self.full_gamma), dtype=np.float64)

    @cached_property
    def shifts(self) -> Array:
        """(s, s) weights of u in the states of the stages."""
        return np.asarray(self.full_alpha @ self.inverse)

    @cached_property
    def ends(self) -> Array:
        """(2, s) weights of u in the solution and in its difference to the companion."""
        b, companion = np.array(self.weights), np.array(self.companion)
        return np.asarray(np.stack([b, b - companion]) @ self.inverse)

    def damping(self, frequency: float, step: float) -> float:
        """Damping 1/s that the method adds to an undamped oscillation, with the exact Jacobian.

        Parameters:
            frequency: angular, 1/s.
            step: s.
        """
        z, ones = 1j * frequency * step, np.ones(self.stages)
        stages = np.linalg.solve(np.eye(self.stages) - z * (self.full_alpha + self.full_gamma), ones)
        return float(-np.log(abs(1.0 + z * np.dot(self.weights, stages))) / step)

    def longest_step(self, frequency: float, damping: float) -> float:
        """Longest step s, up to half a period, that adds at most some damping to an oscillation.

        Parameters:
            frequency: angular, 1/s.
            damping: 1/s.
        """
        from scipy.optimize import brentq

        half = np.pi / frequency
        if self.damping(frequency, half) <= damping:
            return half
        return float(brentq(lambda h: self.damping(frequency, h) - damping, 1e-3 * half, half))


def _square(rows: Rows) -> Array:
    full = np.zeros((len(rows) + 1, len(rows) + 1))
    for i, row in enumerate(rows, start=1):
        full[i, :i] = row
    return full


# J. Lang, D. Teleaga, IEEE Transactions on Magnetics 44 (2008) 1238-1241, DOI 10.1109/TMAG.2007.914837: order 3 for
# stiff problems with the exact Jacobian, stiffly accurate, one evaluation fewer. The companion is another one: of order
# 2 for stiff problems as well, so that errors are not overestimated there, and with half the diagonal as last weight.
ROS3PL = RosenbrockCoefficients(
    name="ROS3PL",
    order=3,
    error_order=2,
    diagonal=0.43586652150845899942,
    alpha=((0.5,), (0.5, 0.5), (0.5, 0.5, 0.0)),
    gamma=(
        (-0.5,),
        (-0.79156480420464204, 0.35244216792751432),
        (-0.49788969914518677, 0.38607515441580453, -0.32405197677907682),
    ),
    weights=(0.0021103008548132300, 0.88607515441580453, -0.32405197677907682, 0.43586652150845900),
    companion=(-0.31097505409134775, 1.1978953206508080, -0.10485352731368979, 0.21793326075422950),
)


# J. Rang, L. Angermann, BIT Numerical Mathematics 45 (2005) 761-787, DOI 10.1007/s10543-005-0035-y: order 3 with any
# approximation of the Jacobian, stiffly accurate. With the exact one both methods agree on linear problems.
ROS34PW2 = RosenbrockCoefficients(
    name="ROS34PW2",
    order=3,
    error_order=2,
    diagonal=0.43586652150845899942,
    alpha=((0.87173304301691799883,), (0.84457060015369423945, -0.11299064236484185), (0.0, 0.0, 1.0)),
    gamma=(
        (-0.87173304301691799883,),
        (-0.90338057013044082163, 0.054180672388095326),
        (0.24212380706095346380, -1.2232505839045147, 0.54526025533510214),
    ),
    weights=(0.24212380706095346380, -1.2232505839045147, 1.5452602553351021, 0.43586652150845899942),
    companion=(0.37810903145819369, -0.096042292212423178, 0.5, 0.21793326075422950),
)


# L. F. Shampine, ACM Transactions on Mathematical Software 8 (1982) 93-113, DOI 10.1145/355993.355994: order 4 with the
# exact Jacobian, A-stable; a third of infinitely stiff parts remains after a step.
SHAMPINE4 = RosenbrockCoefficients(
    name="Shampine4",
    order=4,
    error_order=3,
    diagonal=1 / 2,
    alpha=((1.0,), (12 / 25, 3 / 25), (12 / 25, 3 / 25, 0.0)),
    gamma=((-2.0,), (33 / 25, 3 / 5), (-7 / 125, -57 / 250, -1 / 10)),
    weights=(8 / 27, 1 / 8, 0.0, 125 / 216),
    companion=(16 / 27, 7 / 24, 25 / 216, 0.0),
)


@dataclass(frozen=True)
class RosenbrockPair:
    """Two methods: one for exact Jacobians, and one for approximate ones.

    Parameters:
        name: of the pair.
        exact, approximate: coefficients.
        ends: whether what is costly is solved at the ends of steps only, see `RosenbrockW`; of exact Jacobians, and of
            methods with one stage within the step.
    """

    name: str
    exact: RosenbrockCoefficients
    approximate: RosenbrockCoefficients
    ends: bool = False

    @property
    def error_order(self) -> int:
        """Order of the embedded companion of the exact method, for the step control."""
        return self.exact.error_order


ROSENBROCK = RosenbrockPair("rosenbrock", ROS3PL, ROS34PW2)
ROSENBROCK_ENDS = RosenbrockPair("rosenbrock_ends", ROS3PL, ROS34PW2, ends=True)
ROSENBROCK4 = RosenbrockPair("rosenbrock4", SHAMPINE4, ROS34PW2)


@dataclass(frozen=True)
class LastStage:
    """State (n,) of the last stage of a step, at its end in time, and the solution with its factorised matrix."""

    state: Array
    solve: Callable[[Array], Array]


@dataclass
class RosenbrockW(Generic[E]):
    """`StepMethod`: s solves of one factorised matrix 1/(h g) - A in the unknowns u = h gamma k (Hairer and Wanner,
    Solving ODEs II, section IV.7). The Jacobian is reused when a step is repeated with another length.

    Parameters:
        rhs: right-hand side.
        methods: coefficients; those of a step are chosen by its Jacobian.
        counts: statistics to which evaluations and factorisations are added.
        jacobian: linearisation of the right-hand side.
        follow: motion from which the difference is integrated, of each step; None: zero.
        ends: solutions at the ends of steps, for a pair of methods that asks for them; None: there are none.

    Of a stiffly accurate method, stiff parts of the difference to the companion, which is not, are reduced by
    (1 - h g A)^-1 to the size that they have in the solution (section IV.8 there), and the evaluation at the new state
    shows the next step of Newton's method from the last stage to the solution. The error of the method's quadrature of
    the rates of the forcing is known, is reduced alike, added to the solution, and counted: between stages a kink of a
    rail is a blow that no difference of theirs shows. Rates at the ends of a step contain
    stiff errors multiplied by their rate of decay: within the step they are damped, by 1 - (1 - (1 - h g A)^-1)^3.

    With solutions at the ends of steps the right-hand side itself is evaluated once a step, in the last stage. The
    stage within the step has that at the start to first order; what it lacks is cubic in time by values and slopes at
    both ends, and the unknowns are corrected for it to first order. The difference to what the slope at the end does
    not enter is an error. At the new state the right-hand side is that of the last stage to first order.

    Raises ValueError without a jacobian.
    """

    rhs: RightHandSide[E]
    methods: RosenbrockPair
    counts: StepStatistics
    jacobian: Linearise[E] | None
    follow: Follow[E] | None = None
    ends: Ends[E] | None = None
    linear: tuple[E, HasDerivatives] | None = field(default=None, init=False)
    last_stage: LastStage | None = field(default=None, init=False)
    damping: Damping | None = field(default=None, init=False)
    solved: EndSolution[E] | None = field(default=None, init=False)

    def __post_init__(self) -> None:
        if self.jacobian is None:
            raise ValueError(f"{self.methods.name}: jacobian must be given for a linearly implicit method")

    def __call__(self, t: float, x: Array, start: E, h: float) -> tuple[Array, Array, E]:
        linear = self._linear(t, x, start)
        method = self.methods.exact if linear.exact else self.methods.approximate
        solved = self.ends(x, start, linear) if self.methods.ends and self.ends is not None else None
        evaluation, state, unknowns = start, x, np.zeros((method.stages, len(x)))
        solve = self._factorised(linear.by_state, h * method.diagonal)
        moved, by_time, acceleration = self._moved(t, x, start, linear)
        rise, rate = np.zeros_like(x), moved(0.0)[1]
        integral = h * h * np.dot(method.weights, method.sums) * acceleration
        for i in range(method.stages):
            if i > 0 and not method.repeats[i]:
                self.counts.evaluations += 1
                rise, rate = moved(method.nodes[i] * h)
                state = x + rise + method.shifts[i, :i] @ unknowns[:i]
                rhs = solved if solved is not None and i in method.within else self.rhs
                evaluation = rhs(t + method.nodes[i] * h, state, evaluation)
                if rhs is solved:
                    within = t + method.nodes[i] * h, state, evaluation, float(method.nodes[i])
            integral += h * method.weights[i] * rate
            coupling = (method.inverse[i, :i] / h) @ unknowns[:i]
            unknowns[i] = solve(evaluation.rate - rate - coupling + h * method.sums[i] * by_time)
        self.solved, errors = None, list[Array]()
        if solved is not None:
            self.solved = solved.at(state, evaluation)
            own, without = (
                self._change(method, solve, linear.by_state, h, rates) for rates in solved.missed(*within, self.solved)
            )
            unknowns += own
            errors = [solve(method.ends[0] @ (own - without) / (h * method.diagonal))]
        increment, difference = method.ends @ unknowns
        require_finite(increment, difference)
        rise, self.last_stage = moved(h)[0], None

        def damping(change: Array) -> Array:
            left = change
            for _ in range(DAMPED):
                left = left - solve(left / (h * method.diagonal))
            return np.asarray(change - left)

        self.damping = damping
        if method.stiffly_accurate:
            difference = solve(difference / (h * method.diagonal))
            self.last_stage = LastStage(state, solve)
        new = x + rise + increment
        if self.follow is not None:
            missed = solve((integral - rise) / (h * method.diagonal))
            new, errors = new + missed, [missed, *errors]
        return new, np.stack([difference, *errors]) if errors else difference, evaluation

    @staticmethod
    def _change(
        method: RosenbrockCoefficients, solve: Callable[[Array], Array], by_state: Array, h: float, missed: Array
    ) -> Array:
        """Change (s, n) of the unknowns, to first order, by rates (n,) that the stage within the step has missed."""
        change = np.zeros((method.stages, len(missed)))
        for i in range(method.stages):
            coupling = (method.inverse[i, :i] / h) @ change[:i]
            own = missed if i in method.within else 0.0
            change[i] = solve(own + by_state @ (method.shifts[i, :i] @ change[:i]) - coupling)
        return change

    def end(self, t: float, x: Array, last: E) -> tuple[E, Array | None]:
        self.counts.evaluations += 1
        evaluation = (self.solved or self.rhs)(t, x, last)
        if self.last_stage is None or self.linear is None:
            return evaluation, None
        change = self.linear[1].by_state @ (x - self.last_stage.state)
        error = self.last_stage.solve(evaluation.rate - last.rate - change)
        require_finite(error)
        return evaluation, error

    @property
    def outputs(self) -> Array | None:
        return self.linear[1].outputs if self.linear is not None else None

    def _moved(
        self, t: float, x: Array, start: E, linear: HasDerivatives
    ) -> tuple[Callable[[float], tuple[Array, Array]], Array, Array]:
        """Rise (n,) of the forcing motion until some time s after t, and its rate there; derivative (n,) by time of the
        rates of the difference from this motion; acceleration (n,) of the motion at t.
        """
        if self.follow is None:
            still = np.zeros_like(linear.by_time)
            return lambda after: (still, still), linear.by_time, still
        forcing = self.follow(t, x, start)
        origin, rate, acceleration = forcing(t)

        def moved(after: float) -> tuple[Array, Array]:
            position, rate_there, _ = forcing(t + after)
            return position - origin, rate_there

        return moved, linear.by_time + linear.by_state @ rate - acceleration, acceleration

    def _linear(self, t: float, x: Array, start: E) -> HasDerivatives:
        assert self.jacobian is not None
        if self.linear is None or self.linear[0] is not start:
            self.linear = (start, self.jacobian(t, x, start))
        return self.linear[1]

    def _factorised(self, by_state: Array, shift: float) -> Callable[[Array], Array]:
        from scipy.linalg import lu_factor, lu_solve

        self.counts.factorisations += 1
        factors: Any = lu_factor(np.eye(len(by_state)) / shift - by_state, check_finite=False)
        return lambda right: np.asarray(lu_solve(factors, right, check_finite=False))
