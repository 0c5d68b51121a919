"""Where cases are solved: processes on this machine, or a Dask cluster, both behind one way to ask."""

from __future__ import annotations

import contextlib
import logging
import os
import signal
import sys
import threading
from collections import deque
from collections.abc import Callable, Iterator, Sequence
from concurrent.futures import FIRST_COMPLETED, CancelledError, Executor, Future, ProcessPoolExecutor, wait
from concurrent.futures.process import BrokenProcessPool
from contextlib import contextmanager
from dataclasses import dataclass, field
from multiprocessing import get_context, parent_process
from multiprocessing.connection import Connection
from multiprocessing.connection import wait as wait_for
from types import ModuleType
from typing import TYPE_CHECKING, Protocol

from wheelrail.scenes.schema.errors import RunFailed, SceneError
from wheelrail.scenes.studies.job import Job
from wheelrail.scenes.studies.messages import received_messages, send_messages
from wheelrail.scenes.studies.solve import CaseResult, solve
from wheelrail.support.interrupts import ignore

if TYPE_CHECKING:
    from distributed import Client

THREADS = ("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS", "NUMBA_NUM_THREADS")
PATIENCE = "20s"  # for a scheduler to answer
SCHEMES = ("", "tcp", "tls", "ws", "wss", "ucx")  # of its address


class SchedulerGone(RunFailed):
    """The Dask scheduler ended, or cannot be reached any more."""

    def __init__(self) -> None:
        super().__init__(
            "the Dask scheduler is gone; finished cases are kept: the same command goes on, with another --scheduler "
            "or without one"
        )


class Workers(Protocol):
    """Takes so many jobs at a time, `room`, and gives their results by futures."""

    @property
    def room(self) -> int: ...
    def submit(self, job: Job) -> Future[CaseResult]: ...


def finished(workers: Workers, jobs: Sequence[Job]) -> Iterator[tuple[Job, CaseResult]]:
    """Every job with what came of it, in the order in which they end; a worker that ends is a failure of its job.

    Raises SchedulerGone, after what has ended well.
    """
    waiting, running = deque(jobs), dict[Future[CaseResult], Job]()
    while waiting or running:
        while waiting and len(running) < workers.room:
            job = waiting.popleft()
            running[workers.submit(job)] = job
        ended = {future: _outcome(future) for future in wait(running, return_when=FIRST_COMPLETED).done}
        for future, found in ended.items():
            if found is not None:
                yield running.pop(future), found
        if None in ended.values():
            raise SchedulerGone


def _outcome(future: Future[CaseResult]) -> CaseResult | None:
    """None of a job that was given back unfinished."""
    try:
        return future.result()
    except BrokenProcessPool:
        return CaseResult(
            "failed", "the worker ended abruptly: out of memory, killed, or crashed in a library", lost=True
        )
    except CancelledError:
        return None
    except Exception as error:
        return CaseResult("failed", f"the worker was lost: {type(error).__name__}: {error}", lost=True)


@dataclass
class Processes:
    """Processes on this machine, each a pool of one: when a process dies it is known which case it had."""

    room: int
    messages: Connection
    work: Callable[[Job], CaseResult] = solve
    pools: dict[int, tuple[Executor, Future[int], Future[CaseResult]]] = field(default_factory=dict)

    def submit(self, job: Job) -> Future[CaseResult]:
        """Raises RuntimeError when all are at work."""
        place = next((i for i in range(self.room) if i not in self.pools or self.pools[i][2].done()), None)
        if place is None:
            raise RuntimeError("all workers are at work")
        if place in self.pools:
            pool, pid, last = self.pools[place]
            if not isinstance(last.exception(), BrokenProcessPool):
                with contextlib.suppress(BrokenProcessPool):  # it died while it had nothing to do
                    self.pools[place] = pool, pid, pool.submit(self.work, job)
                    return self.pools[place][2]
            pool.shutdown(wait=False)
        with _quiet_start():
            pool = ProcessPoolExecutor(1, get_context("spawn"), _begin, (self.messages,))
            pid = pool.submit(os.getpid)
        self.pools[place] = pool, pid, pool.submit(self.work, job)
        return self.pools[place][2]

    def stop(self) -> None:
        """At once, whatever they are at."""
        for pool, pid, last in self.pools.values():
            if not last.done():
                with contextlib.suppress(Exception):
                    os.kill(pid.result(timeout=10.0), signal.SIGKILL)
            pool.shutdown(wait=True, cancel_futures=True)
        self.pools.clear()


@contextmanager
def processes(count: int, work: Callable[[Job], CaseResult] = solve) -> Iterator[Processes]:
    """Workers on this machine; they end on leaving, and when this process dies."""
    with received_messages() as messages:
        workers = Processes(count, messages, work)
        try:
            yield workers
        finally:
            workers.stop()


@dataclass(frozen=True)
class Cluster:
    """A Dask cluster: twice as many jobs as it has threads, so that none has to wait for the next."""

    client: Client
    executor: Executor

    @property
    def room(self) -> int:
        with _reached():
            threads: dict[str, int] = self.client.nthreads()
        return max(2, 2 * sum(threads.values()))

    def submit(self, job: Job) -> Future[CaseResult]:
        with _reached():
            return self.executor.submit(solve, job)


@contextmanager
def _reached() -> Iterator[None]:
    try:
        yield
    except (OSError, RuntimeError, ValueError, CancelledError) as error:
        raise SchedulerGone from error


def check_address(address: str) -> None:
    """Raises SceneError for what is no address of a Dask scheduler, or none of a host that is known."""
    import socket

    scheme, _, place = address.rpartition("://")
    host, _, port = place.rpartition(":")
    if scheme not in SCHEMES or not host or not port.isdecimal() or not 0 < int(port) < 2**16:
        raise SceneError(f"--scheduler {address}: must be an address like tcp://host:8786")
    try:
        socket.getaddrinfo(host.strip("[]"), int(port))
    except OSError as error:
        raise SceneError(f"--scheduler {address}: {host} is no known host ({error.strerror})") from None


@contextmanager
def cluster(address: str) -> Iterator[Cluster]:
    """Workers of the Dask scheduler at an address; jobs that have not begun are taken back on leaving.

    Raises RunFailed when nobody answers there or Dask is not installed.
    """
    try:
        from distributed import Client
    except ImportError:
        raise RunFailed("--scheduler needs Dask: pip install 'wheelrail[cluster]'") from None
    for name in ("distributed", "distributed.client"):
        logging.getLogger(name).setLevel(logging.CRITICAL)  # what goes wrong is told in our words
    try:
        client = Client(address, timeout=PATIENCE, set_as_default=False, name="wheelrail-study")
    except OSError:
        raise RunFailed(f"--scheduler {address}: no scheduler answers there") from None
    executor = client.get_executor(pure=False)
    try:
        yield Cluster(client, executor)
    finally:
        with contextlib.suppress(Exception):  # a scheduler that is gone has nothing to take back
            executor.shutdown(wait=False)
        client.close(timeout=5)


@contextmanager
def _quiet_start() -> Iterator[None]:
    """New processes get one thread for dense algebra, and do not run the user's script again as spawned ones would: a
    script without `if __name__ == "__main__"` would start another study in every worker.
    """
    before, main = {name: os.environ.get(name) for name in THREADS}, sys.modules["__main__"]
    os.environ.update(dict.fromkeys(THREADS, "1"))
    sys.modules["__main__"] = ModuleType("__main__")
    try:
        yield
    finally:
        sys.modules["__main__"] = main
        for name, value in before.items():
            if value is None:
                del os.environ[name]
            else:
                os.environ[name] = value


def _begin(messages: Connection) -> None:
    """In a new worker: Ctrl-C is the parent's business, and when the parent is gone, so is the worker."""
    ignore()
    send_messages(messages)
    threading.Thread(target=_end_with_parent, daemon=True).start()


def _end_with_parent() -> None:
    parent = parent_process()
    assert parent is not None
    wait_for([parent.sentinel])
    os._exit(1)
