"""The example of a tram on check rails: run, results by pair, figures, table of the curve."""

from __future__ import annotations

import json
from pathlib import Path

import numpy as np
import pytest
from typer.testing import CliRunner
from xarray import load_dataset

from wheelrail.cli.main import app

SCENES = Path(__file__).parents[2] / "scenes"
VEHICLE = ("--vehicle", str(SCENES / "tram_bogie.toml"))
SPEED, RADIUS, MASS = 3.0, 25.0, 14400.0


def test_the_example_runs_into_the_curve(tmp_path: Path) -> None:
    scene = str(SCENES / "vehicle_tram.toml")
    done = CliRunner().invoke(app, ["run", scene, *VEHICLE, "--out", str(tmp_path)])
    assert done.exit_code == 0, done.output
    assert (tmp_path / "check_rail.png").stat().st_size > 10_000
    data = load_dataset(tmp_path / "run.nc", engine="netcdf4", decode_times=False)
    force, power = data["check_rail_force"], data["check_rail_power"]
    assert not force.values[data["distance"].values < 3.0].any()  # on the tangent
    end = force.isel(time=-1)
    inner, outer = end.sel(wheelset="front").values, end.sel(wheelset="rear").values
    assert inner[0] > 15e3 > 0.0 == inner[1]
    assert outer[1] > 5e3 > 0.0 == outer[0]
    # slip of a wheel that rolls about its lowest point, at the end of the chord; 0.7 m from the middle of its axle
    (patch,) = np.flatnonzero(data["patch_contact_angle"].isel(time=-1).sel(wheelset="front", side="left").values < -1)
    at = data.isel(time=-1, patch=patch).sel(wheelset="front", side="left")
    ahead = float(at["patch_x"]) + 0.7 * float(data["body_yaw"].isel(time=-1).sel(body="front"))
    slip = SPEED / 0.33 * ahead
    assert float(power.isel(time=-1).sel(wheelset="front", side="left")) == pytest.approx(
        0.15 * inner[0] * slip, rel=0.06
    )
    assert float(data["track_shifting_force"].isel(time=-1).sum()) == pytest.approx(MASS * SPEED**2 / RADIUS, rel=0.02)
    table = CliRunner().invoke(app, ["curving", scene, *VEHICLE, "--json"])
    assert table.exit_code == 0, table.output
    rows = {row["wheelset"]: row for row in json.loads(table.stdout)["wheelsets"]}
    assert rows["front"]["check_rail_force"]["left"] == pytest.approx(inner[0], rel=5e-3)
    assert rows["rear"]["check_rail_force"]["right"] == pytest.approx(outer[1], rel=5e-3)
