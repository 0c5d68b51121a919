"""Cached machine code is that of the present sources, including those of called functions."""

from __future__ import annotations

import os
import shutil
import subprocess
import sys
from pathlib import Path
from typing import NamedTuple

import numpy as np
import pytest

from wheelrail.contact.models.standard.polach import polach
from wheelrail.support.arrays import Array
from wheelrail.support.compiled import borrowing, compiled
from wheelrail.support.cache_home import private

ROOT = Path(__file__).parents[2]
USES = "from wheelrail.support.compiled import compiled\n"
OUTER = USES + "from wheelrail.contact.deep.inner import inner\n@compiled\ndef outer(x):\n    return inner(x)\n"
INNER = '"""Module."""\n' + USES + "@compiled\ndef inner(x):\n    'Text.'\n    return {} * x\n"


def said(folder: Path) -> str:
    code = (
        "from wheelrail.contact.outer import outer; from numba import config;"
        "print(outer(2.0), sum(outer.stats.cache_hits.values()), repr(config.CACHE_DIR))"
    )
    environment = {**os.environ, "PYTHONPATH": str(folder), "WHEELRAIL_CACHE": str(folder / "cache")}
    environment.pop("NUMBA_CACHE_DIR", None)
    run = subprocess.run(
        [sys.executable, "-c", code], env=environment, cwd=folder, capture_output=True, text=True, check=True
    )
    return run.stdout.strip()


def package(root: Path) -> Path:
    for folder in (root, root / "support", root / "meshes", root / "contact", root / "contact" / "deep"):
        folder.mkdir(parents=True)
        (folder / "__init__.py").touch()
    for name in ("compiled.py", "machine_code.py", "interrupts.py", "cache.py", "cache_home.py", "atomic_file.py"):
        shutil.copy(ROOT / "wheelrail" / "support" / name, root / "support")
    (root / "contact" / "outer.py").write_text(OUTER)
    (root / "contact" / "deep" / "inner.py").write_text(INNER.format(3.0))
    return root / "contact" / "deep" / "inner.py"


def test_change_in_a_called_file_is_detected(tmp_path: Path) -> None:
    inner = package(tmp_path / "wheelrail")
    assert said(tmp_path) == "6.0 0 ''"
    assert said(tmp_path) == "6.0 1 ''"
    inner.write_text(INNER.format(5.0))
    assert said(tmp_path) == "10.0 0 ''"
    inner.write_text(INNER.format(3.0))
    assert said(tmp_path) == "6.0 1 ''"  # machine code of several versions is kept
    inner.write_text("# a comment\n" + INNER.format(3.0).replace("Module", "A module").replace("Text", "Another text"))
    assert said(tmp_path) == "6.0 1 ''"
    inner.write_text(INNER.format("FACTOR").replace("@", "FACTOR = 3.0\n@"))
    assert said(tmp_path) == "6.0 0 ''"
    inner.write_text(INNER.format("FACTOR").replace("@", "FACTOR = 7.0\n@"))
    assert said(tmp_path) == "14.0 0 ''"


def test_copies_of_the_package_share_machine_code_outside_of_them(tmp_path: Path) -> None:
    package(tmp_path / "first" / "wheelrail")
    package(tmp_path / "second" / "wheelrail")
    (tmp_path / "cache").mkdir()
    for name, hits in (("first", 0), ("second", 1)):
        (tmp_path / name / "cache").symlink_to(tmp_path / "cache")
        assert said(tmp_path / name) == f"6.0 {hits} ''"
        assert not list((tmp_path / name).rglob("*.nb[ic]"))


PLACES = """
import sys
from pathlib import Path
from numba import config
from wheelrail.support.compiled import compiled
from wheelrail.support.machine_code import folder
config.CACHE_DIR = sys.argv[1]
@compiled
def twice(x):
    return 2.0 * x
assert twice(3.0) == 6.0
print(folder(), twice.stats.cache_path)
"""


def test_fallback_without_a_writable_cache_folder(tmp_path: Path) -> None:
    blocked = tmp_path / "file"
    blocked.write_text("not a folder")
    script = tmp_path / "script.py"
    script.write_text(PLACES)

    def places(numba: Path, own: Path) -> list[str]:
        environment = {**os.environ, "PYTHONPATH": str(ROOT), "WHEELRAIL_CACHE": str(own)}
        line = [sys.executable, str(script), str(numba)]
        return subprocess.run(line, env=environment, capture_output=True, text=True, check=True).stdout.split()

    chosen, used = places(blocked / "numba", tmp_path / "own")
    assert Path(chosen).parent == tmp_path / "own"
    assert Path(used).parent == Path(chosen)
    assert places(blocked / "numba", blocked / "own") == ["None", "None"]
    assert not list(ROOT.rglob("script.twice-*.nbi"))


HARM = """
import hashlib, os, pickle, sys
class Harm:
    def __reduce__(self):
        return os.mkdir, (sys.argv[1],)
for index in sys.argv[2:]:
    content = pickle.dumps(Harm())
    open(index, "wb").write(hashlib.sha256(content).digest() + content)
"""


def test_machine_code_that_others_can_write_is_not_read(tmp_path: Path) -> None:
    script, cache = tmp_path / "script.py", tmp_path / "cache"
    script.write_text(PLACES)
    environment = {**os.environ, "PYTHONPATH": str(ROOT), "WHEELRAIL_CACHE": str(tmp_path / "own")}

    def folder() -> Path:
        line = [sys.executable, str(script), str(cache)]
        done = subprocess.run(line, env=environment, capture_output=True, text=True, check=True)
        return Path(done.stdout.split()[0])

    place = folder()
    assert place.parent == cache
    assert place.stat().st_mode & 0o777 == 0o700
    harmed = [str(tmp_path / "harmed"), *map(str, place.rglob("*.nbi"))]
    subprocess.run([sys.executable, "-c", HARM, *harmed], check=True)
    for opened in (place, cache):
        mode = opened.stat().st_mode
        opened.chmod(0o777)
        assert folder().parent == tmp_path / "own"
        opened.chmod(mode)
    assert not (tmp_path / "harmed").exists()
    assert folder() == place  # which the user alone can write: trusted
    assert (tmp_path / "harmed").exists()


def test_private_folders(tmp_path: Path) -> None:
    inner = tmp_path / "outer" / "inner"
    inner.mkdir(parents=True)
    assert private(inner)
    for mode, expected in ((0o777, False), (0o1777, True), (0o755, True)):
        inner.parent.chmod(mode)
        assert private(inner) == expected
    inner.chmod(0o1777)
    assert not private(inner)


MANY = """
import sys
from wheelrail.support.compiled import compiled
{functions}
print("ready", flush=True)
sys.stdin.readline()
print(*(f(2.0) for f in ({names})), sum(sum(f.stats.cache_hits.values()) for f in ({names})))
"""
COUNT = 6


def test_two_processes_compile_at_once(tmp_path: Path) -> None:
    functions = "\n".join(f"@compiled\ndef f{i}(x):\n    return {i}.0 * x" for i in range(COUNT))
    names = ", ".join(f"f{i}" for i in range(COUNT))
    script = tmp_path / "script.py"
    script.write_text(MANY.format(functions=functions, names=names))
    environment = {**os.environ, "PYTHONPATH": str(ROOT), "NUMBA_CACHE_DIR": str(tmp_path)}

    def started() -> subprocess.Popen[str]:
        line = [sys.executable, str(script)]
        return subprocess.Popen(line, env=environment, stdin=subprocess.PIPE, stdout=subprocess.PIPE, text=True)

    def ended(process: subprocess.Popen[str], sent: str | None = None) -> list[float]:
        # Nothing is sent twice: a process may have ended, and MPI libraries end one that writes to a closed pipe.
        out, _ = process.communicate(sent, timeout=60)
        assert process.returncode == 0
        return [float(word) for word in out.split()]

    two = [started() for _ in range(2)]
    for process in two:
        assert process.stdout is not None
        assert process.stdout.readline() == "ready\n"
    for process in two:
        assert process.stdin is not None
        process.stdin.write("go\n")
        process.stdin.flush()
    right = [2.0 * i for i in range(COUNT)]
    first, second = (ended(process) for process in two)
    assert first[:COUNT] == second[:COUNT] == right
    assert first[COUNT] + second[COUNT] == COUNT  # nothing is compiled twice
    third = started()
    assert third.stdout is not None
    third.stdout.readline()
    assert ended(third, "go\n") == [*right, COUNT]


@compiled
def _total(values: np.ndarray) -> float:
    total = 0.0
    for value in values:
        total += value
    return total


def test_sums_keep_their_order() -> None:
    """Else what a process compiles and what the next one loads differ in the last bits, and so do resumed runs."""
    values = np.random.default_rng(1).normal(size=1001)
    assert _total(values) == np.cumsum(values)[-1]  # NumPy adds one after the other there
    assert not _total.targetoptions.get("fastmath", False)
    assert not polach.targetoptions.get("fastmath", False)


FIRST = """
import sys
from numba import config
from wheelrail.support.compiled import compiled
from wheelrail.support.terminal import messages_on, progress_console, set_verbosity
config.CACHE_DIR = sys.argv[1]
set_verbosity(quiet="-q" in sys.argv)
@compiled
def twice(x):
    return 2.0 * x
@compiled
def thrice(x):
    return 3.0 * x
with messages_on(progress_console()):
    twice(3.0)
    thrice(3.0)
"""


def test_a_first_compilation_is_announced(tmp_path: Path) -> None:
    script = tmp_path / "script.py"
    script.write_text(FIRST)

    def messages(folder: str, *options: str) -> str:
        command = [sys.executable, str(script), str(tmp_path / folder), *options]
        return subprocess.run(command, cwd=ROOT, capture_output=True, text=True, check=True).stderr

    assert messages("empty") == "compiling machine code: up to some minutes, only this once\n"
    assert messages("empty") == ""
    assert messages("another", "-q") == ""


class Row(NamedTuple):
    """A row of an array and a factor."""

    values: Array
    factor: float


@borrowing
def scaled_sum(rows: Array, k: int, factor: float) -> float:
    row, total = Row(rows[k], factor), 0.0
    for value in row.values:
        total += row.factor * value
    return total


@compiled
def sums(count: int, factor: float) -> Array:
    rows = np.ones((count, 3))
    return np.array([scaled_sum(rows, k, factor) for k in range(count)])


def test_borrowing_function_takes_slices_of_arrays_of_its_caller() -> None:
    assert sums(1000, 2.0) == pytest.approx(6.0)
