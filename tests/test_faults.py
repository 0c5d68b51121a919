"""Full disks, damaged files, Ctrl-C and kills in every phase: nothing half-written is read, nothing is lost."""

from __future__ import annotations

import os
import re
import resource
import signal
import subprocess
import sys
import time
import traceback
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest
from bad_input import CURVE, WHEELSET, changed, standard
from standin_contact import CONTACT
from test_resume import Stopping
from typer.testing import CliRunner
from xarray import Dataset, open_dataset

from contact.wheelset import WheelsetContact
from meshes.cache import load, store
from meshes.whole_file import PART, whole_file
from scenes.cli import app
from scenes.netcdf import write

ROOT = Path(__file__).parents[1]
SMOOTH = WheelsetContact(Stopping(), CONTACT.mounting)  # a spring with patches, and nothing to remember
ENVIRONMENT = {**os.environ, "PYTHONPATH": os.pathsep.join([str(ROOT), str(ROOT / "tests")])}


def quick(folder: Path, *changes: tuple[str, str]) -> Path:
    """A scene that runs in a second: the standard contact, twelve metres."""
    text = standard(CURVE)
    for old, new in (
        ("tangent = 50.0", "tangent = 1.0"),
        ("transition_length = 100.0", "transition_length = 10.0"),
        ("curve = 200.0", "curve = 1.0"),
        ('method = "ode23"', 'method = "rosenbrock"'),
        ("interval = 0.0", "checkpoint = 10\nfigures = false"),
        *changes,
    ):
        text = changed(text, old, new)
    folder.mkdir(exist_ok=True, parents=True)
    (folder / "scene.toml").write_text(text)
    return folder / "scene.toml"


@pytest.fixture(autouse=True)
def smooth(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("scenes.run.wheelset_contact", lambda scene: SMOOTH)


def stopped(folder: Path, code: str) -> tuple[int, str]:
    """A run in a process of its own, after some code: exit status, or minus the signal's number, and what it said."""
    process = os.fork()
    if process == 0:
        status = 99
        said = os.open(folder / "said", os.O_CREAT | os.O_TRUNC | os.O_WRONLY)
        for number in (1, 2):
            os.dup2(said, number)
        sys.stdout, sys.stderr = (open(number, "w", closefd=False) for number in (1, 2))  # noqa: SIM115
        try:
            exec(code, {})
            app(["run", str(folder / "scene.toml"), "--out", str(folder)])
        except SystemExit as end:
            status = int(end.code or 0)
        except BaseException:
            traceback.print_exc()
        finally:
            sys.stdout.flush()
            sys.stderr.flush()
            os._exit(status)
    status = os.waitstatus_to_exitcode(os.waitpid(process, 0)[1])
    said = (folder / "said").read_text()
    (folder / "said").unlink()
    return status, said


def resumed(folder: Path) -> None:
    done = CliRunner().invoke(app, ["run", str(folder / "scene.toml"), "--out", str(folder), "--resume"])
    assert done.exit_code == 0, done.output


def assert_same_results(one: Path, other: Path) -> None:
    with open_dataset(one / "run.nc") as mine, open_dataset(other / "run.nc") as theirs:
        assert mine.attrs["status"] == theirs.attrs["status"] == "completed"
        for name in set(mine.variables) - {"contact_seconds"}:
            np.testing.assert_array_equal(mine[name].values, theirs[name].values)


@pytest.fixture(scope="module")
def undisturbed(tmp_path_factory: pytest.TempPathFactory) -> Path:
    folder = tmp_path_factory.mktemp("undisturbed")
    quick(folder)
    with pytest.MonkeyPatch.context() as patched:
        patched.setattr("scenes.run.wheelset_contact", lambda scene: SMOOTH)
        resumed(folder)
    return folder


def test_a_file_is_whole_or_the_old_one(tmp_path: Path) -> None:
    file = tmp_path / "folder" / "file.txt"
    with whole_file(file) as part:
        part.write_text("old")
    with pytest.raises(KeyboardInterrupt), whole_file(file) as part:  # noqa: PT012
        part.write_text("half of the n")
        raise KeyboardInterrupt
    assert file.read_text() == "old"
    assert [place.name for place in file.parent.iterdir()] == ["file.txt"]


def test_leftovers_of_killed_writers_go_after_a_day(tmp_path: Path) -> None:
    young, old = (tmp_path / f"{PART}{name}" for name in ("young", "old"))
    for part in (young, old):
        part.write_text("half")
    os.utime(old, (time.time() - 90_000.0,) * 2)
    with whole_file(tmp_path / "file"):
        pass
    assert sorted(os.listdir(tmp_path)) == [young.name, "file"]


@pytest.fixture
def small_files() -> object:
    """No file of this process may get longer than 4 kB: as good as a full disk, and needs no rights."""
    before = resource.getrlimit(resource.RLIMIT_FSIZE)
    handler = signal.signal(signal.SIGXFSZ, signal.SIG_IGN)
    resource.setrlimit(resource.RLIMIT_FSIZE, (4096, before[1]))
    yield
    resource.setrlimit(resource.RLIMIT_FSIZE, before)
    signal.signal(signal.SIGXFSZ, handler)


def test_full_disk_leaves_the_old_cache(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, request: pytest.FixtureRequest
) -> None:
    monkeypatch.setenv("WHEELRAIL_CACHE", str(tmp_path))
    store("name", {"values": np.arange(3)})
    request.getfixturevalue("small_files")
    with pytest.warns(UserWarning, match=r"cannot be written \(.*File too large.*going on without it"):
        store("name", {"values": np.arange(10_000)})
    assert list(load("name")["values"]) == [0, 1, 2]  # type: ignore[index]
    assert os.listdir(tmp_path) == ["name.npz"]


def test_full_disk_leaves_the_old_results(tmp_path: Path, small_files: object) -> None:
    (tmp_path / "run.nc").write_text("old")
    with pytest.raises(OSError, match=r"run\.nc|File too large"):
        write(Dataset({"values": ("n", np.random.default_rng(1).random(10_000))}), tmp_path / "run.nc")
    assert os.listdir(tmp_path) == ["run.nc"]
    assert (tmp_path / "run.nc").read_text() == "old"


def test_run_on_a_full_disk_goes_on_from_its_checkpoints(tmp_path: Path, undisturbed: Path) -> None:
    quick(tmp_path)
    full = (
        "import scenes.netcdf as n\ndef full(*given):\n    raise OSError(28, 'No space left on device')\nn.write = full"
    )
    status, said = stopped(tmp_path, full)
    assert status == 1
    assert "No space left on device" in said
    assert "Traceback" not in said
    assert sorted(os.listdir(tmp_path)) == ["run.checkpoints", "scene.toml"]
    resumed(tmp_path)
    assert_same_results(tmp_path, undisturbed)


@pytest.mark.parametrize("options", [("--json",), ()])
def test_results_that_cannot_be_printed_are_an_error(tmp_path: Path, options: tuple[str, ...]) -> None:
    (tmp_path / "scene.toml").write_text(standard(WHEELSET))
    with open("/dev/full", "w") as full:
        line = [sys.executable, "-m", "scenes.cli", "contact", str(tmp_path / "scene.toml"), *options]
        done = subprocess.run(line, stdout=full, stderr=subprocess.PIPE, text=True, env=ENVIRONMENT, timeout=60)
    assert done.returncode == 1
    assert done.stderr.splitlines()[-1] == "standard output: No space left on device"
    assert "Traceback" not in done.stderr


@pytest.mark.parametrize("spoiled", [b"", b"\x89HDF\r\n\x1a\n half", None])
def test_spoiled_results_are_computed_anew(tmp_path: Path, undisturbed: Path, spoiled: bytes | None) -> None:
    quick(tmp_path)
    whole = (undisturbed / "run.nc").read_bytes()
    (tmp_path / "run.nc").write_bytes(whole[: len(whole) // 2] if spoiled is None else spoiled)
    resumed(tmp_path)
    assert_same_results(tmp_path, undisturbed)


PHASES = {
    "import": "import builtins; kept = builtins.__import__\n"
    "def at(name, *given):\n    if name == 'scenes.run': stop()\n    return kept(name, *given)\n"
    "builtins.__import__ = at",
    "scene": "import scenes.scene as m; m.read_text = stop",
    "head": "import scenes.resume as m; m.head = stop",
    "contact": "import scenes.run as m; m.wheelset_contact = stop",
    "equilibrium": "import vehicle.simulate as m; m.equilibrium = stop",
    "steps": "import vehicle.simulate as m; m.Recorder.add = after(m.Recorder.add, 25)",
    "first checkpoint": "import os; os.replace = after(os.replace, 1)",
    "checkpoint": "import os; os.fsync = after(os.fsync, 3)",
    "half a checkpoint": "import os; kept = os.pwrite; calls = []\n"
    "def half(to, data, at):\n    calls.append(at)\n    if len(calls) == 3: kept(to, data[:99], at); stop()\n"
    "    return kept(to, data, at)\nos.pwrite = half",
    "results": "import xarray as m; m.Dataset.to_netcdf = after(m.Dataset.to_netcdf, 1)",
    "results in place": "import os; os.replace = after(os.replace, 2)",
    "end": "import scenes.journal as m; m.Journal.remove = stop",
}
STOP = """
import os, signal, time
def stop(*given, **options):
    os.kill(os.getpid(), signal.{signal})
    time.sleep(0.05)
    raise AssertionError("not stopped")
def after(kept, count):
    calls = []
    def stopping(*given, **options):
        calls.append(1)
        if len(calls) == count:
            os.kill(os.getpid(), signal.{signal})
        return kept(*given, **options)
    return stopping
"""


@pytest.mark.parametrize("phase", PHASES)
@pytest.mark.parametrize("how", ["SIGINT", "SIGKILL"])
def test_run_stopped_in_any_phase_ends_as_if_it_had_not_been(
    tmp_path: Path, undisturbed: Path, how: str, phase: str
) -> None:
    quick(tmp_path)
    status, said = stopped(tmp_path, STOP.format(signal=how) + PHASES[phase])
    assert "Traceback" not in said
    if how == "SIGKILL":
        assert status == -signal.SIGKILL, said
    elif phase not in ("results", "results in place"):  # where Ctrl-C comes too late to spoil anything
        assert status == 130, said
        assert re.search("^interrupted", said, re.MULTILINE)
    if (tmp_path / "run.nc").exists():
        open_dataset(tmp_path / "run.nc").close()
    resumed(tmp_path)
    assert_same_results(tmp_path, undisturbed)


def gone(process: int) -> bool:
    """Whether a process has ended within three seconds (a zombie has)."""
    for _ in range(60):
        try:
            if Path(f"/proc/{process}/stat").read_text().rsplit(")", 1)[1].split()[0] == "Z":
                return True
        except OSError:
            return True
        time.sleep(0.05)
    return False


@pytest.mark.parametrize("how", [signal.SIGINT, signal.SIGKILL])
def test_no_second_process_is_left(tmp_path: Path, how: signal.Signals) -> None:
    scene = quick(tmp_path, ("curve = 1.0", "curve = 900.0"))
    scene.write_text(scene.read_text().replace("[solver]", "[solver]\nworkers = 2"))
    script = "import os\nfrom scenes.cli import main\nmain()"
    line = [sys.executable, "-c", script, "run", str(scene), "--out", str(tmp_path)]
    with subprocess.Popen(line, stderr=subprocess.PIPE, stdout=subprocess.PIPE, text=True, env=ENVIRONMENT) as running:
        children = Path(f"/proc/{running.pid}/task/{running.pid}/children")
        for _ in range(600):
            if (tmp_path / "run.checkpoints").exists():
                break
            time.sleep(0.05)
        mine = [int(word) for word in children.read_text().split()]
        assert mine
        running.send_signal(how)
        said = running.communicate(timeout=30)
    assert running.returncode == (130 if how == signal.SIGINT else -how)
    assert "Traceback" not in said[1]
    assert all(gone(process) for process in mine)


COMPILED = """
from numba import config
import sys
config.CACHE_DIR = sys.argv[1]
import numpy as np
from meshes.compiled import compiled
@compiled
def total(values):
    found = 0.0
    for value in values:
        found += value * value
    return found
print(total(np.arange(5.0)), sum(total.stats.cache_hits.values()))
"""


def test_damaged_machine_code_is_made_again(tmp_path: Path) -> None:
    script = tmp_path / "script.py"
    script.write_text(COMPILED)

    def hits(limit: Callable[[], None] | None = None) -> str:
        line = [sys.executable, str(script), str(tmp_path / "code")]
        done = subprocess.run(line, capture_output=True, text=True, env=ENVIRONMENT, timeout=60, preexec_fn=limit)
        assert done.returncode == 0, done.stderr
        answer, found = done.stdout.split()
        assert answer == "30.0"
        return found

    def full() -> None:
        signal.signal(signal.SIGXFSZ, signal.SIG_IGN)
        resource.setrlimit(resource.RLIMIT_FSIZE, (100, 100))

    assert hits(full) == "0"
    assert (hits(), hits()) == ("0", "1")
    for ending in ("nbi", "nbc"):
        (file,) = (tmp_path / "code").rglob(f"*.{ending}")
        whole = file.read_bytes()
        for damaged in (b"", whole[: len(whole) // 2], whole[:-50] + bytes([whole[-50] ^ 4]) + whole[-49:]):
            file.write_bytes(damaged)
            assert hits() == "0"
            while hits() == "0":  # an index that was in the way is emptied first, and then written
                pass
