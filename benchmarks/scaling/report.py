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
from benchmarks.common.machine import stated
from benchmarks.common.measurement import Row
from benchmarks.scaling.crossover import crossovers
from benchmarks.scaling.plan import floor_rows, full_rows, point_rows

PARTS = ("points", "elastic", "newton")


def progress(line: str) -> None:
    """Overwrites one line, on terminals only."""
    if sys.stderr.isatty():
        print(f"\r\033[K{line}", end="", file=sys.stderr, flush=True)


def measured(parts: list[str], *, quick: bool) -> dict[str, list[Row]]:
    """Rows of all kinds; each table is printed when complete."""
    found: dict[str, list[Row]] = {"points": [], "floor": [], "elastic": [], "newton": []}
    if "points" in parts:
        found["floor"] = list(floor_rows(quick, progress))
        found["points"] = list(point_rows(quick, progress))
        progress("")
        title = "Condensed contact by contact points: ms a solve, errors against Hertz and CONTACT"
        print(tables.table(title, tables.POINT_COLUMNS, found["points"]))
        print(tables.table("Floors at n points", tables.FLOOR_COLUMNS, found["floor"]))
        by = tables.grouped(found["points"], "family", "task")
        print(tables.exponents("Exponents over contact points", by, "points", tables.POINT_COSTS))
        every = {"floors": [row for row in found["floor"] if "failed" not in row]}
        print(tables.exponents("Exponents of the floors", every, "points", tables.FLOOR_COSTS))
        print(crossovers(found["points"], found["floor"]), flush=True)
    if "elastic" in parts:
        found["elastic"] = list(full_rows("elastic", quick, progress))
        progress("")
        title = "All displacements of one body, K u = f to 1e-8: error of the work against a half-space"
        print(tables.table(title, tables.ELASTIC_COLUMNS, found["elastic"]))
        by = tables.grouped(found["elastic"], "method", "ranks")
        title = "Exponents over unknowns, K u = f by method and ranks"
        print(tables.exponents(title, by, "unknowns", tables.FULL_COSTS), flush=True)
    if "newton" in parts:
        found["newton"] = list(full_rows("newton", quick, progress))
        progress("")
        title = "Contact of two bodies, eq. (12), one rank: Newton with BiCGStab"
        print(tables.table(title, tables.NEWTON_COLUMNS, found["newton"]))
        by = tables.grouped(found["newton"], "method", "friction")
        print(tables.exponents("Exponents over unknowns, contact by friction", by, "unknowns", tables.FULL_COSTS))
    return found


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
    given = parser.parse_args()
    parts = given.only.split(",")
    if unknown := set(parts) - set(PARTS):
        parser.error(f"no part {', '.join(sorted(unknown))}; there are {', '.join(PARTS)}")
    signal.signal(signal.SIGTERM, lambda *_: sys.exit("ended"))  # ends the running case, too
    machine, began = stated(), perf_counter()
    print(machine, flush=True)
    found = measured(parts, quick=given.quick)
    print(f"\n{perf_counter() - began:.0f} s in all")
    if given.json:
        given.json.write_text(json.dumps({"machine": machine, "quick": given.quick, **found}, indent=1))
    if given.picture:
        from benchmarks.scaling.figure import draw

        draw(given.picture, found["points"], found["floor"], found["elastic"], found["newton"])


if __name__ == "__main__":
    main()
