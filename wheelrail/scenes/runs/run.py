"""Vehicle run of a scene: contact model, simulation with progress, results and figures on disk."""

from __future__ import annotations

import json
import signal
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from dataclasses import dataclass, replace
from functools import partial
from math import inf
from pathlib import Path
from typing import TYPE_CHECKING

from wheelrail.scenes.builders.vehicle import applied_loads, run_track, vehicle_on
from wheelrail.scenes.builders.vehicle_file import vehicle_text
from wheelrail.scenes.builders.wheelset import run_contact
from wheelrail.scenes.datasets.input_files import FILES, packed
from wheelrail.scenes.datasets.result_table import Results
from wheelrail.scenes.datasets.run_file import CHECKPOINTS, RESULTS
from wheelrail.scenes.runs.progress import costs, progress_bar
from wheelrail.scenes.runs.steady import failures_as_run_failed
from wheelrail.scenes.schema.errors import SceneError
from wheelrail.scenes.schema.scene import RunScene
from wheelrail.scenes.schema.toml import parse
from wheelrail.vehicle.evaluation.resolved_loads import unresolved_loads

if TYPE_CHECKING:
    from rich.console import Console
    from xarray import Dataset

    from wheelrail.contact.loading.structure import Structure
    from wheelrail.contact.results.vehicle_contact import VehicleContact
    from wheelrail.scenes.runs.checkpoint_file import CheckpointFile
    from wheelrail.vehicle.multibody.vehicle import Vehicle
    from wheelrail.vehicle.simulation.checkpoint import Checkpoint
    from wheelrail.vehicle.simulation.history import History
    from wheelrail.vehicle.simulation.time_run import Progress, Recording


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

    @property
    def _halt(self) -> str:
        """Whether a vehicle that runs free has come to a halt, in words."""
        from wheelrail.vehicle.simulation.limits import SLOWEST

        halted = len(self.history) and self.history.dynamics.runs_free and self.history.speeds[-1] < SLOWEST
        return ", where the vehicle has come to a halt" if halted else ""

    @property
    def results(self) -> Results:
        """Solver statistics by side, status and files."""
        reached = f" at {self.history.distance[-1]:.1f} m" if len(self.history) else " before the first step"
        own, wheelsets = self.history, self.history.dynamics.vehicle.wheelsets
        remarks = unresolved_loads(own.time, own.distance, wheelsets, own.force[..., 2])
        lines = [*remarks, f"{self.status}{reached}{self._halt}", *(f"  {file}" for file in self.files)]
        if self.resumable:
            lines.append("  --resume continues the run from its last checkpoint")
        steps = self.history.cost.steps
        facts = {
            "status": self.status,
            "distance": self.history.distance[-1] if len(self.history) else None,
            "time": self.history.time[-1] if len(self.history) else None,
            "files": self.files,
            "resumable": self.resumable,
            "remarks": remarks,
            "steps": {name: getattr(steps, name) for name in ("accepted", "rejected", "failed", "evaluations")},
            "seconds": self.history.cost.seconds,
        }
        units = {"distance": "m", "time": "s", "steps": "1", "seconds": "s"}
        return Results("run", [costs(self.history), "\n".join(lines)], facts, units)


def run_scene(
    scene: RunScene,
    text: str,
    folder: Path,
    console: Console,
    *,
    resume: bool = False,
    checkpoints: Path | None = None,
    vehicle: Path | None = None,
) -> RunOutcome:
    """Simulate a scene and write its results.

    Parameters:
        scene: to simulate.
        text: of the scene file, stored with the results.
        folder: for the results.
        console: for progress.
        resume: whether to continue from the last checkpoint.
        checkpoints: checkpoint file; one in the folder by default.
        vehicle: file of a vehicle in three dimensions that runs in place of the wagon of the scene.

    Results of an interrupted or failed run are written up to its end; the checkpoint file remains unless the run is
    complete. Raises OSError if the folder cannot be written, SceneError for checkpoints of another scene.
    """
    from wheelrail.scenes.runs.checkpoint_file import CheckpointFile, read_header
    from wheelrail.scenes.runs.resume import header, latest
    from wheelrail.vehicle.simulation.checkpoint import OtherVehicle

    folder.mkdir(parents=True, exist_ok=True)
    report = partial(console.print, highlight=False, markup=False, soft_wrap=True)
    checkpoint_file = CheckpointFile(checkpoints or folder / CHECKPOINTS, header(scene, vehicle), report)
    if not resume and read_header(checkpoint_file.path):
        console.print(
            f"{folder} contains an interrupted run; this run starts from the beginning, --resume continues it"
        )
    elif not resume and (folder / RESULTS).exists():
        report(f"{folder} contains the results of an earlier run, which this one overwrites")
    start = latest(checkpoint_file, checkpoint_file.report) if resume else None
    try:
        history = _simulated(scene, console, vehicle, checkpoint_file, start)
    except OtherVehicle as error:
        raise SceneError(f"{checkpoint_file.path}: {error}; omit --resume to start a new run") from None
    if not len(history):
        return RunOutcome(history, ())
    with console.status("results and figures"):
        files = tuple(write_results(history, text, folder, scene, vehicle))
    if history.status == "completed":
        checkpoint_file.remove()
    resumable = history.status == "interrupted" and checkpoint_file.path.exists()
    return RunOutcome(history, files, resumable)


def simulate_scene(
    scene: RunScene, text: str, console: Console, vehicle: Path | None = None
) -> tuple[History, Dataset | None]:
    """Simulate a scene without writing files: its history and its Dataset; None for a run without a step."""
    history = _simulated(scene, console, vehicle)
    return history, run_dataset(history, text, scene, vehicle) if len(history) else None


def _simulated(
    scene: RunScene,
    console: Console,
    file: Path | None = None,
    checkpoint_file: CheckpointFile | None = None,
    start: Checkpoint | None = None,
) -> History:
    """History of a scene; checkpoints are appended to a file, the run continues from start.

    Parameters:
        scene: to simulate.
        console: for progress.
        file: of a vehicle in place of the wagon.
        checkpoint_file: to which checkpoints are appended.
        start: checkpoint from which the run continues.
    """
    vehicle = vehicle_for_run(scene, file)
    with console.status("meshes and stiffness of wheel and rail"):
        contact, structures = run_contact(scene, vehicle.wheelsets)
    from wheelrail.vehicle.simulation.checkpoint import Checkpoints
    from wheelrail.vehicle.simulation.parallel_contact import in_threads
    from wheelrail.vehicle.simulation.time_run import Recording
    from wheelrail.vehicle.track.speed_profile import SpeedProfile

    checkpoints = None
    if checkpoint_file is not None and scene.output.checkpoint:
        checkpoints = Checkpoints(scene.output.checkpoint, checkpoint_file.append, start)
    length = scene.track.length
    end = SpeedProfile.of(scene.vehicle.speed_profile).time_at(length)
    start_distance = length * start.time / end if start else 0.0
    with (
        in_threads(contact, scene.solver.workers) as parallel,
        progress_bar(console, length, start_distance) as progress,
    ):
        recording = Recording(scene.output.interval or None, checkpoints)
        return simulate_on_track(scene, vehicle, parallel, end, recording, progress, structures)


def vehicle_for_run(scene: RunScene, file: Path | None = None) -> Vehicle:
    """Vehicle of a run of a scene.

    Parameters:
        scene: of the run.
        file: vehicle file; None: the plane wagon of the scene.

    Raises SceneError as `vehicle_on`, for keys of the scene that need a vehicle file or name no body of it, and for an
    explicit method with one.
    """
    if file is None and scene.keys_of_vehicle_files:
        raise SceneError(f"{', '.join(scene.keys_of_vehicle_files)}: allowed only with a vehicle file (--vehicle)")
    if file is not None and not scene.solver.method.startswith("rosenbrock"):
        text = f'solver.method = "{scene.solver.method}": must be "rosenbrock" or "rosenbrock4" with a vehicle file'
        raise SceneError(f'{text}, or "rosenbrock_ends": the spin of its wheelsets on the creep forces is stiff')
    vehicle = vehicle_on(scene, file)
    for body in scene.kick or {}:
        if body not in vehicle.names:
            raise SceneError(f"kick.{body}: must be one of {', '.join(vehicle.names)}, the bodies of {file}")
    applied_loads(scene, vehicle)  # validates them
    return replace(vehicle, speed_hold=None) if scene.vehicle.free_speed else vehicle


def simulate_on_track(
    scene: RunScene,
    vehicle: Vehicle,
    contact: VehicleContact,
    end: float,
    recording: Recording,
    progress: Progress,
    structures: Sequence[Structure | None] | None = None,
) -> History:
    """Motion of a vehicle along the track of a scene.

    Parameters:
        scene: of the run.
        vehicle: from `vehicle_for_run`.
        contact: of its wheels.
        end: s, at which the reference motion reaches the end of the track.
        recording: rows and checkpoints.
        progress: called at each accepted step.
        structures: axle and rails of each wheelset, where they are elastic.

    A vehicle that runs free does so until it reaches the end of the track itself, or stops. Raises RunFailed when a
    kicked vehicle has no equilibrium to start from, and SceneError as `run_track`.
    """
    from wheelrail.vehicle.integration.integrate import StepSettings
    from wheelrail.vehicle.multibody.equations import VehicleDynamics
    from wheelrail.vehicle.simulation.limit_cycle import kicked
    from wheelrail.vehicle.simulation.limits import SLOWEST
    from wheelrail.vehicle.simulation.simulate import simulate
    from wheelrail.vehicle.steady.start_state import start_state

    rails, initial, until = run_track(scene, vehicle), None, inf
    loads = applied_loads(scene, vehicle)
    dynamics = VehicleDynamics(vehicle, rails, contact, scene.vehicle.speed_profile, structures, loads)
    if dynamics.runs_free:
        until = scene.track.length
        end = until / SLOWEST
    resumed = recording.checkpoints is not None and recording.checkpoints.latest is not None
    if scene.kick and not resumed:
        with failures_as_run_failed():
            at_start = replace(dynamics, speed=scene.vehicle.first_speed)
            initial = kicked(dynamics.coordinates, start_state(at_start), scene.kick)
    return simulate(
        dynamics,
        (0.0, end),
        initial=initial,
        steps=StepSettings(scene.solver.method, scene.solver.rtol, scene.solver.atol),
        recording=recording,
        progress=progress,
        until=until,
    )


def write_results(history: History, text: str, folder: Path, scene: RunScene, vehicle: Path | None) -> Iterator[Path]:
    """Write results, then figures; yields the files."""
    from wheelrail.scenes.datasets.netcdf import write

    with ignored_interrupts():
        data = run_dataset(history, text, scene, vehicle)
        write(data, folder / RESULTS)
    yield folder / RESULTS
    if scene.output.figures:
        from wheelrail.scenes.plots.runs import draw_figures

        try:
            yield from draw_figures(data, folder)
        except KeyboardInterrupt:  # the results are already written
            return


def run_dataset(history: History, text: str, scene: RunScene, file: Path | None = None) -> Dataset:
    """Dataset of a run with the input files of its scene, and the energy balance if known.

    Parameters:
        history: of the run.
        text: of the scene file.
        scene: the same, validated.
        file: of the vehicle, if any.
    """
    from wheelrail.scenes.datasets.run import dataset
    from wheelrail.scenes.datasets.run_derived import with_energy
    from wheelrail.scenes.quantities import RUN
    from wheelrail.scenes.quantity import filled
    from wheelrail.scenes.runs.resume import inputs

    vehicle = "" if file is None else vehicle_text(file)
    facts = {
        "inputs": json.dumps(inputs(scene, file)),
        FILES: packed([(parse(text, "scene"), scene.model_dump())]),
        "sampling": _sampling(scene.output.interval),
    }
    data = dataset(history, scene=text, vehicle=vehicle, shear_yield=scene.output.shear_yield).assign_attrs(facts)
    if scene.contacts:
        owners = {one: name for name, own in scene.contacts.items() for one in own.wheelsets}
        data = data.assign(filled(RUN, {"contact": [owners.get(str(one), "") for one in data["wheelset"].values]}))
    return data if scene.output.interval else with_energy(data, history)  # of an interval the work within is unknown


def _sampling(interval: float) -> str:
    """How the samples of a run at an interval, s, were obtained."""
    if not interval:
        return "every accepted step of the time integration"
    return (
        f"every {interval:g} s; states by the cubic Hermite interpolation of the time integration within its steps, "
        "all other variables evaluated at these states, contacts solved there"
    )


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
