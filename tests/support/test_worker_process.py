"""Executor of one process: its start, and the detection of its end."""

from __future__ import annotations

import os
import signal
from concurrent.futures.process import BrokenProcessPool

import pytest

from wheelrail.support.worker_process import WorkerProcess, single_thread


def prepared() -> None:
    os.environ["PREPARED"] = "yes"


def send_signal(number: int) -> None:
    os.kill(os.getpid(), number)


def test_a_spawned_process_is_prepared_before_numpy_is_loaded() -> None:
    """Libraries read the number of threads when they are loaded."""
    worker = WorkerProcess("spawn", single_thread)
    try:
        assert worker.submit(eval, "'numpy' in __import__('sys').modules").result() is False
        assert worker.submit(os.getenv, "OPENBLAS_NUM_THREADS").result() == "1"
    finally:
        worker.stop()


def test_ctrl_c_does_not_end_it_and_a_kill_is_detected() -> None:
    worker = WorkerProcess("fork", prepared)
    try:
        assert worker.submit(os.getenv, "PREPARED").result() == "yes"
        assert "PREPARED" not in os.environ
        worker.submit(send_signal, signal.SIGINT).result()
        process = worker.process
        assert process is not None
        assert process.pid == worker.submit(os.getpid).result() != os.getpid()
        with pytest.raises(BrokenProcessPool):
            worker.submit(send_signal, signal.SIGKILL).result()
        process.join()
        assert worker.process is None
        with pytest.raises(BrokenProcessPool):
            worker.submit(os.getpid)
    finally:
        worker.stop()


def test_a_process_that_cannot_be_prepared_is_lost() -> None:
    worker = WorkerProcess("fork", send_signal, signal.SIGKILL)
    with pytest.raises(BrokenProcessPool):
        worker.submit(os.getpid).result()
    assert worker.process is None
    worker.stop()
