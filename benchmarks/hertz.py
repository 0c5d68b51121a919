"""Errors and computing times of the contact models on Hertz pairs, as Markdown tables."""

from __future__ import annotations

import argparse
import logging
import os
import tempfile
from collections.abc import Iterable, Sequence
from itertools import product
from time import perf_counter

import numpy as np

from benchmarks.common.hertz_pairs import CIRCULAR, ELLIPTIC, HEAVY, Timed, clocked, creep_force, errors, rolling, timed
from benchmarks.common.machine import machine_description
from wheelrail.contact.laws.parameters import ContactLaws
from wheelrail.contact.loading.hertz import hertz_pose
from wheelrail.contact.models.discretisation import Bodies, Model

PENALTY, EXACT = 1e15, np.inf  # N/m3
CREEPAGE, FRICTION = 1e-3, 0.3
SLOPE_SIZES = (4.0, 5.0, 6.0, 7.0, 8.0, 10.0, 12.0)  # errors scatter with the size: a fit needs many
FULL_SIZE = 5.0
MODELS: tuple[Model, Model] = ("condensed", "full")
BODIES: tuple[Bodies, Bodies] = ("solid", "waveguide")


def heading(title: str, columns: str) -> None:
    print(f"\n{title}\n\n| {columns} |\n|{'---|' * (columns.count('|') + 1)}")


def percent(values: Iterable[float]) -> str:
    return " | ".join(f"{100 * value:+.1f}" for value in values)


def seconds(timed_pair: Timed) -> str:
    cold = "shared" if timed_pair.cold is None else f"{timed_pair.cold:.1f}"
    return f"{cold} | {timed_pair.cached:.2f} | {1e3 * timed_pair.solve:.1f}"


def law_name(stiffness: float) -> str:
    return "exact" if np.isinf(stiffness) else f"{stiffness:.0e}"


def normal_table(sizes: Sequence[float]) -> None:
    """Normal contact with and without penalty, and the error of the penalty itself."""
    heading(
        "Normal contact at the given load, errors in % of Hertz",
        "pair | bodies | K N/m3 | across | points | p0 | axis x | axis y | approach | cold s | cached s | solve ms",
    )
    cases = [(pair, across) for pair in (CIRCULAR, ELLIPTIC) for across in sizes]
    for pair, across in [*cases, (HEAVY, max(sizes))]:
        for bodies, stiffness in product(BODIES, (EXACT, PENALTY)):
            solution = timed(pair, across, ContactLaws(stiffness, friction=0.0), rolling(0.0), bodies)
            row = f"{across:g} | {solution.points} | {percent(errors(pair, solution))} | {seconds(solution)}"
            print(f"| {pair.name} | {bodies} | {law_name(stiffness)} | {row} |", flush=True)
    heading("Penetration due to the penalty", "pair | p0 MPa | p0/K um | of the approach %")
    for pair in (CIRCULAR, ELLIPTIC, HEAVY):
        penetration = pair.exact.peak / PENALTY
        row = f"{pair.exact.peak / 1e6:.0f} | {1e6 * penetration:.2f} | {100 * penetration / pair.exact.approach:.1f}"
        print(f"| {pair.name} | {row} |")


def slopes() -> None:
    """Order of convergence: slope of log error over log size."""
    across = ", ".join(f"{a:g}" for a in SLOPE_SIZES)
    heading(
        f"Fitted slope of error over size ({CIRCULAR.name}, exact law, {across} across)",
        "bodies | p0 | axes (RMS of both)",
    )
    size = np.log([CIRCULAR.size(across) for across in SLOPE_SIZES])
    for bodies in BODIES:
        laws = ContactLaws(EXACT, friction=0.0)
        solved = (timed(CIRCULAR, across, laws, rolling(0.0), bodies) for across in SLOPE_SIZES)
        relative_errors = np.array([errors(CIRCULAR, solution) for solution in solved])
        axes = np.sqrt((relative_errors[:, 1:3] ** 2).mean(axis=1))
        peak, semi = (float(np.polyfit(size, np.log(np.abs(error)), 1)[0]) for error in (relative_errors[:, 0], axes))
        print(f"| {bodies} | {peak:.2f} | {semi:.2f} |", flush=True)


def rolling_table(sizes: Sequence[float]) -> None:
    """Creep force of the circular pair with the paper's and with exact laws."""
    reference = creep_force(CIRCULAR, CREEPAGE, FRICTION)
    heading(
        f"Rolling ({CIRCULAR.name}), creepage {CREEPAGE:g}, friction {FRICTION:g}: CONTACT gives {reference:.0f} N",
        "bodies | laws | across | points | creep force N | error % | lateral N | Newton | cold s | cached s | solve ms",
    )
    kinds = {"exact": ContactLaws(EXACT, FRICTION, 0.0), "paper": ContactLaws(PENALTY, FRICTION, 1e-5)}
    for across, bodies, name in product(sizes, BODIES, kinds):
        solution = timed(CIRCULAR, across, kinds[name], rolling(CREEPAGE), bodies)
        along, lateral = solution.patch.tangential_force
        row = f"{across:g} | {solution.points} | {-along:.0f} | {percent([-along / reference - 1])} | {lateral:.1f}"
        print(f"| {bodies} | {name} | {row} | {solution.result.statistics.newton} | {seconds(solution)} |", flush=True)


def full_table() -> None:
    """`full` compared with `condensed` for the same mesh and laws."""
    heading(
        f"Full compared with condensed ({CIRCULAR.name}, {FULL_SIZE:g} across, the paper's laws, Hertz's approach)",
        "friction | model | normal N | creep force N | peak MPa | Newton | linear | cold s | solve s",
    )
    pose, motion = hertz_pose(CIRCULAR.exact.approach), rolling(CREEPAGE)
    differences = []
    for friction in (0.0, FRICTION):
        values = []
        for name in MODELS:
            model = CIRCULAR.model(FULL_SIZE, ContactLaws(PENALTY, friction, 1e-5), model=name)
            (cold, _), (warm, result) = (clocked(lambda m=model: m(pose, motion, None)) for _ in range(2))  # type: ignore[misc]
            count, peak = result.statistics, result.patches[0].max_pressure
            values.append(np.append(result.force, peak))
            row = f"{result.force[2]:.5f} | {0.0 - result.force[0]:.5f} | {peak / 1e6:.6f}"
            times = f"{count.newton} | {count.linear} | {cold:.2f} | {warm:.3g}"
            print(f"| {friction:g} | {name} | {row} | {times} |", flush=True)
        force = np.linalg.norm(values[1][:3] - values[0][:3]) / np.linalg.norm(values[0][:3])
        differences.append(f"friction {friction:g}: force {force:.0e}, peak {abs(values[1][3] / values[0][3] - 1):.0e}")
    print(f"\nRelative difference of both, {'; '.join(differences)}.")


def main() -> None:
    """Measures and prints."""
    parser = argparse.ArgumentParser(prog="python -m benchmarks.hertz", description=__doc__)
    parser.add_argument("--sizes", type=float, nargs="+", default=[5.0, 8.0, 12.0], help="points across the short axis")
    sizes = parser.parse_args().sizes
    logging.disable(logging.WARNING)  # notes of UFL and FFCx on quadrature would disturb the tables
    print(machine_description(), flush=True)
    began = perf_counter()
    with tempfile.TemporaryDirectory() as cache:
        os.environ["WHEELRAIL_CACHE"] = cache  # empty cache for the cold times
        first, _ = clocked(lambda: CIRCULAR.model(3.0, ContactLaws(friction=0.0))(hertz_pose(2e-5), rolling(0.0), None))
        print(f"First solve of all, with imports and the compilation of forms: {first:.1f} s", flush=True)
        normal_table(sizes)
        slopes()
        rolling_table(sizes)
        full_table()
    print(f"\n{perf_counter() - began:.0f} s in all")


if __name__ == "__main__":
    main()
