"""Solution of one case by a worker."""

from __future__ import annotations

import contextlib
import json
import os
import shutil
import threading
from dataclasses import asdict, dataclass, field
from pathlib import Path
from statistics import median
from time import perf_counter
from typing import Any

from wheelrail.scenes.schema.errors import SceneError
from wheelrail.scenes.schema.scene import HertzScene, RunScene, WheelsetScene
from wheelrail.scenes.studies.job import VEHICLE, Job, computer, run_data, unfinished

SOLVE_LOCK = threading.Lock()  # C libraries are not thread-safe; workers of a cluster may have several threads
REPETITIONS, ENOUGH = 5, 0.5  # of a timed solve: largest number, and seconds after which it is not repeated
SPEEDS, PLACES = (5.0, 150.0), 4  # m/s, range of critical speeds, and places of strips over which they are averaged
WARM: set[bool] = set()  # not empty after the first case of this process


@dataclass(frozen=True)
class CaseResult:
    """Result of a case.

    Parameters:
        status: "converged", "separated", "completed", or "failed".
        error: reason of a failure.
        seconds: computing time.
        sides: quantities by side.
        whole: quantities of the whole case.
        histories: time histories of a run.
        host: machine.
        lost: whether the worker ended, without information about the case itself.
    """

    status: str
    error: str = ""
    seconds: float = float("nan")
    sides: dict[str, dict[str, float]] = field(default_factory=dict)
    whole: dict[str, float] = field(default_factory=dict)
    histories: dict[str, Any] = field(default_factory=dict)
    host: str = ""
    lost: bool = False

    @property
    def ok(self) -> bool:
        return self.status in ("converged", "separated", "completed")

    @property
    def peak_pressure(self) -> float:
        """Largest peak pressure of all sides, Pa; zero if unknown."""
        return max((side.get("max_pressure", 0.0) for side in self.sides.values()), default=0.0)

    def text(self) -> str:
        """As JSON, with all bits of numbers."""
        return json.dumps(asdict(self))


def solve(job: Job) -> CaseResult:
    """Solve a case; a failure sets the status and raises nothing."""
    with SOLVE_LOCK:
        if job.timed and job.table["kind"] != "run" and not WARM:
            with contextlib.suppress(Exception):
                _solved(job)
        WARM.add(True)
        start = perf_counter()
        try:
            result = _solved(job)
        except (OSError, MemoryError) as error:  # of this machine, not of the case
            result = {"status": "failed", "error": _error_text(error), "lost": True}
        except Exception as error:
            result = {"status": "failed", "error": _error_text(error)}
        return CaseResult(**result, seconds=perf_counter() - start, host=os.uname().nodename)


def _solved(job: Job) -> dict[str, Any]:
    here = computer()
    if here["sources"] != job.computer["sources"]:
        text = "the worker has another version of the wheelrail sources than the process that started the study"
        return {"status": "failed", "error": text, "lost": True}
    with job.scene() as (scene, folder):
        if not isinstance(scene, RunScene):
            return _contact(scene, timed=job.timed)
        return _run(scene, folder, job) if job.compute == "run" else _steady(scene, folder / VEHICLE, job.compute)


def _steady(scene: RunScene, vehicle: Path, compute: str) -> dict[str, Any]:
    """Steady curve, or linear critical speed, of a vehicle."""
    from wheelrail.scenes.runs.steady import critical_speeds_of, curve_of, equilibria_of, equilibrium_tables
    from wheelrail.scenes.studies.quantities import of_critical_speeds, of_curve

    if compute == "critical":
        found = critical_speeds_of(scene, vehicle, SPEEDS, PLACES)
        if any(own is None for own in found):
            return _ended(f"failed: no critical speed from {SPEEDS[0]:g} to {SPEEDS[1]:g} m/s")
        return _ended("completed") | {"whole": of_critical_speeds([own for own in found if own is not None])}
    curve = curve_of(scene)
    (at,) = equilibria_of(scene, vehicle, [scene.vehicle.first_speed], curve)
    return _ended("completed") | {"whole": of_curve(equilibrium_tables(at, curve)[0].records)}


def _contact(scene: HertzScene | WheelsetScene, *, timed: bool) -> dict[str, Any]:
    from wheelrail.scenes.contacts.side_values import SideValues
    from wheelrail.scenes.contacts.solve import built_model, solve_contact
    from wheelrail.scenes.studies.quantities import of_contact

    model = built_model(scene)
    data = solve_contact(scene, model=model)
    names = ("contact",) if isinstance(scene, HertzScene) else scene.sides
    sides = {name: of_contact(SideValues(data, name)) for name in names}
    if timed and data.attrs["status"] == "converged":
        for name, seconds in warm_seconds(scene, model).items():
            sides[name]["warm_seconds"] = seconds
    return _ended(data.attrs["status"]) | {"sides": sides}


def warm_seconds(scene: HertzScene | WheelsetScene, model: Any) -> dict[str, float]:
    """Time s of the contact solves by side, with compiled code, meshes and compliances at hand: median of repetitions.

    Parameters:
        scene: solved before with the model.
        model: of the scene.

    Without initial guess from the earlier solve; error estimate and stress below the surface are omitted.
    """
    from wheelrail.scenes.contacts.solve import solve_sides

    plain = scene.model_copy(update={"error_estimate": False, "stress": None})
    seconds: dict[str, list[float]] = {}
    for _ in range(REPETITIONS):
        for name, solution in solve_sides(plain, model=model):
            seconds.setdefault(name, []).append(solution.seconds)
        if sum(map(sum, seconds.values())) > ENOUGH:
            break
    return {name: median(values) for name, values in seconds.items()}


def _run(scene: RunScene, folder: Path, job: Job) -> dict[str, Any]:
    from rich.console import Console

    from wheelrail.scenes.datasets.netcdf import read
    from wheelrail.scenes.datasets.run_file import RESULTS
    from wheelrail.scenes.runs.run import run_scene
    from wheelrail.scenes.studies.quantities import histories_of, of_run

    case_folder = (
        Path(job.folder) if job.folder and Path(job.folder).is_dir() else folder
    )  # the folder may be on another machine
    file = unfinished(case_folder, job.key)
    with open(os.devnull, "w") as nowhere:
        vehicle = folder / VEHICLE if (folder / VEHICLE).is_file() else None
        resume = vehicle is None and can_resume(scene, file)
        outcome = run_scene(scene, "", folder, Console(file=nowhere), resume=resume, checkpoints=file, vehicle=vehicle)
    if not outcome.files:
        return _ended(f"failed: {outcome.status.removeprefix('failed: ')} before the first step")
    data = read(folder / RESULTS)
    sides, case_quantities = of_run(data)
    with contextlib.suppress(OSError):  # without its data the run is only missing in the report
        shutil.move(folder / RESULTS, run_data(case_folder, job.key))
    return _ended(outcome.status) | {
        "sides": sides,
        "whole": case_quantities,
        "histories": histories_of(data) if job.histories else {},
    }


def can_resume(scene: RunScene, file: Path) -> bool:
    """Whether a file has a checkpoint of this run; damaged files, files in use and those of other runs do not count."""
    from wheelrail.scenes.runs.checkpoint_file import CheckpointFile
    from wheelrail.scenes.runs.resume import header, latest

    checkpoint_file = CheckpointFile(file, header(scene), lambda _: None)
    try:
        return latest(checkpoint_file, lambda _: None) is not None
    except Exception:
        return False
    finally:
        if checkpoint_file.stream is not None:
            checkpoint_file.stream.close()


def _ended(status: str) -> dict[str, str]:
    """Status, with the reason of a failure as error."""
    if status in ("converged", "separated", "completed"):
        return {"status": status}
    return {"status": "failed", "error": status.removeprefix("failed").lstrip(": ")}


def _error_text(error: BaseException) -> str:
    return str(error) if isinstance(error, SceneError) else f"{type(error).__name__}: {error}"
