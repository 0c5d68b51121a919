"""Every command prints its results as JSON with a schema and units, and nothing else on standard output."""

from __future__ import annotations

import json
import sys
from collections.abc import Iterator
from concurrent.futures import ThreadPoolExecutor
from math import inf, nan
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest
from linear_creep import LinearCreep
from standin_contact import CONTACT
from typer.main import get_command
from typer.testing import CliRunner
from xarray import Dataset

from wheelrail.cli.main import app
from wheelrail.scenes.builders.vehicle_file import MANCHESTER
from wheelrail.scenes.datasets.result_table import Column, Results, ResultTable, json_text

SCENES = Path(__file__).parents[2] / "scenes"
CURVE, VEHICLE, HUNTING = (str(SCENES / f"{name}.toml") for name in ("curve", "vehicle", "hunting"))
STANDARD = (SCENES / "wheelset.toml").read_text().replace('model = "condensed"', 'model = "standard"')
OF_VEHICLE = ("--vehicle", str(MANCHESTER), "--speed", "20")
STUDY = """
kind = "study"
scene = "hertz.toml"
workers = 1
set = { friction = 0.0, bodies = "half-space" }
grid = { load = [1e4, 2e4] }
together = [{ strips = [6, 7, 8], cells = [6, 7, 8] }]
convergence = { over = "cells", reference = "hertz" }
"""
WEAR = f"""
kind = "wear"
scene = "{SCENES / "vehicle.toml"}"
vehicle = "{MANCHESTER}"
law = {{ name = "usfd" }}
until = 1e5
duty = [{{ share = 1.0, steady = {{ curvature = 1e-3, speed = 30.0 }} }}]
"""
# Arguments by command; DIR is a folder with inputs, to which everything is written.
COMMANDS = {
    "contact": ("DIR/wheelset.toml",),
    "export": ("DIR/wheelset.toml", "--fmu", "DIR/contact.fmu"),
    "track": (CURVE,),
    "run": ("DIR/run.toml", "--vehicle", str(MANCHESTER), "--out", "DIR/run"),
    "compare": ("DIR/plane.toml", "--out", "DIR/compared"),
    "modes": (CURVE, "--speed", "10", "--speed", "30"),
    "curving": (CURVE, "--speed", "20", "--speed", "45"),
    "equilibrium": (VEHICLE, *OF_VEHICLE),
    "response": (VEHICLE, *OF_VEHICLE, "--count", "3"),
    "twist": (VEHICLE, *OF_VEHICLE[:2], "--body", "1e-4", "--bogie", "1e-4"),
    "sway": (VEHICLE, *OF_VEHICLE[:2], "--cant", "0.01"),
    "wind": (VEHICLE, *OF_VEHICLE, "--coefficients", "DIR/wind.csv", "--csv", "DIR/curve.csv"),
    "critical": (VEHICLE, *OF_VEHICLE[:2], "--from", "20", "--to", "21"),
    "hunting": (HUNTING, *OF_VEHICLE, "--longest", "1", "--fold", "1"),
    "evaluate": ("DIR/run",),
    "assess": ("DIR/run",),
    "study": ("DIR/study.toml", "--out", "DIR/study"),
    "table": ("DIR/wheelset.toml", "--out", "DIR/table.nc"),
    "wear": ("DIR/wear.toml", "--out", "DIR/wear"),
    "wagon": (),
    "example": (),
    "view": ("DIR/wheelset.toml", "--out", "DIR/view.png"),
    "animate": ("DIR/run", "--out", "DIR/run.gif"),
    "report": ("DIR/run",),
}
# Kinds of rows that a command prints.
TABLES = {
    "track": ["segments"],
    "run": ["contacts"],
    "compare": ["channels"],
    "modes": ["modes"],
    "curving": ["wheelsets", "bodies", "elements"],
    "equilibrium": ["wheelsets", "bodies", "elements"],
    "response": ["points", "amplitudes"],
    "twist": ["wheelsets"],
    "sway": ["bodies"],
    "wind": ["points"],
    "hunting": ["cycles"],
    "evaluate": ["wheelsets"],
    "assess": ["zones"],
    "study": ["cases", "errors", "order", "orders"],
    "table": ["errors"],
    "wear": ["steps", "cases"],
    "example": ["examples"],
}


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Path]:
    """Inputs of the commands, with stand-ins for all that takes long."""
    path = tmp_path_factory.mktemp("json")
    (path / "wheelset.toml").write_text(STANDARD)
    (path / "hertz.toml").write_text((SCENES / "hertz.toml").read_text())
    (path / "study.toml").write_text(STUDY)
    (path / "wind.csv").write_text("yaw, cFy, cMx\n0, 0, 0\n90, 6, 4\n")
    (path / "wear.toml").write_text(WEAR)
    short = {"tangent = 50.0": "tangent = 11.0", "transition_length = 100.0": "transition_length = 10.0"}
    short |= {"curve = 300.0": "curve = 1.0", "tangent = 30.0": "tangent = 11.0"}
    for name, scene in (("run", VEHICLE), ("plane", CURVE)):
        text = Path(scene).read_text()
        for old, new in short.items():
            text = text.replace(old, new)
        text = text if "[output]" in text else f"{text}\n[output]\n"
        (path / f"{name}.toml").write_text(text.replace("[output]", "[output]\nfigures = false"))
    with pytest.MonkeyPatch.context() as patched:
        patched.setattr("wheelrail.scenes.runs.run.run_contact", lambda scene, names: (LinearCreep(), None))
        springs = {"standard": LinearCreep(), "condensed": CONTACT}
        patched.setattr("wheelrail.scenes.runs.steady.run_contact", lambda scene, names: (springs[scene.model], None))
        patched.setattr("wheelrail.scenes.studies.run.processes", ThreadPoolExecutor)
        patched.setattr("wheelrail.scenes.plots.comparison.draw_comparison", lambda *_: [])
        patched.setattr("wheelrail.scenes.studies.plots.draw_study", lambda *_: [])
        patched.setattr("wheelrail.scenes.tables.make.make_table", lambda order, out: force_table())
        patched.setattr("wheelrail.export.unit.export_unit", lambda *_, **options: None)
        views = SimpleNamespace(view_scene=lambda *_, **options: None, animate_file=lambda *_, **options: None)
        patched.setitem(sys.modules, "wheelrail.scenes.views.view", views)
        patched.setitem(sys.modules, "wheelrail.scenes.views.html", SimpleNamespace(save_view=lambda *_: None))
        patched.setitem(
            sys.modules, "wheelrail.scenes.html_report.write", SimpleNamespace(write_report=lambda *_, **o: None)
        )
        yield path


def force_table() -> Dataset:
    """What `wheelrail table` prints of a table: its shape, and errors at three points, of which one is not solved."""
    nodes = {f"left_{kind}_values": (tuple("abcde"), np.zeros((2, 3, 2, 4, 9))) for kind in ("normal", "friction")}
    error = np.array([[0.01, 0.02, 0.03], [nan, nan, nan], [0.01, -0.02, -0.05]])
    attributes = {"sides": "left", "reached": 1, "seconds": 2.0}
    return Dataset({**nodes, "left_force_error": (("point", "axis"), error)}, attrs=attributes)


def invoke(command: str, folder: Path, *options: str) -> Any:
    arguments = [text.replace("DIR", str(folder)) for text in COMMANDS[command]]
    return CliRunner().invoke(app, [command, *arguments, *options])


def numbers(value: Any, path: tuple[str, ...] = ()) -> Iterator[tuple[str, ...]]:
    """Keys to every number."""
    if isinstance(value, dict):
        for key, item in value.items():
            yield from numbers(item, (*path, key))
    elif isinstance(value, list):
        for item in value:
            yield from numbers(item, path)
    elif isinstance(value, int | float) and not isinstance(value, bool):
        yield path


def invalid(constant: str) -> None:
    raise AssertionError(f"{constant} is no JSON")


def test_every_command_is_here() -> None:
    without_results = {"explore"}  # which serves a page until it is ended
    assert set(COMMANDS) | without_results == set(get_command(app).commands)  # type: ignore[attr-defined]


@pytest.mark.parametrize("command", COMMANDS)
def test_results_as_json(command: str, folder: Path) -> None:
    done = invoke(command, folder, "--json")
    assert done.exit_code == 0, done.output
    report = json.loads(done.stdout, parse_constant=invalid)  # one object and nothing else
    assert report["schema"] == f"wheelrail.{command}/1"
    assert all(isinstance(unit, str | list) for unit in report["units"].values())
    for path in numbers({key: value for key, value in report.items() if key != "units"}):
        assert set(path) & set(report["units"]), f"no unit: {'.'.join(path)}"
    for name in TABLES.get(command, []):
        assert report[name], name


def test_values_are_those_of_the_table_in_si_units(folder: Path) -> None:
    report = json.loads(invoke("curving", folder, "--json").stdout)
    (first, second), units = report["wheelsets"], report["units"]
    assert (units["wheel_load"], units["cant_deficiency"], units["yaw_reaction"]) == ("N", "m", "N m")
    assert second["speed"] == 45.0
    assert {row["speed"] for row in report["elements"]} == {20.0, 45.0}
    assert first["cant_deficiency"] == pytest.approx(-9.0e-3, abs=1e-4)
    assert second["wheel_load"]["left"] == pytest.approx(36.58e3, abs=5.0)
    assert "36.58  73.18" in invoke("curving", folder).stdout  # the option holds for one call
    modes = json.loads(invoke("modes", folder, "--json").stdout)["modes"]
    assert {mode["speed"] for mode in modes} == {10.0, 30.0}
    assert all(sum(mode["kinetic_energy"].values()) == pytest.approx(1.0) for mode in modes)


def test_all_cases_of_a_study_are_in_json(folder: Path) -> None:
    report = json.loads(invoke("study", folder, "--json").stdout)
    assert [case["load"] for case in report["cases"]] == [1e4] * 3 + [2e4] * 3
    assert report["units"]["max_pressure"] == "Pa"
    assert report["cases"][0]["max_pressure"] > 1e8
    assert [row["strips"] for row in report["errors"]] == [6, 7, 8]


def test_failures_are_messages_and_exit_codes(folder: Path) -> None:
    refused = CliRunner().invoke(app, ["--json", "track", "nowhere.toml"])
    assert (refused.exit_code, refused.stdout, "nowhere.toml" in refused.stderr) == (2, "", True)


def test_numbers_that_are_none_and_units_that_differ() -> None:
    columns = [Column("y", "y", lambda row: row, "mm", 1)]
    table = ResultTable("rows", "Rows", columns, [1e-3, nan, inf, None])
    report = json.loads(json_text(Results("try", [table], {"file": Path("a")}).report))
    assert report["rows"] == [{"y": 1e-3}, {"y": None}, {"y": None}, {"y": None}]
    assert (report["units"], report["file"]) == ({"y": "m"}, "a")
    assert [row[0] for row in table.as_text.rows] == ["1.0", "-", "inf", "-"]
    other = ResultTable("others", "Others", [Column("y", "y", lambda row: row, "N")], [1.0])
    with pytest.raises(ValueError, match="y: units m and N"):
        _ = Results("try", [table, other]).report
