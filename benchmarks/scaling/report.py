"""Time, memory and error by size: `condensed` by contact points, `full` by unknowns.

python -m benchmarks.scaling.report [--quick] [--only points,elastic,newton] [--picture FILE] [--json FILE]

Every case runs in a separate process with limits on time and memory. A series ends at the first failure.
"""

from __future__ import annotations

import argparse
import json
import signal
import sys
from pathlib import Path
from time import perf_counter

from benchmarks.common import measurement_tables as tables
from benchmarks.common.machine import machine_description
from benchmarks.common.measurement import Row
from benchmarks.scaling.crossover import crossovers
from benchmarks.scaling.plan import bound_rows, full_rows, point_rows

PARTS = ("points", "elastic", "newton")


def progress(line: str) -> None:
    """Overwrites one line, on terminals only."""
    if sys.stderr.isatty():
        print(f"\r\033[K{line}", end="", file=sys.stderr, flush=True)


def measured(parts: list[str], *, quick: bool) -> dict[str, list[Row]]:
    """Rows of all kinds; each table is printed when complete."""
    rows: dict[str, list[Row]] = {"points": [], "floor": [], "elastic": [], "newton": []}
    if "points" in parts:
        rows["floor"] = list(bound_rows(quick, progress))
        rows["points"] = list(point_rows(quick, progress))
        progress("")
        title = "Condensed contact by contact points: ms a solve, errors against Hertz and CONTACT"
        print(tables.table(title, tables.POINT_COLUMNS, rows["points"]))
        print(tables.table("Lower bounds at n points", tables.BOUND_COLUMNS, rows["floor"]))
        by = tables.grouped(rows["points"], "family", "task")
        print(tables.exponents("Exponents over contact points", by, "points", tables.POINT_COSTS))
        every = {"lower bounds": [row for row in rows["floor"] if "failed" not in row]}
        print(tables.exponents("Exponents of the lower bounds", every, "points", tables.BOUND_COSTS))
        print(crossovers(rows["points"], rows["floor"]), flush=True)
    if "elastic" in parts:
        rows["elastic"] = list(full_rows("elastic", quick, progress))
        progress("")
        title = "All displacements of one body, K u = f to 1e-8: error of the work against a half-space"
        print(tables.table(title, tables.ELASTIC_COLUMNS, rows["elastic"]))
        by = tables.grouped(rows["elastic"], "method", "ranks")
        title = "Exponents over unknowns, K u = f by method and ranks"
        print(tables.exponents(title, by, "unknowns", tables.FULL_COSTS), flush=True)
    if "newton" in parts:
        rows["newton"] = list(full_rows("newton", quick, progress))
        progress("")
        title = "Contact of two bodies, eq. (12), one rank: Newton with BiCGStab"
        print(tables.table(title, tables.NEWTON_COLUMNS, rows["newton"]))
        by = tables.grouped(rows["newton"], "method", "friction")
        print(tables.exponents("Exponents over unknowns, contact by friction", by, "unknowns", tables.FULL_COSTS))
    return rows


def main() -> None:
    """Measures and prints."""
    parser = argparse.ArgumentParser(
        prog="python -m benchmarks.scaling.report",
        description=__doc__,
        formatter_class=argparse.RawDescriptionHelpFormatter,
    )
    parser.add_argument("--quick", action="store_true", help="small sizes only")
    parser.add_argument("--only", default=",".join(PARTS), metavar="PARTS", help="of points,elastic,newton (all)")
    parser.add_argument("--picture", type=Path, metavar="FILE", help="file for the figure")
    parser.add_argument("--json", type=Path, metavar="FILE", help="write all data to a file")
    arguments = parser.parse_args()
    parts = arguments.only.split(",")
    if unknown := set(parts) - set(PARTS):
        parser.error(f"no part {', '.join(sorted(unknown))}; there are {', '.join(PARTS)}")
    signal.signal(signal.SIGTERM, lambda *_: sys.exit("ended"))  # ends the running case, too
    machine, began = machine_description(), perf_counter()
    print(machine, flush=True)
    rows = measured(parts, quick=arguments.quick)
    print(f"\n{perf_counter() - began:.0f} s in all")
    if arguments.json:
        arguments.json.write_text(json.dumps({"machine": machine, "quick": arguments.quick, **rows}, indent=1))
    if arguments.picture:
        from benchmarks.scaling.figure import draw

        draw(arguments.picture, rows["points"], rows["floor"], rows["elastic"], rows["newton"])


if __name__ == "__main__":
    main()
