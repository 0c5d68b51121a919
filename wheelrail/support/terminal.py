"""Standard output for results only, standard error for progress, log messages and errors."""

from __future__ import annotations

import logging
import os
import sys
from collections.abc import Iterator
from contextlib import contextmanager
from functools import cache
from typing import TYPE_CHECKING

from wheelrail.support.progress import LOGGER

if TYPE_CHECKING:
    from rich.console import Console


@cache
def progress_console() -> Console:
    """The console for progress and log messages: standard error, a single one, so that messages do not break progress
    bars. Brackets in names of files are no markup.
    """
    from rich.console import Console

    return Console(stderr=True, markup=False)


def result_console() -> Console:
    """The console for results: standard output, 120 columns wide when it is no terminal."""
    from rich.console import Console

    return Console(width=None if sys.stdout.isatty() else 120, soft_wrap=True, markup=False)


class ConsoleHandler(logging.Handler):
    """Prints log messages on a console, above its progress bar."""

    def __init__(self, console: Console) -> None:
        super().__init__(logging.INFO)
        self.console = console

    def emit(self, record: logging.LogRecord) -> None:
        self.console.print(self.format(record), highlight=False, markup=False, soft_wrap=True)


@contextmanager
def messages_on(console: Console) -> Iterator[None]:
    """Log messages of this package from level INFO on a console, and nowhere else."""
    handler, logger = ConsoleHandler(console), logging.getLogger(LOGGER)
    level, propagate = logger.level, logger.propagate
    logger.addHandler(handler)
    logger.setLevel(logging.INFO)
    logger.propagate = False
    try:
        yield
    finally:
        logger.removeHandler(handler)
        logger.setLevel(level)
        logger.propagate = propagate


def quieten_libraries() -> logging.Handler:
    """From now on log only errors of libraries, by a handler of the root logger: form compilers log too much."""
    handler = logging.StreamHandler()
    handler.setLevel(logging.ERROR)
    logging.getLogger().addHandler(handler)  # else FFCx adds one for all messages
    logging.getLogger("UFL").addFilter(_is_error)  # has a handler of its own
    return handler


def _is_error(record: logging.LogRecord) -> bool:
    return record.levelno >= logging.ERROR


@contextmanager
def stdout_for_results() -> Iterator[None]:
    """Redirect standard output to standard error during the block, for what C libraries print.

    Log messages of this package go to the progress console, of libraries only errors.
    """
    errors = quieten_libraries()
    sys.stdout.flush()
    try:
        stdout_copy = os.dup(1)
    except OSError:  # no standard output at all
        stdout_copy = -1
    try:
        if stdout_copy >= 0:
            os.dup2(2, 1)
        with messages_on(progress_console()):
            yield
    finally:
        logging.getLogger().removeHandler(errors)
        sys.stdout.flush()
        if stdout_copy >= 0:
            os.dup2(stdout_copy, 1)
            os.close(stdout_copy)
