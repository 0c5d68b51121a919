"""Accuracy of the contact models: closed forms, Kalker's table and CONTACT; Markdown tables and JSON."""

from __future__ import annotations

import argparse
import json
import logging
import sys
from collections.abc import Callable
from pathlib import Path
from time import perf_counter

from benchmarks.accuracy.bulk_compression import bulk_section
from benchmarks.accuracy.carter import carter_section
from benchmarks.accuracy.cattaneo import cattaneo_section
from benchmarks.accuracy.fastsim import fastsim_section
from benchmarks.accuracy.rolling import creep_section, kalker_section
from benchmarks.accuracy.wheelset import half_space_section, manchester_section, wheelset_section
from benchmarks.common.hertz_cases import hertz_section
from benchmarks.common.machine import machine_description
from benchmarks.common.reference_table import TableSection, show

Say = Callable[[str], None]
SECTIONS: dict[str, Callable[[bool, Say], TableSection]] = {
    "hertz": lambda quick, _: hertz_section(quick),
    "cattaneo": cattaneo_section,
    "carter": carter_section,
    "kalker": kalker_section,
    "creep": creep_section,
    "fastsim": fastsim_section,
    "wheelset": wheelset_section,
    "half-space": half_space_section,
    "manchester": manchester_section,
    "bulk": bulk_section,
}


def run(name: str, *, quick: bool = False, say: Say = lambda _: None) -> TableSection:
    """One section, timed."""
    start = perf_counter()
    section = SECTIONS[name](quick, say)
    section.seconds = perf_counter() - start
    return section


def progress(line: str) -> None:
    """Overwrites one line, on terminals only."""
    if sys.stderr.isatty():
        print(f"\r\033[K{line}", end="", file=sys.stderr, flush=True)


def main() -> None:
    """Measures and prints."""
    parser = argparse.ArgumentParser(prog="python -m benchmarks.accuracy.report", description=__doc__)
    parser.add_argument("sections", nargs="*", metavar="SECTION", help=f"of {', '.join(SECTIONS)} (all)")
    parser.add_argument("--quick", action="store_true", help="few cases of every section")
    parser.add_argument("--json", type=Path, metavar="PATH", help="write all data to a file")
    arguments = parser.parse_args()
    unknown = set(arguments.sections) - set(SECTIONS)
    if unknown:
        parser.error(f"no section {', '.join(sorted(unknown))}; there are {', '.join(SECTIONS)}")
    logging.disable(logging.WARNING)  # notes of UFL and FFCx on quadrature would disturb the tables
    machine = machine_description()
    print(machine, flush=True)
    began, sections = perf_counter(), []
    for name in arguments.sections or SECTIONS:
        section = run(name, quick=arguments.quick, say=progress)
        progress("")
        print(show(section), flush=True)
        sections.append(section)
    print("\n## Everything\n\n| section | error | unit | RMS | worst | met |\n|---|---|---|---|---|---|")
    for section in sections:
        for quantity in section.measures:
            met = {None: "", True: "yes", False: "NO"}[quantity.met]
            errors = f"{quantity.rms:.3g} | {quantity.worst:.3g}"
            print(f"| {section.name} | {quantity.name} | {quantity.unit} | {errors} | {met} |")
    print(f"\n{perf_counter() - began:.0f} s in all")
    if arguments.json:
        report = {"machine": machine, "quick": arguments.quick, "sections": [section.data() for section in sections]}
        arguments.json.write_text(json.dumps(report, indent=1), encoding="utf-8")


if __name__ == "__main__":
    main()
