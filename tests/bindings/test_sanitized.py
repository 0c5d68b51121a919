"""The compiled core with checked indices, addresses and arithmetic: no report, and the same bits."""

from __future__ import annotations

import os
import shutil
import subprocess
import sys
from pathlib import Path

import pytest

from wheelrail import bindings

ROOT = Path(__file__).parents[2]
BUILD = ROOT / "build" / "sanitized"
STATES, CONTACTS = (ROOT / "tests" / "helpers" / name for name in ("random_states.py", "contact_poses.py"))


def output(*command: str | Path, **settings: str) -> str:
    done = subprocess.run(
        list(map(str, command)), env=os.environ | settings, check=False, capture_output=True, text=True, timeout=580
    )
    assert done.returncode == 0, done.stdout[-2000:] + done.stderr[-5000:]
    return done.stdout


@pytest.fixture(scope="module")
def sanitized() -> dict[str, str]:
    """Environment of a process with the sanitized build, which is kept; making it takes minutes."""
    tools = str(Path(sys.executable).parent)
    if (cmake := shutil.which("cmake", path=tools)) is None:
        pytest.skip("cmake is not in the environment of Python")
    path = f"{tools}:{os.environ['PATH']}"
    configure = ["-S", ROOT / "bindings", "-B", BUILD, "-G", "Ninja", "-DSANITIZE=ON"]
    output(cmake, *configure, f"-DPython_EXECUTABLE={sys.executable}", PATH=path)
    output(cmake, "--build", BUILD, PATH=path)
    libraries = [output("c++", f"-print-file-name=lib{name}.so").strip() for name in ("asan", "ubsan")]
    return {
        "WHEELRAIL_CORE": str(BUILD / "baseline"),
        "PYTHONPATH": str(ROOT),
        "PYTHONMALLOC": "malloc",
        "ASAN_OPTIONS": "detect_leaks=0",  # Python's own
        "LD_PRELOAD": " ".join(libraries),
    }


def test_the_build_is_sanitized(sanitized: dict[str, str]) -> None:
    settings = os.environ | sanitized | {"LD_PRELOAD": ""}
    command = [sys.executable, "-c", "import wheelrail.bindings._vehicle"]
    done = subprocess.run(command, env=settings, check=False, capture_output=True, text=True, timeout=60)
    assert "ASan runtime does not come first" in done.stderr


def test_random_states_have_the_same_bits(sanitized: dict[str, str]) -> None:
    here = {"PYTHONPATH": str(ROOT), "WHEELRAIL_CORE": str(bindings.build())}
    assert output(sys.executable, STATES, "digest", **sanitized) == output(sys.executable, STATES, "digest", **here)


def test_wild_states_stay_within_arrays(sanitized: dict[str, str]) -> None:
    """Infinite and undefined ones, too, by every function of the core."""
    assert int(output(sys.executable, STATES, "everything", **sanitized)) == 5 * 11 * 4


def test_contacts_have_the_same_bits_and_stay_within_arrays(sanitized: dict[str, str]) -> None:
    here = {"PYTHONPATH": str(ROOT), "WHEELRAIL_CORE": str(bindings.build())}
    command = sys.executable, CONTACTS, "11", "9"  # two, the first one is wild
    assert output(*command, **sanitized) == output(*command, **here)
