"""Executors of `concurrent.futures` for the cases of a study: processes of this machine, or a Dask cluster."""

from __future__ import annotations

import contextlib
import logging
import sys
import threading
from collections.abc import Callable, Iterable, Iterator
from concurrent.futures import CancelledError, Executor, Future, ThreadPoolExecutor, as_completed
from concurrent.futures.process import BrokenProcessPool
from contextlib import contextmanager
from functools import partial
from multiprocessing.connection import Connection
from types import ModuleType
from typing import ParamSpec, TypeVar

from wheelrail.scenes.schema.errors import RunFailed, SceneError
from wheelrail.scenes.studies.job import Job
from wheelrail.scenes.studies.messages import prepare_worker, received_messages
from wheelrail.scenes.studies.solve import CaseResult, solve
from wheelrail.support.worker_process import WorkerProcess

TIMEOUT = "20s"  # for the connection to a scheduler
LOST = "the worker ended abruptly: out of memory, killed, or crashed in a library"
SCHEMES = ("", "tcp", "tls", "ws", "wss", "ucx")  # of its address

P = ParamSpec("P")
T = TypeVar("T")


class SchedulerGone(RunFailed):
    """The connection to the Dask scheduler is lost."""

    def __init__(self) -> None:
        super().__init__(
            "the connection to the Dask scheduler is lost; finished cases are stored: the same command continues, with "
            "another --scheduler or without one"
        )


def case_results(
    executor: Executor, jobs: Iterable[Job], work: Callable[[Job], CaseResult] = solve
) -> Iterator[tuple[Job, CaseResult]]:
    """Each job with its result, in the order of completion; a job whose worker is lost has failed.

    Raises SchedulerGone when a job is cancelled, as it is when the connection to the scheduler is lost.
    """
    running = {executor.submit(work, job): job for job in jobs}
    for future in as_completed(running):
        yield running.pop(future), _result(future)


def _result(future: Future[CaseResult]) -> CaseResult:
    try:
        return future.result()
    except CancelledError:
        raise SchedulerGone from None
    except BrokenProcessPool:
        return CaseResult("failed", LOST, lost=True)
    except Exception as error:
        return CaseResult("failed", f"the worker was lost: {type(error).__name__}: {error}", lost=True)


class WorkerProcesses(Executor):
    """An executor of several worker processes, one for each of its threads: one that dies fails its own call only.

    A pool of several processes fails all calls when one of them dies.

    Parameters:
        count: largest number of processes; each starts with the first call of its thread.
        messages: pipe for log messages, see `received_messages`.
    """

    def __init__(self, count: int, messages: Connection) -> None:
        self._messages = messages
        self._threads = ThreadPoolExecutor(count)
        self._own = threading.local()
        self._lock = threading.Lock()
        self._workers: list[WorkerProcess] = []
        self._stopped = False

    def submit(self, function: Callable[P, T], /, *args: P.args, **kwargs: P.kwargs) -> Future[T]:
        return self._threads.submit(self._call, partial(function, *args, **kwargs))

    def shutdown(self, wait: bool = True, *, cancel_futures: bool = False) -> None:
        """As of any executor; without waiting, running calls end with their processes, which are killed."""
        self._threads.shutdown(wait=wait, cancel_futures=cancel_futures)
        with self._lock:
            self._stopped = True
        for worker in self._workers:
            worker.stop()
        self._threads.shutdown()

    def _call(self, function: Callable[[], T]) -> T:
        worker: WorkerProcess | None = getattr(self._own, "worker", None)
        if worker is None or worker.process is None:  # the first call of this thread, or the process died while idle
            worker = self._own.worker = self._started()
        try:
            return worker.submit(function).result()
        except BrokenProcessPool:
            self._own.worker = None
            raise

    def _started(self) -> WorkerProcess:
        with self._lock, _without_main():
            if self._stopped:
                raise CancelledError
            worker = WorkerProcess("spawn", prepare_worker, self._messages)
            self._workers.append(worker)
            return worker


@contextmanager
def _without_main() -> Iterator[None]:
    """Spawned processes do not import the user's script, which would start the study once more without a guard
    `if __name__ == "__main__"`.
    """
    main, sys.modules["__main__"] = sys.modules["__main__"], ModuleType("__main__")
    try:
        yield
    finally:
        sys.modules["__main__"] = main


@contextmanager
def processes(count: int) -> Iterator[Executor]:
    """Worker processes on this machine; they are killed on exit, and end when this process ends."""
    with received_messages() as messages:
        executor = WorkerProcesses(count, messages)
        try:
            yield executor
        finally:
            executor.shutdown(wait=False, cancel_futures=True)


@contextmanager
def cluster(address: str) -> Iterator[Executor]:
    """Workers of the Dask scheduler at an address; jobs that have not started are cancelled on exit.

    Raises RunFailed when no scheduler answers there or Dask is not installed.
    """
    try:
        from distributed import Client
    except ImportError:
        raise RunFailed("--scheduler needs Dask: pip install 'wheelrail[cluster]'") from None
    for name in ("distributed", "distributed.client"):
        logging.getLogger(name).setLevel(logging.CRITICAL)  # errors are reported by SchedulerGone
    try:
        client = Client(address, timeout=TIMEOUT, set_as_default=False, name="wheelrail-study")
    except OSError:
        raise RunFailed(f"--scheduler {address}: no scheduler answers there") from None
    executor: Executor = client.get_executor(pure=False)
    try:
        yield executor
    finally:
        with contextlib.suppress(Exception):  # the scheduler may be lost
            executor.shutdown(wait=False)
        client.close(timeout=5)


def check_address(address: str) -> None:
    """Raises SceneError for anything but an address of the form scheme://host:port, and for an unknown host."""
    import socket

    scheme, _, location = address.rpartition("://")
    host, _, port = location.rpartition(":")
    if scheme not in SCHEMES or not host or not port.isdecimal() or not 0 < int(port) < 2**16:
        raise SceneError(f"--scheduler {address}: must be an address like tcp://host:8786")
    try:
        socket.getaddrinfo(host.strip("[]"), int(port))
    except (OSError, UnicodeError) as error:  # a label between dots may have 1 to 63 characters
        reason = getattr(error, "strerror", None) or error
        raise SceneError(f"--scheduler {address}: {host} is not a known host ({reason})") from None
