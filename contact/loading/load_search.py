"""Depth at which a contact carries a given load: a secant search with few solves, each warm-started by the previous.

It is kept between a depth that carries less and one that carries more or where the contact fails. Separated surfaces do
not touch before the upper one has moved by their gap, so that such a depth is known from the first solve on. A smooth
contact force is about proportional to depth^1.5: the secant is taken of F^(2/3), which is nearly linear.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace

import numpy as np

from wheelrail.contact.results.result import ContactResult
from wheelrail.support.interrupts import check_interrupt

Results = tuple[ContactResult, ...]
Lowered = Callable[[float, Results | None], Results]  # depth m, earlier results -> results


RTOL = 1e-9  # of the load
NOISE = 1e-6  # of the load: below it a trial without improvement is accepted, for the contact's own tolerance
JUMP = 2e-4  # of the load: largest accepted jump of a discrete contact's force, where cells become active
MAX_SOLVES = 60  # solves


class LoadError(RuntimeError):
    """The search for the depth at which the contact carries the load failed."""


@dataclass(frozen=True)
class LoadSolution:
    """Depth at which the contact carries a load.

    Parameters:
        depth: m, downwards from the origin of the scale.
        results: of the contact at that depth.
        error: of the vertical force, over the load.
        trials: number of solves.
        slope: of F^(2/3) by depth, N^(2/3)/m.
    """

    depth: float
    results: Results
    error: float
    trials: int
    slope: float


def vertical(results: Results) -> float:
    """Vertical force N on all wheels, including friction."""
    return float(sum(result.force[2] for result in results))


def compliant(force: float) -> float:
    """F^(2/3) with the sign of F, N^(2/3)."""
    return float(np.sign(force) * np.abs(force) ** (2.0 / 3.0))


def check(results: Results, nearest: str = "") -> Results:
    """The results; raises LoadError with the status of the first that failed, and with the load found before."""
    for result in results:
        if not result.ok:
            raise LoadError(f"contact {result.status}{nearest}")
    return results


def find_depth_for_load(
    contact: Lowered,
    load: float,
    *,
    expected: float,
    start: float = 0.0,
    rtol: float = RTOL,
    deepest: float = 0.1,
    guess: Results | None = None,
    known_slope: float | None = None,
) -> LoadSolution:
    """Depth of the upper body at which the vertical force equals a load.

    Parameters:
        contact: results at a depth m, with earlier results as initial guess.
        load: N.
        expected: estimate of the approach under the load, m.
        start: depth of the first solve, m.
        rtol: tolerance of the force over the load.
        deepest: largest depth below the start, or below the gap there, m.
        guess: initial guess of the first solve.
        known_slope: of F^(2/3) by depth at the start, if known from a similar contact, N^(2/3)/m.

    Raises LoadError when contact solves fail, or when the load is not reached.
    """
    target = compliant(load)
    below, above = -np.inf, np.inf  # depths that carry less; more, or where the contact fails
    failed: Results = ()  # results at depth `above` where the contact fails
    depth, stride, slope = start, expected, known_slope or target / expected
    last: tuple[float, float] | None = None  # depth and F^(2/3) of the last solve in contact
    best, width = LoadSolution(start, (), np.inf, 0, slope), np.inf
    for trial in range(1, MAX_SOLVES + 1):
        check_interrupt()
        results = contact(depth, guess)
        if not all(result.ok for result in results):
            penetration = max((result.approach for result in results if result.approach > 0.0), default=0.0)
            above, failed = min(above, depth), results
            if above - below < 1e-3 * expected:
                check(results, f"; nearest {_nearest(best)}" if best.results else "")
            depth = 0.5 * (below + above) if np.isfinite(below) else depth - max(penetration, stride)
            stride = 2.0 * stride
            continue
        penetration = max(result.approach for result in results)
        guess, force = results, vertical(results)
        value, error = compliant(force), abs(force - load) / load
        gap = max(-penetration, 0.0)
        start += gap if trial == 1 else 0.0
        below, above, failed = (max(below, depth + gap), above, failed) if force < load else (below, depth, ())
        if value > 0.0:
            if last or known_slope is None:
                slope = _slope(slope, last, (depth, value), penetration)
            last = depth, value
        stalled = best.error <= NOISE and error >= 0.5 * best.error
        if error < best.error:
            best = LoadSolution(depth, results, error, trial, slope)
        if error <= rtol or stalled:
            return replace(best, trials=trial)
        if above - below <= max(0.1 * rtol * expected, 8.0 * np.spacing(abs(depth))):
            if best.error <= JUMP:
                return replace(best, trials=trial)
            check(failed, f"; nearest {_nearest(best)}")
            raise LoadError(f"the force jumps over {load:g} N at a depth of {depth:.9g} m, nearest {_nearest(best)}")
        if value > 0.0:
            room = 3.0 * max(penetration, expected)
            depth += float(np.clip((target - value) / slope, -room, room)) if slope > 0.0 else expected
        else:
            stride = expected if gap > stride else stride
            depth, stride = depth + gap + stride, 2.0 * stride
        slow = trial % 4 == 0 and above - below > 0.25 * width  # one-sided convergence of the secant: bisect instead
        width = above - below if trial % 4 == 0 else width
        if np.isfinite(below + above) and (slow or not below < depth < above):
            depth = 0.5 * (below + above)
        if depth - start > deepest:
            raise LoadError(f"{load:g} N not reached within {deepest:g} m, nearest {_nearest(best)}")
    raise LoadError(f"{load:g} N not reached in {MAX_SOLVES} solves, nearest {_nearest(best)}")


def _slope(
    slope: float, previous: tuple[float, float] | None, current: tuple[float, float], penetration: float
) -> float:
    """Slope of F^(2/3) by the secant through two solves in contact (depth and F^(2/3)), or by one's penetration m."""
    if previous is not None and current[1] != previous[1] and current[0] != previous[0]:
        return (current[1] - previous[1]) / (current[0] - previous[0])
    return current[1] / penetration if penetration > 0.0 else slope


def _nearest(best: LoadSolution) -> str:
    return f"{vertical(best.results):g} N" if best.results else "none"
