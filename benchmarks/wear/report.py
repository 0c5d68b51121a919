"""Wear of profiles against closed forms and identities: check, figure, tolerance, pass.

    python -m benchmarks.wear [NUMBER ...] [--json FILE]
    python -m benchmarks.wear --duty KM [--contact NAME] [--depth M]
    python -m benchmarks.wear --resolutions KM

Numbers choose checks; the second form times the wear of a duty, step by step; the third compares strips, cells, steps.
"""

from __future__ import annotations

import argparse
import json
import logging
import sys
from collections.abc import Callable, Iterator, Mapping
from dataclasses import asdict
from pathlib import Path

from benchmarks.common.machine import machine_description
from benchmarks.wear import contact, loop, removal, steps
from benchmarks.wear.check import Check

CHECKS: Mapping[int, Callable[[], Iterator[Check]]] = {
    1: contact.full_sliding,
    2: contact.identity,
    3: contact.rolling_cylinder,
    4: contact.energy,
    5: removal.removed_volume,
    6: removal.ripples,
    7: steps.steps,
    8: loop.hands,
    9: contact.mild_wear,
    10: removal.measures,
    11: loop.resumed,
    12: contact.models_agree,
}


def main() -> None:
    """Run the checks and print them."""
    parser = argparse.ArgumentParser(prog="python -m benchmarks.wear", description=__doc__)
    parser.add_argument("numbers", nargs="*", type=int, metavar="NUMBER", help=f"of {', '.join(map(str, CHECKS))}")
    parser.add_argument("--json", type=Path, metavar="FILE", help="write all figures to a file")
    parser.add_argument("--duty", type=float, metavar="KM", help="time the wear of a duty over a distance")
    parser.add_argument(
        "--resolutions", type=float, metavar="KM", help="compare strips, cells and steps in four curves"
    )
    parser.add_argument("--contact", default="condensed", metavar="NAME", help="of the duty: standard or condensed")
    parser.add_argument("--depth", type=float, default=1e-4, metavar="M", help="largest of a step of the duty")
    parser.add_argument("--processes", type=int, default=1, metavar="N", help="that solve the cases of the duty")
    arguments = parser.parse_args()
    if unknown := set(arguments.numbers) - set(CHECKS):
        parser.error(f"no check {min(unknown)}; there are {', '.join(map(str, CHECKS))}")
    logging.disable(logging.WARNING)
    print(machine_description())
    if arguments.resolutions is not None:
        loop.resolutions(1e3 * arguments.resolutions)
        return
    if arguments.duty is not None:
        standard = {"scene": loop.FILES["scene"], "contact": {}} if arguments.contact == "standard" else {}
        loop.duty(1e3 * arguments.duty, arguments.processes, depth=arguments.depth, **standard)
        return
    print("\n| check | figure | tolerance | pass |\n|---|---|---|---|", flush=True)
    checks = []
    for number in arguments.numbers or CHECKS:
        for check in CHECKS[number]():
            checks.append(check)
            print(f"| {number}: {check.row}", flush=True)
    if arguments.json:
        arguments.json.write_text(json.dumps([asdict(check) for check in checks], indent=1), encoding="utf-8")
    sys.exit(not all(check.passed for check in checks))


if __name__ == "__main__":
    main()
