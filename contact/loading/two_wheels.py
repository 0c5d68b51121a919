"""Depths at which wheels on a common axle carry their loads.

A wheel in the air counts as minus its gap times the slope of F^(2/3) by depth, so that the equations stay regular.
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from wheelrail.contact.loading.load_search import MAX_SOLVES, NOISE, RTOL, LoadError, Results, check, compliant
from wheelrail.support.arrays import Array

FARTHEST = 3.0  # step beyond a gap, over the approach: deeper wheels are not needed, and take long to solve
LIFTS = 12  # of a wheel that cannot be solved at the start, each twice as far as the one before


def find_depths_for_loads(
    contact: Callable[[Array, Results | None], Results],
    loads: Array,
    *,
    start: Array,
    slopes: Array,
    guess: Results | None = None,
    rtol: float = RTOL,
) -> tuple[Array, Results, int]:
    """Depths (n,) m of n wheels on a common axle, results and number of trials, by Broyden's method on F^(2/3).

    Parameters:
        contact: results at depths (n,) m, from earlier results as initial guess.
        loads: (n,) N.
        start: (n,) m, initial depths.
        slopes: (n,) N^(2/3)/m, diagonal of the initial Jacobian: the force of a wheel depends mostly on its own depth.
        guess: results to start from.
        rtol: of the loads.

    Raises LoadError when a solve fails, or when the loads are not reached.
    """
    target = np.array([compliant(load) for load in loads])
    expected = target / slopes  # m, approach under the load
    jacobian, depths = np.diag(slopes), np.array(start, dtype=float)
    step: Array = np.zeros(len(loads))
    residual, size = np.zeros(len(loads)), np.inf
    for trial in range(1, MAX_SOLVES + 1):
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
    nearest = ", ".join(
        f"{result.force[2]:g} N" if result.approach > 0.0 else f"{-1e3 * result.approach:.3g} mm of gap"
        for result in results
    )
    raise LoadError(f"loads {np.array2string(loads, precision=6)} N not reached in {MAX_SOLVES} solves, last {nearest}")
