"""Results and figures of a run: variables with units through NetCDF, and labelled axes."""

from __future__ import annotations

import os
import re
import subprocess
import sys
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
import xarray
from spring_contact import patch
from standin_contact import CONTACT

from wheelrail.contact.laws.parameters import ContactLaws
from wheelrail.contact.results.result import ContactResult, Fields
from wheelrail.scenes.datasets.contact import contact_dataset
from wheelrail.scenes.datasets.netcdf import write
from wheelrail.scenes.datasets.run import dataset
from wheelrail.scenes.datasets.run_file import run_of
from wheelrail.scenes.plots import runs as figures
from wheelrail.scenes.plots.patch_cells import PatchCells
from wheelrail.scenes.plots.patches import draw_patches, patches_figure
from wheelrail.scenes.quantities import BANDS, MOTION, PATCH
from wheelrail.scenes.schema.errors import SceneError
from wheelrail.vehicle.integration.step_control import StepStatistics
from wheelrail.vehicle.multibody.plane_wagon import COORDINATES, wagon_dynamics
from wheelrail.vehicle.simulation.contact_cost import ContactCost
from wheelrail.vehicle.simulation.history import History, RunCost
from wheelrail.vehicle.simulation.row import PatchPair, Row
from wheelrail.vehicle.track.piecewise import PiecewiseFunction
from wheelrail.vehicle.track.track import Track
from wheelrail.vehicle.wagon.wagon import Wagon

N = 40


def history(rows: int = N, curvature: float = 1 / 1200) -> History:
    """Synthetic run into a curve: a second patch on the right from the middle, and wheel lift on the left
    at the end.
    """
    share = np.linspace(0.0, 1.0, rows)
    time = 2.0 * share
    force = np.zeros((rows, 2, 3))
    force[:, 0, 2], force[:, 1, 2] = 54e3 - 17e3 * share, 54e3 + 18e3 * share
    force[:, 1, 1] = -20e3 * share
    patches: list[PatchPair] = []
    for row, u in enumerate(share):
        left = () if row == rows - 1 else (patch(force[row, 0, 2], force[row, 0], 2e-3 * u),)
        right = (patch(force[row, 1, 2], force[row, 1], -4e-3 * u),)
        patches.append((left, (*right, patch(10e3, force[row, 1], -32e-3)) if u > 0.5 else right))
    state = np.random.default_rng(3).standard_normal((rows, 20))
    ends = (0.0, 90.0)
    line = Track(PiecewiseFunction(ends, (0.0, curvature)), PiecewiseFunction(ends, (0.0, 0.06)))
    approach = np.full((1, 2), 8e-5)
    made = [
        Row(t, x, f[None], 0.1 * f[None], approach, (pair,), (("converged" if pair[0] else "separated", "converged"),))
        for t, x, f, pair in zip(time.tolist(), state, force, patches, strict=True)
    ]
    return History(
        wagon_dynamics(Wagon(), line, CONTACT, 45.0),
        "completed",
        made,
        RunCost(
            StepStatistics(accepted=rows - 1, rejected=2, failed=1, evaluations=130),
            {"left": ContactCost(300, 1, 600, 1200, 3.0), "right": ContactCost(301, 0, 700, 1500, 4.0)},
            9.0,
        ),
    )


def test_dataset_contains_the_history() -> None:
    run = history()
    data = dataset(run, scene='kind = "run"')
    assert data["body"].values.tolist() == ["car_body", "bogie", "wheelset"]
    assert data["vertical_force"].sel(wheelset="wheelset", side="right").values == pytest.approx(run.force[:, 0, 1, 2])
    assert data["roll_moment"].sel(wheelset="wheelset", side="left").values == pytest.approx(run.moment[:, 0, 0, 0])
    assert data["body_y"].sel(body="car_body").values == pytest.approx(run.state[:, 0])
    assert data["body_roll_rate"].sel(body="bogie").values == pytest.approx(run.rate("bogie")[:, 3])
    assert data["body_pitch"].sel(body="wheelset").values == pytest.approx(run.state[:, 9])
    assert data["body_pitch_rate"].sel(body="wheelset").values == pytest.approx(run.state[:, 19])
    assert not data[["body_x", "body_yaw"]].to_array().any()  # held
    assert data["distance"].values == pytest.approx(45.0 * run.time)
    wrench = np.concatenate([run.force, run.moment], axis=3).sum(axis=2)
    yaw = [run.dynamics.yaw_reactions(row.time, row.state, own) for row, own in zip(run.rows, wrench, strict=True)]
    np.testing.assert_array_equal(data["yaw_reaction"], yaw)
    assert data["newton_iterations"].sel(side="right") == 700
    assert data.attrs["scene"] == 'kind = "run"'
    assert "wheelrail" in data.attrs["versions"]
    assert {*MOTION, *PATCH, *BANDS, "curvature", "lift"} <= set(data.data_vars)


@pytest.fixture(scope="module")
def first_form() -> xarray.Dataset:
    """Results as earlier versions wrote them, which had no dimensions of bodies, wheelsets and elements."""
    data = dataset(history(), scene=(Path(__file__).parents[2] / "scenes" / "curve.toml").read_text())
    turned = {"": data["distance"] / 0.46, "_rate": data["speed"] / 0.46}
    named = {}
    for name in COORDINATES:
        body, _, coordinate = name.rpartition("_")
        for rate, turn in turned.items():
            own = data[f"body_{coordinate}{rate}"].sel(body=body, drop=True)
            named[name + rate] = own + turn if name == "wheelset_pitch" else own
    for name in ("deflection", "force"):
        named[f"bumpstop_{name}"] = data[f"element_{name}"].sel(element="bumpstop", axis="y", drop=True)
    later = ("guiding_force", "derailment_quotient", "track_shifting_force", "axle_load", "wheel_unloading")
    data = data.squeeze("wheelset", drop=True).drop_dims(["body", "element"]).drop_vars(["axis", *later]).assign(named)
    for name in ("form", "vehicle", "wheel_y", "mean_wheel_load"):
        del data.attrs[name]
    return data


def test_results_of_earlier_versions_are_read(first_form: xarray.Dataset) -> None:
    data = run_of(first_form, Path("run.nc"))
    expected = dataset(history(), scene=first_form.attrs["scene"])
    for name, values in expected.data_vars.items():
        if values.dims[:2] != ("time", "element"):
            assert data[name].dims == values.dims
            np.testing.assert_allclose(data[name], values, rtol=1e-12, atol=1e-9, err_msg=str(name))
            assert data[name].attrs["units"] == values.attrs["units"]
    stops = (own["element_force"].sel(element="bumpstop", axis="y") for own in (data, expected))
    np.testing.assert_array_equal(*stops)
    assert data.attrs["mean_wheel_load"] == expected.attrs["mean_wheel_load"]
    for figure in figures.pictures_of(data).values():
        figure(data)
    assert run_of(data, Path("run.nc")) is data


def test_results_of_other_versions_that_lack_something_are_refused(first_form: xarray.Dataset) -> None:
    for name in ("bogie_roll_rate", "yaw_reaction", "bumpstop_force", "speed", "lateral_force"):
        with pytest.raises(SceneError, match=rf"run\.nc: {name}: missing"):
            run_of(first_form.drop_vars(name), Path("run.nc"))
    with pytest.raises(SceneError, match=r"run\.nc: attribute form: 3; must be up to 2"):
        run_of(dataset(history()).assign_attrs(form=3), Path("run.nc"))


def test_patches_are_padded_with_nan() -> None:
    run = history()
    data = dataset(run)
    counts = [[len(left), len(right)] for ((left, right),) in (row.patches for row in run.rows)]
    assert data["patches"].values[:, 0].tolist() == counts
    assert data["patch_area"].notnull().sum("patch").values[:, 0].tolist() == counts
    assert data.sizes["patch"] == 2
    last = data.isel(time=-1, wheelset=0).sel(side="right")
    assert last["wheel_band"].values == pytest.approx(np.array([[-8e-3, 0.0], [-36e-3, -28e-3]]), abs=1e-12)
    assert last["patch_lateral_force"].values == pytest.approx(-0.05 * last["patch_normal_force"].values)
    assert not data["in_contact"].isel(time=-1).sel(side="left").any()


def test_every_variable_has_a_unit_and_a_meaning() -> None:
    data = dataset(history())
    for name, values in {**data.data_vars, "distance": data["distance"]}.items():
        assert values.attrs["units"], name
        assert values.attrs["long_name"], name
    assert data["time"].attrs["units"] == "s"


@pytest.mark.parametrize("rows", [N, 1])
def test_round_trip_through_netcdf(tmp_path: Path, rows: int) -> None:
    data = dataset(history(rows), scene="a = 'ü'\n")
    write(data, tmp_path / "new" / "run.nc")
    with xarray.open_dataset(tmp_path / "new" / "run.nc", decode_times=False) as back:
        xarray.testing.assert_equal(data, back)
        assert back.attrs == data.attrs
        assert back["patch_area"].attrs == data["patch_area"].attrs


def test_failed_write_keeps_the_previous_file(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    file = tmp_path / "run.nc"
    write(dataset(history(3)), file)
    before = file.read_bytes()

    def full(path: Path) -> None:
        assert path.read_bytes() != before
        raise OSError("no space left on device")

    monkeypatch.setattr("wheelrail.scenes.datasets.netcdf.seal", full)
    with pytest.raises(OSError, match="no space"):
        write(dataset(history(5)), file)
    assert file.read_bytes() == before
    assert list(tmp_path.iterdir()) == [file]


def test_no_figures_for_one_sample(tmp_path: Path) -> None:
    assert list(figures.draw_figures(dataset(history(1)), tmp_path)) == []


@pytest.mark.parametrize("name", list(figures.PAPER))
def test_axes_name_quantity_and_unit(name: str) -> None:
    figure = figures.PAPER[name](dataset(history()))
    panels = [ax for ax in figure.axes if ax.get_title(loc="left") or ax.get_title()]
    assert panels
    for ax in panels:
        assert re.search(r"\[\w+\]$", ax.get_ylabel()), ax.get_ylabel()
    assert re.search(r"\[m\]$", panels[-1].get_xlabel())


@pytest.mark.parametrize(("curvature", "inner"), [(1 / 1200, "left"), (-1 / 1200, "right"), (0.0, "")])
def test_inner_and_outer_side_of_a_curve(curvature: float, inner: str) -> None:
    data = dataset(history(curvature=curvature))
    for side in ("left", "right"):
        word = "" if not inner else " (inner)" if side == inner else " (outer)"
        assert figures.named(side, data) == side + word


def test_force_curves_are_those_of_the_data() -> None:
    data = dataset(history())
    (ax,) = figures.of_wheels("vertical_force", data).axes
    curves = {str(line.get_label()): line for line in ax.lines}
    assert set(curves) == {"left (inner)", "right (outer)"}
    assert np.asarray(curves["right (outer)"].get_ydata()) == pytest.approx(
        1e-3 * data["vertical_force"].sel(wheelset="wheelset", side="right").values
    )


def test_round_off_errors_are_a_straight_line() -> None:
    run = history(curvature=0.0)
    data = dataset(replace(run, rows=[replace(row, state=1e-14 * row.state) for row in run.rows]))
    for ax in figures.displacements(data).axes:
        low, high = ax.get_ylim()
        assert high - low == pytest.approx(figures.LEAST_RANGE)
    low, high = figures.displacements(dataset(run)).axes[0].get_ylim()
    assert high - low > 1e3  # mm: left as it was


def test_strips_cover_every_patch_once() -> None:
    data = dataset(history())
    right = data.sel(wheelset="wheelset", side="right")
    distance = data["distance"].values
    shapes, values = figures._strips(distance, right["rail_band"], right["patch_max_pressure"])
    assert len(shapes) == len(values) == int(right["patches"].sum())
    width, height = shapes[:, 1, 0] - shapes[:, 0, 0], shapes[:, 2, 1] - shapes[:, 1, 1]
    assert height == pytest.approx(8e-3)  # of every patch here
    first = shapes[:, 0, 1] > -0.02  # the tread, in every sample
    assert width[first].sum() == pytest.approx(distance[-1] - distance[0])


def test_figures_are_written_and_leave_matplotlibs_global_state_unchanged(tmp_path: Path) -> None:
    code = (
        "import sys, matplotlib; from test_figures import *; before = matplotlib.rcParams.copy();"
        f"files = list(figures.draw_figures(dataset(history()), Path({str(tmp_path)!r})));"
        "assert [file.stem for file in files] == list(figures.PAPER);"
        "assert matplotlib.rcParams.copy() == before; assert 'matplotlib.pyplot' not in sys.modules"
    )
    helpers = Path(__file__).parents[1] / "helpers"
    there = {**os.environ, "PYTHONPATH": os.pathsep.join([str(helpers), os.environ.get("PYTHONPATH", "")])}
    subprocess.run([sys.executable, "-c", code], check=True, cwd=Path(__file__).parent, env=there)
    files = [tmp_path / f"{name}.png" for name in figures.PAPER]
    assert all(file.read_bytes().startswith(b"\x89PNG") for file in files)


def strips(lean: float = 0.1) -> ContactResult:
    """Synthetic patch of two strips of three cells, inclined to the left; the cells at the trailing ends slip."""
    ends = np.array([[-3e-3, -1e-3, 2e-3, 3e-3], [-2e-3, 0.0, 1e-3, 2e-3]])
    x, step = 0.5 * (ends[:, 1:] + ends[:, :-1]).ravel(), np.diff(ends).ravel()
    normal = np.array([0.0, np.sin(lean), -np.cos(lean)])
    axes = np.tile(np.stack([[1.0, 0.0, 0.0], np.cross([1.0, 0.0, 0.0], normal), normal]), (6, 1, 1))
    across = np.repeat([1e-3, -1e-3], 3)
    point = np.column_stack([x, across * np.cos(lean), across * np.sin(lean)])
    pressure = np.array([1.0, 3.0, 2.0, 1.0, 2.0, 1.0]) * 1e8
    share = np.array([0.3, 0.2, 0.1, 0.3, 0.3, 0.1])
    traction = np.column_stack([-share * pressure, 0.0 * share])
    none = np.zeros(6)
    fields = Fields(
        np.arange(6),
        np.zeros(6, dtype=int),
        point,
        axes,
        step * 2e-3,
        step,
        none,
        pressure,
        traction,
        traction,
        np.zeros((6, 3)),
    )
    force = np.array([0.0, 0.0, 10e3])
    return ContactResult(force, none[:3], (patch(10e3, force),), fields, 1e-5, "converged")


def test_cells_are_drawn_in_their_true_lengths() -> None:
    data = contact_dataset(
        {"left": strips(), "right": strips().mirrored()}, dict.fromkeys(("left", "right"), ContactLaws(friction=0.3))
    )
    cells, mirrored = (PatchCells.of(data, side, 0) for side in ("left", "right"))
    size = np.ptp(cells.corners, axis=1)
    np.testing.assert_allclose(size[:, 0], [2e-3, 3e-3, 1e-3, 2e-3, 1e-3, 1e-3], rtol=1e-12)
    np.testing.assert_allclose(size[:, 1], 2e-3, rtol=1e-12)  # in the contact plane, not seen from above
    assert (cells.middle[:3, 1] > 0).all()  # the strip on the left is drawn on the left
    np.testing.assert_allclose(mirrored.middle, cells.middle * [1, -1], atol=1e-15)
    np.testing.assert_allclose(cells.traction[0], [-0.3e8, 0.0], atol=1e-6)


def test_stick_slip_boundary_follows_cell_edges() -> None:
    cells = PatchCells.of(contact_dataset({"left": strips()}, {"left": ContactLaws(friction=0.3)}), "left", 0)
    assert cells.sticks.tolist() == [False, True, True, False, False, True]
    pieces = cells.stick_edge()
    x0 = cells.corners[0, 0, 0] + 3e-3  # where x = 0 is
    along = np.abs(np.ptp(pieces[..., 0], axis=1)) > 1e-9
    # across each strip once, at x = -1 and 1 mm, and along the side between from -1 to 0 and 0 to 1 mm
    assert sorted(np.round(1e3 * (pieces[~along][:, 0, 0] - x0), 6)) == [-1.0, 1.0]
    assert np.ptp(pieces[along][..., 0], axis=1).sum() == pytest.approx(2e-3)


def test_figure_of_patches(tmp_path: Path) -> None:
    results = {"left": strips(), "right": strips(-0.1)}
    data = contact_dataset(results, dict.fromkeys(results, ContactLaws(friction=0.3)))
    draw_patches(data, tmp_path / "patches.png")
    assert (tmp_path / "patches.png").read_bytes().startswith(b"\x89PNG")
    figure = patches_figure(data)
    panels = [ax for ax in figure.axes if ax.get_title(loc="left") or ax.get_title()]
    assert [ax.get_title(loc="left") or ax.get_title() for ax in panels] == ["left wheel: 10 kN", "right wheel: 10 kN"]
    for ax in panels:
        assert ax.get_xlabel().splitlines()[0] == "longitudinal, positive forward [mm]"
        assert ax.get_ylabel() == "lateral, positive to the left [mm]"
        assert "30 MPa" in ax.get_xlabel() or "60 MPa" in ax.get_xlabel()
    with pytest.raises(ValueError, match="not in contact"):
        draw_patches(
            contact_dataset({"left": ContactResult.separated()}, {"left": ContactLaws()}), tmp_path / "none.png"
        )
