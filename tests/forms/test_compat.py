"""Differences between versions of dolfinx, and what its compilers say."""

from __future__ import annotations

import subprocess
import sys
from pathlib import Path

ROOT = Path(__file__).parents[2]


def test_commands_of_the_c_compiler_are_not_logged() -> None:
    """distutils, by which forms are compiled, logs them by the root logger, from level INFO."""
    script = (
        "import logging, setuptools; logging.basicConfig(level=logging.INFO)\n"
        "from distutils.spawn import spawn\n"
        "spawn(['echo', 'before']); import wheelrail.forms.compat; spawn(['echo', 'after']); logging.info('mine')"
    )
    done = subprocess.run(
        [sys.executable, "-c", script], cwd=ROOT, capture_output=True, text=True, timeout=60, check=True
    )
    assert done.stdout.split() == ["before", "after"]
    assert "echo before" in done.stderr  # else the test shows nothing
    assert "echo after" not in done.stderr
    assert "mine" in done.stderr
