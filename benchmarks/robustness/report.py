"""Runs at the limits and beyond: high speed, low friction, irregular track, wheel lift, overturning. No error may
remain undetected.
"""

from __future__ import annotations

import argparse
import json
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from time import process_time

from rich.console import Console

from benchmarks.common.machine import machine_description
from benchmarks.robustness.cases import ELASTIC, RobustnessCase, cases, contact_of, scene
from benchmarks.robustness.diagnostics import APART, Findings, run_differences
from wheelrail.scenes.builders.vehicle import wagon
from wheelrail.vehicle.integration.integrate import StepSettings
from wheelrail.vehicle.multibody.plane_wagon import wagon_dynamics
from wheelrail.vehicle.simulation.history import History
from wheelrail.vehicle.simulation.simulate import simulate

RTOL = 3e-3
PATIENCE = 300.0  # s, limit of the processor time of a run


@dataclass(frozen=True)
class Done:
    """A case with its history, findings, processor time s, and difference from a run at tighter tolerances."""

    case: RobustnessCase
    history: History
    findings: Findings
    seconds: float
    differences: dict[str, float]

    @property
    def sane(self) -> bool:
        return not self.findings.wrong and all(self.differences.get(name, 0.0) <= APART[name] for name in APART)


def run(case: RobustnessCase, rtol: float = RTOL) -> History:
    """Run with rows at accepted steps, in one process; interrupted at the time limit."""
    deadline = process_time() + PATIENCE * RTOL / rtol

    def watch(fraction: float, figures: Mapping[str, float]) -> None:
        if process_time() > deadline:
            raise KeyboardInterrupt

    contact, vehicle = contact_of(case.model, case.friction), wagon(scene(case.model, case.friction))
    return simulate(
        wagon_dynamics(vehicle, case.track(), contact, case.speed),
        case.span,
        initial=case.start(vehicle, contact),
        steps=StepSettings("rosenbrock", rtol, 1e-3 * rtol),
        progress=watch,
    )


def examined(case: RobustnessCase) -> Done:
    """Runs a case, and repeats it at tighter tolerances if required."""
    began = process_time()
    history = run(case)
    seconds = process_time() - began
    findings = Findings.of(history, wagon(scene(case.model, case.friction)), case.track())
    return Done(case, history, findings, seconds, run_differences(history, run(case, 0.1 * RTOL)) if case.again else {})


def row(done: Done) -> dict[str, str]:
    case, f, steps = done.case, done.findings, done.history.cost.steps
    d = done.differences
    return {
        "run": case.name if case.seed is None else f"{case.name}, seed {case.seed}",
        "contact": case.model,
        "m/s": f"{case.speed:g}",
        "mu": case.mu,
        "radius m": f"{case.radius:g}",
        "status": done.history.status.removeprefix("failed: ").replace("interrupted", "stopped, too slow"),
        "m": f"{f.metres:.1f}",
        "steps (rejected, failed)": f"{steps.accepted} ({steps.rejected}, {steps.failed})",
        "processor s": f"{done.seconds:.1f}",
        "least load kN": f"{1e-3 * f.load:.1f}",
        "Y/Q": f"{f.ratio:.2f}",
        "in the air s": f"{f.off:.3f}",
        "|y| mm": f"{1e3 * f.aside:.1f}",
        "roll mrad": f"{1e3 * f.roll:.0f}",
        "energy %": f"{100 * f.energy:.1f}",
        "tighter: y mm, roll mrad, end %": f"{1e3 * d['y']:.3f}, {1e3 * d['roll']:.3f}, {100 * d['end']:.2f}"
        if d
        else "",
        "sane": "yes" if done.sane else f"NO {f.wrong}",
    }


def draw(runs: list[Done], path: Path) -> None:
    """Wheel loads of a run with wheel lift, of an overturning one and of one on irregular track, for each contact
    model.
    """
    import matplotlib

    matplotlib.use("Agg")
    import matplotlib.pyplot as plt

    names = ("wheel lifted, landed", "overturning", "irregular")
    fig, axes = plt.subplots(1, len(names), figsize=(14, 4), layout="constrained")
    for ax, name in zip(axes, names, strict=True):
        for model, style in (("standard", "-"), (ELASTIC, "--")):
            for done in [d for d in runs if (d.case.name, d.case.model) == (name, model)][:1]:
                h = done.history
                for side, colour in ((0, "C0"), (1, "C1")):
                    label = f"{('left', 'right')[side]}, {model}"
                    ax.plot(h.time, 1e-3 * h.force[:, 0, side, 2], style, color=colour, lw=1, label=label)
        ax.set(title=name, xlabel="time [s]", ylabel="wheel load [kN]")
        ax.grid(alpha=0.3)
    axes[1].set_ylim(-10.0, 250.0)
    axes[0].legend(frameon=False)
    fig.savefig(path, dpi=130)


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--quick", action="store_true", help="inexpensive cases only")
    parser.add_argument("--only", help="runs with this in their name")
    parser.add_argument("--picture", type=Path, help="file for the figure")
    parser.add_argument("--json", type=Path, help="file for the table's rows")
    arguments = parser.parse_args()
    chosen = [c for c in cases() if (c.quick or not arguments.quick) and (arguments.only or "") in c.name]
    console, runs, began = Console(stderr=True), [], process_time()
    for case in chosen:
        with console.status(f"{case.name}, {case.model}"):
            runs.append(examined(case))
        text = f"{case.name}, {case.model}, {case.speed:g} m/s, mu {case.mu}: {runs[-1].seconds:.1f} s"
        console.print(f"{text}, {runs[-1].history.status}", highlight=False)
    rows = [row(done) for done in runs]
    print(f"{machine_description()}; {process_time() - began:.0f} s of processor time in all\n")
    print(f"| {' | '.join(rows[0])} |\n|{'---|' * len(rows[0])}")
    for cells in rows:
        print(f"| {' | '.join(cells.values())} |")
    print(f"\n{sum(done.sane for done in runs)} of {len(runs)} runs are sane")
    if arguments.json:
        arguments.json.write_text(json.dumps(rows, indent=1) + "\n", encoding="utf-8")
    if arguments.picture:
        draw(runs, arguments.picture)


if __name__ == "__main__":
    main()
