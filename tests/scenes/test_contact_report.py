"""JSON and table of a contact, both made from the Dataset of the solution."""

from __future__ import annotations

import json
from dataclasses import asdict, replace
from math import nan
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from xarray import Dataset, load_dataset

from wheelrail.contact.results.error_estimate import ErrorEstimate
from wheelrail.contact.results.result import ContactResult, Statistics
from wheelrail.contact.stress.subsurface import PatchStress, SubsurfaceStress
from wheelrail.scenes.builders.wheelset import side_profiles
from wheelrail.scenes.contacts.report import contact_report
from wheelrail.scenes.contacts.side_solution import SideSolution
from wheelrail.scenes.contacts.side_values import SideValues
from wheelrail.scenes.contacts.solution import solution_dataset
from wheelrail.scenes.contacts.solve import solve_sides
from wheelrail.scenes.contacts.table import table
from wheelrail.scenes.datasets.result_table import json_text
from wheelrail.scenes.schema.scene import WheelsetScene, parse_scene
from wheelrail.scenes.studies.quantities import of_contact

TEXT = (Path(__file__).parents[2] / "scenes" / "wheelset.toml").read_text()
DEPTH = np.array([1e-3, 2e-3, 4e-3])
FALLING = "\n[falling]\nshare = 0.6\nrate = 0.5\n"


@pytest.fixture(scope="module")
def scene() -> WheelsetScene:
    changed = TEXT.replace('model = "condensed"', 'model = "standard"') + FALLING
    checked = parse_scene(changed)
    assert isinstance(checked, WheelsetScene)
    return checked


@pytest.fixture(scope="module")
def solved(scene: WheelsetScene) -> dict[str, SideSolution]:
    """Solution with an error estimate, a stress and statistics that the standard model does not have."""
    sides = dict(solve_sides(scene))
    statistics = Statistics(5, 2, 192, 1e-12, {"fit": 0.1, "solve": 0.2})
    generator = np.random.default_rng(1)
    for name, side in sides.items():
        stress = tuple(
            PatchStress(DEPTH, generator.normal(size=(3, 3)), generator.normal(size=(3, 3, 3)))
            for _ in side.result.patches
        )
        estimate = ErrorEstimate(1.5, 2.5, nan, 1e-7)
        result = replace(side.result, error_estimate=estimate, statistics=statistics)
        sides[name] = replace(side, result=result, stress={"rail": SubsurfaceStress(stress, 40, 0.3)})
    return sides


def dataset(scene: WheelsetScene, solved: dict[str, SideSolution]) -> Dataset:
    return solution_dataset(scene, solved, side_profiles(scene))


def plain(value: Any) -> Any:
    return json.loads(json_text({"value": value}))["value"]


def test_json_has_every_bit_of_the_results(scene: WheelsetScene, solved: dict[str, SideSolution]) -> None:
    report = json.loads(json_text(contact_report(dataset(scene, solved))))
    assert report["falling"] == {"share": 0.6, "rate": 0.5}
    for name, side in solved.items():
        own, result = report[name], side.result
        assert [list(patch) for patch in own["patches"]] == [list(asdict(patch)) for patch in result.patches]
        for key in ("status", "force", "moment", "approach"):
            assert own[key] == plain(getattr(result, key))
        assert own["patches"] == plain([asdict(patch) for patch in result.patches])
        assert own["error_estimate"] == plain(asdict(result.error_estimate))  # type: ignore[arg-type]
        seconds = {"fit": 0.1, "solve": 0.2, "all_solves": side.seconds}
        assert own["statistics"] == asdict(result.statistics) | {"contact_solves": side.solves, "seconds": seconds}
        stress = own["stress"]["rail"]
        assert (stress["wavenumbers"], stress["seconds"]) == (40, 0.3)
        for patch, below in zip(side.stress["rail"].patches, stress["patches"], strict=True):
            for key in ("depth", "position", "stress", "von_mises"):
                assert below[key] == plain(getattr(patch, key))
            largest = patch.von_mises.argmax()
            assert below["largest"] == {"von_mises": patch.von_mises[largest], "depth": DEPTH[largest]}


def test_a_saved_solution_gives_the_same_json_and_table(
    scene: WheelsetScene, solved: dict[str, SideSolution], tmp_path: Path
) -> None:
    data = dataset(scene, solved)
    data.to_netcdf(tmp_path / "solution.nc", engine="netcdf4")
    saved = load_dataset(tmp_path / "solution.nc", engine="netcdf4")
    assert json_text(contact_report(saved)) == json_text(contact_report(data))
    shown = table(data)
    assert shown == table(saved)
    text = "\n".join(map(" ".join, shown.rows))
    for line in ("192", "error estimate: peak pressure [MPa]", "unknown", "stress, rail [MPa]"):
        assert line in text


def test_a_failed_side_has_no_values(scene: WheelsetScene, solved: dict[str, SideSolution]) -> None:
    failed = replace(solved["right"], result=replace(solved["right"].result, status="failed: iterations"))
    data = dataset(scene, {"left": SideSolution.failed("too heavy"), "right": failed})
    report = contact_report(data)
    assert report["status"] == "failed: left: too heavy"
    assert report["left"] == {"status": "failed: too heavy"}
    assert list(report["right"]) == ["status", "statistics"]
    assert report["right"]["statistics"]["points"] == 192
    assert [of_contact(SideValues(data, side)) for side in ("left", "right")] == [{}, {}]


def test_a_separated_side_has_zero_forces(scene: WheelsetScene, solved: dict[str, SideSolution]) -> None:
    apart = SideSolution(ContactResult.separated(-1e-4), solved["left"].pose, 1e-3, 0.0, 1, 0.1)
    report = contact_report(dataset(scene, {"left": apart, "right": solved["right"]}))
    assert report["status"] == "converged"
    assert report["left"]["patches"] == []
    assert not {"error_estimate", "stress"} & set(report["left"])
    assert (report["left"]["normal_force"], report["left"]["force"]) == (0, [0.0, 0.0, 0.0])
    assert report["left"]["statistics"]["seconds"] == {"all_solves": 0.1}
