"""Standard output for results only, standard error for progress and complaints."""

from __future__ import annotations

import logging
import os
import sys
from collections.abc import Iterator
from contextlib import contextmanager
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from rich.console import Console


def progress_console() -> Console:
    """The console for progress: standard error."""
    from rich.console import Console

    return Console(stderr=True)


def result_console() -> Console:
    """The console for results: standard output, wide enough for a table when it is no terminal."""
    from rich.console import Console

    return Console(width=None if sys.stdout.isatty() else 120, soft_wrap=True)


@contextmanager
def stdout_for_results() -> Iterator[None]:
    """Nothing but results on standard output: what libraries in C print there goes to standard error meanwhile.

    Log messages below an error are left out: those of form compilers run into hundreds of lines.
    """
    logging.disable(logging.WARNING)
    sys.stdout.flush()
    try:
        kept = os.dup(1)
    except OSError:  # no standard output at all
        kept = -1
    try:
        if kept >= 0:
            os.dup2(2, 1)
        yield
    finally:
        logging.disable(logging.NOTSET)
        sys.stdout.flush()
        if kept >= 0:
            os.dup2(kept, 1)
            os.close(kept)
