"""Preparation of worker processes, and transfer of their log messages to the parent process.

NumPy is not imported here: it reads the number of threads at import, after `prepare_worker` sets it.
"""

from __future__ import annotations

import logging
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from multiprocessing import Pipe
from multiprocessing.connection import Connection
from threading import Thread

from wheelrail.support.terminal import LOGGER, quieten_libraries
from wheelrail.support.worker_process import single_thread

LONGEST = 1000  # characters of a message; writes of several processes to a pipe are atomic up to 4096 bytes


class PipeHandler(logging.Handler):
    """Sends name, level and text of log messages through a pipe."""

    def __init__(self, pipe: Connection) -> None:
        super().__init__(logging.INFO)
        self.pipe = pipe

    def emit(self, record: logging.LogRecord) -> None:
        with suppress(OSError):  # the reading end is closed
            self.pipe.send((record.name, record.levelno, self.format(record)[:LONGEST]))


def prepare_worker(pipe: Connection) -> None:
    """In a new worker process: use one thread and send log messages to the pipe."""
    single_thread()
    send_messages(pipe)


def send_messages(pipe: Connection) -> None:
    """In a worker process: send messages of this package from level INFO to the pipe; libraries log only errors."""
    quieten_libraries()
    logger = logging.getLogger(LOGGER)
    logger.addHandler(PipeHandler(pipe))
    logger.setLevel(logging.INFO)


@contextmanager
def received_messages() -> Iterator[Connection]:
    """Pipe for worker processes, which must have ended at the end of the block."""
    receiver, sender = Pipe(duplex=False)
    thread = Thread(target=_log, args=(receiver,), daemon=True)
    thread.start()
    try:
        yield sender
    finally:
        sender.close()
        thread.join(timeout=1.0)


def _log(pipe: Connection) -> None:
    with pipe, suppress(EOFError, OSError):
        while True:
            name, level, text = pipe.recv()
            logging.getLogger(name).log(level, "%s", text)
