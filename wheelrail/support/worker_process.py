"""A second process that executes function calls, with the interface of `concurrent.futures`."""

from __future__ import annotations

import os
import threading
from collections.abc import Callable
from concurrent.futures import ProcessPoolExecutor
from concurrent.futures.process import BrokenProcessPool
from multiprocessing import active_children, get_context, parent_process
from multiprocessing.connection import wait
from multiprocessing.process import BaseProcess
from typing import Literal

from wheelrail.support.interrupts import deferred_interrupts, ignore

THREADS = ("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS")


class WorkerProcess(ProcessPoolExecutor):
    """Executor of one process, so that a call during which the process dies is identified: BrokenProcessPool.

    Parameters:
        method: to start the process, which is done at once.
        prepare, arguments: first call of the process; with "spawn" from a module without NumPy if it sets threads.

    The process ignores Ctrl-C and ends when the process that started it ends; `stop` kills it, which the standard
    executor offers from Python 3.14 on. Raises ValueError where the start method is not available.
    """

    def __init__(self, method: Literal["fork", "spawn"], prepare: Callable[..., None], *arguments: object) -> None:
        super().__init__(1, get_context(method), _start, (prepare, arguments))
        with deferred_interrupts():  # a Ctrl-C between the fork and `ignore` would reach both processes
            self._pid = self.submit(os.getpid)

    @property
    def process(self) -> BaseProcess | None:
        """Worker process, None unless alive."""
        try:
            pid = self._pid.result()
        except BrokenProcessPool:
            return None
        # The executor's thread waits for the process, too: only the sentinel is ready as soon as it has ended.
        return next((child for child in active_children() if child.pid == pid and not wait([child.sentinel], 0)), None)

    def stop(self) -> None:
        """Kill the process at once, without waiting for its results; unfinished calls raise BrokenProcessPool."""
        if process := self.process:
            process.kill()
        self.shutdown(wait=True, cancel_futures=True)


def _start(prepare: Callable[..., None], arguments: tuple[object, ...]) -> None:
    ignore()  # Ctrl-C reaches the whole group; the process that started this one decides
    threading.Thread(target=_end_with_parent, daemon=True).start()
    prepare(*arguments)


def _end_with_parent() -> None:
    parent = parent_process()
    assert parent is not None
    wait([parent.sentinel])
    os._exit(1)


def single_thread() -> None:
    """Use one thread for dense algebra in this process; to be called before NumPy is loaded."""
    os.environ.update(dict.fromkeys(THREADS, "1"))
