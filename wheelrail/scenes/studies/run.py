"""Runs of studies: the missing cases are computed in parallel, and each result is stored when its case has ended."""

from __future__ import annotations

import contextlib
from collections.abc import Callable, Mapping
from concurrent.futures import Executor
from contextlib import AbstractContextManager
from dataclasses import dataclass
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING, Any

from wheelrail.scenes.datasets.result_table import Results
from wheelrail.scenes.runs.progress import case_bar
from wheelrail.scenes.studies.plan import Plan, plan
from wheelrail.scenes.studies.schema import StudyTable, check_study, load_study
from wheelrail.scenes.studies.solve import CaseResult
from wheelrail.scenes.studies.workers import SchedulerGone, case_results, check_address, cluster, processes
from wheelrail.support.interrupts import deferred_interrupts

if TYPE_CHECKING:
    from rich.console import Console
    from xarray import Dataset

    from wheelrail.scenes.studies.job import Job
    from wheelrail.scenes.studies.store import Store

RESULTS, CASES = "study.nc", "cases"


@dataclass(frozen=True)
class StudyOutcome:
    """Outcome of a study.

    Parameters:
        data: results.
        files: written files.
        computed: number of cases computed in this call.
        interrupted: whether Ctrl-C ended it.
    """

    data: Dataset
    files: tuple[Path, ...]
    computed: int
    interrupted: bool = False

    @property
    def failed(self) -> int:
        return int((self.data["status"] == "failed").sum())

    @property
    def results(self) -> Results:
        """Tables of cases and of convergence, number of cases by status, and files."""
        from wheelrail.scenes.studies.tables import tables

        counts = {str(s): int((self.data["status"] == s).sum()) for s in sorted(set(self.data["status"].values.flat))}
        statuses = ", ".join(f"{count} {status}" for status, count in counts.items())
        text = "\n".join([f"{statuses}; {self.computed} computed now", *(f"  {file}" for file in self.files)])
        facts = {"statuses": counts, "computed": self.computed, "interrupted": self.interrupted, "files": self.files}
        return Results("study", [*tables(self.data), text], facts, {"statuses": "1", "computed": "1"})


def run_study(
    study: StudyTable | Mapping[str, Any] | str | Path,
    folder: str | Path | None = None,
    *,
    scheduler: str | None = None,
    fresh: bool = False,
    pictures: bool = True,
) -> Dataset:
    """Results of a study.

    Parameters:
        study: file, or table of a study, whose `scene` may be a table, too.
        folder: for results (study.nc), figures, and each case when it has ended, so that an interrupted study can be
            resumed; without it nothing is stored.
        scheduler: address of a Dask cluster; this machine by default.
        fresh: whether to recompute all cases.
        pictures: whether to draw figures.

    A failed case is NaN, with its error. Raises SceneError for an invalid study, before any case is computed,
    KeyboardInterrupt after storing the finished cases.
    """
    import tempfile

    from rich.console import Console

    from wheelrail.support.terminal import messages_on

    path = Path(study) if isinstance(study, str | Path) else Path("study")
    if not isinstance(study, StudyTable):
        study = check_study(study) if isinstance(study, Mapping) else load_study(path)
    planned, console = plan(study, path), Console(stderr=True, markup=False)
    with tempfile.TemporaryDirectory(prefix="wheelrail-study-") as temporary:
        target = Path(temporary if folder is None else folder)
        with messages_on(console):
            outcome = run_plan(
                planned, target, console, scheduler=scheduler, fresh=fresh, pictures=pictures and folder is not None
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
    """Compute the missing cases of a study, and write results and figures; Ctrl-C ends the computation.

    Parameters:
        planned: cases.
        folder: of the results.
        console: for progress.
        scheduler: address of a Dask cluster; this machine by default.
        fresh: whether to recompute all cases.
        pictures: whether to draw figures.

    Raises OSError if the folder cannot be written, RunFailed and SceneError if the cluster cannot be reached; if it
    becomes unreachable, after writing the results.
    """
    if scheduler is not None:
        check_address(scheduler)
    report = partial(console.print, highlight=False, markup=False, soft_wrap=True)
    folder.mkdir(parents=True, exist_ok=True)
    run = StudyRun.of(planned, folder, report, fresh=fresh)
    interrupted, scheduler_error = False, None
    try:
        run.compute(scheduler, console)
    except KeyboardInterrupt:
        interrupted = True
        report("interrupted; finished cases are stored, the same command computes the missing ones")
    except SchedulerGone as error:
        scheduler_error = error
    data, files = run.write(folder)
    if scheduler_error is not None:
        raise scheduler_error
    if pictures and not interrupted:
        from wheelrail.scenes.studies.plots import draw_study

        files += draw_study(data, folder)
    return StudyOutcome(data, tuple(files), run.computed, interrupted)


@dataclass
class StudyRun:
    """Jobs of a study and the results that are available.

    Parameters:
        planned: cases.
        store: of results.
        report: called with a message.
        jobs: by key; equal scenes share one job.
        indices: of the cases of each job in the grid, by key.
        results: by key.
        computed: number of results computed by this run.
    """

    planned: Plan
    store: Store
    report: Callable[[str], None]
    jobs: Mapping[str, Job]
    indices: Mapping[str, list[tuple[int, ...]]]
    results: dict[str, CaseResult]
    computed: int = 0

    @classmethod
    def of(cls, planned: Plan, folder: Path, report: Callable[[str], None], *, fresh: bool) -> StudyRun:
        """Jobs of a study with the results stored in its folder; fresh: stored results are removed."""
        from wheelrail.scenes.studies.job import Job
        from wheelrail.scenes.studies.store import Store

        store = Store(folder / CASES)
        jobs: dict[str, Job] = {}
        indices: dict[str, list[tuple[int, ...]]] = {}
        for case in planned.cases:
            timed = planned.convergence is not None
            job = Job.of(
                case, histories=planned.study.histories, timed=timed, folder=store.folder, compute=planned.study.compute
            )
            jobs[job.key] = job
            indices.setdefault(job.key, []).append(case.index)
        if fresh:
            for key in jobs:
                store.remove(key)
        results = {key: result for key in jobs if (result := store.load(key)) is not None}
        if results:
            report(f"{len(results)} of {len(jobs)} cases are already computed; --fresh recomputes them")
        elif (folder / RESULTS).exists():
            report(f"{folder} contains the results of an earlier study, which this one overwrites")
        return cls(planned, store, report, jobs, indices, results)

    def compute(self, scheduler: str | None, console: Console) -> None:
        """Compute and store the missing results; raises KeyboardInterrupt and SchedulerGone."""
        missing = [job for key, job in self.jobs.items() if key not in self.results]
        if not missing:
            return
        with contextlib.suppress(OSError):  # reported for each case that cannot be stored
            self.store.folder.mkdir(exist_ok=True)
        started = _executor(self.planned, scheduler, len(missing))
        with started as executor, case_bar(console, len(missing)) as done:
            for job, result in case_results(executor, missing):
                with deferred_interrupts():  # a result that is in the Dataset is in the store, too
                    self.results[job.key], self.computed = result, self.computed + 1
                    if not result.lost:  # a case whose worker was lost has no result and is computed again next time
                        self._store(job.key, result)
                        if job.folder:
                            self.store.prune_run_data(self.results)
                done(result.ok)

    def write(self, folder: Path) -> tuple[Dataset, list[Path]]:
        """Write the Dataset of all cases; returns it and the written files."""
        from wheelrail.scenes.runs.run import ignored_interrupts

        with ignored_interrupts():
            from wheelrail.scenes.datasets.netcdf import write
            from wheelrail.scenes.studies.convergence import with_errors
            from wheelrail.scenes.studies.dataset import dataset

            results = {index: result for key, result in self.results.items() for index in self.indices[key]}
            key = self.store.prune_run_data(self.results)
            attributes = {"kept_run": f"{CASES}/{key}.nc", "kept_case": self.indices[key][0]} if key else {}
            data = with_errors(dataset(self.planned, results), self.planned).assign_attrs(attributes)
            write(data, folder / RESULTS)
        return data, [folder / RESULTS]

    def _store(self, key: str, result: CaseResult) -> None:
        try:
            self.store.save(key, result)
        except OSError as error:
            self.report(
                f"{self.store.folder}: result of a case not stored: {error.strerror or error}; the study continues"
            )


def _executor(planned: Plan, scheduler: str | None, jobs: int) -> AbstractContextManager[Executor]:
    return cluster(scheduler) if scheduler is not None else processes(min(planned.study.processes, jobs))
