"""Warnings: values that are allowed but unusual, and results that a run overwrites."""

from __future__ import annotations

import re
import tomllib
import warnings
from io import StringIO
from pathlib import Path

import pytest
from malformed_inputs import CURVE, HERTZ, WHEELSET, changed, standard
from rich.console import Console
from typer.testing import CliRunner

import wheelrail as wr
from wheelrail.cli.main import app
from wheelrail.scenes.builders.vehicle_file import MANCHESTER, load_vehicle
from wheelrail.scenes.runs import run as run_module
from wheelrail.scenes.schema.errors import RunFailed, SceneError
from wheelrail.scenes.schema.scene import load_scene, parse_scene
from wheelrail.scenes.studies.plan import plan
from wheelrail.scenes.studies.run import StudyRun
from wheelrail.scenes.studies.schema import check_study

CASES = [
    (WHEELSET, "radius = 0.46", "radius = 0.92", "wheelset.radius = 0.92", "from 0.15 to 0.7 m", "diameter"),
    (WHEELSET, "wheel_load = 57e3", "wheel_load = 5.7e3", "wheelset.wheel_load = 5700", "from 20000 to 300000 N"),
    (HERTZ, "creepage = [1e-3, 0.0", "creepage = [1e-3, 1.0", "creepage[1] = 1", "from -0.1 to 0.1"),
    (HERTZ, "speed = 10.0", "speed = 120.0", "speed = 120", "at most 100 m/s", "162 km/h is 45 m/s"),
    (HERTZ, "friction = 0.3", "friction = 1.0", "friction = 1", "at most 0.8"),
    (CURVE, "speed = 45.0", "speed = [[0.0, 45.0], [3.0, 162.0]]", "vehicle.speed[1][1] = 162", "at most 100 m/s"),
    (CURVE, "speed = 45.0", "speed = 45.0\ncar_body.mass = 60", "vehicle.car_body.mass = 60", "kg", "1 t is 1000"),
]


@pytest.mark.parametrize("case", CASES, ids=[case[3] for case in CASES])
def test_unusual_values_are_listed(case: tuple[str, ...], tmp_path: Path) -> None:
    text, old, new, *says = case
    file = tmp_path / "scene.toml"
    file.write_text(changed(text, old, new))
    with pytest.warns(UserWarning, match="unusual, mostly") as seen:
        load_scene(file)
    (message,) = [str(one.message) for one in seen]
    assert message.startswith(f"{file}: {says[0]}: ")
    assert all(part in message for part in says)


def test_masses_in_tonnes_of_a_vehicle_file(tmp_path: Path) -> None:
    file = tmp_path / "vehicle.toml"
    text = MANCHESTER.read_text()
    file.write_text(re.sub(r"(?m)^mass = ([0-9.]+)", lambda mass: f"mass = {1e-3 * float(mass[1])}", text))
    with pytest.warns(UserWarning, match=r"mass = 32: unusual, mostly from 100 to 200000 kg \(1 t is 1000\)") as seen:
        load_vehicle(file)
    assert 3 <= len(seen) <= 4


def test_the_examples_are_usual() -> None:
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        for file in sorted(MANCHESTER.parent.glob("*.toml")):
            if 'kind = "run"' in (text := file.read_text()) or 'kind = "wheelset"' in text:
                load_scene(file)
            elif "[bodies." in text:
                load_vehicle(file)


def test_unusual_arguments_are_listed() -> None:
    with pytest.warns(UserWarning, match="^Wheelset: radius = 0.92: unusual, mostly from 0.15 to 0.7 m"):
        wr.Wheelset(model="standard", radius=0.92)


def test_a_warning_is_one_line_on_standard_error(tmp_path: Path) -> None:
    file = tmp_path / "scene.toml"
    file.write_text(changed(CURVE, "speed = 45.0", "speed = 120.0"))
    done = CliRunner().invoke(app, ["track", str(file)])
    assert done.exit_code == 0
    assert (
        done.stderr == f"warning: {file}: vehicle.speed = 120: unusual, mostly at most 100 m/s (162 km/h is 45 m/s)\n"
    )
    assert "warning" not in CliRunner().invoke(app, ["--quiet", "track", str(file)]).stderr


def test_a_suggested_key_is_not_missing_as_well(tmp_path: Path) -> None:
    with pytest.raises(SceneError) as raised:
        parse_scene(changed(CURVE, "gauge = 1.435", "gague = 1.435"), "scene.toml")
    assert str(raised.value) == "scene.toml: track.gague = 1.435: unknown key; did you mean track.gauge?"


def test_overwriting_results_is_said(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    def stopped(*arguments: object) -> None:
        raise RunFailed("here")

    monkeypatch.setattr(run_module, "_simulated", stopped)
    scene = parse_scene(standard(CURVE))
    for written in (False, True):
        console = Console(file=StringIO(), width=200)
        with pytest.raises(RunFailed, match="here"):
            run_module.run_scene(scene, CURVE, tmp_path, console)  # type: ignore[arg-type]
        said = console.file.getvalue()  # type: ignore[attr-defined]
        assert ("contains the results of an earlier run, which this one overwrites" in said) == written
        (tmp_path / "run.nc").touch()


def test_overwriting_results_of_a_study_is_said(tmp_path: Path) -> None:
    planned = plan(check_study({"scene": tomllib.loads(standard(WHEELSET)), "grid": {"wheelset.y": [0.0, 1e-3]}}))
    (tmp_path / "study.nc").touch()
    said: list[str] = []
    StudyRun.of(planned, tmp_path, said.append, fresh=False)
    assert said == [f"{tmp_path} contains the results of an earlier study, which this one overwrites"]
