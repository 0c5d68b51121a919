"""Files of a scene inside its results: read wherever the results lie, and when the files are gone."""

from __future__ import annotations

import json
import shutil
from pathlib import Path

import numpy as np
import pytest
from malformed_inputs import CURVE, WHEEL, changed, lines, standard
from xarray import Dataset

from wheelrail.scenes.datasets.input_files import FILES, packed, unpacked
from wheelrail.scenes.schema.errors import SceneError
from wheelrail.scenes.schema.scene import RunScene, load_scene
from wheelrail.scenes.schema.toml import parse
from wheelrail.scenes.views.view import bodies_of_run, scene_of_run

UNEVEN = "s, alignment [mm]\n0, 0\n50, 1\n500, -2\n"


@pytest.fixture
def stored(tmp_path: Path) -> tuple[Dataset, RunScene, Path]:
    """Attributes of results, the scene that was run, and the folder with its files."""
    folder = tmp_path / "project"
    (folder / "worn").mkdir(parents=True)
    (folder / "worn" / "wheel.txt").write_bytes(b"# Verschlei\xdf\n" + lines(WHEEL).encode())  # not in UTF-8
    (folder / "other.txt").write_text(lines(WHEEL * np.array([1.0, 1.01])))
    (folder / "wagon.toml").write_text("car_body.mass = 31000.0\n")
    (folder / "uneven.csv").write_text(UNEVEN)
    text = changed(
        standard(CURVE), 'wheel = "S1002"', 'wheel = "worn/wheel.txt"\nleft = {wheel = "other.txt"}\nnoise = 0'
    )
    text = changed(text, "speed = 45.0", f'speed = 45.0\nwagon = "{folder / "wagon.toml"}"')
    text = changed(text, "[track]", '[track]\nirregularities = {file = "uneven.csv"}')
    (folder / "scene.toml").write_text(text)
    scene = load_scene(folder / "scene.toml")
    assert isinstance(scene, RunScene)
    files = packed([(parse(text, "scene"), scene.model_dump())])
    return Dataset(attrs={"scene": text, FILES: files}), scene, folder


def test_results_are_read_when_the_files_are_gone(stored: tuple[Dataset, RunScene, Path], tmp_path: Path) -> None:
    data, scene, folder = stored
    wheels = [scene.profiles.profile(side, "wheel").digest() for side in ("left", "right")]
    wagon, at = scene.vehicle.on(0.46), np.linspace(0.0, 300.0, 7)
    uneven = scene.track.track().irregularities.at(at)  # type: ignore[union-attr]
    shutil.rmtree(folder)
    read = scene_of_run(data, tmp_path / "elsewhere" / "run.nc")
    assert [read.profiles.profile(side, "wheel").digest() for side in ("left", "right")] == wheels
    assert read.vehicle.on(0.46) == wagon
    np.testing.assert_array_equal(read.track.track().irregularities.at(at), uneven)  # type: ignore[union-attr]
    assert np.abs(uneven).max() > 1e-4
    assert bodies_of_run(data, Path("run.nc")).on("left").wheel.digest() == wheels[0] != wheels[1]


def test_the_bytes_are_those_of_the_files(stored: tuple[Dataset, RunScene, Path]) -> None:
    data, _, folder = stored
    content = json.loads(data.attrs[FILES])
    names = {"worn/wheel.txt", "other.txt", str(folder / "wagon.toml"), "uneven.csv"}
    assert content.keys() == names
    assert all(text.encode("latin-1") == (folder / name).read_bytes() for name, text in content.items())


def test_results_of_earlier_versions_look_beside_themselves(stored: tuple[Dataset, RunScene, Path]) -> None:
    data, scene, folder = stored
    del data.attrs[FILES]
    assert scene_of_run(data, folder / "run.nc").vehicle == scene.vehicle
    with pytest.raises(SceneError, match=r"worn/wheel\.txt"):
        scene_of_run(data, folder / "results" / "run.nc")


def test_a_force_table_is_not_stored() -> None:
    tables = {"model": "table", "table": "large.nc", "friction": 0.3}
    assert unpacked(tables, {FILES: "{}"}, "run.nc") == {"model": "standard", "friction": 0.3}


@pytest.mark.parametrize("content", ["{", "[1]", '{"a": 1}', '{"..": "x"}', '{"a\\u0000b": "x"}', '{"a": "\\u4e00"}'])
def test_damaged_files_are_an_error(content: str) -> None:
    with pytest.raises(SceneError, match=r"run\.nc: files: the stored files of the scene are damaged"):
        unpacked({"wheel": "a"}, {FILES: content}, "run.nc")
