"""Depths at which wheels on a common axle carry their loads, by the core: `contact/loading/core/two_wheels.hpp`."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from wheelrail.bindings._contact import MAX_TRIALS, RTOL, depths_for_loads
from wheelrail.contact.loading.load_search import Results, interruptible
from wheelrail.support.arrays import Array


def find_depths_for_loads(
    contact: Callable[[Array, Results | None], Results],
    loads: Array,
    *,
    start: Array,
    slopes: Array,
    guess: Results | None = None,
    rtol: float = RTOL,
    max_trials: int = MAX_TRIALS,
) -> tuple[Array, Results, int]:
    """Depths (2,) m of two wheels on a common axle, results and number of trials.

    Parameters:
        contact: results at depths (2,) m, from earlier results as initial guess.
        loads: (2,) N.
        start: (2,) m, initial depths.
        slopes: (2,) N^(2/3)/m, diagonal of the initial Jacobian: the force of a wheel depends mostly on its own depth.
        guess: results to start from.
        rtol: of the loads.
        max_trials: of Broyden's method, after which brackets are searched.

    Raises LoadError when the loads are not reached.
    """
    lowered = interruptible(contact)
    depths, results, trials = depths_for_loads(
        lowered, loads.tolist(), start.tolist(), slopes.tolist(), rtol, guess, max_trials
    )
    return np.array(depths), results, trials
