"""Error and solution time of one contact model: normal contact, and rolling with xi, eta and spin.

Times are those of the processor: on a machine shared with other work the wall time of a solve is up to several times
as long.
"""

from __future__ import annotations

from collections.abc import Callable
from time import perf_counter, process_time

import numpy as np

from benchmarks.common.measurement import Row
from benchmarks.common.models import carrying, rolling
from benchmarks.error_vs_time.cases import ModelVariant, TimedCase, timing_case
from benchmarks.error_vs_time.reference import Reference, rms
from wheelrail.contact.loading.hertz import hertz_pose
from wheelrail.contact.results.result import ContactResult
from wheelrail.support.arrays import Array

REPEATS, FEW = 7, 3  # at least; of solves longer than LONG
ENOUGH, MOST = 0.15, 40  # s and repeats, of short solves
LONG = 1.0  # s
DEEPER, FASTER = 1e-3, 1e-2  # a step of a vehicle: changes of approach and of creepages, relative
Solve = Callable[[float, ContactResult | None], ContactResult]  # steps away from the pose in question, guess


def normal_row(variant: ModelVariant) -> Row:
    """Force, peak pressure and area at Hertz's approach, in % of Hertz; seconds."""
    pair = timing_case().pair
    model, depth = variant.of(pair, 0.0), variant.hertz_depth(pair)

    def solve(steps: float, guess: ContactResult | None) -> ContactResult:
        return model(hertz_pose(depth * (1 + DEEPER * steps)), rolling(0.0), guess)

    row, result = _timed(variant, solve)
    patch, (a, b) = result.patches[0], pair.exact.semi_axes
    row["task"] = "normal"
    row["force error"] = 100 * float(result.force[2] / pair.load - 1)
    row["peak error"] = 100 * (patch.max_pressure / pair.exact.peak - 1)
    row["area error"] = 100 * (patch.area / (np.pi * a * b) - 1)
    return row


def rolling_row(
    variant: ModelVariant, against: Reference, cases: tuple[TimedCase, ...], *, patience: float = np.inf
) -> Row:
    """Creep forces under the load, in % of mu F_n: the larger error of the timed case; RMS and maximum of the other
    cases, those with CONTACT's forces and sampled ones apart, unless a solve takes longer than the patience [s];
    seconds.
    """
    row, result = _timed(variant, _solve(variant, timing_case()))
    row["task"] = "rolling"
    row["creep error"] = 100 * float(np.abs(timing_case().forces(result) - against.of(timing_case())).max())
    if row["median"] <= patience:
        for name, sampled in (("creep", False), ("sampled", True)):
            own = [case for case in cases if (case.contact_forces is None) == sampled]
            if own:
                errors = [creep_error(variant, case, against) for case in own]
                row[f"{name} RMS"] = 100 * rms(np.array(errors))
                row[f"{name} worst"] = 100 * float(np.abs(errors).max())
    return row


def creep_error(variant: ModelVariant, case: TimedCase, against: Reference) -> Array:
    """(2,) of the forces, over mu F_n."""
    solve = _solve(variant, case)
    guess = _ok(solve(-1.0, None)) if variant.warm else None
    return np.asarray(case.forces(_ok(solve(0.0, guess))) - against.of(case))


def _solve(variant: ModelVariant, case: TimedCase) -> Solve:
    model, depth = variant.of(case.pair, case.friction), variant.loaded_depth(case.pair)

    def solve(steps: float, guess: ContactResult | None) -> ContactResult:
        motion = rolling(*(c * (1 + FASTER * steps) for c in case.creep))
        return model(hertz_pose(depth * (1 + DEEPER * steps)), motion, guess)

    return solve


def _timed(variant: ModelVariant, solve: Solve) -> tuple[Row, ContactResult]:
    """Smallest and median seconds of the processor, and the result at the final pose.

    Warm solves are the steps of a path that ends at this pose, each with the previous result as initial guess, never an
    identical one. A first solve computes everything that the solves of a model share.
    """
    guess = _ok(solve(-REPEATS - 2.0, None)) if variant.warm else None
    result = _ok(solve(-REPEATS - 1.0 if variant.warm else 0.0, guess))
    timings: list[float] = []
    began, repeats = perf_counter(), REPEATS + 1
    while len(timings) < repeats or (not variant.warm and len(timings) < MOST and perf_counter() - began < ENOUGH):
        steps = float(len(timings) - REPEATS) if variant.warm else 0.0
        start = process_time()
        result = solve(steps, result if variant.warm else None)
        timings.append(process_time() - start)
        repeats = FEW if timings[0] > LONG and not variant.warm else repeats
    row: Row = {
        "family": variant.family,
        "bodies": variant.bodies,
        "model": variant.model,
        "division": variant.division,
        "laws": variant.laws,
        "order": variant.order,
        "start": "warm" if variant.warm else "cold",
        "points": carrying(_ok(result)),
        "least": min(timings),
        "median": float(np.median(timings)),
        "newton": result.statistics.newton,
        "force": result.force.tolist(),
    }
    return row, result


def _ok(result: ContactResult) -> ContactResult:
    if result.status != "converged":
        raise RuntimeError(f"contact {result.status}")
    return result
