"""Results do not hang on last bits: tests of derivatives with the kernels of OpenBLAS for the oldest processors."""

from __future__ import annotations

import os
import platform
import subprocess
import sys
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[4]
TESTS = "tests/contact/models/lattice/test_pose_derivatives.py"
OLDEST = "Prescott"  # of x86-64, which all others run


@pytest.mark.skipif(platform.machine() != "x86_64", reason="kernels of another family of processors")
def test_derivatives_with_the_oldest_kernels() -> None:
    """`make test-kernels` runs all tests of contact and vehicles so, with machine code for any processor."""
    environment = os.environ | {"OPENBLAS_CORETYPE": OLDEST, "WHEELRAIL_TEST_CACHE": os.environ["WHEELRAIL_CACHE"]}
    command = "tests/helpers/blas_kernels.py", "-q", "-p", "no:cacheprovider", "-k", "half-space or quadrics", TESTS
    done = subprocess.run(
        [sys.executable, *command], cwd=ROOT, env=environment, capture_output=True, text=True, check=False
    )
    first, *_ = done.stdout.splitlines()
    if first != f"kernels {OLDEST}":
        pytest.skip(f"one set of kernels alone: {first}")
    assert done.returncode == 0, done.stdout
    assert "......" in done.stdout, done.stdout
