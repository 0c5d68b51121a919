"""Random stress test of the contact models: convergence, speed and consistency of results."""

from __future__ import annotations

import argparse
import json
import logging
import sys
from collections import Counter
from collections.abc import Sequence
from pathlib import Path

import numpy as np
from rich.console import Console
from rich.progress import Progress, TimeElapsedColumn, TimeRemainingColumn

from benchmarks.common.machine import machine_description
from benchmarks.stability.invariants import limits
from benchmarks.stability.sample import SampledCase, cases
from benchmarks.stability.solve import SolveOutcome, legitimate, solve
from wheelrail.support.arrays import Array

TWIN = 20  # every so many cases are compared with an independent solution
OUTLIERS = {"force": 0.02, "area": 0.1}
HISTORY = 1e-6  # relative difference of forces from other starts


def run(count: int, seed: int, *, every: int = TWIN, only: Sequence[int] = ()) -> list[SolveOutcome]:
    """Solves a number of cases, or only those of some numbers, grouped by model to limit memory."""
    chosen = [case for case in cases(count, seed) if not only or case.number in only]
    chosen.sort(key=lambda case: (case.rail, case.size, np.isfinite(case.stiffness_per_area), case.number))
    outcomes = []
    with Progress(
        *Progress.get_default_columns()[:2],
        TimeElapsedColumn(),
        TimeRemainingColumn(),
        console=Console(stderr=True),
        disable=not sys.stderr.isatty(),
    ) as bar:
        for case in bar.track(chosen, description="cases"):
            outcomes.append(attempt(case, twin=every > 0 and case.number % every == 0))
    return sorted(outcomes, key=lambda outcome: outcome.case.number)


def attempt(case: SampledCase, *, twin: bool) -> SolveOutcome:
    """Solves a case; an unexpected exception is a failure of that case."""
    try:
        return solve(case, twin=twin)
    except Exception as error:
        return SolveOutcome(case, "failed", f"{type(error).__name__}: {error}")


def show(outcomes: list[SolveOutcome]) -> str:
    """Tables in Markdown."""
    lines = []
    for name, part in (("strips", [o for o in outcomes if o.strips]), ("grid", [o for o in outcomes if not o.strips])):
        solvable = [o for o in part if o.kind != "no answer"]
        converged = [o for o in solvable if o.kind == "converged"]
        if not converged:
            continue
        times, newton = np.array([o.seconds for o in converged]), np.array([o.newton for o in converged])
        lines += [
            f"\n## {name}: {len(part)} cases, {len(solvable)} with an answer, {len(converged)} converged "
            f"({len(converged) / len(solvable):.2%}), {sum(not o.broken for o in converged)} keep all limits\n",
            "| figure | median | 99 % | worst | limit | cases beyond |\n|---|---|---|---|---|---|",
            f"| seconds | {_spread(times)} | | |",
            f"| factorisations and Newton steps | {_spread(newton)} | | |",
            f"| load kN | {_spread(1e-3 * np.array([o.load for o in converged]))} | | |",
        ]
        least = [limits(o.case) for o in converged]
        for figure in least[0]:
            values, limit = np.array([o.figures[figure] for o in converged]), min(case[figure] for case in least)
            beyond = sum(figure in o.broken for o in converged)
            lines.append(f"| {figure} | {_spread(values)} | {limit:g} | {beyond} |")
        for rough in (False, True):
            for figure, bound in OUTLIERS.items():
                values = np.array([getattr(o, f"{figure}_differs") for o in converged if o.rough == rough])
                values = values[np.isfinite(values)]
                if len(values):
                    which = ", few strips" if rough else ""
                    beyond = "| |" if rough else f"| {bound:g} | {int((values > bound).sum())} |"
                    lines.append(f"| {figure} against twin{which} | {_spread(values)} {beyond}")
        starts = np.array([o.history for o in converged])
        starts = starts[~np.isnan(starts)]
        if len(starts):
            lines.append(f"| other starts | {_spread(starts)} | {HISTORY:g} | {int((starts > HISTORY).sum())} |")
        twins = [o for o in converged if o.twin]
        without_force = sum(not np.isfinite(o.force_differs) for o in twins)
        rough_ones = sum(o.rough for o in converged)
        if rough_ones:
            lines.append(f"\n{rough_ones} say that a patch has few strips: their area and gaps are rough")
        lines += [f"\n{len(twins)} compared with a twin, {without_force} of which had no force to compare"]
    reasons = Counter(f"{kind(o)}: {o.reason}" for o in outcomes if o.kind == "no answer")
    lines += ["\n## Without an answer\n", *(f"- {number} x {reason}" for reason, number in reasons.most_common())]
    lines += ["\n## Failed, beyond a limit, or unlike their twin\n"]
    lines += [f"- {kind(o)}: {trouble(o)}: {o.case}" for o in outcomes if trouble(o)] or ["- none"]
    return "\n".join(lines)


def kind(outcome: SolveOutcome) -> str:
    return "strips" if outcome.strips else "grid"


def trouble(outcome: SolveOutcome) -> str:
    """Short description of the errors of an outcome; empty without errors."""
    if outcome.kind == "failed":
        return outcome.reason
    parts = [f"{name} {outcome.figures[name]:.1e}" for name in outcome.broken]
    for figure, bound in OUTLIERS.items():
        differs = getattr(outcome, f"{figure}_differs")
        if differs > bound and not outcome.rough:
            parts.append(f"{figure} {differs:.1%} from its twin")
    if outcome.twin and not np.isfinite(outcome.force_differs) and not legitimate(outcome.twin):
        parts.append(f"its twin: {outcome.twin}")
    if outcome.history > HISTORY:
        parts.append(f"force {outcome.history:.1e} from other starts")
    return ", ".join(parts)


def _spread(values: Array) -> str:
    return f"{np.median(values):.3g} | {np.quantile(values, 0.99):.3g} | {values.max():.3g}"


def main() -> None:
    """Measures and prints."""
    parser = argparse.ArgumentParser(prog="python -m benchmarks.stability.report", description=__doc__)
    parser.add_argument("--cases", type=int, default=2000, metavar="N", help="in all (2000)")
    parser.add_argument("--seed", type=int, default=0, metavar="S", help="of the hypercube (0)")
    parser.add_argument("--only", type=int, nargs="*", default=[], metavar="NUMBER", help="these cases of all")
    parser.add_argument("--twin", type=int, default=TWIN, metavar="N", help="compare every so many cases (20; 0: none)")
    parser.add_argument("--json", type=Path, metavar="PATH", help="write all data to a file")
    arguments = parser.parse_args()
    logging.disable(logging.WARNING)
    machine = machine_description()
    print(machine, flush=True)
    outcomes = run(arguments.cases, arguments.seed, every=arguments.twin, only=arguments.only)
    print(show(outcomes))
    if arguments.json:
        report = {
            "machine": machine,
            "cases": arguments.cases,
            "seed": arguments.seed,
            "outcomes": [o.data() for o in outcomes],
        }
        arguments.json.write_text(json.dumps(report, indent=1), encoding="utf-8")


if __name__ == "__main__":
    main()
