"""Comparison of two runs: differences, residual noise, wear, figures."""

from __future__ import annotations

import json
from dataclasses import replace
from functools import cache
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from matplotlib.figure import Figure
from standin_contact import CONTACT
from test_figures import history
from typer.testing import CliRunner
from xarray import DataArray, Dataset

from wheelrail.cli.main import app
from wheelrail.contact.models.wheelset import WheelsetContact
from wheelrail.scenes.datasets.run import dataset
from wheelrail.scenes.datasets.run_derived import wear
from wheelrail.scenes.datasets.run_differences import channels, differences, noise, scatter, table
from wheelrail.scenes.plots.comparison import PICTURES, draw_comparison
from wheelrail.scenes.plots.style import save
from wheelrail.scenes.runs.compare import with_model
from wheelrail.scenes.schema.scene import RunScene, load_scene, parse_scene

FOLDER = Path(__file__).parents[2] / "scenes"


@cache
def data(rows: int = 40) -> Dataset:
    return dataset(history(rows))


def moved(one: Dataset, y: object) -> Dataset:
    """The same with another displacement of the wheelset, added to its own."""
    values = one["body_y"] + DataArray(y, dims="time") * (one["body"] == "wheelset")
    return one.assign(body_y=one["body_y"].copy(data=values))


def test_differences_are_unshifted_and_unfiltered() -> None:
    one = data(2001)
    time = one["time"].values
    wave = 3e-3 * np.sin(2 * np.pi * time)
    other = moved(one, wave).assign(lateral_force=one["lateral_force"] - 500.0)
    found = {d.channel: d for d in differences(one, other)}
    y = found["wheelset y"]
    assert y.rms == pytest.approx(3.0 / np.sqrt(2.0), rel=1e-3)
    assert y.worst == pytest.approx(3.0, rel=1e-3)
    assert y.at % 45.0 == pytest.approx(45.0 / 4, abs=0.1) or y.at % 45.0 == pytest.approx(3 * 45.0 / 4, abs=0.1)
    assert (found["lateral force, left"].rms, found["lateral force, left"].worst) == pytest.approx((0.5, 0.5))
    assert found["vertical force, right"].worst == 0.0


def test_runs_are_compared_over_their_common_time() -> None:
    """The second run is shorter and sampled at other times; a straight line is interpolated exactly."""
    one = data(401)
    other = data(401).isel(time=slice(0, 301, 3))
    found = {d.channel: d for d in differences(one, other)}
    assert found["lateral force, right"].worst == pytest.approx(0.0, abs=1e-9)
    assert found["lateral force, right"].span == pytest.approx(20.0 * 300 / 400, rel=1e-9)


def test_rms_is_over_time_and_not_over_samples() -> None:
    one = data(401)
    other = moved(one, np.where(one["time"] < 1.0, 1e-3, 0.0))
    crowded = np.unique(np.concatenate([np.arange(0, 200), np.arange(200, 401, 40)]))
    found = differences(one.isel(time=crowded), other.isel(time=crowded))
    assert found[0].rms == pytest.approx(np.sqrt(0.5), rel=0.06)


def test_residual_noise_excludes_smooth_signals() -> None:
    time = np.linspace(0.0, 2.0, 4001)
    smooth = 1e4 * np.sin(2.0 * time)
    noise = np.random.default_rng(1).normal(0.0, 50.0, len(time))
    assert np.abs(scatter(time, smooth)).max() < 1.0
    assert float(scatter(time, smooth + noise).std()) == pytest.approx(50.0, rel=0.05)


def test_noise_in_the_full_curve_counts_all_of_it() -> None:
    for at in (0.85, 1.5):  # s, both at full curvature, from 0.8 s on
        made = data(2001).copy(deep=True)
        time = made["time"].values
        made["curvature"][:] = np.clip(time / 0.8, 0.0, 1.0) / 1200
        jump = 892.0 * ((time >= at) & (time < at + 0.004))
        made["vertical_force"][:, 0, 0] += jump
        over_run, in_curve = noise(made)["vertical force, left"]
        assert in_curve == pytest.approx(over_run * np.sqrt(2.0 / 1.2), rel=0.02)
        assert in_curve > 30.0
    words = PICTURES["compare_scatter"]((made, made), ("a", "b")).axes[0].get_legend().get_texts()[0].get_text()
    assert f"{in_curve:.2g} N in the full curve" in words


def test_t_gamma_and_shakedown_map() -> None:
    made = dataset(history())
    power = made["patch_frictional_power"] * 0 + 90.0
    given = made.assign(patch_frictional_power=power)
    added = wear(given, 250e6)
    found = given.assign(added)
    last = found.isel(time=-1, wheelset=0).sel(side="right")
    assert float(last["frictional_power"]) == pytest.approx(180.0)
    assert float(last["t_gamma"]) == pytest.approx(4.0)
    end = made.isel(time=-1, wheelset=0).sel(side="right")
    size = np.hypot(end["patch_longitudinal_force"], end["patch_lateral_force"]) / end["patch_normal_force"]
    assert last["patch_utilisation"].values == pytest.approx(size.values)
    assert last["patch_load_factor"].values == pytest.approx(end["patch_max_pressure"].values / 250e6)
    expected = last["patch_utilisation"] - 1.0 / last["patch_load_factor"]
    assert last["patch_surface_fatigue_index"].values == pytest.approx(expected.values)
    assert np.isnan(found["patch_load_factor"].isel(time=-1).sel(side="left")).all()
    assert all(values.attrs["units"] and values.attrs["long_name"] for values in added.values())


def test_displacements_of_both_runs() -> None:
    ax = PICTURES["compare_displacement"]((data(), moved(data(), np.full(40, 1e-3))), ("a", "b")).axes[0]
    (first, second) = ax.get_lines()[:2]
    assert second.get_ydata() - first.get_ydata() == pytest.approx(1.0)


def test_table_and_file_have_every_channel() -> None:
    found = differences(data(), data())
    shown = table(found, ("condensed", "standard"))
    assert [row[0] for row in shown.as_text.rows] == [label for label, _, _ in channels(data())]
    assert [record["worst"] for record in shown.records] == [one.worst for one in found]


@pytest.mark.parametrize("name", ["curve", "paper_curve"])
def test_scene_with_another_model(name: str) -> None:
    text = (FOLDER / f"{name}.toml").read_text()
    assert parse_scene(with_model(text, "condensed")) == load_scene(FOLDER / f"{name}.toml")
    scene, other = load_scene(FOLDER / f"{name}.toml"), parse_scene(with_model(text, "standard"))
    apart = {key for key, value in scene.model_dump().items() if other.model_dump()[key] != value}
    assert {"model"} <= apart <= {"model", "strips", "cells"}


def short_scene(folder: Path) -> Path:
    text = (FOLDER / "curve.toml").read_text()
    for old, new in (
        ("tangent = 50.0", "tangent = 1.0"),
        ("transition_length = 100.0", "transition_length = 12.0"),
        ("curve = 300.0", "curve = 2.0"),
        ("workers = 2", "workers = 1"),
        ("interval = 0.05", "figures = false\ninterval = 0.0"),
        ("rtol = 4.5e-3", "rtol = 1e-4"),
        ("atol = 4.5e-6", "atol = 1e-7"),
    ):
        assert old in text
        text = text.replace(old, new)
    file = folder / "short.toml"
    file.write_text(text)
    return file


def test_command(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """Both runs, figures, table; completed runs are not repeated, those of another scene are."""
    models: list[str] = []

    def contact(scene: RunScene, names: object) -> tuple[WheelsetContact, None]:
        models.append(scene.model)
        elsewhere = replace(CONTACT, mounting=replace(CONTACT.mounting, rail_y=0.751))
        return CONTACT if scene.model == "standard" else elsewhere, None

    drawn: list[Path] = []
    figures: list[Figure] = []

    def drawn_once(*arguments: Any) -> list[Path]:  # nine figures take seconds
        drawn.extend([] if drawn else draw_comparison(*arguments))
        return drawn

    def saved(figure: Figure, file: Path) -> None:
        figures.append(figure)
        if len(figures) == 1:
            save(figure, file)

    monkeypatch.setattr("wheelrail.scenes.runs.run.run_contact", contact)
    monkeypatch.setattr("wheelrail.scenes.plots.comparison.draw_comparison", drawn_once)
    monkeypatch.setattr("wheelrail.scenes.plots.comparison.save", saved)
    file, out = short_scene(tmp_path), tmp_path / "out"
    first = CliRunner().invoke(app, ["compare", str(file), "--out", str(out)])
    assert first.exit_code == 0, first.output
    assert models == ["condensed", "standard"]
    assert "wheelset y" in first.stdout
    assert first.stdout.count("error of the energy balance") == 2
    report = json.loads((out / "differences.json").read_text())
    assert (report["first"], report["second"]) == ("condensed", "standard")
    assert all(0.0 < error < 1e-2 for error in report["energy_balance_error"])
    assert [file.stem for file in drawn] == list(PICTURES)
    assert drawn[0].stat().st_size > 5000
    for name, figure in zip(PICTURES, figures, strict=True):
        words = [text.get_text() for ax in figure.axes if (legend := ax.get_legend()) for text in legend.get_texts()]
        assert any("standard" in word for word in words), name
        assert all(ax.get_ylabel() for ax in figure.axes[:1])
    again = CliRunner().invoke(app, ["compare", str(file), "--out", str(out)])
    assert again.exit_code == 0
    assert models == ["condensed", "standard"]
    assert again.stdout == first.stdout
    file.write_text(file.read_text().replace("friction = 0.3", "friction = 0.2"))
    assert CliRunner().invoke(app, ["compare", str(file), "--out", str(out)]).exit_code == 0
    assert models == ["condensed", "standard"] * 2


def test_invalid_comparisons(tmp_path: Path) -> None:
    for arguments, says in (
        ([str(FOLDER / "hertz.toml")], 'must be "run"'),
        ([str(FOLDER / "curve.toml"), "--with", "condensed"], "must differ"),
        ([str(FOLDER / "curve.toml"), "--with", "simple"], "model"),
        ([str(FOLDER / "curve.toml"), "--with", "full"], "only with points"),
    ):
        refused = CliRunner().invoke(app, ["compare", *arguments, "--out", str(tmp_path / "out")])
        assert refused.exit_code == 2
        assert says in refused.output
    assert not (tmp_path / "out").exists()
