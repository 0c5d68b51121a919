"""Command `table`, and scenes that use its file."""

from __future__ import annotations

import re
import shutil
from concurrent.futures import ThreadPoolExecutor
from concurrent.futures.process import BrokenProcessPool
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import xarray as xr
from typer.testing import CliRunner

import wheelrail as wr
from wheelrail.cli.main import app
from wheelrail.scenes.datasets.netcdf import write
from wheelrail.scenes.tables import make

SCENE = """
kind = "wheelset"
model = "standard"
friction = 0.3
[profiles]
wheel = "S1002"
rail = "UIC60-benchmark"
"""
RANGES = ["--y", "-1e-3", "1e-3", "--roll", "-5e-4", "5e-4", "--yaw", "-2e-3", "2e-3", "--load", "30e3", "90e3"]
PAIR = {"wheel": "S1002", "rail": "UIC60-benchmark"}


@pytest.fixture
def threads(monkeypatch: pytest.MonkeyPatch) -> None:
    """Solves in a thread of this process: another one takes seconds to start."""
    monkeypatch.setattr(make, "processes", ThreadPoolExecutor)


def made(folder: Path, *options: str) -> Any:
    scene = folder / "scene.toml"
    scene.write_text(SCENE)
    return CliRunner().invoke(app, ["table", str(scene), "--out", str(folder / "t.nc"), *RANGES, *options])


def _forces(data: xr.Dataset) -> np.ndarray:
    return np.array([data[f"{axis}_force"].values for axis in ("longitudinal", "lateral", "vertical")])


@pytest.fixture(scope="module")
def table(tmp_path_factory: pytest.TempPathFactory) -> Path:
    folder = tmp_path_factory.mktemp("table")
    result = made(folder, "--tolerance", "0.03", "--picture", str(folder / "t.png"))
    assert result.exit_code == 0, result.output
    assert "Errors between the nodes, of the vertical load" in result.output
    return folder / "t.nc"


def test_file_has_what_reproduces_it_and_its_errors(table: Path) -> None:
    with xr.open_dataset(table) as data:
        assert data.attrs["scene"] == SCENE
        assert data.attrs["tolerance"] == 0.03
        assert data.attrs["reached"] == 1
        for key in ("versions", "commit", "ranges", "model", "files", "pairs", "seconds"):
            assert key in data.attrs
        error = np.linalg.norm(data["left_force_error"].values, axis=1)
        assert error.shape == (200,)
        assert np.sqrt(np.mean(error**2)) < 0.03
    assert table.with_suffix(".png").stat().st_size > 10_000


def test_a_table_in_place_of_its_model(table: Path) -> None:
    states = [{"y": -5e-4, "yaw": 1e-3, "speed": 20.0}, {"y": 4e-4, "y_rate": 0.02, "speed": 30.0}]
    own, model = wr.Wheelset(**PAIR, model="table", table=table), wr.Wheelset(**PAIR, model="standard")
    for state in states:
        forces = [_forces(wheelset.solve(wheel_load=60e3, **state).data) for wheelset in (own, model)]
        np.testing.assert_allclose(*forces, atol=0.05 * 60e3)
        assert not np.array_equal(*forces)


def test_element_with_a_table_has_arrays_tangent_and_patches(table: Path) -> None:
    element = wr.Wheelset(**PAIR, model="table", table=table, z=-2.4e-4, speed=20.0).element()
    inputs, outputs = element.start_array(), np.zeros(14)
    assert element.solve_array(inputs, outputs) == "converged"
    change = element.tangent_array()[:, 1] * 1e-9
    moved = np.zeros(14)
    inputs[1] += 1e-9
    element.solve_array(inputs, moved)
    np.testing.assert_allclose(moved[:12] - outputs[:12], change, rtol=1e-4, atol=1e-4 * np.abs(change).max())
    assert element.patch_array()[0, 3] == pytest.approx(outputs[2], rel=0.01)
    inputs[0] = 5e-3
    assert "table: y of the wheel = 0.005 m: must be from -0.001 to 0.001 m" in element.solve_array(inputs, outputs)


def test_a_run_with_a_table_follows_that_with_its_model(table: Path, tmp_path: Path) -> None:
    scene = Path(wr.__file__).parents[1] / "scenes" / "curve.toml"
    text = scene.read_text()
    for key in ("laws", "surface_size", "strips", "cells"):
        text = re.sub(rf"(?m)^{key} .*\n", "", text)
    short_and_straight = {
        *(("rail = .*", 'rail = "UIC60-benchmark"'), ("laying_angle = .*", "laying_angle = 0.0")),
        *(("curvature = .*", "curvature = 1e-5"), ("cant = .*", "cant = 0.0"), ("curve = .*", "curve = 20.0")),
        *(("tangent = .*", "tangent = 5.0"), ("transition_length = .*", "transition_length = 5.0")),
        ("workers = 2", "workers = 1"),
    }
    for old, new in short_and_straight:
        text = re.sub(f"(?m)^{old}", new, text)
    for model, keys in (("table", f'model = "table"\ntable = "{table}"'), ("standard", 'model = "standard"')):
        (tmp_path / f"{model}.toml").write_text(text.replace('model = "condensed"', keys))
    results = {model: wr.run(tmp_path / f"{model}.toml").data for model in ("table", "standard")}
    Q = {model: data["vertical_force"].isel(time=-1).values for model, data in results.items()}
    np.testing.assert_allclose(Q["table"], Q["standard"], rtol=0.02)
    assert np.isnan(results["table"]["t_gamma"]).all()  # unknown, not zero
    assert (results["standard"]["t_gamma"] >= 0.0).all()


@pytest.mark.parametrize(
    ("changes", "message"),
    [
        ({"friction": 0.4}, "made for friction = 0.3; the left side has 0.4"),
        ({"radius": 0.45}, "made for radius = 0.46 m; the left side has 0.45 m"),
        ({"rail": "60E1"}, "made for another rail profile than that of the left side"),
        ({"right": {"friction": 0.1}}, "made for friction = 0.3; the right side has 0.1"),
        ({"strips": 8}, 'strips = 8: allowed only with model = "condensed" or "full"'),
        ({"model": "standard"}, 'allowed only with model = "table"'),
        ({"table": "missing.nc"}, "must be an existing file"),
        ({"table": None}, 'required with model = "table"'),
    ],
)
def test_a_table_of_another_pair_is_refused(table: Path, changes: dict[str, Any], message: str) -> None:
    with pytest.raises(wr.SceneError, match=message.replace(".", r"\.").replace("[", r"\[")):
        wr.Wheelset(**{**PAIR, "model": "table", "table": table, **changes}).element()


def test_a_file_that_is_no_table_is_refused(tmp_path: Path) -> None:
    write(xr.Dataset(attrs={"kind": "wheelset"}), tmp_path / "other.nc")
    with pytest.raises(wr.SceneError, match=r"other\.nc: not a table of contact forces"):
        wr.Wheelset(**PAIR, model="table", table=tmp_path / "other.nc").element()


@pytest.mark.usefixtures("threads")
def test_a_table_continues_after_a_kill(table: Path, tmp_path: Path) -> None:
    """Half of the solves are stored, the last line is cut off: the others are solved, and the table is the same."""
    lines = table.with_name("t.nc.solves").read_bytes().splitlines(keepends=True)
    assert len(lines) > 100
    kept = len(lines) // 2
    (tmp_path / "t.nc.solves").write_bytes(b"".join(lines[:kept]) + lines[kept][:20])
    result = made(tmp_path, "--tolerance", "0.03")
    assert result.exit_code == 0, result.output
    with xr.open_dataset(table) as first, xr.open_dataset(tmp_path / "t.nc") as second:
        assert second.attrs["tasks"] == len(lines) - kept
        xr.testing.assert_identical(first.drop_attrs(), second.drop_attrs())


def test_another_scene_does_not_use_stored_solves(table: Path, tmp_path: Path) -> None:
    solves = tmp_path / "t.nc.solves"
    shutil.copy(table.with_name("t.nc.solves"), solves)
    store = make.TaskStore(solves, "another header")
    assert len(store) == 0
    assert solves.read_text() == "another header\n"


@pytest.mark.parametrize(
    ("options", "message"),
    [
        (["--tolerance", "0"], "--tolerance 0: must be greater than 0 and less than 1"),
        (["--y", "1e-3", "-1e-3"], "--y = 0.001, -0.001: must be two increasing numbers"),
        (["--out", "t.txt"], "--out t.txt: must end in .nc"),
    ],
)
def test_impossible_options_are_refused(tmp_path: Path, options: list[str], message: str) -> None:
    result = made(tmp_path, *options)
    assert result.exit_code == 2
    assert message in result.output


def test_tables_of_what_is_no_function_of_the_pose_are_refused(tmp_path: Path) -> None:
    scene = tmp_path / "scene.toml"
    scene.write_text('kind = "wheelset"\n[wheelset]\naxle = {}\n')
    result = CliRunner().invoke(app, ["table", str(scene), "--out", str(tmp_path / "t.nc")])
    assert result.exit_code == 2
    assert "elastic axle and pads are not allowed" in result.output


def test_a_killed_worker_is_one_line(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    class Killed(ThreadPoolExecutor):
        def submit(self, *call: Any, **options: Any) -> Any:
            def dead() -> None:
                raise BrokenProcessPool("a process in the process pool was terminated abruptly")

            return super().submit(dead)

    monkeypatch.setattr(make, "processes", Killed)
    result = made(tmp_path)
    assert result.exit_code == 1
    assert "killed, or crashed in a library; solves are stored, the same command continues" in result.stderr
    assert not (tmp_path / "t.nc").exists()


@pytest.mark.usefixtures("threads")
def test_a_model_that_has_no_solution_is_one_line(tmp_path: Path) -> None:
    result = made(tmp_path, "--load", "5e9", "6e9", "--workers", "1")
    assert result.exit_code == 1
    assert "a narrower range may help" in result.output
