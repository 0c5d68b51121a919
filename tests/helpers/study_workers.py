"""Workers of a study in a thread of the test's own process."""

from __future__ import annotations

from collections.abc import Callable
from concurrent.futures import Executor, ThreadPoolExecutor
from typing import Any

from wheelrail.scenes.studies.job import Job
from wheelrail.scenes.studies.solve import CaseResult, solve


class Here(Executor):
    """Works in a thread of this process: quick."""

    def __init__(self, work: Callable[[Job], CaseResult] = solve) -> None:
        self.work, self.jobs = work, list[Job]()

    def submit(self, _: Any, job: Job) -> Any:  # type: ignore[override]
        return self.pool.submit(self._work, job)

    def _work(self, job: Job) -> CaseResult:
        self.jobs.append(job)
        return self.work(job)

    def __enter__(self) -> Here:
        self.pool = ThreadPoolExecutor(1)
        return self

    def __exit__(self, *_: object) -> None:
        self.pool.shutdown(cancel_futures=True)
