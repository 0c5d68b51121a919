"""Work that kills its worker, or raises, at certain loads."""

from __future__ import annotations

import os
import signal

from wheelrail.scenes.studies.job import Job
from wheelrail.scenes.studies.solve import CaseResult

DEADLY, RAISING = 2e4, 4e4


def fragile(job: Job) -> CaseResult:
    if job.table["load"] == DEADLY:
        os.kill(os.getpid(), signal.SIGKILL)
    if job.table["load"] == RAISING:
        raise ZeroDivisionError("at work")
    return CaseResult("converged", whole={"pid": os.getpid(), "threads": float(os.environ["OMP_NUM_THREADS"])})
