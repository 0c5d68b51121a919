"""A population of users' situations: profiles, tracks, loads, positions and models at random, each result judged by an
oracle of its own: gaps of the undeformed surfaces, equilibrium, laws of contact and friction, mirror image, other
starts, the other model.

python -m benchmarks.population [--count N] [--seed S] [--processes P] [--only SEED ...] [--measured FOLDER] [--quick]
                                [--failures FILE] [--json FILE]

Situation k of seed S is drawn from the integer S + k. A failure is explained where the oracle confirms its reason. A
situation that raises anything but one clear message, or breaks a law, is wrong.
"""

from __future__ import annotations

import argparse
import json
import logging
import re
import sys
from collections import Counter, defaultdict
from collections.abc import Callable, Sequence
from contextlib import suppress
from dataclasses import asdict
from pathlib import Path
from time import perf_counter

import numpy as np
from rich.console import Console
from rich.progress import BarColumn, MofNCompleteColumn, Progress, TextColumn, TimeElapsedColumn, TimeRemainingColumn

from benchmarks.common.machine import machine_description
from benchmarks.population.draw import HEADER, SUFFIXES, situation
from benchmarks.population.judge import KINDS, Verdict, judged
from benchmarks.population.workers import Plan, verdicts

QUICK = 40  # situations
EXAMPLES = 3  # of a cluster


def run(seeds: Sequence[int], plan: Plan, kept: Callable[[Verdict], None] = lambda _: None) -> list[Verdict]:
    """Judges situations, with progress, in the order of their seeds; those judged so far at Ctrl-C.

    Parameters:
        seeds: of the situations.
        plan: of the work.
        kept: called with every verdict.
    """
    console, found, began = Console(stderr=True), list[Verdict](), perf_counter()
    columns = (TextColumn("{task.description}"), BarColumn(), MofNCompleteColumn(), TimeElapsedColumn())
    terminal = sys.stderr.isatty()
    with (
        Progress(*columns, TimeRemainingColumn(), console=console, disable=not terminal) as bar,
        suppress(KeyboardInterrupt),
    ):
        task = bar.add_task("situations", total=len(seeds))
        for verdict in verdicts(seeds, plan):
            found.append(verdict)
            kept(verdict)
            counts = Counter(v.kind for v in found)
            text = ", ".join(f"{counts[kind]} {kind}" for kind in KINDS)
            bar.update(task, advance=1, description=text)
            if not terminal and len(found) % 20 == 0:
                left = (perf_counter() - began) / len(found) * (len(seeds) - len(found))
                print(f"{len(found)} of {len(seeds)}: {text}, {left:.0f} s left", file=sys.stderr, flush=True)
    return sorted(found, key=lambda verdict: verdict.seed)


def cluster(verdict: Verdict) -> str:
    """Reason without its numbers and sides."""
    text = re.sub(r"/\S*/", "", verdict.reason)
    text = re.sub(r"[-+]?(\d+\.?\d*|\.\d+)(e[-+]?\d+)?|\binf\b|\bnan\b", "#", text)
    text = re.sub(r"\b(left|right)\b( wheel)?:? ?", "", text)
    text = re.sub(r", at y = [^;]*", "", text)
    return f"{verdict.model}: {'; '.join(dict.fromkeys(part.strip() for part in text.split(';')))[:200]}"


def show(found: Sequence[Verdict]) -> str:
    """Tables in Markdown."""
    models = sorted({verdict.model for verdict in found})
    lines = [f"| model | {' | '.join(KINDS)} | median s | worst s |", f"|{'---|' * (len(KINDS) + 3)}"]
    for model in [*models, "all"]:
        own = [v for v in found if model in ("all", v.model)]
        counts, seconds = Counter(v.kind for v in own), np.array([v.seconds[0] for v in own])
        numbers = " | ".join(str(counts[kind]) for kind in KINDS)
        lines.append(f"| {model} | {numbers} | {np.median(seconds):.2g} | {seconds.max():.3g} |")
    for kind in KINDS[:0:-1]:
        clusters = defaultdict(list)
        for verdict in found:
            if verdict.kind == kind:
                clusters[cluster(verdict)].append(verdict)
        lines += ["", f"## {kind}", ""]
        for name, own in sorted(clusters.items(), key=lambda item: -len(item[1])):
            seeds = ", ".join(str(v.seed) for v in own[:EXAMPLES])
            lines.append(f"- {len(own)} x {name} (seeds {seeds}{', ...' if len(own) > EXAMPLES else ''})")
        if not clusters:
            lines.append("- none")
    return "\n".join(lines)


def reproduction(verdict: Verdict) -> str:
    """A failure as a line of Python after its reason; empty for others."""
    if verdict.kind not in KINDS[2:]:
        return ""
    return f"\n# seed {verdict.seed}, {verdict.kind}: {' '.join(verdict.reason.split())}\n{verdict.line}\n"


def details(verdict: Verdict) -> str:
    """All about one situation."""
    sides = "\n".join(f"  {side}: {text}" for side, text in verdict.sides.items())
    seconds = f"{verdict.seconds[0]:.2f} s, {verdict.seconds[1]:.2f} s with its judgement"
    return f"{HEADER}{verdict.line}\n{sides}\n{verdict.kind}: {verdict.reason}\n{seconds}"


def main() -> None:
    """Judges and prints."""
    parser = argparse.ArgumentParser(prog="python -m benchmarks.population", description=__doc__)
    parser.add_argument("--count", type=int, default=2000, metavar="N", help="situations (2000)")
    parser.add_argument("--seed", type=int, default=0, metavar="S", help="of the first situation (0)")
    parser.add_argument("--processes", type=int, default=2, metavar="P", help="2")
    parser.add_argument(
        "--only", type=int, nargs="+", default=[], metavar="SEED", help="these situations, with details"
    )
    parser.add_argument("--measured", type=Path, metavar="FOLDER", help="of measured profiles (.whl, .prw, .ban, ...)")
    parser.add_argument(
        "--limit", type=float, default=120.0, metavar="S", help="processor time of a situation, s (120)"
    )
    parser.add_argument("--quick", action="store_true", help=f"{QUICK} situations, half-spaces and standard contact")
    parser.add_argument("--failures", type=Path, default=Path("population_failures.txt"), metavar="FILE")
    parser.add_argument("--json", type=Path, metavar="FILE", help="write all verdicts to a file")
    arguments = parser.parse_args()
    logging.disable(logging.WARNING)
    suffixes = {suffix for own in SUFFIXES.values() for suffix in own}
    files = sorted(arguments.measured.rglob("*")) if arguments.measured else []
    measured = tuple(file.resolve() for file in files if file.suffix.lower() in suffixes)
    if arguments.only:
        for seed in arguments.only:
            print(details(judged(situation(seed, measured, arguments.quick))), flush=True)
        return
    count = min(arguments.count, QUICK) if arguments.quick else arguments.count
    plan = Plan(arguments.processes, arguments.limit, measured, arguments.quick)
    machine, began = machine_description(), perf_counter()
    with arguments.failures.open("w", encoding="utf-8", buffering=1) as file:
        file.write(HEADER)
        found = run(
            range(arguments.seed, arguments.seed + count),
            plan,
            lambda verdict: print(reproduction(verdict), end="", file=file),
        )
    print(
        f"{machine}; {count} situations from seed {arguments.seed} in {perf_counter() - began:.0f} s\n\n{show(found)}"
    )
    print(f"\nreproductions in {arguments.failures}")
    if arguments.json:
        report = {"machine": machine, "seed": arguments.seed, "verdicts": [asdict(verdict) for verdict in found]}
        arguments.json.write_text(json.dumps(report, indent=1) + "\n", encoding="utf-8")


if __name__ == "__main__":
    main()
