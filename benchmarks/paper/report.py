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

from benchmarks.common.machine import machine_description
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
            errors = data[body.name] = accuracies(part, chosen)
        except FAILURES as error:
            lines.append(f"failed: {type(error).__name__}: {error}")
            continue
        rows: list[list[Any]] = [
            [
                f"{a.tolerance:.0e}",
                "previous step" if a.warm else "no guess",
                *(f"{100 * error:.2g}" for error in (a.creep, a.worst, a.force)),
                f"{a.newton:.1f}",
                f"{1e3 * a.seconds:.3g}",
                a.failed,
            ]
            for a in errors
        ]
        head = "tolerance|from|creep force, RMS % of mu F_n|worst|force, RMS % of load|Newton|ms|failed"
        lines += [markdown(head, rows), f"\n{len(chosen)} contacts of both sides, errors against {1e-11:g}."]
        if part.scene.laws == "paper":
            relative_tolerance = equivalent(chosen, part.scene.stiffness_per_area)
            lines.append(
                f"The paper's Tol is absolute, for displacements; for {PAPER_TOL:g} m (the exponent is illegible in "
                f"the scan) K Tol is {relative_tolerance:.1e} of the norm of the pressures."
            )
    return "\n".join(lines), data


def main() -> None:
    """Runs and prints."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--seconds", type=float, help="length of the part (0.05)")
    parser.add_argument("--short", type=float, help="length of the part for Eq. (12) (0.0004)")
    parser.add_argument("--start", type=float, default=1.65, help="s from the scene's start")
    parser.add_argument("--quick", action="store_true", help="a part of 0.01 s, of 0.001 s for Eq. (12), few states")
    parser.add_argument("--only", default=",".join(ALL))
    parser.add_argument("--picture", type=Path)
    parser.add_argument("--json", type=Path)
    arguments = parser.parse_args()
    names = arguments.only.split(",")
    if unknown := set(names) - set(ALL):
        parser.error(f"no table {', '.join(sorted(unknown))}; there are {', '.join(ALL)}")
    logging.disable(logging.WARNING)
    seconds, short = (
        arguments.seconds or (0.01 if arguments.quick else 0.05),
        arguments.short or (0.0002 if arguments.quick else 0.0004),
    )
    began = perf_counter()
    print(machine_description())
    print(
        f"\nPart of {seconds:g} s from {arguments.start:g} s on, for Eq. (12) and its row of Eq. (15) {short:g} s; "
        f"relative tolerance of Newton's method {TOLERANCE:g}; errors are RMS against ODE45 at RelTol 1e-6, AbsTol "
        "1e-9 and 1e-11, from the same state, near equilibrium; forces in % of the mean wheel load. #New includes "
        "factorisations of the normal problem; BiCGStab solves the tangential problem only. Times are without meshes, "
        "factorisations and compliances. "
        "The first evaluation of a run has no initial guess. Forces are interpolated linearly between steps, which "
        "increases the error of long steps."
    )
    runs = Runs(arguments.start, seconds, short, say=lambda text: print(f"  {text}", file=sys.stderr, flush=True))
    report: dict[str, Any] = {"machine": machine_description(), "start": arguments.start, "tables": {}}
    for name in names:
        title = {"9": "Fig. 9", "new": "Additional rows"}.get(name, f"Table {name}")
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
    if "new" in names:
        head = "contact model|residual at the start, % of axle load|y mm RMS|contact force, % of load RMS"
        print(f"\n## Contact models compared with a lattice, tight runs\n\n{markdown(head, runs.models())}")
        text, data = tolerances(runs, 3 if arguments.quick else 10)
        print(f"\n## Force error against Newton's tolerance, fixed states\n{text}")
        report["tolerances"] = {body: [asdict(accuracy) for accuracy in rows] for body, rows in data.items()}
    print("\n" + "\n".join(f"- {note}" for note in NOTES) + f"\n\n{perf_counter() - began:.0f} s in all")
    if arguments.json:
        arguments.json.write_text(json.dumps(report, indent=1), encoding="utf-8")
    if arguments.picture:
        picture(arguments.picture, runs.variants)


if __name__ == "__main__":
    main()
