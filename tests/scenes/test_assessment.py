"""Assessment of stored runs: command, page, JSON and CSV, refusals; acceleration on the floor in a steady curve."""

from __future__ import annotations

import csv
import json
import re
import shutil
from pathlib import Path

import numpy as np
import pytest
from linear_creep import LinearCreep
from typer.testing import CliRunner
from xarray import Dataset, load_dataset

import wheelrail as wr
from wheelrail.cli.main import app
from wheelrail.scenes.builders.vehicle_file import MANCHESTER

SCENES = Path(__file__).parents[2] / "scenes"
LENGTHS = {"tangent": "60.0", "transition_length": "60.0", "curve": "120.0"}


def run(folder: Path, *options: str, scene: str = "vehicle") -> Path:
    """Results of a run with linear creep on a transition of 60 m to a curve of 120 m."""
    text = (SCENES / f"{scene}.toml").read_text().partition("[output]")[0]
    for key, value in LENGTHS.items():
        text = re.sub(rf"^{key} = .*$", f"{key} = {value}", text, flags=re.MULTILINE)
    folder.mkdir()
    (folder / "scene.toml").write_text(f"{text}\n[output]\nfigures = false\n")
    with pytest.MonkeyPatch.context() as patched:
        patched.setattr("wheelrail.scenes.runs.run.run_contact", lambda scene, names: (LinearCreep(), None))
        done = CliRunner().invoke(app, ["run", str(folder / "scene.toml"), "--out", str(folder), *options])
    assert done.exit_code == 0, done.output
    return folder


@pytest.fixture(scope="module")
def curve(tmp_path_factory: pytest.TempPathFactory) -> Path:
    return run(tmp_path_factory.mktemp("runs") / "curve", "--vehicle", str(MANCHESTER))


def data_of(folder: Path) -> Dataset:
    return load_dataset(folder / "run.nc", engine="netcdf4", decode_times=False)


def test_floor_of_a_steady_curve_has_the_unbalanced_acceleration(curve: Path) -> None:
    """V2/R cos b - g sin b of the cant's angle less the roll of the body, which the run has at its end."""
    found = wr.assess(curve, length=50.0).found
    data, (signals,) = data_of(curve), found.runs
    last = data.isel(time=-1)
    section = found.sections[-1]
    roll = float(last["body_roll"].sel(body="car_body"))
    angle = -np.arcsin(float(last["lift"]) / 1.5) + roll
    lateral = float(last["speed"]) ** 2 * float(last["curvature"]) * np.cos(angle) + 9.81 * np.sin(angle)
    assert section.values["quasi_static_acceleration"]["car_body middle"].value == pytest.approx(abs(lateral), abs=0.01)
    assert signals.acceleration[-1, 1, 1] == pytest.approx(lateral, abs=0.01)
    assert list(signals.points) == ["car_body front", "car_body middle", "car_body rear"]
    assert [signals.points[name] for name in signals.points] == [9.5, 0.0, -9.5]
    assert section.deficiency == pytest.approx(
        1.5 * float(last["speed"]) ** 2 * abs(float(last["curvature"])) / 9.81 - abs(float(last["lift"]))
    )


def test_values_are_those_of_the_stored_forces(curve: Path) -> None:
    """Steady in the curve: the last sample has the medians of the section."""
    section, last = wr.assess(curve, length=50.0).found.sections[-1], data_of(curve).isel(time=-1)
    outer = "right" if float(last["curvature"]) > 0.0 else "left"
    for name in last["wheelset"].values.tolist():
        wheel = last.sel(wheelset=name, side=outer)
        of = {key: values.get(f"{name} outer") for key, values in section.values.items()}
        assert of["quasi_static_load"].value == pytest.approx(float(wheel["vertical_force"]), rel=5e-3)  # type: ignore[union-attr]
        assert of["quotient"].value == pytest.approx(abs(float(wheel["derailment_quotient"])), abs=5e-3)  # type: ignore[union-attr]


def test_page_json_and_csv_have_the_same_numbers(curve: Path, tmp_path: Path) -> None:
    options = ("--length", "50", "--floor", "1.1", "--out", str(tmp_path / "out"))
    done = CliRunner().invoke(app, ["assess", str(curve), *options])
    assert done.exit_code == 0, done.output
    assert "No complete test, sections are missing: zone 1: 0 of 25" in done.stdout
    report = json.loads((tmp_path / "out" / "assessment.json").read_text())
    with (tmp_path / "out" / "assessment.csv").open() as stream:
        lines = list(csv.DictReader(stream))
    for one in report["estimates"]:
        own = one[one["criterion"]]
        limits = [line for line in lines if line["statistic"] == "limit" and line["signal"] == own["signal"]]
        assert own["limit"] in [float(line["value"]) for line in limits]
        assert ("not confirmed" not in own["limit_source"]) == own["confirmed"]
    loads = [line for line in lines if (line["quantity"], line["statistic"]) == ("Q", "section, percentiles")]
    stored = [one["value"] for section in report["sections"] for one in section["load"]]
    assert [float(line["value"]) for line in loads] == stored
    (transition,) = report["transitions"]
    assert (transition["start"], transition["end"]) == pytest.approx((60.0, 120.0), abs=2.0)
    assert transition["transition_standing"] > transition["transition_seated"] > 0.0
    page = (tmp_path / "out" / "assessment.html").read_text()
    for text in ("Verdict", "not confirmed", "railwaynews.net", "Places of maxima", "P_CT standing"):
        assert text in page
    assert page.count("data:image/") == 2
    printed = repr(wr.assess(curve, length=50.0, floor=1.1))
    assert report["verdict"] in printed


def test_a_lower_limit_is_exceeded(curve: Path) -> None:
    """The sum of Y of the curve against a tenth of its limit."""
    found = wr.assess(curve, length=50.0, alpha=0.1)
    assert "Limits exceeded" in found.verdict
    assert "sum of Y, mean over 2 m" in found.verdict
    assert len(found.plot().axes) == 1
    assert len(found.plot_run().axes) == 4


def test_wagon_without_free_bodies_has_no_accelerations(tmp_path: Path) -> None:
    found = wr.assess(run(tmp_path / "wagon", scene="curve"), length=50.0)
    assert found.found.comfort == []
    assert "No accelerations" in repr(found)
    assert found.data["estimates"]


@pytest.mark.parametrize(
    ("options", "said"),
    [
        (("--alpha", "2"), "alpha = 2: must be 0.1 to 1"),
        (("--length", "1"), "length = 1 m: must be 4 to 10000 m"),
        (("--floor", "nan"), "floor = nan m: must be 0 to 5 m"),
        (("--deficiency", "150"), "deficiency = 150 m: must be -0.5 to 0.5 m"),
    ],
)
def test_options_out_of_range(curve: Path, options: tuple[str, str], said: str) -> None:
    done = CliRunner().invoke(app, ["assess", str(curve), *options])
    assert done.exit_code == 2
    assert done.stderr.strip() == said


def test_runs_of_other_vehicles_are_refused(curve: Path, tmp_path: Path) -> None:
    other = tmp_path / "other"
    shutil.copytree(curve, other)
    data = data_of(curve)
    data.attrs["vehicle"] = data.attrs["vehicle"].replace("32000.0", "30000.0")
    data.to_netcdf(other / "run.nc")
    done = CliRunner().invoke(app, ["assess", str(curve), str(other)])
    assert (done.exit_code, "must be a run of the vehicle of" in done.stderr) == (2, True)
    nothing = CliRunner().invoke(app, ["assess", str(tmp_path / "nowhere")])
    assert nothing.exit_code != 0
    assert "nowhere" in nothing.stderr
