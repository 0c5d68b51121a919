"""Full disks, damaged files, Ctrl-C and kills in every phase: incomplete files are never read, results are not lost."""

from __future__ import annotations

import os
import re
import shutil
import signal
import subprocess
import sys
import time
import traceback
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest
from full_disk import files_up_to
from malformed_inputs import CURVE, WHEELSET, changed, standard
from standin_contact import CONTACT
from study_workers import Here
from test_resume import Stopping
from typer.testing import CliRunner
from xarray import Dataset, open_dataset

from wheelrail.cli.main import app
from wheelrail.contact.models.wheelset import WheelsetContact
from wheelrail.scenes.datasets.netcdf import write
from wheelrail.support.atomic_file import PART, atomic_file
from wheelrail.support.cache import load, store

ROOT = Path(__file__).parents[2]
SMOOTH = WheelsetContact(Stopping(), CONTACT.mounting)  # a spring with patches, without state
ENVIRONMENT = {
    **os.environ,
    "PYTHONPATH": os.pathsep.join([str(ROOT), str(ROOT / "tests/helpers"), str(ROOT / "tests/scenes")]),
}


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
    monkeypatch.setattr("wheelrail.scenes.runs.run.run_contact", lambda scene, names: (SMOOTH, None))


def stopped(folder: Path, code: str, *line: str) -> tuple[int, str]:
    """Runs a command in a separate process after some code: exit code, or minus the signal's number, and output."""
    reads, writes = os.pipe()
    process = os.fork()
    if process == 0:
        status = 99
        for number in (1, 2):
            os.dup2(writes, number)
        sys.stdout, sys.stderr = (open(number, "w", closefd=False) for number in (1, 2))  # noqa: SIM115
        try:
            exec(code, {})
            app([*line] or ["run", str(folder / "scene.toml"), "--out", str(folder)])
        except SystemExit as end:
            status = int(end.code or 0)
        except BaseException:
            traceback.print_exc()
        finally:
            try:
                sys.stdout.flush()
                sys.stderr.flush()
            finally:
                os._exit(status)
    os.close(writes)
    with open(reads) as said:
        text = said.read()
    return os.waitstatus_to_exitcode(os.waitpid(process, 0)[1]), text


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
        patched.setattr("wheelrail.scenes.runs.run.run_contact", lambda scene, names: (SMOOTH, None))
        resumed(folder)
    return folder


def test_files_are_written_atomically(tmp_path: Path) -> None:
    file = tmp_path / "folder" / "file.txt"
    with atomic_file(file) as part:
        part.write_text("old")
    with pytest.raises(KeyboardInterrupt), atomic_file(file) as part:  # noqa: PT012
        part.write_text("half of the n")
        raise KeyboardInterrupt
    assert file.read_text() == "old"
    assert [place.name for place in file.parent.iterdir()] == ["file.txt"]


def test_temporaries_of_a_dead_process_are_removed_at_the_next_start(tmp_path: Path) -> None:
    child = os.fork()
    if child == 0:
        with atomic_file(tmp_path / "file"):
            os.kill(os.getpid(), signal.SIGKILL)
    os.waitpid(child, 0)
    assert len(os.listdir(tmp_path)) == 1
    with atomic_file(tmp_path / "file"):
        running = os.listdir(tmp_path)
        assert len(running) == 1
        with atomic_file(tmp_path / "other"):
            assert set(running) < set(os.listdir(tmp_path))  # of a living process, this one
    assert sorted(os.listdir(tmp_path)) == ["file", "other"]


@pytest.mark.parametrize("mask", [0o022, 0o027, 0o002])
def test_files_have_the_permissions_of_the_mask(tmp_path: Path, mask: int) -> None:
    before = os.umask(mask)
    try:
        with atomic_file(tmp_path / "file") as part:
            assert part.stat().st_mode & 0o777 == 0o600
    finally:
        assert os.umask(before) == mask
    assert (tmp_path / "file").stat().st_mode & 0o777 == 0o666 & ~mask


def test_any_error_on_a_full_disk_says_so(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    (tmp_path / "file").write_text("old")
    usage = shutil.disk_usage(tmp_path)
    for free, expected in ((1000, OSError), (usage.free, RuntimeError)):
        monkeypatch.setattr(shutil, "disk_usage", lambda folder, free=free: usage._replace(free=free))
        with pytest.raises(expected) as caught, atomic_file(tmp_path / "file"):
            raise RuntimeError("NetCDF: HDF error")
        assert ("No space left on device" in str(caught.value)) == (free == 1000)
    assert (os.listdir(tmp_path), (tmp_path / "file").read_text()) == (["file"], "old")


def test_stale_temporaries_are_removed_after_a_day(tmp_path: Path) -> None:
    young, old = (tmp_path / f"{PART}{name}" for name in ("young", "old"))
    for part in (young, old):
        part.write_text("half")
    os.utime(old, (time.time() - 90_000.0,) * 2)
    with atomic_file(tmp_path / "file"):
        pass
    assert sorted(os.listdir(tmp_path)) == [young.name, "file"]


def test_full_disk_keeps_the_previous_cache(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("WHEELRAIL_CACHE", str(tmp_path))
    store("name", {"values": np.arange(3)})
    message = r"cannot be written \(.*File too large.*continuing without it"
    with files_up_to(4096), pytest.warns(UserWarning, match=message):
        store("name", {"values": np.arange(10_000)})
    assert list(load("name")["values"]) == [0, 1, 2]  # type: ignore[index]
    assert os.listdir(tmp_path) == ["name.npz"]


def test_full_disk_keeps_the_previous_results(tmp_path: Path) -> None:
    (tmp_path / "run.nc").write_text("old")
    with files_up_to(4096), pytest.raises(OSError, match=r"run\.nc|File too large"):
        write(Dataset({"values": ("n", np.random.default_rng(1).random(10_000))}), tmp_path / "run.nc")
    assert os.listdir(tmp_path) == ["run.nc"]
    assert (tmp_path / "run.nc").read_text() == "old"


FULL = """
import resource, signal, sys
import numpy as np
from pathlib import Path
from xarray import Dataset
from wheelrail.scenes.datasets.netcdf import write
signal.signal(signal.SIGXFSZ, signal.SIG_IGN)
resource.setrlimit(resource.RLIMIT_FSIZE, (20_000, 20_000))
try:
    write(Dataset({f"values {k}": ("n", np.random.default_rng(k).random(1000)) for k in range(20)}), Path(sys.argv[1]))
except OSError as error:
    sys.exit(f"{error.strerror}")
"""


def test_process_that_fills_a_disk_ends_in_order(tmp_path: Path) -> None:
    line = [sys.executable, "-c", FULL, str(tmp_path / "run.nc")]
    done = subprocess.run(line, capture_output=True, text=True, env=ENVIRONMENT, timeout=300)
    assert (done.returncode, done.stderr) == (1, "File too large\n")  # not a crash of HDF5 at exit
    assert os.listdir(tmp_path) == []


def test_run_on_a_full_disk_resumes_from_its_checkpoints(tmp_path: Path, undisturbed: Path) -> None:
    quick(tmp_path)
    full = (
        "import wheelrail.scenes.datasets.netcdf as n\n"
        "def full(*given):\n    raise OSError(28, 'No space left on device')\n"
        "n.write = full"
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
        line = [sys.executable, "-m", "wheelrail.cli", "contact", str(tmp_path / "scene.toml"), *options]
        done = subprocess.run(line, stdout=full, stderr=subprocess.PIPE, text=True, env=ENVIRONMENT, timeout=300)
    assert done.returncode == 1
    assert done.stderr.splitlines()[-1] == "standard output: No space left on device"
    assert "Traceback" not in done.stderr


@pytest.mark.parametrize("spoiled", [b"", b"\x89HDF\r\n\x1a\n half", None])
def test_damaged_results_are_recomputed(tmp_path: Path, undisturbed: Path, spoiled: bytes | None) -> None:
    quick(tmp_path)
    whole = (undisturbed / "run.nc").read_bytes()
    (tmp_path / "run.nc").write_bytes(whole[: len(whole) // 2] if spoiled is None else spoiled)
    resumed(tmp_path)
    assert_same_results(tmp_path, undisturbed)


BEFORE = {  # nothing is written yet
    "import": "import builtins; kept = builtins.__import__\n"
    "def at(name, *given):\n    if name == 'wheelrail.scenes.runs.run': stop()\n    return kept(name, *given)\n"
    "builtins.__import__ = at",
    "scene": "import wheelrail.scenes.schema.scene as m; m.read_text = stop",
    "header": "import wheelrail.scenes.runs.resume as m; m.header = stop",
    "contact": "import wheelrail.scenes.runs.run as m; m.run_contact = stop",
    "equilibrium": "import wheelrail.vehicle.simulation.time_run as m; m.start_state = stop",
}
PHASES = {
    "steps": "import wheelrail.vehicle.simulation.time_run as m; m.Recorder.add = after(m.Recorder.add, 25)",
    "first checkpoint": "import os; os.replace = after(os.replace, 1)",
    "checkpoint": "import os; os.fsync = after(os.fsync, 3)",
    "half a checkpoint": "import os; kept = os.pwrite; calls = []\n"
    "def half(to, data, at):\n    calls.append(at)\n    if len(calls) == 3: kept(to, data[:99], at); stop()\n"
    "    return kept(to, data, at)\nos.pwrite = half",
    "results": "import xarray as m; m.Dataset.dump_to_store = after(m.Dataset.dump_to_store, 1)",
    "results in place": "import os; os.replace = after(os.replace, 2)",
    "end": "import wheelrail.scenes.runs.checkpoint_file as m; m.CheckpointFile.remove = stop",
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


@pytest.mark.parametrize("phase", BEFORE)
def test_a_run_interrupted_at_its_start_leaves_nothing(tmp_path: Path, phase: str) -> None:
    quick(tmp_path)
    status, said = stopped(tmp_path, STOP.format(signal="SIGINT") + BEFORE[phase])
    assert status == 130, said
    assert re.search("^interrupted", said, re.MULTILINE)
    assert "Traceback" not in said
    assert os.listdir(tmp_path) == ["scene.toml"]


@pytest.mark.parametrize("phase", PHASES)
@pytest.mark.parametrize("how", ["SIGINT", "SIGKILL"])
def test_interrupted_run_resumes_to_identical_results(tmp_path: Path, undisturbed: Path, how: str, phase: str) -> None:
    quick(tmp_path)
    status, said = stopped(tmp_path, STOP.format(signal=how) + PHASES[phase])
    assert "Traceback" not in said
    if how == "SIGKILL":
        assert status == -signal.SIGKILL, said
    elif phase not in ("results", "results in place"):  # phases in which the results are already written
        assert status == 130, said
        assert re.search("^interrupted", said, re.MULTILINE)
    if (tmp_path / "run.nc").exists():
        open_dataset(tmp_path / "run.nc").close()
    resumed(tmp_path)
    assert_same_results(tmp_path, undisturbed)


LITTLE = """
import resource, signal
signal.signal(signal.SIGXFSZ, signal.SIG_IGN)
resource.setrlimit(resource.RLIMIT_FSIZE, ({size}, {size}))
"""
DRAWN = "import matplotlib.figure as m; m.Figure.savefig = after(m.Figure.savefig, 1)"


def contact_with_picture(folder: Path, code: str) -> tuple[int, str]:
    (folder / "scene.toml").write_text(standard(WHEELSET))
    return stopped(folder, code, "contact", str(folder / "scene.toml"), "--picture", str(folder / "patches.png"))


@pytest.mark.parametrize(
    "phase",
    [
        "from wheelrail.contact.models.standard.model import StandardContact as m; m.results = after(m.results, 2)",
        "import wheelrail.scenes.contacts.solve as m; m.solution_dataset = stop",
        "import wheelrail.scenes.contacts.table as m; m.table = stop",
        DRAWN,
    ],
)
def test_ctrl_c_in_a_contact(tmp_path: Path, phase: str) -> None:
    status, said = contact_with_picture(tmp_path, STOP.format(signal="SIGINT") + phase)
    assert status == 130, said
    assert said.splitlines()[-1] == "interrupted"
    assert "Traceback" not in said
    assert os.listdir(tmp_path) == ["scene.toml"]


SOLVE = """
kind = "hertz"
model = "{model}"
laws = "paper"
friction = 0.3
{depth}
speed = 10.0
creepage = [1e-3, 0.0, 0.0]
surface_size = 4e-3
upper = {{radii = [0.46, 0.3], E = 210e9, nu = 0.3}}
lower = {{radii = [inf, 0.3], E = 210e9, nu = 0.3}}
"""
WITHIN = {
    "full": "import wheelrail.contact.models.full.newton as m; m.Newton._update = after(m.Newton._update, 2)",
    "condensed": "import wheelrail.contact.solvers.semismooth_newton as m; m.newton = after(m.newton, 1)",
}


@pytest.mark.parametrize(("model", "depth"), [("full", "approach = 15e-6"), ("condensed", "load = 20e3")])
def test_ctrl_c_within_a_solve(tmp_path: Path, model: str, depth: str) -> None:
    (tmp_path / "scene.toml").write_text(SOLVE.format(model=model, depth=depth))
    code = STOP.format(signal="SIGINT") + WITHIN[model] + "\nfrom wheelrail.cli.entry import main\nmain()"
    # no fork of this process: MPI and PETSc, once loaded by another test, wait for ever in the copy
    line = [sys.executable, "-c", code, "contact", str(tmp_path / "scene.toml")]
    done = subprocess.run(line, capture_output=True, text=True, env=ENVIRONMENT, timeout=120)
    assert done.returncode == 130, done.stderr
    assert done.stderr.splitlines()[-1] == "interrupted"
    assert "Traceback" not in done.stderr


def test_picture_on_a_full_disk(tmp_path: Path) -> None:
    status, said = contact_with_picture(tmp_path, LITTLE.format(size=4096))
    assert status == 1, said
    assert "patches.png: [Errno 27] File too large" in said
    assert "Traceback" not in said
    assert os.listdir(tmp_path) == ["scene.toml"]


def test_ctrl_c_in_a_comparison(tmp_path: Path) -> None:
    scene = quick(tmp_path)
    scene.write_text(scene.read_text().replace('model = "standard"', 'model = "condensed"'))
    phase = "import wheelrail.vehicle.simulation.time_run as m; m.Recorder.add = after(m.Recorder.add, {count})"
    line = ("compare", str(scene), "--out", str(tmp_path / "out"))
    first = stopped(tmp_path, STOP.format(signal="SIGINT") + phase.format(count=5), *line)
    second = stopped(tmp_path, STOP.format(signal="SIGINT") + DRAWN, *line)
    third = stopped(tmp_path, "import wheelrail.scenes.plots.comparison as m; m.PICTURES.clear()", *line)  # quick
    assert [status for status, _ in (first, second, third)] == [130, 130, 0], (first, second, third)
    assert not any("Traceback" in said for _, said in (first, second, third))
    assert third[1].count("already contains this run") == 2
    assert not list((tmp_path / "out").rglob(f"{PART}*"))


STUDY = 'kind = "study"\nscene = "scene.toml"\nworkers = 1\n[grid]\nfriction = [0.1, 0.2, 0.3, 0.4]\n'
IN_A_THREAD = (
    "from study_workers import Here; import wheelrail.scenes.studies.run as m; m.processes = lambda count: Here()\n"
)


def study_of_four(folder: Path, code: str, how: str = "SIGINT") -> tuple[int, str]:
    (folder / "scene.toml").write_text(standard(WHEELSET))
    (folder / "study.toml").write_text(STUDY)
    return stopped(folder, STOP.format(signal=how) + IN_A_THREAD + code, *study_line(folder))


def study_line(folder: Path) -> tuple[str, ...]:
    return ("study", str(folder / "study.toml"), "--out", str(folder / "out"))


@pytest.fixture
def restarted(tmp_path: Path, here: Here) -> Callable[[], str]:
    """Output of a study's restart, in this process and without its figure."""

    def restart() -> str:
        with pytest.MonkeyPatch.context() as patched:
            patched.setattr("wheelrail.scenes.studies.plots.draw_study", lambda data, folder: [])
            done = CliRunner().invoke(app, study_line(tmp_path))
        assert done.exit_code == 0, done.output
        return done.output

    return restart


@pytest.mark.parametrize("count", [1, 4])
def test_a_study_killed_among_its_cases_repeats_none(tmp_path: Path, restarted: Callable[[], str], count: int) -> None:
    """Killed as soon as some cases are stored; the restart leaves these alone and computes the others."""
    killing = (
        "import wheelrail.scenes.studies.store as m; save = m.Store.save; saved = []\n"
        "def killed(*given, **options):\n    save(*given, **options); saved.append(1)\n"
        f"    if len(saved) == {count}: stop()\n"
        "m.Store.save = killed"
    )
    status, said = study_of_four(tmp_path, killing, "SIGKILL")
    assert status == -signal.SIGKILL, said
    cases = tmp_path / "out" / "cases"
    before = {file.name: file.stat().st_mtime_ns for file in cases.glob("*.json")}
    assert len(before) == count
    assert f"{count} of 4 cases are already computed" in restarted()
    after = {file.name: file.stat().st_mtime_ns for file in cases.glob("*.json")}
    assert before.items() <= after.items()
    assert len(after) == 4


@pytest.mark.parametrize(
    ("phase", "kept", "code"),
    [
        (
            "import wheelrail.scenes.studies.plan as m; m.plan = stop",
            0,
            130,
        ),
        ("import wheelrail.scenes.studies.store as m; m.Store.save = after(m.Store.save, 2)", 1, 130),
        ("import os; os.replace = after(os.replace, 3)", 2, 130),
        ("import xarray as m; m.Dataset.dump_to_store = after(m.Dataset.dump_to_store, 1)", 4, 0),
        (DRAWN, 4, 130),
    ],
)
def test_ctrl_c_in_a_study(tmp_path: Path, restarted: Callable[[], str], phase: str, kept: int, code: int) -> None:
    status, said = study_of_four(tmp_path, phase)
    assert status == code, said
    assert "Traceback" not in said
    assert ("interrupted" in said) == (code == 130)
    cases = tmp_path / "out" / "cases"
    before = {file.name: file.stat().st_mtime_ns for file in cases.glob("*.json")} if cases.exists() else {}
    assert len(before) >= kept
    assert not list(tmp_path.rglob(f"{PART}*"))
    restarted()
    assert before.items() <= {file.name: file.stat().st_mtime_ns for file in cases.glob("*.json")}.items()
    with open_dataset(tmp_path / "out" / "study.nc") as data:
        assert set(data["status"].values) == {"converged"}


@pytest.mark.parametrize("size", [100, 8000])
def test_study_on_a_full_disk(tmp_path: Path, restarted: Callable[[], str], size: int) -> None:
    """Cases cannot be stored, or cases can and the results cannot."""
    status, said = study_of_four(tmp_path, LITTLE.format(size=size))
    assert status == 1, said
    assert "Traceback" not in said
    assert ("a case not stored" in said) == (size == 100)
    assert len(list((tmp_path / "out" / "cases").glob("*.json"))) == (0 if size == 100 else 4)
    assert not (tmp_path / "out" / "study.nc").exists()
    assert not list(tmp_path.rglob(f"{PART}*"))
    assert ("4 of 4 cases are already computed" in restarted()) == (size != 100)
