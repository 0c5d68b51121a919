"""One thread, quiet compilers, and a cache of their own for all tests."""

from __future__ import annotations

import os

# Before NumPy is imported. One thread per process, like the two commands of the Makefile.
os.environ["OMP_NUM_THREADS"] = "1"
os.environ["OPENBLAS_NUM_THREADS"] = "1"

import logging
import shutil
import signal
import tempfile
from collections.abc import Iterator

import pytest

# A shell makes what it starts in the background ignore Ctrl-C, and so would all that the tests start.
signal.signal(signal.SIGINT, signal.default_int_handler)

# dolfinx compiles its forms through distutils, which reports every command to the root logger. Filters and not levels:
# all of them set their own when they are imported.
for _logger in ("", "FFCX", "UFL"):
    logging.getLogger(_logger).addFilter(lambda record: record.levelno >= logging.ERROR)


@pytest.fixture(scope="session", autouse=True)
def cache() -> Iterator[str]:
    """A cache that starts empty and goes with the session, for this process and those that it starts.

    $WHEELRAIL_TEST_CACHE keeps one from run to run instead.
    """
    before, kept = os.environ.get("WHEELRAIL_CACHE"), os.environ.get("WHEELRAIL_TEST_CACHE")
    folder = kept or tempfile.mkdtemp(prefix="wheelrail-test-")
    os.environ["WHEELRAIL_CACHE"] = folder
    yield folder
    if before is None:
        del os.environ["WHEELRAIL_CACHE"]
    else:
        os.environ["WHEELRAIL_CACHE"] = before
    if not kept:
        shutil.rmtree(folder, ignore_errors=True)
