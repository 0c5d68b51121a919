"""Accuracy and wall time with exact laws: 10 s of the paper's curve and 2.2 s on irregular rails, tables and figure.

`python -m benchmarks.curve [--only curve] [--seconds S] [--quick] [--picture FILE] [--json FILE]`. Every run is
compared with one at a tight tolerance, and with one of finer strips and cells.
"""

from __future__ import annotations

import argparse
import json
from dataclasses import dataclass, replace
from pathlib import Path
from time import perf_counter, process_time

import numpy as np
from rich.console import Console

from benchmarks.common.machine import machine_description
from wheelrail.contact.kinematics.frames import SIDES
from wheelrail.contact.models.lattice.model import LatticeContact
from wheelrail.contact.models.lattice.resolution import LatticeResolution
from wheelrail.contact.models.wheelset import WheelsetContact
from wheelrail.scenes.builders.vehicle import wagon
from wheelrail.scenes.builders.wheelset import wheelset_contact
from wheelrail.scenes.schema.scene import RunScene, load_scene
from wheelrail.support.arrays import Array
from wheelrail.vehicle.integration.integrate import StepSettings
from wheelrail.vehicle.multibody.plane_wagon import wagon_dynamics
from wheelrail.vehicle.simulation.history import History
from wheelrail.vehicle.simulation.parallel_contact import in_threads
from wheelrail.vehicle.simulation.simulate import simulate
from wheelrail.vehicle.simulation.time_run import Recording

SCENES = Path(__file__).parents[1] / "scenes"
TRANSIENT_END = 0.1  # s, end of the initial transient


@dataclass(frozen=True)
class CurveVariant:
    """Strips and cells of the contact, tolerance of the integrator over that of the scene, number of threads."""

    name: str
    fineness: tuple[int, int]
    tolerance: float
    workers: int = 2
    method: str = "rosenbrock"


VARIANTS = (
    CurveVariant("the scene", (6, 10), 1.0),
    CurveVariant("one thread", (6, 10), 1.0, workers=1),
    CurveVariant("tighter", (6, 10), 1 / 3, workers=1),
    CurveVariant("4 x 6 cells", (4, 6), 1.0, workers=1),
    CurveVariant("4 x 10 cells", (4, 10), 1.0, workers=1),
    CurveVariant("8 x 10 cells", (8, 10), 1.0, workers=1),
    CurveVariant("14 x 12 cells", (14, 12), 1.0, workers=1),
)
TIGHT = CurveVariant("tight tolerance", (6, 10), 1 / 30)


@dataclass(frozen=True)
class CurveCase:
    """A scene, the length of its run s, and the strips and cells and tolerance of the finer run."""

    scene: str
    seconds: float
    fine: CurveVariant


CASES = (
    CurveCase("curve", 10.0, CurveVariant("finer cells", (18, 16), 1 / 3)),
    CurveCase("irregular", 2.2, CurveVariant("finer cells", (12, 14), 1 / 3)),
)


@dataclass(frozen=True)
class TimedRun:
    """A variant with its history, wall time s, and processor time s of this process."""

    variant: CurveVariant
    history: History
    seconds: float
    processor: float

    def channels(self) -> tuple[Array, Array]:
        """Lateral displacement (n,) mm and forces (n, 6) N of both wheels, after the initial transient."""
        selected = self.history.time > TRANSIENT_END
        return 1e3 * self.history.state[selected, 6], self.history.force[selected, 0].reshape(-1, 6)


def run(scene: RunScene, contact: WheelsetContact, variant: CurveVariant, seconds: float) -> TimedRun:
    """Runs the first seconds of the scene with prepared bodies."""
    assert isinstance(contact.model, LatticeContact)
    model = replace(contact.model, resolution=LatticeResolution(*variant.fineness))
    tuned = replace(contact, model=model)
    with in_threads(tuned, variant.workers) as parallel:
        began, used = perf_counter(), process_time()
        history = simulate(
            wagon_dynamics(wagon(scene), scene.track.track(), parallel, scene.vehicle.speed_profile),
            (0.0, seconds),
            steps=StepSettings(
                variant.method, variant.tolerance * scene.solver.rtol, variant.tolerance * scene.solver.atol
            ),
            recording=Recording(scene.output.interval),
        )
        return TimedRun(variant, history, perf_counter() - began, process_time() - used)


def differences(tested: TimedRun, reference: TimedRun) -> tuple[float, float, float, float]:
    """RMS and largest difference of the lateral displacement, mm, and of the forces, % of the mean wheel load."""
    (y, forces), (y0, forces0) = tested.channels(), reference.channels()
    n = min(len(y), len(y0))
    lateral, force = y[:n] - y0[:n], forces[:n] - forces0[:n]
    load = 0.5 * forces0[:n, [2, 5]].sum(axis=1).mean()
    rms = np.sqrt((force**2).mean(axis=0)).max()  # of the worst of the six
    return (
        float(np.sqrt((lateral**2).mean())),
        float(np.abs(lateral).max()),
        float(100 * rms / load),
        float(100 * np.abs(force).max() / load),
    )


COLUMNS = (
    "run",
    "cells",
    "tolerance over the scene's",
    "threads",
    "wall s",
    "processor s",
    "steps (rejected)",
    "contact problems a side",
    "ms a problem, left / right",
    "y RMS / worst mm, tight",
    "force RMS / worst %, tight",
    "y RMS / worst mm, finer cells",
    "force RMS / worst %, finer cells",
)


def row(timed_run: TimedRun, tight: TimedRun, fine: TimedRun) -> list[str]:
    cost, v = timed_run.history.cost, timed_run.variant
    deviations = []
    for reference in (tight, fine):
        d = differences(timed_run, reference)
        deviations += ["", ""] if timed_run is reference else [f"{d[0]:.4f} / {d[1]:.3f}", f"{d[2]:.3f} / {d[3]:.2f}"]
    sides = [cost.contact[side] for side in SIDES]
    spent = [1e3 * sum(side.phases.values()) / side.solves for side in sides]
    return [
        v.name if timed_run.history.status == "completed" else f"{v.name}: {timed_run.history.status}",
        "{} x {}".format(*v.fineness),
        f"{v.tolerance:.2g}",
        str(v.workers),
        f"{timed_run.seconds:.1f}",
        f"{timed_run.processor:.1f}",
        f"{cost.steps.accepted} ({cost.steps.rejected})",
        str(sides[0].solves),
        "{:.1f} / {:.1f}".format(*spent),
        *deviations,
    ]


def draw(runs: list[TimedRun], tight: TimedRun, fine: TimedRun, path: Path) -> None:
    """Lateral displacement and vertical forces of the first and the reference run; error over time of all runs."""
    import matplotlib

    matplotlib.use("Agg")
    import matplotlib.pyplot as plt

    fig, (left, middle, right) = plt.subplots(1, 3, figsize=(14, 4), layout="constrained")
    for timed_run, style in ((fine, "k-"), (runs[0], "C1--")):
        time = timed_run.history.time
        label = "{} x {} cells, tolerance {:.2g}".format(*timed_run.variant.fineness, timed_run.variant.tolerance)
        left.plot(time, 1e3 * timed_run.history.state[:, 6], style, lw=1.2, label=label)
        for side in (0, 1):
            middle.plot(time, 1e-3 * timed_run.history.force[:, 0, side, 2], style, lw=1.2)
    left.set(xlabel="time [s]", ylabel="lateral displacement, to the left [mm]")
    middle.set(xlabel="time [s]", ylabel="vertical forces, left falls, right rises [kN]")
    left.legend(frameon=False)
    for reference, marker, label in ((tight, "o", "tight tolerance"), (fine, "s", "finer cells")):
        points = [(timed_run.seconds, differences(timed_run, reference)[2]) for timed_run in runs]
        right.loglog(*zip(*points, strict=True), marker, label=f"against {label}")
    right.axhline(0.5, color="0.6", lw=0.8)
    right.axvline(10.0, color="0.6", lw=0.8)
    right.set(xlabel="wall time of 10 s [s]", ylabel="RMS error, worst force [% of load]")
    right.legend(frameon=False)
    for ax in (left, middle, right):
        ax.grid(alpha=0.3)
    fig.savefig(path, dpi=130)


def measured(case: CurveCase, seconds: float, quick: bool, console: Console) -> list[TimedRun]:
    """Runs of a scene: at a tight tolerance, with finer strips and cells, and all variants."""
    scene = load_scene(SCENES / f"{case.scene}.toml")
    assert isinstance(scene, RunScene)
    contact = wheelset_contact(scene)
    run(scene, contact, VARIANTS[0], 0.02)  # compilation and compliance
    runs: list[TimedRun] = []
    for variant in (TIGHT, VARIANTS[0]) if quick else (case.fine, TIGHT, *VARIANTS):
        name = f"{case.scene}, {variant.name}"
        with console.status(f"{name}, {variant.fineness[0]} x {variant.fineness[1]} cells"):
            runs.append(run(scene, contact, variant, seconds))
        console.print(f"{name}: {runs[-1].seconds:.1f} s, {runs[-1].history.status}")
    return runs


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--only", choices=[case.scene for case in CASES], help="one scene alone")
    parser.add_argument("--seconds", type=float, help="length of the runs, at most (10 and 2.2)")
    parser.add_argument("--quick", action="store_true", help="only the unchanged scene and the run at tight tolerance")
    parser.add_argument("--picture", type=Path, help="file for the figure of the curve")
    parser.add_argument("--json", type=Path, help="file for the tables' rows")
    arguments = parser.parse_args()
    console, tables = Console(stderr=True), dict[str, list[dict[str, str]]]()
    print(machine_description())
    for case in CASES:
        if arguments.only not in (None, case.scene):
            continue
        seconds = min(arguments.seconds or case.seconds, case.seconds)
        runs = measured(case, seconds, arguments.quick, console)
        fine, tight = runs[0], runs[0 if arguments.quick else 1]
        rows = [row(timed_run, tight, fine) for timed_run in runs]
        print(f"\n{seconds:g} s of scenes/{case.scene}.toml; preparation excluded; forces in % of the load\n")
        print(f"| {' | '.join(COLUMNS)} |\n|{'---|' * len(COLUMNS)}")
        for cells in rows:
            print(f"| {' | '.join(cells)} |")
        tables[case.scene] = [dict(zip(COLUMNS, cells, strict=True)) for cells in rows]
        if arguments.picture and case is CASES[0]:
            draw(runs[2:] or runs[1:], tight, fine, arguments.picture)
    if arguments.json:
        arguments.json.write_text(json.dumps(tables, indent=1))


if __name__ == "__main__":
    main()
