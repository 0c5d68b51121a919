"""Cases of a step as jobs of worker processes, of this machine or of a Dask cluster that sees the same files."""

from __future__ import annotations

import pickle
from collections.abc import Iterator, Mapping, Sequence
from concurrent.futures import CancelledError, Executor, Future
from concurrent.futures.process import BrokenProcessPool
from contextlib import contextmanager
from dataclasses import dataclass, replace
from functools import lru_cache
from pathlib import Path

import numpy as np

from wheelrail.scenes.schema.errors import RunFailed, SceneError
from wheelrail.scenes.wear.cases import CaseRates, Duty
from wheelrail.support.arrays import Array
from wheelrail.vehicle.wear.evolution import WearingProfile

KEPT = 32  # profiles of a worker, of which the cases of a step share the worn ones
Removed = Mapping[str, Array]  # sections (n,) m2 removed from the cells, by profile


@dataclass(frozen=True)
class CaseJob:
    """A case at worn profiles.

    Parameters:
        table: of the wear file, pickled.
        path: of the wear file.
        number: of the case.
        present: profiles.
        renewed: those that the compliance of the bodies is of.
        guesses: states of its curves, by hand.
    """

    table: bytes
    path: Path
    number: int
    present: Removed
    renewed: Removed
    guesses: Mapping[str, Array]

    @classmethod
    def of(
        cls,
        duty: Duty,
        number: int,
        profiles: Mapping[str, WearingProfile],
        renewed: Mapping[str, WearingProfile],
        guesses: Mapping[str, Array],
    ) -> CaseJob:
        """Job of a case of a duty at present profiles."""
        present, earlier = ({name: own.removed for name, own in each.items()} for each in (profiles, renewed))
        return cls(pickle.dumps(duty.table), duty.path, number, present, earlier, guesses)


def rated(job: CaseJob) -> CaseRates:
    """Rates of a job, in a worker. Raises RunFailed that names the case."""
    duty = _duty(job.table, job.path)
    profiles, renewed = (
        {name: _profile(job.table, job.path, name, removed.tobytes()) for name, removed in each.items()}
        for each in (job.present, job.renewed)
    )
    case = duty.cases[job.number]
    with duty.contacts(profiles, renewed, [case], threads=1) as contacts:
        return duty.rates(case, contacts[case.contact_key], profiles, job.guesses)


@lru_cache(maxsize=1)
def _duty(table: bytes, path: Path) -> Duty:
    """The duty of a worker, with the bodies of its last jobs."""
    return Duty(pickle.loads(table), path)


@lru_cache(maxsize=KEPT)
def _profile(table: bytes, path: Path, name: str, removed: bytes) -> WearingProfile:
    """Profile of wheels or a rail by name.

    removed: bytes of the sections m2 removed from its cells.
    """
    duty = _duty(table, path)
    unworn = duty.unworn() | {rail: own.profile for rail, own in duty.unworn_rails().items()}
    return replace(unworn[name], removed=np.frombuffer(removed))


def rates_of(executor: Executor, jobs: Sequence[CaseJob]) -> Iterator[CaseRates]:
    """Rates of jobs, which begin now, in their order; of any executor's workers.

    The iterator raises RunFailed, also for a worker that is lost.
    """
    return _results([executor.submit(rated, job) for job in jobs])


def _results(running: Sequence[Future[CaseRates]]) -> Iterator[CaseRates]:
    from wheelrail.scenes.studies.workers import LOST, SchedulerGone

    try:
        for future in running:
            yield future.result()
    except CancelledError:
        raise SchedulerGone from None
    except BrokenProcessPool:
        raise RunFailed(LOST) from None
    finally:
        for future in running:
            future.cancel()


@contextmanager
def workers(count: int, scheduler: str | None) -> Iterator[Executor | None]:
    """Executor of a number of processes of this machine or of a Dask cluster; None for this process alone.

    Parameters:
        count: of processes of this machine.
        scheduler: address of the cluster.

    Raises SceneError and RunFailed for a cluster that cannot be reached.
    """
    from wheelrail.scenes.studies.workers import check_address, cluster, processes

    if count < 1:
        raise SceneError(f"workers = {count}: must be at least 1")
    if scheduler is not None:
        check_address(scheduler)
        with cluster(scheduler) as executor:
            yield executor
    elif count > 1:
        with processes(count) as executor:
            yield executor
    else:
        yield None
