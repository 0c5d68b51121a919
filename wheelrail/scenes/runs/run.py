"""Vehicle run of a scene: contact model, simulation with progress, results and figures on disk."""

from __future__ import annotations

import json
import signal
from collections.abc import Iterator
from contextlib import AbstractContextManager, contextmanager, nullcontext
from dataclasses import dataclass
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING

from wheelrail.scenes.builders.vehicle import track, wagon
from wheelrail.scenes.builders.wheelset import wheelset_contact
from wheelrail.scenes.runs.files import CHECKPOINTS, RESULTS
from wheelrail.scenes.runs.progress import costs, progress_bar
from wheelrail.scenes.schema.scene import RunScene

if TYPE_CHECKING:
    from rich.console import Console, RenderableType
    from xarray import Dataset

    from wheelrail.contact.results.vehicle_contact import VehicleContact
    from wheelrail.scenes.runs.checkpoint_file import CheckpointFile
    from wheelrail.vehicle.simulation.checkpoint import Checkpoint
    from wheelrail.vehicle.simulation.history import History


@dataclass(frozen=True)
class RunOutcome:
    """Outcome of a run.

    Parameters:
        history: of the run.
        files: written files.
        resumable: whether the run was interrupted after a checkpoint.
    """

    history: History
    files: tuple[Path, ...]
    resumable: bool = False

    @property
    def status(self) -> str:
        return self.history.status

    def summary(self) -> list[RenderableType]:
        """Solver statistics by side, status and files."""
        reached = f" at {self.history.distance[-1]:.1f} m" if len(self.history) else " before the first step"
        lines = [f"{self.status}{reached}", *(f"  {file}" for file in self.files)]
        if self.resumable:
            lines.append("  --resume continues the run from its last checkpoint")
        return [costs(self.history), "\n".join(lines)]


def run_scene(
    scene: RunScene,
    text: str,
    folder: Path,
    console: Console,
    *,
    resume: bool = False,
    checkpoints: Path | None = None,
) -> RunOutcome:
    """Simulate a scene and write its results.

    Parameters:
        scene: to simulate.
        text: of the scene file, stored with the results.
        folder: for the results.
        console: for progress.
        resume: whether to continue from the last checkpoint.
        checkpoints: checkpoint file; one in the folder by default.

    Results of an interrupted or failed run are written up to its end; the checkpoint file remains unless the run is
    complete. Raises OSError if the folder cannot be written, SceneError for checkpoints of another scene.
    """
    from wheelrail.scenes.runs.checkpoint_file import CheckpointFile, read_header
    from wheelrail.scenes.runs.resume import header, latest

    folder.mkdir(parents=True, exist_ok=True)
    report = partial(console.print, highlight=False, markup=False, soft_wrap=True)
    checkpoint_file = CheckpointFile(checkpoints or folder / CHECKPOINTS, header(scene), report)
    if not resume and read_header(checkpoint_file.path):
        console.print(
            f"{folder} contains an interrupted run; this run starts from the beginning, --resume continues it"
        )
    start = latest(checkpoint_file, checkpoint_file.report) if resume else None
    history = _simulated(scene, console, checkpoint_file, start)
    if not len(history):
        return RunOutcome(history, ())
    with console.status("results and figures"):
        files = tuple(write_results(history, text, folder, scene))
    if history.status == "completed":
        checkpoint_file.remove()
    resumable = history.status == "interrupted" and checkpoint_file.path.exists()
    return RunOutcome(history, files, resumable)


def simulate_scene(scene: RunScene, text: str, console: Console) -> tuple[History, Dataset | None]:
    """Simulate a scene without writing files: its history and its Dataset; None for a run without a step."""
    history = _simulated(scene, console)
    return history, run_dataset(history, text, scene) if len(history) else None


def _simulated(
    scene: RunScene,
    console: Console,
    checkpoint_file: CheckpointFile | None = None,
    start: Checkpoint | None = None,
) -> History:
    """History of a scene; checkpoints are appended to a file, the run continues from start."""
    with console.status("meshes and stiffness of wheel and rail"):
        contact = wheelset_contact(scene)
    from wheelrail.vehicle.dynamics.equations import Dynamics
    from wheelrail.vehicle.integration.integrate import StepSettings
    from wheelrail.vehicle.simulation.checkpoint import Checkpoints
    from wheelrail.vehicle.simulation.simulate import simulate
    from wheelrail.vehicle.simulation.time_run import Recording
    from wheelrail.vehicle.track.speed_profile import SpeedProfile

    checkpoints = None
    if checkpoint_file is not None and scene.output.checkpoint:
        checkpoints = Checkpoints(scene.output.checkpoint, checkpoint_file.append, start)
    speed, length = scene.vehicle.speed_profile, scene.track.length
    end = SpeedProfile.of(speed).time_at(length)
    start_distance = length * start.time / end if start else 0.0
    with (
        _workers(contact, scene.solver.workers) as parallel,
        progress_bar(console, length, start_distance) as progress,
    ):
        return simulate(
            Dynamics(wagon(scene), track(scene), parallel, speed),
            (0.0, end),
            steps=StepSettings(scene.solver.method, scene.solver.rtol, scene.solver.atol),
            recording=Recording(scene.output.interval or None, checkpoints),
            progress=progress,
        )


def write_results(history: History, text: str, folder: Path, scene: RunScene) -> Iterator[Path]:
    """Write results, then figures; yields the files."""
    from wheelrail.scenes.datasets.netcdf import write

    with ignored_interrupts():
        data = run_dataset(history, text, scene)
        write(data, folder / RESULTS)
    yield folder / RESULTS
    if scene.output.figures:
        from wheelrail.scenes.plots.runs import draw_figures

        try:
            yield from draw_figures(data, folder)
        except KeyboardInterrupt:  # the results are already written
            return


def run_dataset(history: History, text: str, scene: RunScene) -> Dataset:
    """Dataset of a run with wear and energy balance.

    Parameters:
        history: of the run.
        text: of the scene file.
        scene: the same, validated.
    """
    from wheelrail.scenes.datasets.run import dataset
    from wheelrail.scenes.datasets.run_derived import wear, with_energy
    from wheelrail.scenes.runs.resume import inputs

    data = dataset(history, scene=text)
    data = data.assign(wear(data, scene.output.shear_yield)).assign_attrs(
        inputs=json.dumps(inputs(scene)), sampling=_sampling(scene.output.interval)
    )
    if scene.output.interval:  # the work between samples is unknown
        return data
    return with_energy(data, history, wagon(scene), track(scene))


def _sampling(interval: float) -> str:
    """How the samples of a run at an interval, s, were obtained."""
    if not interval:
        return "every accepted step of the time integration"
    return (
        f"every {interval:g} s; states by the cubic Hermite interpolation of the time integration within its steps, "
        "all other variables evaluated at these states, contacts solved there"
    )


def _workers(contact: VehicleContact, count: int) -> AbstractContextManager[VehicleContact]:
    """Contact model in this process, or with the right side in a second one."""
    from wheelrail.vehicle.simulation.parallel_contact import in_parallel

    return nullcontext(contact) if count == 1 else in_parallel(contact)


@contextmanager
def ignored_interrupts() -> Iterator[None]:
    """Ignore Ctrl-C in the block, which writes results."""
    try:
        handler = signal.signal(signal.SIGINT, signal.SIG_IGN)
    except ValueError:  # not in the main thread, where no Ctrl-C arrives
        yield
        return
    try:
        yield
    finally:
        signal.signal(signal.SIGINT, handler)
