"""The public package: short examples with known results, saving, figures, and errors for invalid arguments."""

from __future__ import annotations

import inspect
import json
import os
import re
import subprocess
import sys
from pathlib import Path
from typing import Any

import matplotlib
import numpy as np
import pytest
import xarray

import wheelrail as wr
from wheelrail.contact.analytical.hertz import hertz, modulus
from wheelrail.contact.geometry.rigid_surfaces import RigidWheelRail
from wheelrail.meshes.profiles.named import named_profile
from wheelrail.meshes.profiles.profile import from_sections
from wheelrail.scenes.contacts.solve import solve_contact
from wheelrail.scenes.schema.edits import changed, without
from wheelrail.scenes.schema.errors import SceneError
from wheelrail.scenes.schema.scene import WheelsetScene, load_scene

matplotlib.use("Agg")
ROOT = Path(__file__).parents[2]
SCENES = ROOT / "scenes"
STEEL = (2.1e11, 0.3)


@pytest.fixture(scope="module")
def pressed() -> wr.Solution:
    return wr.Hertz(upper=(0.46, np.inf), lower=(np.inf, 0.30), friction=0.3).solve(load=60e3, creepage=(0.9e-3, 0, 0))


@pytest.fixture(scope="module")
def wheelset() -> wr.Wheelset:
    return wr.Wheelset(wheel="S1002", rail="UIC60", friction=0.3, model="standard")


@pytest.fixture(scope="module")
def curving(wheelset: wr.Wheelset) -> wr.Solution:
    return wheelset.solve(y=2e-3, wheel_load=57e3, speed=45.0)


def test_import_is_light() -> None:
    script = (
        "import sys, wheelrail; assert set(wheelrail.__all__) <= set(dir(wheelrail));"
        "heavy = {'matplotlib', 'xarray', 'pandas', 'dolfinx', 'numpy', 'scipy', 'pydantic', 'pyvista'};"
        "assert not heavy & set(sys.modules), sys.modules"
    )
    environment = {**os.environ, "PYTHONPATH": str(ROOT)}
    subprocess.run([sys.executable, "-c", script], check=True, cwd=ROOT, env=environment, timeout=60)


def test_public_names_are_documented_with_units() -> None:
    assert sorted(wr.__all__) == sorted(wr._HOMES)
    for name in wr.__all__:
        found = getattr(wr, name)
        parts = [found]
        if inspect.isclass(found) and name != "SceneError":
            parts += [value for key, value in vars(found).items() if inspect.isfunction(value) and key[0] != "_"]
        for part in parts:
            assert part.__doc__, part
    units = re.compile(r"\b(m|N|Pa|rad|MPa|mm|SI)\b")
    for numbers in (wr.Hertz, wr.Hertz.solve, wr.Wheelset, wr.Wheelset.solve, wr.contact_geometry, wr.profile, wr.run):
        assert units.search(numbers.__doc__ or ""), numbers
    with pytest.raises(AttributeError, match="it has Hertz"):
        _ = wr.Herz


def test_hertz_peak(pressed: wr.Solution) -> None:
    exact = hertz(0.5 / 0.46, 0.5 / 0.3, modulus(STEEL, STEEL), force=60e3)
    (patch,) = pressed.patches.itertuples()
    assert pressed.ok
    assert patch.side == "contact"
    assert patch.max_pressure == pytest.approx(exact.peak, rel=6e-3)
    assert patch.normal_force == pytest.approx(60e3, rel=1e-6)  # noise of the default tolerance
    assert patch.semi_axis_x == pytest.approx(exact.semi_axes[0], rel=5e-3)
    assert wr.Hertz().closed_form(load=60e3).peak == pytest.approx(exact.peak, rel=1e-12)
    half = pressed.data["patch_gap_curvature_x"].item(), pressed.data["patch_gap_curvature_y"].item()
    assert half == pytest.approx((0.5 / 0.46, 0.5 / 0.3))


def test_a_wheelset_as_from_its_scene(tmp_path: Path) -> None:
    text = (SCENES / "wheelset.toml").read_text().replace('model = "condensed"', 'model = "standard"')
    (tmp_path / "wheelset.toml").write_text(text)
    scene = load_scene(tmp_path / "wheelset.toml")
    assert isinstance(scene, WheelsetScene)
    solution = solve_contact(scene)
    loaded = wr.load(tmp_path / "wheelset.toml")
    given = wr.Wheelset("S1002", "UIC60-benchmark", friction=0.3, model="standard")
    for found in (loaded.solve(), given.solve(y=-2e-3, wheel_load=57e3, speed=45.0)):
        for name in ("lateral_force", "spin_moment", "z"):
            np.testing.assert_array_equal(found.data[name], solution[name])
    assert isinstance(loaded, wr.Wheelset)
    again = loaded.solve(axle_load=100e3)  # instead of the wheel load
    assert float(again.data["vertical_force"].sum()) == pytest.approx(100e3, rel=1e-6)
    assert loaded.solve(speed=30.0).data["longitudinal_force"].values == pytest.approx(
        found.data["longitudinal_force"].values, rel=1e-6
    )  # pure rolling at any speed


def test_left_and_right_are_mirror_images(wheelset: wr.Wheelset) -> None:
    one, other = (wheelset.solve(y=y, wheel_load=57e3).data for y in (2e-3, -2e-3))
    left = one.sel(point=one["point_side"] == "left")
    right = other.sel(point=other["point_side"] == "right")
    np.testing.assert_array_equal(left["pressure"], right["pressure"])
    np.testing.assert_array_equal(left["position"] * [1.0, -1.0, 1.0], right["position"])
    for data, side in ((one, "left"), (other, "right")):
        own = data.sel(point=data["point_side"] == side)
        axes = own["axes"].values
        np.testing.assert_allclose(np.cross(axes[:, 1], axes[:, 0]), axes[:, 2], atol=1e-12)  # outward is down
        local = np.column_stack([own["traction"], -own["pressure"]]) * own["area"].values[:, None]
        force = np.einsum("nk,nkc->c", local, axes)
        total = [data[f"{axis}_force"].sel(side=side).item() for axis in ("longitudinal", "lateral", "vertical")]
        assert force == pytest.approx(total, rel=1e-9, abs=1e-3)  # the points carry the wheel load


def test_repr_is_a_table_with_units(curving: wr.Solution) -> None:
    shown = repr(curving)
    assert "patch 1: peak pressure [MPa]" in shown
    assert shown.splitlines()[1].split() == ["left", "right"]
    assert max(map(len, shown.splitlines())) <= 130
    page = curving._repr_html_()
    assert page.count("<tr>") == len(shown.splitlines()) - 1
    assert "xarray" in page
    assert repr(wr.profile("S1002")).startswith("Profile S1002 (wheel): y -70.00 to 65.00 mm")
    assert repr(wr.profile("UIC60")) == repr(named_profile("60E1"))


def test_every_variable_has_unit_and_meaning(curving: wr.Solution) -> None:
    for name, values in {**curving.data.data_vars, **wr.contact_geometry(y=[1e-3]).data_vars}.items():
        assert ("units" in values.attrs) == (values.dtype.kind != "U"), name  # texts have none
        assert values.attrs["long_name"], name
    assert json.loads(curving.data.attrs["arguments"])["y"] == 2e-3
    assert "numpy" in curving.data.attrs["versions"]


def test_saved_solution_is_opened_and_drawn(curving: wr.Solution, tmp_path: Path) -> None:
    file = curving.to_netcdf(tmp_path / "new" / "curving.nc")
    back = wr.open(file)
    assert isinstance(back, wr.Solution)
    xarray.testing.assert_identical(back.data, curving.data)
    assert repr(back) == repr(curving)
    for one, other in (
        (back.plot.pressure(), curving.plot.pressure()),
        (back.plot.profiles(), curving.plot.profiles()),
    ):
        assert one.get_title(loc="left") == other.get_title(loc="left")
        one.figure.savefig(tmp_path / "picture.png")
    assert [ax.get_title(loc="left").split(":")[0] for ax in back.plot()] == ["left wheel", "right wheel"]
    matplotlib.pyplot.close("all")


@pytest.mark.parametrize("text", [b"", b"no NetCDF"])
def test_files_without_results_are_rejected(tmp_path: Path, text: bytes) -> None:
    (tmp_path / "other.nc").write_bytes(text)
    with pytest.raises(SceneError, match=r"other\.nc: not a readable NetCDF file"):
        wr.open(tmp_path / "other.nc")
    xarray.Dataset({"a": ("time", [1.0])}).to_netcdf(tmp_path / "foreign.nc")
    with pytest.raises(SceneError, match=r"foreign\.nc: must be the results of a contact solution"):
        wr.open(tmp_path / "foreign.nc")
    with pytest.raises(FileNotFoundError, match=r"none\.nc"):
        wr.open(tmp_path / "none.nc")


@pytest.mark.parametrize(
    ("call", "says"),
    [
        (lambda w: w.solve(y=2.0, wheel_load=57e3), "Wheelset: y = 2.0: must be a number from -0.1 to 0.1 m"),
        (lambda w: w.solve(wheel_load=57e3, z=0.0), "exactly one of wheel_load, axle_load and z"),
        (lambda w: w.solve(axle_load=1e5, roll="solve"), 'roll = "solve": "solve" requires wheel_load'),
        (lambda w: w.solve(wheel_load=float("nan")), "wheel_load = NaN: must be a number from 1 to 1e+06 N"),
        (lambda w: w.solve(wheel_load=57e3, sides=("inner",)), 'sides[0] = "inner": must be "left" or "right"'),
        (lambda w: wr.Wheelset(whel="S1002"), "Wheelset: whel: unknown argument; did you mean wheel?"),
        (lambda w: wr.Wheelset(gage=1.435), "did you mean gauge?"),
        (lambda w: wr.Wheelset(wheel="60E1"), 'Wheelset: wheel = "60E1": must be S1002, or an existing file'),
        (lambda w: wr.Wheelset(wheel=named_profile("60E1")), "must be a wheel profile"),
        (lambda w: wr.Wheelset(friction="dry"), 'Wheelset: friction = "dry": must be a number from 0 to 2'),
        (lambda w: wr.Wheelset(radius=460.0), "radius = 460.0: must be a number from 0.1 to 1 m"),
        (
            lambda w: wr.Hertz(upper=(0.3, 0.0)),
            "Hertz: upper.radii[1] = 0.0: must be a radius with magnitude from 1e-4",
        ),
        (lambda w: wr.Hertz(upper=(-0.3, 0.3)), "must give point contact"),
        (lambda w: wr.Hertz().solve(), "Hertz: load: missing: exactly one of load and approach"),
        (lambda w: wr.Hertz(surface_sice=1e-3), "did you mean surface_size?"),
        (lambda w: wr.load(SCENES / "curve.toml"), "for a vehicle run use wheelrail.run"),
        (lambda w: wr.run(SCENES / "hertz.toml"), "for a single contact use wheelrail.load"),
        (lambda w: wr.run(SCENES / "curve.toml", **{"vehicle.speed": -1.0}), "vehicle.speed = -1.0: must be"),
        (
            lambda w: wr.run(SCENES / "curve.toml", **{"friction.mu": 0.3}),
            "friction.mu = 0.3: unknown key",
        ),
        (lambda w: wr.contact_geometry(y=[2.0]), "y must be numbers from -0.1 to 0.1 m"),
        (lambda w: wr.contact_geometry(y=[-9e-2]), "the wheel is beside the rail"),
        (lambda w: wr.profile("S1003"), "profile 'S1003': must be one of S1002"),
    ],
)
def test_invalid_arguments_are_named(wheelset: wr.Wheelset, call: Any, says: str) -> None:
    with pytest.raises(ValueError) as caught:
        call(wheelset)
    assert says in str(caught.value)


def test_a_load_that_cannot_be_carried_is_a_status(wheelset: wr.Wheelset) -> None:
    found = wheelset.solve(y=-0.1, wheel_load=57e3, sides=["left"])
    assert not found.ok
    assert found.status.startswith("failed: left")
    assert "failed" in repr(found)
    assert not len(found.patches)
    assert found.data["vertical_force"].isnull().all()
    with pytest.raises(ValueError, match="in contact"):
        found.plot()


def test_profile_objects_as_named_ones(curving: wr.Solution) -> None:
    measured = wr.Wheelset(wr.profile("S1002"), wr.profile("UIC60"), friction=0.3, model="standard")
    found = measured.solve(y=2e-3, wheel_load=57e3, speed=45.0)
    np.testing.assert_array_equal(found.data["lateral_force"], curving.data["lateral_force"])


def test_stress_and_error_estimate_on_demand(pressed: wr.Solution) -> None:
    assert "von_mises" not in pressed.data
    assert "force_error" not in pressed.data
    found = wr.Hertz(friction=0.0, strips=6, cells=8).solve(
        load=60e3, error_estimate=True, stress={"depths": [2e-3, 3e-3]}
    )
    assert found.data["von_mises"].dims == ("side", "body", "patch", "depth")
    assert found.data["von_mises"].values == pytest.approx(0.6 * 1044e6, rel=0.1)  # Johnson: 0.6 p0, near 0.5 a deep
    assert 0.0 < float(found.data["max_pressure_error"][0]) < 0.04 * 1044e6  # from four strips


def test_rolling_radii_of_cones() -> None:
    """Cone of slope 1/40 on a crowned rail, in closed form."""
    from wheelrail.meshes.curves.arc_length import arc, line

    slope, radius = 1.0 / 40.0, 0.3
    wheel = from_sections([line(-0.06 + 0.06j * slope, 0.06 - 0.06j * slope)], name="cone", kind="wheel")
    crown = [arc(-1j * radius, radius, np.pi / 2 + 0.2, np.pi / 2 - 0.2)]
    rail = from_sections(crown, name="crown", kind="rail")
    assert RigidWheelRail(wheel, rail, 0.46).wheel is wheel
    y = np.linspace(-5e-3, 5e-3, 11)
    found = wr.contact_geometry(wheel, rail, y, gauge_height=0.005)
    # roll of (rr - rl) / base: small displacement over the crown
    difference = found["rolling_radius_difference"].values
    assert np.polyfit(y, difference, 1)[0] == pytest.approx(2.0 * slope, rel=0.03)
    assert found["equivalent_conicity"].values == pytest.approx(slope, rel=1e-4)
    assert found["equivalent_conicity_with_roll"].values == pytest.approx(
        0.5 * np.polyfit(y, difference, 1)[0], rel=1e-3
    )


def test_contact_geometry_of_s1002_on_uic60() -> None:
    found = wr.contact_geometry("S1002", "UIC60", [-3e-3, 0.0, 3e-3, 7e-3])
    difference = found["rolling_radius_difference"].values
    assert difference[0] == pytest.approx(-difference[2], rel=1e-6)
    assert found["roll"].values[1] == pytest.approx(0.0, abs=1e-9)
    assert found["contact_angle"].sel(side="left").values[3] > 1.0  # on the flange, 70 degrees at most
    assert found["contact_angle"].values[1] == pytest.approx(found["contact_angle"].values[1, ::-1] * -1.0, abs=1e-6)
    assert found["equivalent_conicity"].sel(amplitude=3e-3).item() == pytest.approx(0.174, abs=0.001)
    assert found["equivalent_conicity_with_roll"].sel(amplitude=3e-3).item() == pytest.approx(0.177, abs=0.001)


def test_a_run_from_a_changed_scene(tmp_path: Path) -> None:
    changes = {
        "model": "standard",
        "strips": None,
        "cells": None,
        "surface_size": None,
        "track.tangent": 5.0,
        "track.transition_length": 10.0,
        "track.curve": 5.0,
        "vehicle.speed": 30.0,
        "solver.workers": 1,
    }
    found = wr.run(SCENES / "curve.toml", **changes)
    assert found.status == "completed"
    assert found.data.attrs["speed"] == 30.0
    assert float(found.data["distance"][-1]) == pytest.approx(20.0, abs=1.5)  # samples every 0.05 s
    assert "speed = 30.0" in found.data.attrs["scene"]
    assert repr(found).startswith("Vehicle run: completed at 19.5 m")
    assert "<table>" in found._repr_html_()
    kept = wr.run(SCENES / "curve.toml", tmp_path / "kept", **changes, **{"output.figures": False})
    np.testing.assert_array_equal(kept.data["lateral_force"], found.data["lateral_force"])
    page = wr.report(tmp_path / "kept", tmp_path / "page.html", view=False)
    assert "speed = 30.0" in page.read_text(encoding="utf-8")
    drawn = found.view(10.0)
    assert drawn.title.startswith("10.5 m, ")
    drawn.close()
    back = wr.open(found.to_netcdf(tmp_path / "run.nc"))
    assert isinstance(back, wr.Run)
    assert len(back.plot.displacements()) == len(back.plot.bands("rail")) == 2
    assert set(back.plot()) >= {"lateral_force", "contact_on_wheel"}
    with pytest.raises(ValueError, match='"wheel" or "rail"'):
        back.plot.bands("axle")  # type: ignore[arg-type]
    matplotlib.pyplot.close("all")


def test_values_of_scenes_are_changed_by_dotted_names() -> None:
    tables = {"a": {"b": 1, "c": [1, 2]}}
    assert changed(tables, {"a.c.0": 3, "a.d.e": 4}, "scene") == {"a": {"b": 1, "c": [3, 2], "d": {"e": 4}}}
    assert without(tables, ["a.b"], "scene") == {"a": {"c": [1, 2]}}
    with pytest.raises(wr.SceneError, match=r"scene: a\.b\.x = 1: unknown key"):
        changed(tables, {"a.b.x": 1}, "scene")
    with pytest.raises(wr.SceneError, match=r"scene: a\.x: must be a key of the scene"):
        without(tables, ["a.x"], "scene")


def test_study_from_a_table(tmp_path: Path) -> None:
    table = {
        "scene": {
            "kind": "hertz",
            "model": "standard",
            "normal": "hertz",
            "friction": 0.0,
            "load": 1e4,
            "upper": {"radii": [0.3, 0.3], "E": 2.1e11, "nu": 0.3},
            "lower": {"radii": [float("inf"), float("inf")], "E": 2.1e11, "nu": 0.3},
        },
        "workers": 1,
        "grid": {"load": [1e3, 8e3, 6.4e4]},
    }
    found = wr.study(table)
    # Hertz: the peak is proportional to the cube root of the load
    np.testing.assert_allclose(np.diff(np.log2(found.data["max_pressure"])), 1.0, rtol=1e-3)
    assert "3 cases" in repr(found)
    assert "<details>" in found._repr_html_()
    back = wr.open(found.to_netcdf(tmp_path / "study.nc"))
    assert isinstance(back, wr.Study)
    assert set(back.plot()) == {"study"}
    with pytest.raises(ValueError, match="convergence: the study has no such figure"):
        back.plot.convergence()
    matplotlib.pyplot.close("all")


def test_no_view_without_bodies(pressed: wr.Solution, tmp_path: Path) -> None:
    with pytest.raises(ValueError, match="from a file contains no bodies"):
        wr.open(pressed.to_netcdf(tmp_path / "patch.nc")).view()  # type: ignore[union-attr]
    with pytest.raises(wr.SceneError, match="side = 'left': must be 'contact'"):
        pressed.view("left")
    with pytest.raises(wr.SceneError, match=r"view\.pdf': must end in \.png or \.html"):
        pressed.view(file="view.pdf")
    with pytest.raises(wr.SceneError, match="must be upper, lower or both"):
        pressed.view(body="wheel")


def test_a_solution_in_three_dimensions(pressed: wr.Solution) -> None:
    view = pressed.view(body="lower")
    assert "Hertz pair" in view.title
    assert "von Mises stress [MPa]" in dict(view.scalar_bars.items())
    view.close()


def test_both_wheels_in_threads_are_those_of_one_after_the_other() -> None:
    contact = wr.Wheelset(wheel="S1002", rail="60E1", bodies="half-space", strips=6, cells=8)
    alone, together = (contact.solve(y=2e-3, wheel_load=57e3).data for _ in range(2))
    xarray.testing.assert_equal(*(data.drop_vars(["contact_seconds", "phase_seconds"]) for data in (alone, together)))
