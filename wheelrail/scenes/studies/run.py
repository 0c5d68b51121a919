"""A study from its file to its results: cases in parallel, kept as they finish, and only those that are missing."""

from __future__ import annotations

import contextlib
from collections.abc import Callable, Mapping
from concurrent.futures import Executor
from contextlib import AbstractContextManager
from dataclasses import dataclass
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING, Any

from wheelrail.scenes.runs.progress import case_bar
from wheelrail.scenes.studies.plan import Plan, plan
from wheelrail.scenes.studies.schema import StudyTable, check_study, load_study
from wheelrail.scenes.studies.solve import CaseResult
from wheelrail.scenes.studies.workers import SchedulerGone, case_results, check_address, cluster, processes

if TYPE_CHECKING:
    from rich.console import Console, RenderableType
    from xarray import Dataset

RESULTS, CASES = "study.nc", "cases"


@dataclass(frozen=True)
class StudyOutcome:
    """A study that ended: its results, the files that were written, and how many cases were computed this time."""

    data: Dataset
    files: tuple[Path, ...]
    computed: int
    interrupted: bool = False

    @property
    def failed(self) -> int:
        return int((self.data["status"] == "failed").sum())

    def summary(self) -> list[RenderableType]:
        """What to print at the end: the table of cases, convergence, how many failed, where everything is."""
        from wheelrail.scenes.studies.tables import tables

        counts = {str(s): int((self.data["status"] == s).sum()) for s in sorted(set(self.data["status"].values.flat))}
        said = f"{', '.join(f'{count} {status}' for status, count in counts.items())}; {self.computed} computed now"
        return [*tables(self.data), "\n".join([said, *(f"  {file}" for file in self.files)])]


def run_study(
    study: StudyTable | Mapping[str, Any] | str | Path,
    folder: str | Path | None = None,
    *,
    scheduler: str | None = None,
    fresh: bool = False,
    pictures: bool = True,
) -> Dataset:
    """Results of a study: a file, or a table like one, whose `scene` may be a table, too.

    folder keeps every case as it finishes, so that a study that was stopped goes on, with the results (study.nc) and
    pictures, if wanted; without it nothing is kept. scheduler: address of a Dask cluster, instead of this machine.
    fresh: compute everything anew. A failed case is NaN, with its error. Raises SceneError for a study that cannot be
    used, before anything is computed; KeyboardInterrupt after keeping what is done.
    """
    import tempfile

    from rich.console import Console

    from wheelrail.support.terminal import messages_on

    path = Path(study) if isinstance(study, str | Path) else Path("study")
    if not isinstance(study, StudyTable):
        study = check_study(study) if isinstance(study, Mapping) else load_study(path)
    planned, console = plan(study, path), Console(stderr=True)
    with tempfile.TemporaryDirectory(prefix="wheelrail-study-") as spare:
        place = Path(spare if folder is None else folder)
        with messages_on(console):
            outcome = run_plan(
                planned, place, console, scheduler=scheduler, fresh=fresh, pictures=pictures and folder is not None
            )
    if outcome.interrupted:
        raise KeyboardInterrupt
    return outcome.data


def run_plan(
    planned: Plan,
    folder: Path,
    console: Console,
    *,
    scheduler: str | None = None,
    fresh: bool = False,
    pictures: bool = True,
) -> StudyOutcome:
    """Compute what is missing, then write results and pictures; Ctrl-C stops at once and writes what is there.

    Raises OSError when the folder cannot be written, RunFailed and SceneError for a cluster that cannot be reached, or
    no longer: then after writing the results.
    """
    from wheelrail.scenes.studies.job import Job
    from wheelrail.scenes.studies.store import Store

    if scheduler is not None:
        check_address(scheduler)
    tell = partial(console.print, highlight=False, markup=False, soft_wrap=True)
    folder.mkdir(parents=True, exist_ok=True)
    store = Store(folder / CASES)
    jobs: dict[str, Job] = {}
    places: dict[str, list[tuple[int, ...]]] = {}
    for case in planned.cases:  # the same scene at two places is computed once
        compared = planned.convergence is not None
        job = Job.of(case, histories=planned.study.histories, timed=compared, folder=store.folder)
        jobs[job.key] = job
        places.setdefault(job.key, []).append(case.place)
    if fresh:
        for key in jobs:
            store.forget(key)
    results = {key: result for key in jobs if (result := store.load(key)) is not None}
    if results:
        tell(f"{len(results)} of {len(jobs)} cases are done already; --fresh would compute them anew")
    missing, computed = [job for key, job in jobs.items() if key not in results], 0
    interrupted, lost = False, None
    try:
        if missing:
            with contextlib.suppress(OSError):  # whoever cannot keep anything is told for every case
                store.folder.mkdir(exist_ok=True)
            with _executor(planned, scheduler, len(missing)) as executor, case_bar(console, len(missing)) as done:
                for job, result in case_results(executor, missing):
                    results[job.key], computed = result, computed + 1
                    if not result.lost:  # a case whose worker was lost is computed again in the next run of the study
                        _keep(store, job.key, result, tell)
                        if job.folder:
                            store.hardest_run(results)
                    done(result.ok)
    except KeyboardInterrupt:
        interrupted = True
        tell("interrupted; what is done is kept, the same command goes on from there")
    except SchedulerGone as error:
        lost = error
    from wheelrail.scenes.runs.run import undisturbed

    with undisturbed():
        by_place = {place: result for key, result in results.items() for place in places[key]}
        hardest = store.hardest_run(results)
        kept = {"kept_run": f"{CASES}/{hardest}.nc", "kept_case": places[hardest][0]} if hardest else {}
        data, files = _written(planned, by_place, folder, kept)
    if lost is not None:
        raise lost
    if pictures and not interrupted:
        from wheelrail.scenes.studies.plots import draw_study

        files += draw_study(data, folder)
    return StudyOutcome(data, tuple(files), computed, interrupted)


def _executor(planned: Plan, scheduler: str | None, jobs: int) -> AbstractContextManager[Executor]:
    return cluster(scheduler) if scheduler is not None else processes(min(planned.study.processes, jobs))


def _keep(store: Any, key: str, result: CaseResult, tell: Callable[[str], None]) -> None:
    try:
        store.keep(key, result)
    except OSError as error:
        tell(f"{store.folder}: a case was not kept: {error.strerror or error}; the study goes on")


def _written(
    planned: Plan, results: Mapping[tuple[int, ...], CaseResult], folder: Path, kept: Mapping[str, Any]
) -> tuple[Dataset, list[Path]]:
    """kept: which run's data are in which file."""
    from wheelrail.scenes.datasets.netcdf import write
    from wheelrail.scenes.studies.convergence import with_errors
    from wheelrail.scenes.studies.dataset import dataset

    data = with_errors(dataset(planned, results), planned).assign_attrs(kept)
    write(data, folder / RESULTS)
    return data, [folder / RESULTS]
