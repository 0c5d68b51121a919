"""Interrupted or killed runs resume to bitwise identical results."""

from __future__ import annotations

import errno
import json
import os
import re
import signal
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from rich.console import Console
from small_strips import few_strips
from spring_contact import patch
from standin_contact import CONTACT
from typer.testing import CliRunner
from xarray import open_dataset

from wheelrail.cli.main import app
from wheelrail.contact.kinematics.frames import Pose, RigidMotion, Side
from wheelrail.contact.kinematics.wheelset_state import WheelsetState
from wheelrail.contact.models.wheelset import WheelsetContact
from wheelrail.contact.results.result import ContactResult
from wheelrail.contact.results.vehicle_contact import VehicleContact
from wheelrail.scenes.runs.checkpoint_file import CheckpointFile, StillRunning, read_header
from wheelrail.scenes.runs.checkpoint_format import PACKAGES, Unreadable, checksum_of, entries
from wheelrail.scenes.runs.resume import differences
from wheelrail.scenes.runs.run import run_scene
from wheelrail.scenes.schema.errors import SceneError
from wheelrail.scenes.schema.scene import RunScene, parse_scene
from wheelrail.support.plain_data import decode, encode
from wheelrail.vehicle.integration.integrate import StepSettings
from wheelrail.vehicle.multibody.plane_wagon import wagon_dynamics
from wheelrail.vehicle.simulation.checkpoint import Checkpoint, Checkpoints
from wheelrail.vehicle.simulation.history import History
from wheelrail.vehicle.simulation.parallel_contact import in_threads
from wheelrail.vehicle.simulation.simulate import simulate
from wheelrail.vehicle.simulation.time_run import Recording
from wheelrail.vehicle.track.track import Track
from wheelrail.vehicle.wagon.wagon import Wagon

SCENES = Path(__file__).parents[2] / "scenes"
CURVE = Track.curve(curvature=1 / 600, cant=0.06, transition=20.0, length=200.0)
HEADER = {"scene": {"solver": {"rtol": 1e-3}}, "versions": {"wheelrail": "1"}}


def run(contact=CONTACT, *, checkpoints: Checkpoints | None = None, every=None, **options) -> History:  # type: ignore[no-untyped-def]
    dynamics, span = wagon_dynamics(Wagon(), CURVE, contact, 45.0), options.pop("span", (0.0, 0.2))
    return simulate(dynamics, span, steps=StepSettings(**options), recording=Recording(every, checkpoints))


def kept(steps: int, contact=CONTACT, **options) -> tuple[History, list[bytes]]:  # type: ignore[no-untyped-def]
    """A run, and its checkpoints as they were when they were handed out."""
    found: list[bytes] = []
    history = run(contact, checkpoints=Checkpoints(steps, lambda at: found.append(encode(at))), **options)
    return history, found


def resumed(steps: int, at: bytes, contact=CONTACT, **options) -> History:  # type: ignore[no-untyped-def]
    return run(contact, checkpoints=Checkpoints(steps, lambda _: None, decode(at, PACKAGES)), **options)


def assert_same(one: History, other: History) -> None:
    """All but seconds."""
    assert one.status == other.status
    for name in ("time", "state", "force", "moment", "approach"):
        np.testing.assert_array_equal(getattr(one, name), getattr(other, name))
    assert repr([row.patches for row in one.rows]) == repr([row.patches for row in other.rows])
    assert [row.contact_status for row in one.rows] == [row.contact_status for row in other.rows]
    assert one.cost.steps == other.cost.steps
    for side, cost in one.cost.contact.items():
        assert replace(cost, seconds=0.0, phases={}) == replace(other.cost.contact[side], seconds=0.0, phases={})


@pytest.mark.parametrize("every", [None, 0.007])
@pytest.mark.parametrize(("method", "steps"), [("ode23", 30), ("rosenbrock", 5)])
def test_resuming_from_any_checkpoint_is_bitwise_identical(method: str, steps: int, every: float | None) -> None:
    whole, found = kept(steps, method=method, every=every)
    assert whole.status == "completed"
    assert len(found) > 3
    for at in found:
        assert_same(resumed(steps, at, method=method, every=every), whole)


@pytest.mark.parametrize("method", ["ode23", "rosenbrock"])
def test_checkpoints_do_not_change_the_results(method: str) -> None:
    plain = run(method=method)
    for steps in (3, 10):
        assert_same(kept(steps, method=method)[0], plain)
    with pytest.raises(ValueError, match="1 at least"):
        Checkpoints(0, print)


@dataclass
class Clinging(VehicleContact):
    """Solves with an initial guess, but without one only in the middle; results depend on the guess."""

    def __call__(self, state: WheelsetState, side: Side, guess: ContactResult | None = None) -> ContactResult:
        if guess is None and abs(state.y) > 1e-9:
            return replace(ContactResult.separated(), status="failed: from nothing")
        result = CONTACT(state, side, guess)
        before = 0.0 if guess is None else float(guess.warm_start)  # type: ignore[arg-type]
        return replace(result, force=result.force * (1 + 1e-7 * np.sin(before)), warm_start=float(result.force[2]))


def test_checkpoints_where_contacts_depend_on_their_guess() -> None:
    plain = run(Clinging())
    whole, found = kept(5, Clinging())
    assert_same(whole, plain)
    assert len(found) == 1 + (len(whole) - 2) // 5
    for at in found[1::4]:
        assert_same(resumed(5, at, Clinging()), whole)


def test_few_strips_in_two_threads_resume_bitwise_identically() -> None:
    options = {"method": "rosenbrock", "rtol": 3e-3, "atol": 3e-6, "span": (0.0, 0.1)}
    with in_threads(few_strips(), 2) as contact:
        whole, found = kept(3, contact, **options)
    assert whole.status == "completed"
    assert len(found) > 2
    assert_same(run(few_strips(), **options), whole)
    with in_threads(few_strips(), 2) as contact:
        assert_same(resumed(3, found[1], contact, **options), whole)
    assert_same(resumed(3, found[-1], few_strips(), **options), whole)


def checkpoint_file(path: Path, messages: list[str] | None = None) -> CheckpointFile:
    return CheckpointFile(path, HEADER, [].append if messages is None else messages.append)


def written(file: Path) -> tuple[History, CheckpointFile, list[int]]:
    """A run, its checkpoint file, and the file's size in bytes after each checkpoint."""
    log, lengths = checkpoint_file(file), []

    def keep(at: Checkpoint) -> None:
        log.append(at)
        lengths.append(file.stat().st_size)

    return run(checkpoints=Checkpoints(30, keep)), log, lengths


def test_truncated_or_damaged_file_yields_the_previous_checkpoint(tmp_path: Path) -> None:
    file = tmp_path / "checkpoints"
    whole, _, lengths = written(file)
    content, steps = file.read_bytes(), np.diff(lengths)
    assert steps[2:].max() < 1.2 * steps[2:].min()  # rows are written once
    times = []
    for count, length in enumerate(lengths):
        for end in (length, length + 1, length + 300, length + 3000):  # into the next entry, or not
            (tmp_path / "torn").write_bytes(content[:end])
            at = checkpoint_file(tmp_path / "torn").latest()
            assert at is not None
            times.append((count, at.time, len(at.rows)))
    assert len(set(times)) == len(lengths)  # one for each, wherever the file is truncated
    spoiled = bytearray(content)
    spoiled[lengths[1] + 500] ^= 1
    (tmp_path / "torn").write_bytes(spoiled)
    log = checkpoint_file(tmp_path / "torn")
    at = log.latest()
    assert at is not None
    assert (1, at.time, len(at.rows)) in times
    # new entries replace the damaged ones
    assert_same(run(checkpoints=Checkpoints(30, log.append, at)), whole)
    again = checkpoint_file(tmp_path / "torn")
    log.stream.close()  # type: ignore[union-attr]
    at = again.latest()
    assert at is not None
    assert (len(lengths) - 1, at.time, len(at.rows)) in times
    (tmp_path / "torn").write_bytes(content[: lengths[0] - 1])
    assert checkpoint_file(tmp_path / "torn").latest() is None  # the very first was cut off
    for other in (b"", b"{}\n", b"\xff\xfe", content[40:]):
        (tmp_path / "torn").write_bytes(other)
        assert read_header(tmp_path / "torn") is None


def test_a_flipped_bit_anywhere_is_detected(tmp_path: Path) -> None:
    file = tmp_path / "checkpoints"
    lengths = written(file)[2]
    content = file.read_bytes()
    header = content.find(b"\n") + 1
    checkpoints = [encode(at) for _, _, at in entries(content)]
    assert len(checkpoints) == len(lengths)
    places = np.random.default_rng(7).integers(0, len(content), 40).tolist()
    for start in (header, *lengths[:-1]):
        places += [start - 1, start, start + 7, start + 8, start + 40]  # length, checksum, payload
    for place in places:
        damaged = bytearray(content)
        damaged[place] ^= 1 << place % 8
        intact = sum(length <= place for length in lengths) if place >= header else 0
        assert [encode(at) for _, _, at in entries(bytes(damaged))] == checkpoints[:intact]


def test_entries_of_two_writers_are_kept_apart(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    def lockf(*given: object) -> None:
        raise OSError(errno.ENOLCK, "No locks available")

    monkeypatch.setattr("fcntl.lockf", lockf)
    first, *later = (decode(at, PACKAGES) for at in kept(30)[1])
    file = tmp_path / "checkpoints"
    checkpoint_file(file).append(first)
    writers = [checkpoint_file(file) for _ in range(2)]
    for writer in writers:
        assert writer.latest() is not None
    for number, writer, read in ((0, 0, [0]), (0, 1, [1]), (1, 0, [1]), (2, 0, [1]), (1, 1, [1, 1])):
        writers[writer].append(replace(later[number], error=float(writer)))
        assert [at.error for _, _, at in entries(file.read_bytes())][1:] == read


def test_full_disk_ends_neither_run_nor_checkpoints(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    messages: list[str] = []
    log, count, put = checkpoint_file(tmp_path / "checkpoints", messages), 0, os.pwrite
    full = range(3, 5)

    def pwrite(handle: int, data: bytes, at: int) -> int:
        if count in full:
            put(handle, data[: len(data) // 2], at)
            raise OSError(errno.ENOSPC, "No space left on device")
        return put(handle, data, at)

    def keep(at: Checkpoint) -> None:
        nonlocal count
        log.append(at)
        count += 1
        found.append(len(checkpoint_file(tmp_path / "copy").latest().rows) if copied() else 0)  # type: ignore[union-attr]

    def copied() -> bool:
        if log.path.exists():
            (tmp_path / "copy").write_bytes(log.path.read_bytes())
        return log.path.exists()

    found: list[int] = []
    monkeypatch.setattr(os, "pwrite", pwrite)
    whole = run(checkpoints=Checkpoints(30, keep))
    assert whole.status == "completed"
    assert found == [1, 31, 61, 61, 61, *range(151, 31 * len(found), 30)][: len(found)]
    assert len(messages) == 2
    assert "not written: No space left on device; the run continues" in messages[0]
    full, count = range(9), 0
    other = checkpoint_file(tmp_path / "other", messages)
    assert run(checkpoints=Checkpoints(30, other.append), span=(0.0, 0.02)).status == "completed"
    assert sorted(p.name for p in tmp_path.iterdir()) == ["checkpoints", "copy"]


def test_a_checkpoint_file_has_one_writer(tmp_path: Path) -> None:
    _, log, _ = written(tmp_path / "checkpoints")
    child = os.fork()
    if child == 0:
        try:
            checkpoint_file(log.path).latest()
        except StillRunning:
            os._exit(7)
        os._exit(0)
    assert os.waitstatus_to_exitcode(os.waitpid(child, 0)[1]) == 7


def crafted(file: Path, payload: bytes) -> Path:
    """A checkpoint file with the right header and checksum and a payload of its author's choice."""
    line = json.dumps(HEADER).encode() + b"\n"
    file.write_bytes(line + len(payload).to_bytes(8) + checksum_of(checksum_of(line), payload) + payload)
    return file


def test_a_pickle_in_a_checkpoint_file_is_not_read(tmp_path: Path) -> None:
    # a dtype with a flag for objects, state of a pickled array: crashed the process through a restricted unpickler
    flags = b"cnumpy\ndtype\n(Vf8\nI00\nI01\ntR(I3\nV|\nNNNI-1\nI-1\nI63\ntb."
    for payload in (flags, b"cos\nmkdir\n(V" + bytes(tmp_path / "harmed") + b"\ntR."):
        with pytest.raises(Unreadable, match="unreadable checkpoint"):
            checkpoint_file(crafted(tmp_path / "checkpoints", payload)).latest()
    assert not (tmp_path / "harmed").exists()


def test_a_checkpoint_with_other_values_is_not_read(tmp_path: Path) -> None:
    at = decode(kept(30)[1][1], PACKAGES)
    row = at.rows[0]
    spoiled = [
        replace(at, time="0.1"),
        replace(at, error=float("nan")),
        replace(at, step=3),
        replace(at, state=at.state.astype(np.float32)),
        replace(at, state=at.state[:, None]),
        replace(at, cost=None),
        replace(at, guess=3),
        replace(at, rows=[replace(row, state=row.state[1:])]),
        replace(at, rows=[replace(row, force=row.moment[:, :1])]),
        row,
    ]
    for other in spoiled:
        with pytest.raises(Unreadable, match="its values are not those of a run"):
            checkpoint_file(crafted(tmp_path / "checkpoints", encode(other))).latest()
    assert checkpoint_file(crafted(tmp_path / "checkpoints", encode(at))).latest() is not None
    with pytest.raises(ValueError, match="checkpoint: a state of shape"):
        run(checkpoints=Checkpoints(30, print, replace(at, state=at.state[:-1])))
    two = replace(row, force=np.concatenate([row.force] * 2))
    for other in (replace(at, rows=[two]), replace(at, guess={"wheelset_1": at.guess["wheelset"]})):
        with pytest.raises(ValueError, match="forces of other wheelsets: must be those of wheelset"):
            run(checkpoints=Checkpoints(30, print, other))


def test_a_checkpoint_of_another_vehicle_is_one_line(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    text = (SCENES / "curve.toml").read_text(encoding="utf-8").replace("workers = 2", "workers = 1")
    at, scene = decode(kept(30)[1][1], PACKAGES), parse_scene(text)
    assert isinstance(scene, RunScene)
    other = replace(at, state=at.state[:-1])
    monkeypatch.setattr("wheelrail.scenes.runs.run.run_contact", lambda scene, names: (CONTACT, None))
    monkeypatch.setattr("wheelrail.scenes.runs.resume.latest", lambda *given: other)
    with pytest.raises(SceneError, match=r"checkpoints.*a state of shape \(19,\): must be \(20,\); omit --resume"):
        run_scene(scene, text, tmp_path, Console(), resume=True)


def test_a_pipe_in_place_of_a_checkpoint_file_is_none(tmp_path: Path) -> None:
    os.mkfifo(tmp_path / "checkpoints")
    assert read_header(tmp_path / "checkpoints") is None
    for content in (b"[" * 100_000, b'{"scene": 1, "versions": []}\n'):
        (tmp_path / "other").write_bytes(content)
        assert read_header(tmp_path / "other") is None


def test_differing_keys_are_named() -> None:
    then = {"friction": 0.3, "solver": {"rtol": 1e-3, "workers": 1}, "output": {"figures": True}}
    now = {"friction": 0.3, "solver": {"rtol": 1e-4, "workers": 2}, "output": {"figures": False}, "falling": None}
    assert list(differences(then, now)) == ["solver.rtol: 0.001 before, 0.0001 now"]
    assert list(differences(now, {**now, "falling": {"rate": 2.0}})) == ['falling: null before, {"rate": 2.0} now']


@dataclass
class Stopping:
    """A smooth spring with a patch, that ends its process, or interrupts it, at one of its solves."""

    at: int = 0
    by: int = signal.SIGKILL
    calls: int = 0

    def __call__(self, pose: Pose, motion: RigidMotion, guess: ContactResult | None = None) -> ContactResult:
        self.calls += 1
        if self.calls == self.at:
            os.kill(os.getpid(), self.by)
        result = CONTACT.model(pose, motion, guess)
        return replace(result, patches=(patch(float(result.force[2]), result.force),) * result.ok)


def command(folder: Path, *options: str, contact: Stopping | None = None, **changes: str) -> Any:
    """`wheelrail run` on a short curve in this process; changes to the scene by key."""
    changes = {"tangent": "2.0", "transition_length": "10.0", "curve": "1.0", **changes}
    text = (SCENES / "paper_curve.toml").read_text()
    for key, value in changes.items():
        text = re.sub(rf"^{key} = .*$", f"{key} = {value}", text, flags=re.MULTILINE)
    folder.mkdir(exist_ok=True)
    scene = folder / "scene.toml"
    scene.write_text(text.replace("[output]", "[output]\ncheckpoint = 30\nfigures = false"))
    model = WheelsetContact(contact or Stopping(), CONTACT.mounting)
    with pytest.MonkeyPatch.context() as patched:
        patched.setattr("wheelrail.scenes.runs.run.run_contact", lambda scene, names: (model, None))
        return CliRunner().invoke(app, ["run", str(scene), "--out", str(folder), *options])


def killed(folder: Path, *options: str, at: int) -> None:
    """The same in a separate process, killed at one of its solves."""
    process = os.fork()
    if process == 0:
        command(folder, *options, contact=Stopping(at))
        os._exit(0)
    assert os.waitstatus_to_exitcode(os.waitpid(process, 0)[1]) == -signal.SIGKILL


def assert_same_results(one: Path, other: Path) -> None:
    with open_dataset(one / "run.nc") as mine, open_dataset(other / "run.nc") as theirs:
        assert set(mine.variables) == set(theirs.variables)
        for name in set(mine.variables) - {"contact_seconds"}:
            np.testing.assert_array_equal(mine[name].values, theirs[name].values)
        for key in set(mine.attrs) - {"seconds", "created"}:
            assert mine.attrs[key] == theirs.attrs[key]


def test_repeatedly_killed_run_gives_identical_results(tmp_path: Path) -> None:
    whole, broken = tmp_path / "whole", tmp_path / "broken"
    assert command(whole).exit_code == 0
    killed(broken, "--resume", at=3)  # before the first checkpoint
    assert not (broken / "run.checkpoints").exists()
    for at in np.random.default_rng(5).integers(250, 450, 3).tolist():
        killed(broken, "--resume", at=at)
    stopped = command(broken, "--resume", contact=Stopping(150, signal.SIGINT))
    assert stopped.exit_code == 130
    assert "--resume continues the run" in stopped.stdout
    assert (broken / "run.nc").exists()
    refused = command(broken, "--resume", rtol="2e-3")
    assert (refused.exit_code, "solver.rtol: 0.001 before, 0.002 now" in refused.stderr) == (2, True)
    assert (broken / "run.checkpoints").exists()
    done = command(broken, "--resume")
    assert done.exit_code == 0, done.stderr
    assert "continues from the checkpoint at 0." in done.stderr
    assert "completed at 13.0 m" in done.stdout
    assert_same_results(whole, broken)
    assert sorted(file.name for file in broken.iterdir()) == ["run.nc", "scene.toml"]
    again = command(broken, "--resume")
    assert (again.exit_code, "is complete" in again.stdout) == (0, True)
    other = command(broken, "--resume", friction="0.2")
    assert (other.exit_code, "friction: 0.3 before, 0.2 now" in other.stderr) == (2, True)


def test_without_resume_a_run_starts_from_the_beginning(tmp_path: Path) -> None:
    killed(tmp_path, at=400)
    before = (tmp_path / "run.checkpoints").read_bytes()
    done = command(tmp_path, contact=Stopping(5, signal.SIGINT), rtol="2e-3")
    assert "--resume continues it" in " ".join(done.stderr.split())
    assert (tmp_path / "run.checkpoints").read_bytes() == before  # as long as the new run has none
    other = command(tmp_path / "new", "--resume", rtol="2e-3", curve="0.5")
    assert "starts from the beginning" in " ".join(other.stderr.split())
    assert command(tmp_path, rtol="2e-3", curve="0.5").exit_code == 0
    assert not (tmp_path / "run.checkpoints").exists()
    assert_same_results(tmp_path, tmp_path / "new")
