"""Scenes with torques, forces and a speed that runs free: results, report, resumed runs, messages."""

from __future__ import annotations

import re
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from linear_creep import LinearCreep
from typer.testing import CliRunner
from xarray import Dataset, load_dataset

from wheelrail.cli.main import app
from wheelrail.scenes.builders.vehicle_file import MANCHESTER
from wheelrail.scenes.html_report.write import write_report
from wheelrail.scenes.plots.runs import pictures_of
from wheelrail.scenes.runs import run as runs
from wheelrail.scenes.schema.errors import SceneError
from wheelrail.scenes.schema.scene import RunScene, parse_scene

SCENE = Path(__file__).parents[2] / "scenes" / "vehicle_braking.toml"
VEHICLE = ("--vehicle", str(MANCHESTER))


def text(**changes: str) -> str:
    """The scene on a short track without a sharp curve, with other values by key."""
    result = SCENE.read_text()
    short = {"tangent": "20.0", "transition_length": "10.0", "curve": "15.0", "curvature": "5e-4", "cant": "0.0"}
    for key, value in (short | changes).items():
        result, count = re.subn(rf"^{key} = .*$", f"{key} = {value}", result, flags=re.MULTILINE)
        assert count >= 1, key
    return f"{result}\n[output]\ncheckpoint = 4\nfigures = false\n"


def command(folder: Path, scene: str, *options: str, vehicle: tuple[str, ...] = VEHICLE, what: str = "run") -> Any:
    """`wheelrail run` in this process, with linear creep."""
    folder.mkdir(exist_ok=True)
    file = folder / "scene.toml"
    file.write_text(scene)
    out = ("--out", str(folder)) if what == "run" else ()
    with pytest.MonkeyPatch.context() as patched:
        patched.setattr("wheelrail.scenes.runs.run.run_contact", lambda scene, names: (LinearCreep(), None))
        patched.setattr("wheelrail.scenes.runs.steady.run_contact", lambda scene, names: (LinearCreep(), None))
        return CliRunner().invoke(app, [what, str(file), *vehicle, *out, *options])


def results(folder: Path) -> Dataset:
    return load_dataset(folder / "run.nc", engine="netcdf4", decode_times=False)


@pytest.fixture(scope="module")
def whole(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Brakes and wind from the start on; the vehicle reaches the end of the track while it brakes."""
    folder = tmp_path_factory.mktemp("braking")
    done = command(folder, text(torque="[[0.2, 0.0], [0.6, 8e3]]", lateral="[[0.1, 0.0], [0.4, 10e3]]"))
    assert done.exit_code == 0, done.stderr
    assert re.search(r"completed at 4[5-9]\.\d m\n", done.stdout)
    return folder


def test_results_count_from_where_the_vehicle_is(whole: Path) -> None:
    data = results(whole)
    speed, time = data["speed"].values, data["time"].values
    assert speed[0] == pytest.approx(20.0, rel=1e-6)
    assert speed[-1] < 18.0
    assert np.isin([0.2, 0.6, 0.1, 0.4], time).all()
    distance = np.concatenate([[0.0], np.cumsum(0.5 * (speed[1:] + speed[:-1]) * np.diff(time))])
    np.testing.assert_allclose(data["distance"], distance, atol=0.02)
    assert float(abs(data["body_x"]).max()) < 0.05
    assert float(abs(data["body_x_rate"]).max()) < 0.2
    wheels = data["body_pitch_rate"].sel(body=data["wheelset"].values)
    assert float(abs(wheels).max()) * 0.46 < 0.5
    torque = np.interp(time, [0.2, 0.6], [0.0, -8e3])
    np.testing.assert_allclose(data["applied_torque"], torque[:, None] * np.ones(4), atol=1e-6)
    wind = data["applied_force"].sel(body="car_body")
    np.testing.assert_allclose(wind.sel(axis="y"), np.interp(time, [0.1, 0.4], [0.0, 10e3]), atol=1e-6)
    assert float(abs(data["applied_force"]).sum()) == pytest.approx(float(wind.sel(axis="y").sum()))
    assert data["longitudinal_force"].isel(time=-1).sum("side").max() < -15e3


def test_report_has_speed_and_creep_forces(whole: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("wheelrail.scenes.html_report.figures._saved", lambda figure, kind: b"")  # takes seconds
    page = write_report(whole, tmp_path / "report.html", view=False).read_text(encoding="utf-8")
    assert page.count("data:image/") == 12  # of the track, ten of the run, shakedown
    assert len(pictures_of(results(whole))) == 9
    assert "speed of vehicle and rims" in page
    figure = pictures_of(results(whole))["traction"](results(whole))
    assert [ax.get_ylabel() for ax in figure.axes] == ["speed [m/s]", "force, forwards [kN]", "torque, forwards [kN m]"]


def test_an_interrupted_run_resumes_to_the_same_bits(whole: Path, tmp_path: Path) -> None:
    scene, accept, count = (whole / "scene.toml").read_text(), runs.CHECKPOINTS, 0

    class Interrupting(LinearCreep):
        def __call__(self, *arguments: Any) -> Any:
            nonlocal count
            count += 1
            if count == 1200:
                raise KeyboardInterrupt
            return super().__call__(*arguments)

    (tmp_path / "scene.toml").write_text(scene)
    with pytest.MonkeyPatch.context() as patched:
        patched.setattr("wheelrail.scenes.runs.run.run_contact", lambda scene, names: (Interrupting(), None))
        line = ["run", str(tmp_path / "scene.toml"), *VEHICLE, "--out", str(tmp_path)]
        stopped = CliRunner().invoke(app, line)
    assert stopped.exit_code == 130
    assert (tmp_path / accept).exists()
    other = command(tmp_path, scene.replace("8e3", "7e3"), "--resume")
    assert (other.exit_code, "torque: " in other.stderr) == (2, True)
    done = command(tmp_path, scene, "--resume")
    assert done.exit_code == 0, done.stderr
    assert "continues from the checkpoint at" in done.stderr
    one, two = results(whole), results(tmp_path)
    for name in set(one.variables) - {"contact_seconds"}:
        np.testing.assert_array_equal(one[name].values, two[name].values)


def test_a_halt_is_told(tmp_path: Path) -> None:
    done = command(tmp_path, text(speed="4.0", torque="8e3", lateral="0.0"))
    assert done.exit_code == 0, done.stderr
    assert re.search(r"completed at \d\.\d m, where the vehicle has come to a halt", done.stdout)


def test_steady_states_have_the_torques_and_forces_of_the_start(tmp_path: Path) -> None:
    """Held speed, as the vehicle file has it."""
    scene = text(torque="[[0.0, 5e3], [1.0, 0.0]]", lateral="20e3")
    done = command(tmp_path, scene, what="equilibrium")
    assert done.exit_code == 0, done.stderr
    (row,) = (line for line in done.stdout.splitlines() if "longitudinal force" in line)
    forces = np.array([float(value) for value in re.findall(r"-?\d+\.\d+", row)]).reshape(4, 2).sum(axis=1)
    np.testing.assert_allclose(forces, -5.0 / 0.46, atol=0.03)
    (row,) = (line for line in done.stdout.splitlines() if "sum of Y" in line)
    assert sum(float(value) for value in re.findall(r"-?\d+\.\d+", row)) == pytest.approx(-20.0, abs=0.02)  # kN


@pytest.mark.parametrize(
    ("changes", "message"),
    [
        ({"torque": "-8e3"}, "torque[0].torque = -8000.0: must not be negative with kind"),
        ({"torque": "[[1.0, 2.0], [1.0, 3.0]]"}, "torque[0].torque = [[1.0, 2.0], [1.0, 3.0]]: must have points with"),
        ({"torque": "nan"}, "torque[0].torque = NaN: must be"),
        ({"kind": '"handbrake"'}, 'must be "motor" or "brake"'),
        ({"lateral": "[[0.0, 1e12]]"}, "force[0].lateral[0][1] = 1000000000000.0: must be a number from -1e+08"),
        ({"speed": "[[0.0, 20.0], [5.0, 10.0]]"}, "vehicle.speed"),
    ],
)
def test_wrong_values(changes: dict[str, str], message: str) -> None:
    scene = text(**{key: value for key, value in changes.items() if key != "kind"})
    if "kind" in changes:
        scene = scene.replace('kind = "brake"', f"kind = {changes['kind']}")
    with pytest.raises(SceneError) as error:
        parse_scene(scene)
    assert message in str(error.value)
    assert len(str(error.value).splitlines()) == 1


@pytest.mark.parametrize(
    ("added", "message"),
    [
        ('wheelsets = ["axle"]', 'torque[0].wheelsets = "axle": must be one of wheelset_1, wheelset_2, '),
        ('wheelsets = ["front_bogie"]', 'torque[0].wheelsets = "front_bogie": must be one of wheelset_1, '),
        ('reaction = "wheelset_2"', 'torque[0].reaction = "wheelset_2": must be one of car_body, front_bogie, '),
    ],
)
def test_torques_on_no_wheelset(tmp_path: Path, added: str, message: str) -> None:
    refused = command(tmp_path, text().replace('kind = "brake"', f'kind = "brake"\n{added}'))
    assert (refused.exit_code, message in refused.stderr) == (2, True), refused.stderr


def test_forces_on_no_body_and_scenes_without_a_vehicle_file(tmp_path: Path) -> None:
    refused = command(tmp_path, text(body='"engine"'))
    assert (refused.exit_code, 'force[0].body = "engine": must be one of car_body' in refused.stderr) == (2, True)
    refused = command(tmp_path, text(), vehicle=())
    needs = "torque, force, vehicle.free_speed: allowed only with a vehicle file (--vehicle)"
    assert (refused.exit_code, needs in refused.stderr) == (2, True)


def test_a_scene_without_loads_has_none() -> None:
    scene = parse_scene(SCENE.with_name("vehicle.toml").read_text())
    assert isinstance(scene, RunScene)
    assert scene.keys_of_vehicle_files == []
