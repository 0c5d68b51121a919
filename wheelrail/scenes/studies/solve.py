"""One case, solved: what a worker does."""

from __future__ import annotations

import contextlib
import json
import os
import shutil
import threading
from dataclasses import asdict, dataclass, field
from pathlib import Path
from time import perf_counter
from typing import Any

from wheelrail.scenes.schema.errors import SceneError
from wheelrail.scenes.schema.scene import HertzScene, RunScene, WheelsetScene
from wheelrail.scenes.studies.job import Job, computer, run_data, unfinished

ALONE = threading.Lock()  # the libraries in C are made for one thread; workers of a cluster may have several
WARM: set[bool] = set()  # not empty when this process has solved a case


@dataclass(frozen=True)
class CaseResult:
    """What is known of a case: status, what went wrong, seconds in all, numbers by side and in all, histories.

    status: "converged", "separated" or "completed", or "failed" with the error. lost: the worker ended, and nothing is
    known about the case itself.
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
        """Of all sides, Pa; zero where none is known."""
        return max((side.get("max_pressure", 0.0) for side in self.sides.values()), default=0.0)

    def text(self) -> str:
        """As JSON, every bit of every number kept."""
        return json.dumps(asdict(self))


def solve(job: Job) -> CaseResult:
    """Never raises for what a case does: a failure is a status too."""
    with ALONE:
        if job.timed and job.table["kind"] != "run" and not WARM:
            with contextlib.suppress(Exception):
                _solved(job)
        WARM.add(True)
        start = perf_counter()
        try:
            found = _solved(job)
        except (OSError, MemoryError) as error:  # of this machine, not of the case
            found = {"status": "failed", "error": _said(error), "lost": True}
        except Exception as error:
            found = {"status": "failed", "error": _said(error)}
        return CaseResult(**found, seconds=perf_counter() - start, host=os.uname().nodename)


def _solved(job: Job) -> dict[str, Any]:
    here = computer()
    if here["sources"] != job.computer["sources"]:
        text = "the worker has another version of wheelrail's files than what started the study"
        return {"status": "failed", "error": text, "lost": True}
    with job.scene() as (scene, folder):
        return _run(scene, folder, job) if isinstance(scene, RunScene) else _contact(scene)


def _contact(scene: HertzScene | WheelsetScene) -> dict[str, Any]:
    from wheelrail.scenes.contacts.solve import solve_contact
    from wheelrail.scenes.studies.quantities import of_contact

    report = solve_contact(scene)
    names = ("contact",) if isinstance(scene, HertzScene) else scene.sides
    return _ended(report["status"]) | {"sides": {name: of_contact(report[name]) for name in names}}


def _run(scene: RunScene, folder: Path, job: Job) -> dict[str, Any]:
    from rich.console import Console
    from xarray import load_dataset

    from wheelrail.scenes.runs.files import RESULTS
    from wheelrail.scenes.runs.run import run_scene
    from wheelrail.scenes.studies.quantities import histories_of, of_run

    place = Path(job.folder) if job.folder and Path(job.folder).is_dir() else folder  # it may be on another machine
    file = unfinished(place, job.key)
    with open(os.devnull, "w") as nowhere:
        resume = goes_on(scene, file)
        outcome = run_scene(scene, "", folder, Console(file=nowhere), resume=resume, checkpoints=file)
    if not outcome.files:
        return _ended(f"failed: {outcome.status.removeprefix('failed: ')} before the first step")
    data = load_dataset(folder / RESULTS, engine="netcdf4")
    sides, whole = of_run(data)
    with contextlib.suppress(OSError):  # whoever cannot keep it has no picture of it
        shutil.move(folder / RESULTS, run_data(place, job.key))
    return _ended(outcome.status) | {
        "sides": sides,
        "whole": whole,
        "histories": histories_of(data) if job.histories else {},
    }


def goes_on(scene: RunScene, file: Path) -> bool:
    """Whether a file has a checkpoint of this run; a damaged file, another run's or one in use counts as none."""
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
    """The first word of a status, the rest as its error."""
    if status in ("converged", "separated", "completed"):
        return {"status": status}
    return {"status": "failed", "error": status.removeprefix("failed").lstrip(": ")}


def _said(error: BaseException) -> str:
    return str(error) if isinstance(error, SceneError) else f"{type(error).__name__}: {error}"
