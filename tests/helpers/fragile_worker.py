"""Work that kills its worker, raises at certain loads, or logs messages."""

from __future__ import annotations

import logging
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


def talkative(job: Job) -> CaseResult:
    logging.getLogger("wheelrail.contact.work").info("%g N, 5 %%", job.table["load"])
    logging.getLogger("wheelrail.contact.work").debug("details")
    logging.getLogger("library").warning("noise")
    return CaseResult("converged")
