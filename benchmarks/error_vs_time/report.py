"""Error over time of a contact solve: lattices and grids, cold and warm, regularised and exact laws, `full` and
`condensed`, and CONTACT.

python -m benchmarks.error_vs_time [--quick] [--strips] [--ratios] [--seed S] [--picture FILE] [--json FILE]
"""

from __future__ import annotations

import argparse
import json
import logging
import math
import os
import secrets
import sys
from pathlib import Path
from time import perf_counter

import numpy as np

from benchmarks.common.machine import machine_description
from benchmarks.common.measurement import Row
from benchmarks.common.measurement_tables import Column, table
from benchmarks.error_vs_time.cases import ModelVariant, creep_cases, timing_case
from benchmarks.error_vs_time.measure import creep_error
from benchmarks.error_vs_time.plan import measured
from benchmarks.error_vs_time.reference import WARM_GAIN, contact_rows, extrapolated, long_cell_rows, rms
from benchmarks.error_vs_time.sampled import sampled_cases
from benchmarks.error_vs_time.wheel_on_rail import ASIDE, DEEPER, FINEST, LATERAL, strip_rows
from benchmarks.error_vs_time.wheel_on_rail import contact_rows as wheel_contact_rows
from benchmarks.scaling.report import progress
from wheelrail.contact.models.lattice.resolution import LatticeResolution

REFERENCE, QUICK_REFERENCE = LatticeResolution(32, 24), LatticeResolution(24, 24)
SAMPLED, QUICK_SAMPLED = 40, 4  # random ellipses
RATIOS = ((0.2, 0.5), (0.5, 2.0), (2.0, 5.0))  # ranges of a/b
TITLES = {
    "normal": "Normal contact alone",
    "rolling": "Rolling with xi, eta and spin",
    "wheel": "One wheel under its load from cold, and at its height",
}
EVERY, QUICK_EVERY = 6, 15  # of the 132 cases, one in so many


def _percent(name: str, unit: str = "%", sign: str = "+") -> Column:
    return f"{name}, {unit}", lambda row: f"{row[name]:{sign}.3f}" if name in row else ""


def _ms(name: str) -> Column:
    return f"{name}, ms", lambda row: 1e3 * row[name] if name in row else None


CREEP_ERRORS = ("creep error", "creep RMS", "creep worst")
COMMON: list[Column] = [
    ("model", lambda row: row["family"]),
    ("division", lambda row: row.get("division")),
    ("laws", lambda row: row.get("laws")),
    ("points", lambda row: row.get("points")),
    _ms("least"),
    _ms("median"),
]
NORMAL: list[Column] = [*COMMON, *map(_percent, ("force error", "peak error", "area error"))]
ROLLING: list[Column] = [
    *COMMON,
    ("Newton", lambda row: row.get("newton")),
    *[_percent(name, "% of mu F_n", "") for name in (*CREEP_ERRORS, "sampled RMS", "sampled worst")],
]

WHEEL: list[Column] = [
    *COMMON[:2],
    ("load, kN", lambda row: row["load"]),
    ("patches", lambda row: row["patches"]),
    ("solves", lambda row: row.get("solves")),
    *COMMON[4:],
    _ms("cold"),
    _ms("warm"),
    _percent("force error", "% of mu F_n", ""),
    _percent("peak error", "%", ""),
]


def full_against_condensed(rows: list[Row]) -> str:
    """Relative difference of the forces of `full` and `condensed`; empty where they were not measured."""
    deviations = []
    for task in TITLES:
        forces = [row["force"] for row in rows if row["task"] == task and row.get("bodies") == "solid"]
        if len(forces) == 2:
            deviations.append(f"{task} {math.dist(*forces) / math.hypot(*forces[0]):.0e}")
    return (
        f"\n- full compared with condensed, same mesh: relative difference of the force {', '.join(deviations)}."
        if deviations
        else ""
    )


def notes(seed: int) -> str:
    """Notes on the tables; seed of the sampled ellipses."""
    case = timing_case()
    xi, eta, phi = case.creep
    a, b = case.pair.exact.semi_axes
    return f"""
- Timed: an ellipse of {2e3 * a:.3g} x {2e3 * b:.3g} mm under {1e-3 * case.pair.load:.4g} kN, mu {case.friction:g}; \
rolling with xi {xi:g}, eta {eta:g}, spin {phi:g} rad/m. CONTACT's file does not state these creepages; they are the \
round values that give its forces.
- Times of the processor: the whole call with projection, candidates, compliance, solve and forces, 8 repeats or more \
(3 where a solve takes over 1 s), after a first one that computes shared data. Patches are computed on request and not \
timed.
- warm: each solve starts from the previous one, along a path of steps that change approach by 0.1 % and creepages by \
1 %.
- Normal contact: errors in % of Hertz at Hertz's approach, corrected for finite blocks. A penalty reduces the force \
by its part of the approach.
- Rolling: under the load, by the same laws; in % of mu F_n against the extrapolated finest solution. creep \
error: the larger of Fx and Fy on the timed ellipse; RMS and worst: of Fx and Fy over {len(creep_cases(EVERY))} cases \
of creep_curves.json (every sixth; --quick: {len(creep_cases(QUICK_EVERY))}), where a solve takes less than 1 s; \
sampled: over {SAMPLED} ellipses drawn anew at every call, here by --seed {seed} (a/b 0.2 to 5, friction 0.1 to 0.6, \
5 to 150 % of saturation; --quick: {QUICK_SAMPLED}).
- CONTACT: times of another machine and date, first-order slip; its load is prescribed, so its force error is that of \
its approach times 1.5; its area is that of its elements. On square elements; "long cells": nx along x by ny across \
over the ellipse, which is more accurate at equal times, errors over 40 other random ellipses in the same ranges \
against its own extrapolation; warm: its warm starts are 1.6 to 2 times quicker, shown at {WARM_GAIN:g}.
- One wheel: S1002 on UIC60, half-spaces, all solves of the search for the height under the load. CONTACT's file has \
loads and numbers of patches, not the position: ours is y = {1e3 * LATERAL[1]:g} mm with one patch and \
{1e3 * LATERAL[2]:g} mm with two. cold, warm: one solve at this height, without an earlier result and along a path of \
steps of {1e6 * ASIDE:g} um aside and {1e6 * DEEPER:g} um down. Errors: differences from {FINEST[0]} x {FINEST[1]} of \
the tangential force and of the peak pressure of the smaller patch."""


def errors_by_ratio(finest: LatticeResolution, count: int, seed: int) -> str:
    """Table of errors of strips over so many sampled ellipses of each range of a/b."""
    rows = list[Row]()
    for k, ratios in enumerate(RATIOS):
        against = extrapolated(finest, sampled_cases(count, seed + k, ratios), progress)
        for fineness in (LatticeResolution(6, 10), LatticeResolution()):
            variant = ModelVariant("lattice", "half-space", fineness)
            errors = np.array([creep_error(variant, case, against) for case in against.cases[1:]])
            row: Row = {"a/b": "{} to {}".format(*ratios), "division": variant.division}
            rows.append({**row, "RMS": 100 * rms(errors), "worst": 100 * float(np.abs(errors).max())})
    progress("")
    columns: list[Column] = [("a/b", lambda row: row["a/b"]), *COMMON[1:2]]
    columns += [_percent(name, "% of mu F_n", "") for name in ("RMS", "worst")]
    return table(f"{count} sampled ellipses of each range, --seed {seed}", columns, rows)


def main() -> None:
    """Measures and prints."""
    parser = argparse.ArgumentParser(
        prog="python -m benchmarks.error_vs_time",
        description=__doc__,
        formatter_class=argparse.RawDescriptionHelpFormatter,
    )
    parser.add_argument("--quick", action="store_true", help="few models, few cases, no `full`")
    parser.add_argument("--strips", action="store_true", help="strips on half-spaces alone, beside CONTACT")
    parser.add_argument("--seed", type=int, metavar="S", help="of the sampled ellipses (another one at every call)")
    parser.add_argument("--picture", type=Path, metavar="FILE", help="file for the figure")
    parser.add_argument("--json", type=Path, metavar="FILE", help="write all data to a file")
    parser.add_argument("--ratios", action="store_true", help="errors of strips by the ratio a/b of ellipses, no times")
    arguments = parser.parse_args()
    if "OMP_NUM_THREADS" not in os.environ:
        print("OMP_NUM_THREADS is not set: times may be those of several cores", file=sys.stderr)
    logging.disable(logging.WARNING)  # notes of UFL and FFCx on quadrature would disturb the tables
    machine, began = machine_description(), perf_counter()
    print(machine, flush=True)
    finest, every = (QUICK_REFERENCE, QUICK_EVERY) if arguments.quick else (REFERENCE, EVERY)
    seed = secrets.randbelow(2**31) if arguments.seed is None else arguments.seed
    if arguments.ratios:
        print(errors_by_ratio(finest, QUICK_SAMPLED if arguments.quick else SAMPLED, seed))
        return
    sampled = sampled_cases(QUICK_SAMPLED if arguments.quick else SAMPLED, seed)
    against = extrapolated(finest, (*creep_cases(every), *sampled), progress)
    rows: list[Row] = [
        *measured(arguments.quick, against, progress, strips=arguments.strips),
        *contact_rows(against.of(timing_case())),
        *long_cell_rows(),
        *strip_rows(),
        *wheel_contact_rows(),
    ]
    progress("")
    print(f"\n{against.description()}")
    for task, columns in (("normal", NORMAL), ("rolling", ROLLING), ("wheel", WHEEL)):
        print(table(TITLES[task], columns, [row for row in rows if row["task"] == task]), flush=True)
    print(f"{notes(seed)}{full_against_condensed(rows)}\n\n{perf_counter() - began:.0f} s in all")
    if arguments.json:
        report = {"machine": machine, "quick": arguments.quick, "reference": against.description(), "rows": rows}
        arguments.json.write_text(json.dumps(report, indent=1))
    if arguments.picture:
        from benchmarks.error_vs_time.figure import draw

        draw(arguments.picture, rows)


if __name__ == "__main__":
    main()
