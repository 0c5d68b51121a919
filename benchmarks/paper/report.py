"""Tables 5, 6 and 7 and Fig. 9 of the paper reproduced with our model, with further rows and errors.

python -m benchmarks.paper.report [--seconds T] [--short T] [--start T] [--quick] [--only 5,6,7,9,new]
                                  [--picture FILE] [--json FILE]

All variants run the same part of scenes/paper_curve.toml, within its transition, from the same state: the equilibrium
at its start, within the accuracy of the contact model. Eq. (12) takes seconds per contact problem: it and the
corresponding row of Eq. (15) run a much shorter part on a coarser mesh. Values of the two parts are not scaled.
"""

from __future__ import annotations

import argparse
import json
import logging
import sys
from dataclasses import asdict
from pathlib import Path
from time import perf_counter
from typing import Any

from benchmarks.common.machine import stated
from benchmarks.paper.figure import picture
from benchmarks.paper.fixed_states import PAPER_TOL, Accuracy, accuracies, equivalent, states
from benchmarks.paper.published import FIG_9, NOTES, SOURCE, TABLES
from benchmarks.paper.runs import FAILURES, Runs
from benchmarks.paper.tables import HEAD, line, markdown, printed, row
from benchmarks.paper.variants import SOLID, TOLERANCE, WAVES_EXACT, table

ALL = ("5", "6", "7", "9", "new")


def tolerances(runs: Runs, count: int) -> tuple[str, dict[str, list[Accuracy]]]:
    """Force error over Newton's tolerance at states of the runs."""
    lines, data = [], {}
    for body in (SOLID, WAVES_EXACT):
        lines.append(f"\n### {body.name}\n")
        try:
            part = runs.part(body, runs.seconds)
            chosen = states(part, part.run("ode23", {"tolerance": TOLERANCE}), count)
            found = data[body.name] = accuracies(part, chosen)
        except FAILURES as error:
            lines.append(f"failed: {type(error).__name__}: {error}")
            continue
        rows: list[list[Any]] = [
            [
                f"{a.tolerance:.0e}",
                "step before" if a.warm else "nothing",
                *(f"{100 * error:.2g}" for error in (a.creep, a.worst, a.force)),
                f"{a.newton:.1f}",
                f"{1e3 * a.seconds:.3g}",
                a.failed,
            ]
            for a in found
        ]
        head = "tolerance|from|creep force, RMS % of mu F_n|worst|force, RMS % of load|Newton|ms|failed"
        lines += [markdown(head, rows), f"\n{len(chosen)} contacts of both sides, errors against {1e-11:g}."]
        if part.scene.laws == "paper":
            share = equivalent(chosen, part.scene.stiffness_per_area)
            lines.append(
                f"The paper's Tol is absolute, on displacements; were it {PAPER_TOL:g} m (the scan leaves the exponent "
                f"open), K Tol would be {share:.1e} of the norm of the pressures."
            )
    return "\n".join(lines), data


def main() -> None:
    """Runs and prints."""
    given = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    given.add_argument("--seconds", type=float, help="length of the part (0.05)")
    given.add_argument("--short", type=float, help="length of the part for Eq. (12) (0.0004)")
    given.add_argument("--start", type=float, default=1.65, help="s from the scene's start")
    given.add_argument("--quick", action="store_true", help="a part of 0.01 s, of 0.001 s for Eq. (12), few states")
    given.add_argument("--only", default=",".join(ALL))
    given.add_argument("--picture", type=Path)
    given.add_argument("--json", type=Path)
    args = given.parse_args()
    wanted = args.only.split(",")
    if unknown := set(wanted) - set(ALL):
        given.error(f"no table {', '.join(sorted(unknown))}; there are {', '.join(ALL)}")
    logging.disable(logging.WARNING)
    seconds, short = args.seconds or (0.01 if args.quick else 0.05), args.short or (0.0002 if args.quick else 0.0004)
    began = perf_counter()
    print(stated())
    print(
        f"\nPart of {seconds:g} s from {args.start:g} s on, for Eq. (12) and beside it {short:g} s; relative tolerance "
        f"of Newton's method {TOLERANCE:g}; errors are RMS against ODE45 at RelTol 1e-6, AbsTol 1e-9 and 1e-11, from "
        "the same state, near equilibrium; forces in % of the mean wheel load. #New counts factorisations of the "
        "normal problem, too; BiCGStab solves those of friction only. Times are without meshes, factorisations and "
        "compliances. "
        "The first evaluation of a run starts from nothing. Forces are taken linear between steps, which long steps "
        "pay for in the error."
    )
    runs = Runs(args.start, seconds, short, say=lambda text: print(f"  {text}", file=sys.stderr, flush=True))
    report: dict[str, Any] = {"machine": stated(), "start": args.start, "tables": {}}
    for name in wanted:
        title = {"9": "Fig. 9", "new": "Rows that the paper lacks"}.get(name, f"Table {name}")
        print(f"\n## {title}\n\n{markdown(HEAD, [])}", flush=True)
        rows = []
        for variant in table(name):
            rows.append(row(variant, runs.of(variant), runs.length(variant)))
            print(line(rows[-1]), flush=True)
        print()
        if name in TABLES:
            print(f"{SOURCE}:\n\n{printed(name)}", flush=True)
        elif name == "9":
            print(FIG_9)
        report["tables"][name] = {"columns": HEAD.split("|"), "rows": rows}
    if "new" in wanted:
        head = "contact model|left at the start, % of axle load|y mm RMS|contact force, % of load RMS"
        print(f"\n## Contact models beside fitted points, tight runs\n\n{markdown(head, runs.models())}")
        text, data = tolerances(runs, 3 if args.quick else 10)
        print(f"\n## Force error against Newton's tolerance, fixed states\n{text}")
        report["tolerances"] = {body: [asdict(one) for one in rows] for body, rows in data.items()}
    print("\n" + "\n".join(f"- {note}" for note in NOTES) + f"\n\n{perf_counter() - began:.0f} s in all")
    if args.json:
        args.json.write_text(json.dumps(report, indent=1), encoding="utf-8")
    if args.picture:
        picture(args.picture, runs.variants)


if __name__ == "__main__":
    main()
