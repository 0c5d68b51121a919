"""Time and error of a vehicle in three dimensions: curve, hunting and irregular rails, standard and elastic contact.

python -m benchmarks.vehicle_runs [--scene NAME ...] [--contact standard|elastic ...] [--resolution 8x10 ...]
                                  [--seconds T] [--quick]

Wall time per simulated second of whole runs without reading, meshes, compilation and output rows; two threads solve
the contacts of elastic wheels. Errors, RMS / maximum over all wheelsets and 10 ms of time each,
are differences to a run with a tenth of the tolerances and, of elastic contact, to one with 12 x 16 strips and cells.
"""

from __future__ import annotations

import argparse
from dataclasses import dataclass, replace
from pathlib import Path
from time import perf_counter

import numpy as np
from rich.console import Console

from benchmarks.common.machine import machine_description
from benchmarks.common.models import lattice_resolution
from benchmarks.paper.tables import markdown
from wheelrail.contact.models.lattice.resolution import LatticeResolution
from wheelrail.contact.models.wheelset import WheelsetContact
from wheelrail.scenes.builders.vehicle_file import MANCHESTER
from wheelrail.scenes.builders.wheelset import wheelset_contact
from wheelrail.scenes.runs.run import simulate_on_track, vehicle_for_run
from wheelrail.scenes.schema.scene import RunScene, checked
from wheelrail.scenes.schema.toml import parse, read_text
from wheelrail.vehicle.multibody.coordinates import Y
from wheelrail.vehicle.simulation.history import History
from wheelrail.vehicle.simulation.parallel_contact import in_threads
from wheelrail.vehicle.simulation.time_run import Recording
from wheelrail.vehicle.track.speed_profile import SpeedProfile

SCENES = {"curve": "vehicle.toml", "hunting": "hunting.toml", "irregular": "vehicle_irregular.toml"}
CONTACTS: dict[str, dict[str, object]] = {
    "standard": {"model": "standard"},
    "elastic": {"model": "condensed", "laws": "exact", "surface_size": 1e-3},
}
USUAL, FINER = LatticeResolution(8, 10), LatticeResolution(12, 16)
EVERY = 0.01  # s, between the rows that are compared
HEAD = (
    "run|contact|threads|wall s per s|steps per s (rejected)|contact problems a side|threads in contacts"
    "|y mm, tight|wheel force %, tight|y mm, finer|wheel force %, finer"
)


@dataclass(frozen=True)
class TimedRun:
    """Wall time s of a run and its history."""

    seconds: float
    history: History


def loaded(name: str, contact: str) -> RunScene:
    """Scene of a run with a contact."""
    path = Path(__file__).parents[1] / "scenes" / SCENES[name]
    scene = checked({**parse(read_text(path), path), **CONTACTS[contact]}, path)
    assert isinstance(scene, RunScene)
    return scene


def timed(
    scene: RunScene, contact: WheelsetContact, threads: int, end: float, *, tolerance: float = 1.0, rows: bool = False
) -> TimedRun:
    """A run until a time s, with a multiple of the tolerances; with rows for comparison or without any but the ends."""
    solver = scene.solver.model_copy(
        update={"rtol": tolerance * scene.solver.rtol, "atol": tolerance * scene.solver.atol}
    )
    scene = scene.model_copy(update={"solver": solver})
    recording = Recording(EVERY if rows else end)
    vehicle = vehicle_for_run(scene, MANCHESTER)
    with in_threads(contact, threads) as wheels:
        start = perf_counter()
        history = simulate_on_track(scene, vehicle, wheels, end, recording, lambda *_: None)
        return TimedRun(perf_counter() - start, history)


def difference(own: History, reference: History) -> list[str]:
    """RMS / maximum of the difference of lateral displacements, mm, and vertical wheel forces, % of their mean."""
    n = min(len(own), len(reference))
    lateral = 1e3 * np.array(
        [own.coordinate(name, Y)[:n] - reference.coordinate(name, Y)[:n] for name in own.dynamics.vehicle.wheelsets]
    )
    vertical, mean = own.force[:n, ..., 2] - reference.force[:n, ..., 2], reference.force[:n, ..., 2].mean()
    return [
        f"{np.sqrt(np.mean(np.square(error))):.3f} / {np.abs(error).max():.3f}"
        for error in (lateral, 100.0 * vertical / mean)
    ]


def with_resolution(contact: WheelsetContact, resolution: LatticeResolution) -> WheelsetContact:
    """The contact on other strips and cells."""
    return replace(contact, model=replace(contact.model, resolution=resolution))  # type: ignore[type-var]


def row(
    name: str, kind: str, resolution: LatticeResolution, *, seconds: float | None, quick: bool, console: Console
) -> list[str]:
    """One line of the table.

    Parameters:
        name: of the scene.
        kind: of the contact.
        resolution: of elastic contact.
        seconds: of the run; None: all of the scene.
        quick: whether errors are left out.
        console: for progress.
    """
    scene = loaded(name, kind)
    contact, threads, label = wheelset_contact(scene), 1, kind
    if kind == "elastic":
        contact, threads = with_resolution(contact, resolution), 2
        label = f"elastic, {resolution.strips} x {resolution.cells}"
    end = seconds or SpeedProfile.of(scene.vehicle.speed_profile).time_at(scene.track.length)
    with console.status(f"{name}, {label}"):
        run = timed(scene, contact, threads, end)
    history, cost = run.history, run.history.cost
    span = float(history.time[-1])
    line = [
        name if history.status == "completed" else f"{name}: {history.status}",
        label,
        str(threads),
        f"{run.seconds / span:.3f}",
        f"{cost.steps.accepted / span:.0f} ({cost.steps.rejected / span:.0f})",
        str(max(side.solves for side in cost.contact.values())),
        f"{sum(side.seconds for side in cost.contact.values()) / cost.seconds:.2f}",
    ]
    console.print(" ".join(line), markup=False)
    if quick:
        return [*line, "", "", "", ""]
    with console.status(f"{name}, {label}: rows"):
        own = timed(scene, contact, threads, end, rows=True).history
    with console.status(f"{name}, {label}: a tenth of the tolerances"):
        tight = timed(scene, contact, threads, end, tolerance=0.1, rows=True).history
    line += difference(own, tight)
    if kind != "elastic":
        return [*line, "", ""]
    fine = with_resolution(contact, FINER)
    with console.status(f"{name}, {label}: finer cells"):
        finer = timed(scene, fine, threads, end, rows=True).history
    return line + difference(own, finer)


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--scene", nargs="+", choices=SCENES, default=list(SCENES))
    parser.add_argument("--contact", nargs="+", choices=CONTACTS, default=list(CONTACTS))
    parser.add_argument("--resolution", type=lattice_resolution, nargs="+", default=[USUAL], metavar="STRIPSxCELLS")
    parser.add_argument("--seconds", type=float, default=None, help="length of the runs; default: all of the scenes")
    parser.add_argument("--quick", action="store_true", help="times only, without errors")
    arguments = parser.parse_args()
    console = Console(stderr=True)
    lines = [
        row(name, kind, resolution, seconds=arguments.seconds, quick=arguments.quick, console=console)
        for kind in arguments.contact
        for name in arguments.scene
        for resolution in (arguments.resolution if kind == "elastic" else [USUAL])
    ]
    print(machine_description(), "\n")
    print(markdown(HEAD, lines))


if __name__ == "__main__":
    main()
