"""Runs of a vehicle in three dimensions: results, report, and runs resumed after an end by force."""

from __future__ import annotations

import os
import re
import signal
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from linear_creep import LinearCreep
from typer.testing import CliRunner
from xarray import Dataset, load_dataset

import wheelrail as wr
from wheelrail.cli.main import app
from wheelrail.contact.kinematics.frames import Side
from wheelrail.contact.kinematics.wheelset_state import WheelsetState
from wheelrail.contact.results.result import ContactResult
from wheelrail.contact.results.vehicle_contact import VehicleContact
from wheelrail.scenes.builders.vehicle_file import MANCHESTER
from wheelrail.scenes.html_report.extremes import body_table
from wheelrail.scenes.html_report.write import write_report
from wheelrail.scenes.plots.runs import PICTURES
from wheelrail.scenes.runs.hunting import _bifurcation, fold_line, hunting_table
from wheelrail.scenes.schema.errors import SceneError
from wheelrail.vehicle.simulation.limit_cycle import LimitCycle

SCENE = Path(__file__).parents[2] / "scenes" / "vehicle.toml"
HUNTING = SCENE.with_name("hunting.toml")
SHORT = {"tangent": "11.0", "transition_length": "10.0", "curve": "1.0"}  # all wheelsets start on the tangent


@dataclass
class Stopping(VehicleContact):
    """Smooth conical wheels, with an end of the process, or an interrupt, at one of the solves."""

    contact: LinearCreep = field(default_factory=LinearCreep)
    at: int = 0
    by: int = signal.SIGKILL
    calls: int = 0

    def __call__(self, state: WheelsetState, side: Side, guess: ContactResult | None = None) -> ContactResult:
        self.calls += 1
        if self.calls == self.at:
            os.kill(os.getpid(), self.by)
        return self.contact(state, side, guess)


def command(
    folder: Path, *options: str, contact: Stopping | None = None, vehicle: Path = MANCHESTER, **changes: str
) -> Any:
    """`wheelrail run` of the vehicle on a short curve in this process; changes to the scene by key."""
    text = SCENE.read_text()
    for key, value in {**SHORT, **changes}.items():
        text = re.sub(rf"^{key} = .*$", f"{key} = {value}", text, flags=re.MULTILINE)
    folder.mkdir(exist_ok=True)
    scene = folder / "scene.toml"
    scene.write_text(f"{text}\n[output]\ncheckpoint = 5\nfigures = false\n")
    with pytest.MonkeyPatch.context() as patched:
        patched.setattr("wheelrail.scenes.runs.run.run_contact", lambda scene, names: (contact or Stopping(), None))
        return CliRunner().invoke(app, ["run", str(scene), "--vehicle", str(vehicle), "--out", str(folder), *options])


def killed(folder: Path, *options: str, at: int) -> None:
    """The same in a separate process, killed at one of its solves."""
    process = os.fork()
    if process == 0:
        command(folder, *options, contact=Stopping(at=at))
        os._exit(0)
    assert os.waitstatus_to_exitcode(os.waitpid(process, 0)[1]) == -signal.SIGKILL


def results(folder: Path) -> Dataset:
    return load_dataset(folder / "run.nc", engine="netcdf4", decode_times=False)


@pytest.fixture(scope="module")
def whole(tmp_path_factory: pytest.TempPathFactory) -> Path:
    folder = tmp_path_factory.mktemp("whole")
    done = command(folder)
    assert done.exit_code == 0, done.stderr
    assert "completed at 22.0 m" in done.stdout
    return folder


def test_a_killed_run_resumes_to_the_same_bits(whole: Path, tmp_path: Path) -> None:
    killed(tmp_path, "--resume", at=700)
    killed(tmp_path, "--resume", at=500)
    stopped = command(tmp_path, "--resume", contact=Stopping(at=300, by=signal.SIGINT))
    assert stopped.exit_code == 130
    assert "--resume continues the run" in stopped.stdout
    other = tmp_path / "other.toml"
    other.write_text(MANCHESTER.read_text().replace("mass = 32000.0", "mass = 32001.0"))
    refused = command(tmp_path, "--resume", vehicle=other)
    assert (refused.exit_code, "vehicle.file: " in refused.stderr) == (2, True)
    done = command(tmp_path, "--resume")
    assert done.exit_code == 0, done.stderr
    assert "continues from the checkpoint at" in done.stderr
    one, two = results(whole), results(tmp_path)
    assert set(one.variables) == set(two.variables)
    for name in set(one.variables) - {"contact_seconds"}:
        np.testing.assert_array_equal(one[name].values, two[name].values)
    again = command(tmp_path, "--resume")
    assert (again.exit_code, "is complete" in again.stdout) == (0, True)


def test_results_have_wheelsets(whole: Path) -> None:
    data = results(whole)
    assert dict(data.sizes) | {"time": 0} == {
        **{"time": 0, "body": 7, "wheelset": 4, "side": 2, "element": 16, "axis": 3, "patch": 1, "edge": 2, "cause": 4}
    }
    right = data.sel(side="right")
    np.testing.assert_array_equal(right["guiding_force"], right["lateral_force"])
    np.testing.assert_array_equal(data["guiding_force"].sel(side="left"), -data["lateral_force"].sel(side="left"))
    pair = data["guiding_force"].sel(side="right") - data["guiding_force"].sel(side="left")
    np.testing.assert_allclose(data["track_shifting_force"], pair, atol=1e-6)
    np.testing.assert_allclose(data["axle_load"].isel(time=0).sum(), 436368.42, rtol=1e-6)
    np.testing.assert_allclose(data["wheel_unloading"].isel(time=0), 0.0, atol=1e-3)
    springs = data["element_force"].sel(element="front_secondary_1", axis="z").isel(time=0)
    assert float(springs) == pytest.approx(78480.0, rel=1e-3)
    assert data.attrs["inputs"].count("a file of SHA-256") == 1
    assert all("units" in data[name].attrs for name in data.data_vars)


def test_report(whole: Path, tmp_path: Path) -> None:
    page = write_report(whole, tmp_path / "report.html", view=False).read_text(encoding="utf-8")
    assert "Running safety and track loading after EN 14363" in page
    assert "Y/Q, 2 m mean, left" in page
    for text in ("wheelset_4", "Plan view of the wheelsets", "unloading of a wheel", "Manchester benchmark vehicle 1"):
        assert text in page
    assert page.count("data:image/") == 11
    table = body_table(results(whole))
    assert {row[0]: row[table.head.index("pitch [mrad]")] for row in table.rows if row[0].startswith("wheelset")} == {
        f"wheelset_{i}": "–"
        for i in (1, 2, 3, 4)  # they roll
    }
    assert "the rise of its chord" in page


def test_explicit_methods_are_refused(tmp_path: Path) -> None:
    refused = command(tmp_path, method='"ode45"')
    assert refused.exit_code == 2
    assert 'solver.method = "ode45": must be "rosenbrock" or "rosenbrock4" with a vehicle file' in refused.stderr
    assert not (tmp_path / "run.nc").exists()


@dataclass(frozen=True)
class CubicSpring(LinearCreep):
    """With a lateral force of each wheel that grows with the cube of y, which limits hunting."""

    cubic: float = 3e11  # N/m3

    def __call__(self, state: WheelsetState, side: Side, guess: ContactResult | None = None) -> ContactResult:
        spring = LinearCreep(lateral=self.cubic * state.y**2, conicity=0.3)
        return spring(state, side, guess)


def hunting(*options: str, scene: Path = HUNTING, vehicle: Path = MANCHESTER) -> Any:
    with pytest.MonkeyPatch.context() as patched:
        patched.setattr("wheelrail.scenes.runs.steady.run_contact", lambda scene, names: (CubicSpring(), None))
        return CliRunner().invoke(app, ["hunting", str(scene), "--vehicle", str(vehicle), *options])


def test_hunting_command(tmp_path: Path) -> None:
    picture = tmp_path / "bifurcation.png"
    done = hunting("--speed", "20", "--longest", "1", "--fold", "1", "--picture", str(picture))
    assert done.exit_code == 0, done.stderr
    assert "nonlinear critical speed: needs a speed that keeps a limit cycle and a lower one" in done.stdout
    row = next(line for line in done.stdout.splitlines() if "not settled" in line or "dies out" in line)
    assert row.split()[0] == "20"
    assert picture.stat().st_size > 5000
    still = tmp_path / "still.toml"
    still.write_text(HUNTING.read_text().split("[kick]")[0])
    assert "kick: missing" in hunting(scene=still).stderr
    unknown = tmp_path / "unknown.toml"
    unknown.write_text(HUNTING.read_text().replace("front_bogie", "bogie"))
    refused = hunting(scene=unknown)
    assert (refused.exit_code, "kick.bogie: must be one of car_body, " in refused.stderr) == (2, True)
    refused = CliRunner().invoke(app, ["run", str(HUNTING), "--out", str(tmp_path / "plane")])
    assert (refused.exit_code, "kick: allowed only with a vehicle file" in refused.stderr) == (2, True)


def test_table_and_picture_state_the_bracket_of_the_fold() -> None:
    """Motions in the order of a bisection; the bracket is that of the two nearest ones."""
    known = {70.0: "limit cycle", 60.0: "dies out", 65.0: "limit cycle", 62.5: "dies out", 63.75: "not settled"}
    one = np.ones(1)
    cycles = [LimitCycle(v, v - 64.0, s, one, 6.0, one, 1.0, 1.0, np.zeros(0)) for v, s in known.items()]
    assert fold_line(cycles).endswith("between 62.5 m/s (dies out) and 65 m/s (limit cycle)")
    assert [row[0] for row in hunting_table(cycles, ["wheelset"]).as_text.rows] == ["70", "65", "63.75", "62.5", "60"]
    (axes,) = _bifurcation(cycles, ["wheelset"]).axes
    assert "between 62.5 and 65 m/s" in axes.get_legend().get_texts()[0].get_text()


def test_evaluate_command(whole: Path, tmp_path: Path) -> None:
    done = CliRunner().invoke(app, ["evaluate", str(whole), "--from", "5"])
    assert done.exit_code == 0, done.stderr
    row = next(line for line in done.stdout.splitlines() if line.strip().startswith("sum of Y"))
    assert row.split()[-2] == "46.36"  # 10 kN and a third of the axle load of 109.1 kN
    refused = CliRunner().invoke(app, ["evaluate", str(whole), "--from", "21"])
    assert (refused.exit_code, "must have results of more than 2 m" in refused.stderr) == (2, True)


def test_evaluate_says_that_a_run_failed_and_takes_no_missing_force_for_zero(whole: Path, tmp_path: Path) -> None:
    from wheelrail.scenes.runs.safety_table import safety_of_data

    file, data = tmp_path / "run.nc", results(whole)
    complete = safety_of_data(data, file)
    assert complete.remarks == []
    gap = data.copy(deep=True).assign_attrs(status="failed: the front wheelset has left the rails")
    middle = gap.sizes["time"] // 2
    for name in ("guiding_force", "vertical_force"):
        gap[name][middle] = np.nan
    gap.to_netcdf(file)
    done = CliRunner().invoke(app, ["evaluate", str(file)])
    assert done.exit_code == 0, done.stderr
    text = " ".join(done.stdout.split())
    assert f"The run is not complete and ends at {float(data['distance'][-1]):.1f} m: failed: the front" in text
    assert f"1 of {gap.sizes['time']} samples have no contact forces and are left out" in text
    # With 0 N in the gap the sum of Y and Q would be those of a wheel in the air.
    for name, safety in safety_of_data(gap, file).wheelsets.items():
        assert safety.load[0].value == pytest.approx(complete.wheelsets[name].load[0].value, rel=1e-3)
    gap["vertical_force"][2:-2] = np.nan
    with pytest.raises(SceneError, match=r"no contact forces over \d+\.\d m: must be known every 2 m"):
        safety_of_data(gap, file)


def test_a_run_of_a_vehicle_from_python(tmp_path: Path, monkeypatch: pytest.MonkeyPatch, whole: Path) -> None:
    """The same as of the command, with figures and table of a vehicle."""
    monkeypatch.setattr("wheelrail.scenes.runs.run.run_contact", lambda scene, names: (LinearCreep(), None))
    done = wr.run(whole / "scene.toml", vehicle=MANCHESTER)
    assert done.status == "completed"
    np.testing.assert_array_equal(done.data["vertical_force"].values, results(whole)["vertical_force"].values)
    assert re.search(r"wheelsets y -?\d+\.\d{3} to ", repr(done))
    assert "Q, positive upwards [kN]" in repr(done)
    assert set(done.plot()) == set(PICTURES)
    assert len(done.plot.bands("rail")) == 8
    with pytest.raises(SceneError, match=r"wheelset = 'front': must be wheelset_1, "):
        done.view(wheelset="front")
    assert wr.open(done.to_netcdf(tmp_path / "run.nc")).status == "completed"
