"""The functional mock-up unit: validated and driven by FMPy, and by a program without Python."""

from __future__ import annotations

import os
import shutil
import subprocess
from pathlib import Path
from typing import Any
from zipfile import ZipFile

import numpy as np
import pytest
from typer.testing import CliRunner

import wheelrail as wr
from wheelrail.api.elements.variables import INPUTS, OUTPUTS
from wheelrail.cli.main import app
from wheelrail.export.unit import write_scene

pytest.importorskip("cffi")
if shutil.which("cc") is None:
    pytest.skip("no C compiler", allow_module_level=True)

HERE = Path(__file__).parent
SCENES = HERE.parents[1] / "scenes"
PLACES = ((-1e-3, -2.8e-4), (-1.2e-3, -2.7e-4))


@pytest.fixture(scope="module")
def scene(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A wheelset of half-spaces with few strips."""
    text = (SCENES / "wheelset.toml").read_text(encoding="utf-8")
    file = tmp_path_factory.mktemp("scene") / "few.toml"
    file.write_text('bodies = "half-space"\nstrips = 8\ncells = 8\n' + text)
    return file


@pytest.fixture(scope="module")
def unit(scene: Path) -> Path:
    """The exported unit."""
    file = scene.with_suffix(".fmu")
    exported = CliRunner().invoke(app, ["export", str(scene), "--fmu", str(file)])
    assert exported.exit_code == 0, exported.stderr
    return file


def numbers(element: wr.WheelsetElement, places: Any) -> list[list[float]]:
    """Outputs, derivatives by yaw and area of the left patch at each place, which is accepted."""
    rows, outputs, inputs = [], np.zeros(len(OUTPUTS)), element.start_array()
    for inputs[0], inputs[1] in places:
        assert element.solve_array(inputs, outputs) == "converged"
        rows.append([*outputs, *element.tangent_array([3])[:, 0], element.patch_array()[0, 1]])
        element.accept()
    return rows


def test_a_host_in_c(unit: Path, scene: Path, tmp_path: Path) -> None:
    ZipFile(unit).extractall(tmp_path / "a b")
    (library,) = (tmp_path / "a b/binaries/linux64").iterdir()
    program = tmp_path / "host"
    subprocess.run(["cc", "-Wall", str(HERE / "unit_host.c"), "-ldl", "-o", program], check=True, timeout=60)
    guid = (tmp_path / "a b/modelDescription.xml").read_text(encoding="utf-8").split('guid="')[1].split('"')[0]
    environment = {name: value for name, value in os.environ.items() if name != "PYTHONPATH"}
    resources = (tmp_path / "a b/resources").as_uri()
    done = subprocess.run(
        [program, library, guid, resources], capture_output=True, text=True, env=environment, timeout=120, check=False
    )
    assert done.returncode == 0, done.stdout[-500:] + done.stderr
    refused, first, other, second, wild, status, again, new, negative, last = done.stdout.splitlines()
    assert refused == "wrong, status 3: the GUID is not that of the unit"
    assert wild == "first, status 2: failed: z = 1.0: must be a number from -0.1 to 0.1 m (2 mm is 0.002)"
    assert (status, last) == ("status 2", "status 3")
    assert negative.startswith("again, status 3: Wheelset: left.friction = -1")
    expected = numbers(wr.load(scene).element(), PLACES)  # type: ignore[union-attr]
    for line, row in zip((first, second), expected, strict=True):
        *values, failed = line.split()
        assert [float.fromhex(value) for value in values] == row
        assert failed == "0"
    assert first == again == new
    slippery = wr.Wheelset(**{**wr.load(scene).arguments, "left": {"friction": 0.1}})
    *values, _ = other.split()
    assert [float.fromhex(value) for value in values] == numbers(slippery.element(), PLACES[:1])[0]


def test_fmpy_validates_and_drives_the_unit(unit: Path, scene: Path) -> None:
    fmpy = pytest.importorskip("fmpy")
    from fmpy.validation import validate_fmu

    assert validate_fmu(str(unit)) == []
    element, outputs = wr.load(scene).element(), np.zeros(len(OUTPUTS))  # type: ignore[union-attr]
    names = [variable.name for variable in OUTPUTS[:12]]
    signal = np.array([(0.0, -2.5e-4), (3e-3, -2.8e-4)], dtype=[("time", float), ("z", float)])
    for kind in ("ModelExchange", "CoSimulation"):
        run = fmpy.simulate_fmu(
            str(unit), fmi_type=kind, stop_time=3e-3, output_interval=1e-3, step_size=1e-3, input=signal, output=names
        )
        assert len(run) == 4
        inputs = element.start_array()
        inputs[1] = -2.5e-4
        element.solve_array(inputs, outputs)
        assert list(run[0])[1:] == pytest.approx(outputs[:12].tolist(), rel=1e-6)
        assert run["left_Fz"][-1] > run["left_Fz"][0] > 1e4
    description = fmpy.read_model_description(str(unit))
    starts = {variable.name: float(variable.start) for variable in description.modelVariables if variable.start}
    assert starts["speed"] == 45.0
    assert starts["right_friction"] == 0.3
    assert [variable.name for variable in description.modelVariables][: len(INPUTS)] == [v.name for v in INPUTS]


def test_profiles_of_files_are_in_the_unit(tmp_path: Path) -> None:
    """A unit needs no file beside it."""
    (tmp_path / "rail.txt").write_text("points")
    scene = tmp_path / "scene.toml"
    scene.write_text('[profiles]\nwheel = "S1002"\nrail = "60E1"\n[profiles.left]\nrail = "rail.txt"\n')
    (tmp_path / "unit").mkdir()
    write_scene(scene, tmp_path / "unit")
    text = (tmp_path / "unit/scene.toml").read_text(encoding="utf-8")
    assert 'rail = "0_rail.txt"' in text
    assert 'rail = "60E1"' in text
    assert (tmp_path / "unit/0_rail.txt").read_text(encoding="utf-8") == "points"
