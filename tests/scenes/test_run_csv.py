"""Runs as comma-separated values."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pandas as pd
import pytest
from test_figures import history
from typer.testing import CliRunner
from xarray import Dataset

from wheelrail.cli.main import app
from wheelrail.scenes.datasets.netcdf import write
from wheelrail.scenes.datasets.run import dataset
from wheelrail.scenes.datasets.run_csv import write_csv


@pytest.fixture
def data() -> Dataset:
    """Seven samples of the wagon, one of them without a lateral force, with an elastic axle."""
    made = dataset(history(7))
    made["lateral_force"][3, 0, 0] = np.nan
    hubs = np.arange(7 * 2 * 6.0).reshape(7, 1, 2, 6) / 7.0
    return made.assign(hub_motion=(("time", "wheelset", "side", "hub_component"), hubs, {"units": "m and rad"}))


def test_every_variable_over_time_is_a_column_with_its_unit(data: Dataset, tmp_path: Path) -> None:
    write(data, tmp_path / "run.nc")
    for results in (tmp_path, tmp_path / "run.nc"):
        done = CliRunner().invoke(app, ["export", str(results), "--csv", str(tmp_path / "run.csv")])
        assert (done.exit_code, done.stdout) == (0, f"{tmp_path / 'run.csv'}\n"), done.output
    table = pd.read_csv(tmp_path / "run.csv", float_precision="round_trip")
    assert list(table.columns[:2]) == ["time [s]", "distance [m]"]
    assert len(table) == 7
    over_time = [values for values in data.variables.values() if values.dims[:1] == ("time",)]
    assert len(table.columns) == sum(values[0].size for values in over_time)
    for side in ("left", "right"):
        own = data.sel(wheelset="wheelset", side=side)
        force = own["lateral_force"].values
        np.testing.assert_array_equal(table[f"lateral_force wheelset {side} [N]"], force)  # every bit, NaN where it is
        area = own["patch_area"].values
        for k in range(data.sizes["patch"]):
            np.testing.assert_array_equal(table[f"patch_area wheelset {side} patch {k + 1} [m2]"], area[:, k])
        motion = own["hub_motion"].values
        for head, column in (("x [m]", 0), ("roll [rad]", 3), ("yaw [rad]", 5)):
            np.testing.assert_array_equal(table[f"hub_motion wheelset {side} {head}"], motion[:, column])
    assert set(table["in_contact wheelset left [1]"]) <= {0, 1}
    np.testing.assert_array_equal(table["body_y car_body [m]"], data["body_y"].sel(body="car_body"))


def test_files_are_plain_tables_of_numbers(data: Dataset, tmp_path: Path) -> None:
    """As programs without a CSV reader see them: NaN is a word, not an empty cell that becomes 0."""
    write_csv(data, tmp_path / "run.csv")
    head, *rows = (tmp_path / "run.csv").read_text(encoding="utf-8").splitlines()
    count = len(head.split(","))
    assert all(len(row.split(",")) == count for row in rows)
    values = np.loadtxt(tmp_path / "run.csv", delimiter=",", skiprows=1)
    assert values.shape == (7, count)
    assert rows[3].split(",")[head.split(",").index("lateral_force wheelset left [N]")] == "NaN"


@pytest.mark.parametrize(
    ("arguments", "says"),
    [
        (["nowhere", "--csv", "x.csv"], "nowhere: file does not exist"),
        (["nowhere", "--csv", "x.txt"], "--csv x.txt: must end in .csv"),
        (["nowhere", "--csv", "x.csv", "--runtime"], "--runtime: allowed only with --fmu and --c"),
        (["--csv", "x.csv"], "SCENE is required"),
    ],
)
def test_wrong_arguments_are_one_line(arguments: list[str], says: str) -> None:
    done = CliRunner().invoke(app, ["export", *arguments])
    assert (done.exit_code, len(done.stderr.splitlines()), done.stdout) == (2, 1, "")
    assert says in done.stderr
