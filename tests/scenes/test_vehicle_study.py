"""Studies of vehicle files: parameters of bodies and elements, sensitivities, steady curves, refusals."""

from __future__ import annotations

from concurrent.futures import ThreadPoolExecutor
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from linear_creep import LinearCreep
from xarray import Dataset

from wheelrail.scenes.builders.vehicle_file import MANCHESTER, vehicle_of
from wheelrail.scenes.builders.vehicle_tables import located, value_at, vehicle_tables, with_own_values
from wheelrail.scenes.runs.steady import critical_speeds_of, curve_of, equilibria_of, equilibrium_tables
from wheelrail.scenes.schema.edits import changed
from wheelrail.scenes.schema.errors import SceneError
from wheelrail.scenes.schema.scene import RunScene, load_scene
from wheelrail.scenes.studies.plots import drawings
from wheelrail.scenes.studies.run import run_study

SCENE = MANCHESTER.with_name("vehicle.toml")
BASE = {"vehicle_file": vehicle_tables(MANCHESTER)}
PRIMARY = "vehicle_elements_primary_stiffness_0"
STUDY = {"kind": "study", "scene": str(SCENE), "vehicle": str(MANCHESTER), "workers": 1}


@pytest.fixture
def springs(monkeypatch: pytest.MonkeyPatch) -> None:
    """Linear creep in place of the contact, in threads of this process."""
    monkeypatch.setattr("wheelrail.scenes.runs.steady.run_contact", lambda scene, names: (LinearCreep(), None))
    monkeypatch.setattr("wheelrail.scenes.runs.run.run_contact", lambda scene, names: (LinearCreep(), None))
    monkeypatch.setattr("wheelrail.scenes.studies.run.processes", ThreadPoolExecutor)


def study(**tables: Any) -> Dataset:
    return run_study({**STUDY, **tables}, pictures=False)


def test_names_of_bodies_elements_and_types() -> None:
    """A name that is no element stands for the type; an element with a type gets values of its own."""
    assert located("vehicle.elements.primary.stiffness.1", BASE) == "vehicle_file.element_types.primary.stiffness.1"
    assert located("vehicle.bodies.car_body.mass", BASE) == "vehicle_file.bodies.car_body.mass"
    assert located("vehicle.speed", BASE) == "vehicle.speed"
    name = "vehicle.elements.front_secondary.stiffness.2"
    own = with_own_values(BASE, [name])
    assert value_at(own, name) == 430e3
    tables = changed(own, {located(name, own): 5e5}, "study")["vehicle_file"]
    found, before = vehicle_of(tables, "study").elements, vehicle_of(BASE["vehicle_file"], "study").elements
    different = [key for key in found if found[key] != before[key]]
    assert different == ["front_secondary_1", "front_secondary_2"]
    assert found["front_secondary_1"].stiffness[2] == 5e5


def edited(folder: Path, old: str, new: str) -> Path:
    """The vehicle file with a text replaced."""
    text = MANCHESTER.read_text()
    assert text.count(old) == 1
    file = folder / "vehicle.toml"
    file.write_text(text.replace(old, new))
    return file


def run_scene() -> RunScene:
    scene = load_scene(SCENE)
    assert isinstance(scene, RunScene)
    return scene


@pytest.mark.usefixtures("springs")
def test_steady_curves_are_those_of_edited_files(tmp_path: Path) -> None:
    """Car bodies of three masses at random: guiding forces as of the file with this mass in its text."""
    masses = np.random.default_rng(5).uniform(20e3, 50e3, 3).round().tolist()
    data = study(compute="curving", grid={"vehicle.bodies.car_body.mass": masses})
    assert data["status"].values.tolist() == ["completed"] * 3
    assert data["vehicle_bodies_car_body_mass"].attrs["units"] == "kg"
    scene = run_scene()
    for mass, largest in zip(masses, data["largest_guiding_force"].values.tolist(), strict=True):
        file = edited(tmp_path, "mass = 32000.0", f"mass = {mass}")
        (at,) = equilibria_of(scene, file, [scene.vehicle.first_speed], curve_of(scene))
        rows = equilibrium_tables(at)[0].records
        expected = max(abs(value) for row in rows for value in np.ravel(list(row["guiding_force"].values())))
        assert largest == pytest.approx(expected, rel=1e-9)


@pytest.mark.usefixtures("springs")
def test_parameters_one_at_a_time_are_a_tornado() -> None:
    ranges = {
        "vehicle.elements.primary.stiffness.1": {"low": 2e6, "high": 6e6},
        "vehicle.elements.rear_secondary.stiffness.0": {"low": 1e5, "high": 3e5},
        "track.cant": {"low": 0.05, "high": 0.12},
    }
    data = study(compute="curving", one_at_a_time=ranges)
    assert data.sizes == {"variation": 7, "side": 2}
    assert data["vehicle_elements_primary_stiffness_1"].values.tolist() == [3.884e6, 2e6, 6e6] + 4 * [3.884e6]
    assert data["vehicle_elements_rear_secondary_stiffness_0"].values.tolist() == 3 * [160e3] + [1e5, 3e5] + 2 * [160e3]
    figure = drawings(data)["study"](data, None)
    assert figure is not None
    labels = [text.get_text() for text in figure.axes[0].get_yticklabels()]
    assert "track.cant 0.05 to 0.12 m" in labels
    assert "vehicle.elements.primary.stiffness.1 2e+06 to 6e+06 N/m" in labels
    quantity = data["largest_guiding_force"].values
    bars = [bar.get_width() for bar in figure.axes[0].patches]
    assert sorted(np.abs(bars)) == pytest.approx(sorted(1e-3 * np.abs(quantity[1:] - quantity[0])))


@pytest.mark.usefixtures("springs")
def test_critical_speed_of_samples_and_runs_in_time(tmp_path: Path) -> None:
    cube = {"samples": 3, "ranges": {"vehicle.elements.primary.stiffness.0": {"low": 5e6, "high": 40e6}}}
    data = study(compute="critical", latin_hypercube=cube)
    for stiffness, speed in zip(data[PRIMARY].values.tolist(), data["critical_speed"].values.tolist(), strict=True):
        file = edited(tmp_path, "[31.391e6, 3.884e6, 1.220e6]", f"[{stiffness!r}, 3.884e6, 1.220e6]")
        (found,) = critical_speeds_of(run_scene(), file, (5.0, 150.0), 1)
        assert found is not None
        assert speed == pytest.approx(found.speed, rel=1e-9)
    short = {"track.tangent": 11.0, "track.transition_length": 10.0, "track.curve": 1.0}
    runs = study(set=short, grid={"vehicle.bodies.car_body.mass": [32000.0, 40000.0]})
    assert runs["status"].values.tolist() == ["completed"] * 2
    assert np.isfinite(runs["largest_guiding_force"].values).all()
    lower, higher = runs["greatest_vertical_force"].max("side").values
    assert higher - lower == pytest.approx(1e3 * 9.81, rel=0.1)  # an eighth of 8 t more on a wheel


@pytest.mark.parametrize(
    ("tables", "said"),
    [
        ({"grid": {"vehicle.elements.none.stiffness.0": [1e6]}}, "vehicle.elements.none"),
        ({"grid": {"vehicle.bodies.car_body.mass": [-1.0]}}, r"mass.* = -1\.0: must be"),
        ({"grid": {"vehicle.bodies.car_body.mass": [3e4]}, "vehicle": None}, "needs vehicle, a vehicle file"),
        ({"grid": {"friction": [0.3]}, "compute": "critical", "vehicle": None}, 'compute = "critical": needs vehicle'),
        ({"one_at_a_time": {"vehicle.bodies.car_body.name": {"low": 0.0, "high": 1.0}}}, "must be a number that"),
        ({"grid": {"friction": [0.3]}, "vehicle": "none.toml"}, "must be an existing vehicle file"),
        (
            {"grid": {"load": [1e4]}, "scene": str(SCENE.with_name("hertz.toml"))},
            'allowed only for a scene with kind = "run"',
        ),
    ],
)
def test_refusals(tables: dict[str, Any], said: str) -> None:
    with pytest.raises(SceneError, match=said):
        study(**{"vehicle": str(MANCHESTER), **tables})
