"""Standard output for results only, standard error for progress, log messages and errors."""

from __future__ import annotations

import logging
import os
import sys
import warnings
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass, field
from functools import cache
from time import monotonic
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from rich.console import Console


LOGGER = "wheelrail"  # root of all loggers of this package
PERIOD = 10.0  # s between two messages of one computation


@cache
def progress_console() -> Console:
    """The console for progress and log messages: standard error, a single one, so that messages do not break progress
    bars. Brackets in names of files are no markup.
    """
    from rich.console import Console

    return Console(stderr=True, markup=False)


def set_verbosity(*, quiet: bool = False, verbose: bool = False) -> None:
    """Set the verbosity on standard error: errors only, or also details of the solvers and warnings of libraries."""
    progress_console().quiet = quiet
    warnings.showwarning = _print_warning  # type: ignore[assignment]
    Verbosity.level = logging.DEBUG if verbose else logging.INFO


def _print_warning(message: Warning | str, *_: object) -> None:
    """Print a warning as one line, without its location in the source."""
    progress_console().print(f"warning: {message}", highlight=False, markup=False, soft_wrap=True)


class Verbosity:
    """Smallest level of log messages on the progress console."""

    level = logging.INFO


class ConsoleHandler(logging.Handler):
    """Prints log messages on a console, above its progress bar."""

    def __init__(self, console: Console) -> None:
        super().__init__(Verbosity.level)
        self.console = console

    def emit(self, record: logging.LogRecord) -> None:
        self.console.print(self.format(record), highlight=False, markup=False, soft_wrap=True)


@contextmanager
def messages_on(console: Console) -> Iterator[None]:
    """Log messages of this package on a console, and nowhere else; from level INFO unless `set_verbosity` sets it."""
    handler, logger = ConsoleHandler(console), logging.getLogger(LOGGER)
    level, propagate = logger.level, logger.propagate
    logger.addHandler(handler)
    logger.setLevel(Verbosity.level)
    logger.propagate = False
    try:
        yield
    finally:
        logger.removeHandler(handler)
        logger.setLevel(level)
        logger.propagate = propagate


def quieten_libraries() -> logging.Handler:
    """From now on log only errors of libraries, by a handler of the root logger: form compilers log too much.

    With `--verbose` warnings, too.
    """
    handler = logging.StreamHandler()
    handler.setLevel(_library_level())
    logging.getLogger().addHandler(handler)  # else FFCx adds one for all messages
    logging.getLogger("UFL").addFilter(_is_error)  # has a handler of its own
    return handler


def _is_error(record: logging.LogRecord) -> bool:
    return record.levelno >= _library_level()


def _library_level() -> int:
    return logging.WARNING if Verbosity.level < logging.INFO else logging.ERROR


@contextmanager
def stdout_for_results() -> Iterator[None]:
    """Redirect standard output to standard error during the block, against prints by C libraries.

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


@dataclass
class ProgressTimer:
    """Logs periodically the number of completed items of a total, and the remaining time at the same rate.

    The first item may include preparations and is excluded from the rate.
    """

    log: logging.Logger
    task: str
    _first: tuple[int, float] | None = field(init=False, default=None)
    _logged: float = field(init=False, default=0.0)

    def __call__(self, done: int, total: int) -> None:
        now = monotonic()
        if self._first is None:
            self._first, self._logged = (done, now), now
        elif now - self._logged >= PERIOD:
            first, start = self._first
            self._logged = now
            left = (now - start) / (done - first) * (total - done)
            self.log.info("%s: %d of %d, %.0f s left", self.task, done, total, left)
