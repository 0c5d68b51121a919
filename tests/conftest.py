"""One thread, quiet compilers, and a separate cache for all tests."""

from __future__ import annotations

import os

# Before NumPy is imported. One thread per process, like the two commands of the Makefile.
os.environ["OMP_NUM_THREADS"] = "1"
os.environ["OPENBLAS_NUM_THREADS"] = "1"

import gc
import logging
import shutil
import signal
import sys
import tempfile
from collections.abc import Iterator
from functools import cache, partial

import pytest
import typer.testing

# Imports of thousands of modules take a fifth of their time for the collector of cycles, of which there are few.
gc.set_threshold(50_000)

LARGE = 1.5e9  # bytes of a process
TESTS = os.path.dirname(__file__) + os.sep

# A shell lets background processes ignore Ctrl-C, which processes started by tests would inherit.
signal.signal(signal.SIGINT, signal.default_int_handler)

# dolfinx compiles its forms through distutils, which reports every command to the root logger. Filters and not levels:
# all of them set their own when they are imported.
for _logger in ("", "FFCX", "UFL"):
    logging.getLogger(_logger).addFilter(lambda record: record.levelno >= logging.ERROR)


# Typer builds all commands anew for each command line, which takes most of the time of a short one.
typer.testing._get_command = cache(typer.testing._get_command)


def pytest_configure(config: pytest.Config) -> None:
    """Cache that is empty at the start and removed after the session, for all processes of the session.
    $WHEELRAIL_TEST_CACHE names a permanent one instead.
    """
    if hasattr(config, "workerinput"):
        return  # started by a process that has created it
    kept = os.environ.get("WHEELRAIL_TEST_CACHE")
    folder = os.environ["WHEELRAIL_CACHE"] = kept or tempfile.mkdtemp(prefix="wheelrail-test-")
    if not kept:
        config.add_cleanup(partial(shutil.rmtree, folder, ignore_errors=True))


def pytest_collection_finish() -> None:
    """What was imported stays to the end: the collector of cycles need not look at it again."""
    gc.freeze()


@pytest.fixture(autouse=True)
def _messages_as_before() -> Iterator[None]:
    """Benchmarks silence the messages of the process that they run in."""
    yield
    logging.disable(logging.NOTSET)


@pytest.fixture(autouse=True, scope="module")
def _models_of_files() -> Iterator[None]:
    """Models that tests share end where they are too large: a process of the suite grew to 8 GB by tables of narrow
    strips.
    """
    yield
    with open("/proc/self/statm", encoding="ascii") as file:
        if int(file.read().split()[1]) * os.sysconf("SC_PAGE_SIZE") < LARGE:
            return
    for module in list(sys.modules.values()):
        if (getattr(module, "__file__", None) or "").startswith(TESTS):
            for shared in list(vars(module).values()):
                if hasattr(shared, "cache_clear") and not shared.__module__.startswith("wheelrail."):
                    shared.cache_clear()
