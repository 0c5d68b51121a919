"""Random ellipses that roll, on strips of half-spaces: failed solves, and errors against cells twice as fine.

python -m benchmarks.ellipses [--cases N] [--seed S] [--resolution 4x10 ...] [--log FILE] [--only NUMBER ...]

A log has one line of JSON per case. A run that finds its log there solves only the cases that are missing from it.
"""

from __future__ import annotations

import argparse
import json
import logging
from collections import Counter
from collections.abc import Iterator, Sequence
from dataclasses import asdict, dataclass
from pathlib import Path
from time import perf_counter
from typing import Any

import numpy as np

from benchmarks.common.machine import machine_description
from benchmarks.common.models import hertz_model, lattice_resolution, rolling
from benchmarks.ellipses.sample import RollingEllipse, rolling_ellipse
from wheelrail.contact.loading.hertz import hertz_pose
from wheelrail.contact.models.lattice.resolution import LatticeResolution
from wheelrail.contact.results.result import ContactResult

FINE = 20  # every so many cases are compared with strips and cells twice as fine
ACROSS = 16  # lines of the surface over the short axis; half-spaces are exact, whatever their lines
CONVERGED = "converged"


@dataclass(frozen=True)
class EllipseOutcome:
    """Status of a solve, its Newton iterations and seconds; for some cases the status of the finer solve and the
    largest difference of (Fx, Fy) over mu F_n, and of F_n over the load.
    """

    number: int
    strips: int
    cells: int
    seed: int
    status: str
    newton: int
    seconds: float
    fine: str = ""
    creep_force: float = np.nan
    normal_force: float = np.nan

    @property
    def failed(self) -> bool:
        """Whether this solve or the finer one has no result."""
        return self.status != CONVERGED or self.fine not in ("", CONVERGED)


def solve(case: RollingEllipse, resolution: LatticeResolution) -> ContactResult:
    """The case at Hertz's approach; an exception is a failure with its message."""
    how = {"bodies": "half-space", "strips": resolution.strips, "cells": resolution.cells}
    motion = rolling(*case.creepages, speed=case.speed)
    try:
        model = hertz_model(case.pair, case.laws, case.pair.size(across=ACROSS), **how)
        result: ContactResult = model(hertz_pose(case.pair.exact.approach), motion, None)
    except Exception as error:
        return ContactResult.failed(f"{type(error).__name__}: {error}")
    return result


def outcome(case: RollingEllipse, seed: int, resolution: LatticeResolution, *, fine: bool) -> EllipseOutcome:
    """Solves a case, and on request the finer one."""
    start = perf_counter()
    result = solve(case, resolution)
    seconds = perf_counter() - start
    solved: dict[str, Any] = {
        "number": case.number,
        **asdict(resolution),
        "seed": seed,
        "status": result.status,
        "newton": result.statistics.newton,
        "seconds": seconds,
    }
    if not (fine and result.ok):
        return EllipseOutcome(**solved)
    finer = solve(case, LatticeResolution(2 * resolution.strips, 2 * resolution.cells))
    if not finer.ok:
        return EllipseOutcome(**solved, fine=finer.status)
    difference = np.abs(result.force - finer.force)
    bound = max(case.friction.mu * case.pair.load, 1e-300)
    return EllipseOutcome(
        **solved,
        fine=finer.status,
        creep_force=float(difference[:2].max() / bound),
        normal_force=float(difference[2] / case.pair.load),
    )


def logged(path: Path) -> Iterator[EllipseOutcome]:
    """Outcomes of a log. A last line that was not finished is cut off."""
    if not path.exists():
        return
    text = path.read_text(encoding="utf-8")
    finished = text[: text.rfind("\n") + 1]
    if finished != text:
        path.write_text(finished, encoding="utf-8")
    for line in finished.splitlines():
        yield EllipseOutcome(**json.loads(line))


def run(numbers: Sequence[int], seed: int, resolution: LatticeResolution, log: Path | None) -> list[EllipseOutcome]:
    """Outcomes of the cases of some numbers, of the log where it has them."""
    wanted = set(numbers)
    outcomes = {
        earlier.number: earlier
        for earlier in (logged(log) if log else ())
        if (earlier.seed, earlier.strips, earlier.cells) == (seed, resolution.strips, resolution.cells)
        and earlier.number in wanted
    }
    for number in numbers:
        if number in outcomes:
            continue
        case = rolling_ellipse(seed, number)
        outcomes[number] = outcome(case, seed, resolution, fine=number % FINE == 0)
        if log:
            with log.open("a", encoding="utf-8") as stream:
                stream.write(json.dumps(asdict(outcomes[number])) + "\n")
    return [outcomes[number] for number in numbers]


def show(outcomes: Sequence[EllipseOutcome]) -> str:
    """Summary of one resolution in Markdown."""
    failures = [o for o in outcomes if o.failed]
    newton, seconds = np.array([o.newton for o in outcomes]), np.array([o.seconds for o in outcomes])
    lines = [
        f"\n## {outcomes[0].strips} x {outcomes[0].cells}: {len(outcomes)} ellipses, {len(failures)} failed\n",
        f"- Newton iterations: median {np.median(newton):g}, 99 % {np.quantile(newton, 0.99):g}, most {newton.max()}",
        f"- seconds: median {np.median(seconds):.3f}, 99 % {np.quantile(seconds, 0.99):.3f}, most {seconds.max():.2f}",
    ]
    for name, unit in (("creep_force", "mu F_n"), ("normal_force", "F_n")):
        values = np.array([getattr(o, name) for o in outcomes if o.fine == CONVERGED])
        if len(values):
            lines.append(
                f"- {name.replace('_', ' ')} against cells twice as fine, % of {unit}: {len(values)} cases, "
                f"RMS {100 * np.sqrt(np.mean(values**2)):.3f}, worst {100 * values.max():.3f}"
            )
    for reason, count in Counter((o.status if o.status != CONVERGED else o.fine)[:80] for o in failures).most_common():
        lines.append(f"- {count} x {reason}")
    return "\n".join([*lines, *(f"- {rolling_ellipse(o.seed, o.number)}" for o in failures)])


def main() -> None:
    """Measures and prints."""
    parser = argparse.ArgumentParser(
        prog="python -m benchmarks.ellipses",
        description=__doc__,
        formatter_class=argparse.RawDescriptionHelpFormatter,
    )
    default = [LatticeResolution(4, 10), LatticeResolution(6, 12), LatticeResolution()]
    parser.add_argument("--cases", type=int, default=20000, metavar="N", help="of each resolution (20000)")
    parser.add_argument("--seed", type=int, default=0, metavar="S", help="of the cases (0)")
    parser.add_argument("--resolution", type=lattice_resolution, nargs="+", default=default, metavar="STRIPSxCELLS")
    parser.add_argument("--only", type=int, nargs="*", default=[], metavar="NUMBER", help="these cases of all")
    parser.add_argument("--log", type=Path, metavar="FILE", help="one line per case; continued where it exists")
    arguments = parser.parse_args()
    logging.disable(logging.WARNING)
    print(machine_description(), flush=True)
    numbers = arguments.only or range(arguments.cases)
    for resolution in arguments.resolution:
        print(show(run(numbers, arguments.seed, resolution, arguments.log)), flush=True)
