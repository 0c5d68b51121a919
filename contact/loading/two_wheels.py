"""Depths at which wheels on a common axle carry their loads.

Broyden's method takes few solves, but may not end on steep flanges, where a wheel that is lowered rolls the axle and
climbs. The search by brackets always does: both wheels together carry their loads at one height for every roll, and
the part of the left one passes its load between rolls that lift it and the other.
"""

from __future__ import annotations

from collections.abc import Callable
from contextlib import suppress
from dataclasses import dataclass, replace

import numpy as np

from wheelrail.contact.kinematics.wheelset_state import WheelsetState
from wheelrail.contact.loading.load_search import (
    JUMP,
    NOISE,
    RTOL,
    LoadError,
    LoadSolution,
    Results,
    check,
    compliant,
    find_depth_for_load,
)
from wheelrail.support.arrays import Array

MAX_TRIALS = 24  # of Broyden's method: 4 to 10 suffice but on steep flanges
FARTHEST = 3.0  # step beyond a gap, over the approach: deeper wheels are not needed, and take long to solve
LIFTS = 12  # of a wheel that cannot be solved at the start, each twice as far as the one before
WIDEST = 0.15  # m, largest change of the difference of both depths: rolls of 0.1 rad
LIFTED = 0.9  # part of a load by which wheels that hardly carry, or carry nearly all, are told from others
MAX_HALVINGS = 60  # of a bracket


def at_depths(state: WheelsetState, depths: Array, base: float) -> WheelsetState:
    """State with wheels at depths (2,) m below the nominal height at the roll of a state, base m from the middle."""
    left, right = depths  # z + base roll = -left, z - base roll = -right
    return replace(state, z=-0.5 * (left + right), roll=state.roll + 0.5 * (right - left) / base)


def find_depths_for_loads(
    contact: Callable[[Array, Results | None], Results],
    loads: Array,
    *,
    start: Array,
    slopes: Array,
    guess: Results | None = None,
    rtol: float = RTOL,
) -> tuple[Array, Results, int]:
    """Depths (2,) m of two wheels on a common axle, results and number of trials.

    Parameters:
        contact: results at depths (2,) m, from earlier results as initial guess.
        loads: (2,) N.
        start: (2,) m, initial depths.
        slopes: (2,) N^(2/3)/m, diagonal of the initial Jacobian: the force of a wheel depends mostly on its own depth.
        guess: results to start from.
        rtol: of the loads.

    Raises LoadError when the loads are not reached.
    """
    with suppress(LoadError):
        return _broyden(contact, loads, start, slopes, guess, rtol)
    expected = float(np.max([compliant(load) / slope for load, slope in zip(loads, slopes, strict=True)]))
    return _bracketed(contact, loads, start, expected, rtol)


def _broyden(
    contact: Callable[[Array, Results | None], Results],
    loads: Array,
    start: Array,
    slopes: Array,
    guess: Results | None,
    rtol: float,
) -> tuple[Array, Results, int]:
    """Depths, results and trials of `find_depths_for_loads`, by Broyden's method on F^(2/3).

    A wheel in the air counts as minus its gap times the slope of F^(2/3) by depth, so that the equations stay regular.
    Raises LoadError when a solve fails, or when the loads are not reached.
    """
    target = np.array([compliant(load) for load in loads])
    expected = target / slopes  # m, approach under the load
    jacobian, depths = np.diag(slopes), np.array(start, dtype=float)
    step: Array = np.zeros(len(loads))
    residual, size = np.zeros(len(loads)), np.inf
    for trial in range(1, MAX_TRIALS + 1):
        results = contact(depths + step, guess)
        approach = np.array([result.approach for result in results])
        force = [compliant(float(result.force[2])) for result in results]
        trial_residual = np.where(approach > 0.0, force, slopes * np.minimum(approach, 0.0)) - target
        errors = np.abs([float(r.force[2]) / load - 1.0 for r, load in zip(results, loads, strict=True)])
        usable, largest = all(result.ok for result in results), float(np.abs(trial_residual).max())
        # Below the contact's own tolerance the force depends on the guess: shorter steps need not come back to `size`.
        if usable and (errors.max() <= rtol or (errors.max() <= NOISE and largest > 0.5 * size)):
            return depths + step, results, trial
        if not usable and size == np.inf and trial < LIFTS:  # too deep at the roll of both: from above
            depths = depths - 2.0**trial * expected * [not result.ok for result in results]
            continue
        if not usable and np.abs(step).max() < min(1e-9, 1e-3 * expected.min()):
            check(results)
        if not usable or largest > 2.0 * size:
            step = 0.5 * step
            continue
        if step.any():
            jacobian += np.outer(trial_residual - residual - jacobian @ step, step) / (step @ step)
        depths, guess = depths + step, results
        residual, size = trial_residual, largest
        room = np.maximum(-approach, 0.0) + FARTHEST * np.maximum(approach, expected)
        try:
            step = -np.linalg.solve(jacobian, residual)
        except np.linalg.LinAlgError:
            step = -residual / slopes
        step *= min(1.0, float(np.min(room / np.maximum(np.abs(step), 1e-300))))
    raise LoadError(f"loads not reached in {MAX_TRIALS} solves")


@dataclass(frozen=True)
class _Balance:
    """Both wheels carry their loads together, at a difference of their depths.

    Parameters:
        tilt: depth of the right wheel below the left one, m.
        found: mean depth.
        excess: of the left wheel's force over its load.
    """

    tilt: float
    found: LoadSolution
    excess: float

    @property
    def depths(self) -> Array:
        return np.asarray(self.found.depth + np.array([-0.5, 0.5]) * self.tilt)


def _bracketed(
    contact: Callable[[Array, Results | None], Results], loads: Array, start: Array, expected: float, rtol: float
) -> tuple[Array, Results, int]:
    """Depths, results and trials of `find_depths_for_loads`, by brackets of the difference of both depths.

    Raises LoadError.
    """
    trials = 0

    def balance(tilt: float, mean: float, guess: Results | None) -> _Balance:
        nonlocal trials
        apart = np.array([-0.5, 0.5]) * tilt
        found = find_depth_for_load(
            lambda depth, own: contact(depth + apart, own),
            float(loads.sum()),
            expected=expected,
            start=mean,
            rtol=0.5 * rtol,
            guess=guess,
        )
        trials += found.trials
        return _Balance(tilt, found, float(found.results[0].force[2] / loads[0] - 1.0))

    first = float(start[1] - start[0])
    low = high = last = balance(first, float(start.min()) - 0.5 * abs(first), None)
    stride = 2.0 * expected
    while low.excess < 0.0 or high.excess > 0.0:  # the left wheel carries more at low, less at high
        way = np.sign(last.excess)
        if abs(last.tilt - first) > WIDEST:
            raise LoadError(f"no roll at which each wheel carries {loads[0]:g} N, nearest {_forces(last)}")
        try:
            last = balance(last.tilt + way * stride, last.found.depth - 0.5 * stride, last.found.results)
        except LoadError:
            if stride < 1e-3 * expected:
                raise
            stride *= 0.25
            continue
        stride *= 2.0
        low, high = (last, high) if last.excess >= 0.0 else (low, last)
    side = 0  # of the last trials: as often as one end stays, its excess counts half (Illinois)
    weights = [1.0, 1.0]
    for _ in range(MAX_HALVINGS):
        best = min(low, high, key=lambda own: abs(own.excess))
        narrow = high.tilt - low.tilt <= max(0.1 * rtol * expected, 8.0 * np.spacing(abs(low.tilt)))
        if abs(best.excess) <= rtol or narrow:
            break
        left, right = low.excess * weights[0], high.excess * weights[1]
        part = 0.5 if max(left, -right) > LIFTED else left / (left - right)
        tilt = low.tilt + part * (high.tilt - low.tilt)
        last = balance(tilt, best.found.depth - 0.5 * abs(tilt - best.tilt), best.found.results)
        if last.excess >= 0.0:
            low, weights = last, [1.0, 0.5 * weights[1] if side == 1 else 1.0]
            side = 1
        else:
            high, weights = last, [0.5 * weights[0] if side == -1 else 1.0, 1.0]
            side = -1
    if abs(best.excess) > max(JUMP, rtol):
        raise LoadError(f"forces of the wheels jump over {loads[0]:g} N at one roll, nearest {_forces(best)}")
    return best.depths, best.found.results, trials


def _forces(balance: _Balance) -> str:
    return " and ".join(f"{result.force[2]:g} N" for result in balance.found.results)
