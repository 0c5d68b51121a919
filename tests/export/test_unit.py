"""The functional mock-up unit: validated and driven by FMPy, and by a program without Python."""

from __future__ import annotations

import os
import re
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
from wheelrail.export.host import loaded_inputs

pytest.importorskip("cffi")
if shutil.which("cc") is None:
    pytest.skip("no C compiler", allow_module_level=True)

HERE = Path(__file__).parent
SCENES = HERE.parents[1] / "scenes"
PLACES = ((-1e-3, -2.8e-4), (-1.2e-3, -2.7e-4))
SLIPPERY = {"friction": 0.1}


@pytest.fixture(scope="module")
def scene(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A wheelset of half-spaces with few strips."""
    text = (SCENES / "wheelset.toml").read_text(encoding="utf-8")
    file = tmp_path_factory.mktemp("scene") / "few.toml"
    file.write_text('bodies = "half-space"\nstrips = 8\ncells = 8\n' + text)
    return file


def exported_unit(scene: Path, fmi: str) -> Path:
    file = scene.with_name(f"few_{fmi[0]}.fmu")
    exported = CliRunner().invoke(app, ["export", str(scene), "--fmu", str(file), "--fmi", fmi])
    assert exported.exit_code == 0, exported.stderr
    return file


@pytest.fixture(scope="module")
def unit(scene: Path) -> Path:
    """The exported unit of FMI 2.0."""
    return exported_unit(scene, "2.0")


@pytest.fixture(scope="module")
def unit3(scene: Path) -> Path:
    """The exported unit of FMI 3.0."""
    return exported_unit(scene, "3.0")


def numbers(scene: Path, places: Any, **values: Any) -> list[list[float]]:
    """Outputs, derivatives by yaw and area of the left patch at each place, accepted, of a unit with other values."""
    loaded = wr.load(scene)
    assert isinstance(loaded, wr.Wheelset)
    element = wr.Wheelset(**{**loaded.arguments, **values}).element()
    rows, outputs, inputs = [], np.zeros(len(OUTPUTS)), loaded_inputs(loaded)
    for inputs[0], inputs[1] in places:
        assert element.solve_array(inputs, outputs) == "converged"
        rows.append([*outputs, *element.tangent_array([3])[:, 0], element.patch_array()[0, 1]])
        element.accept()
    return rows


def test_a_host_in_c(unit: Path, scene: Path, tmp_path: Path) -> None:
    expected = numbers(scene, PLACES)
    ZipFile(unit).extractall(tmp_path / "a b")
    (library,) = (tmp_path / "a b/binaries/linux64").iterdir()
    program = tmp_path / "host"
    subprocess.run(["cc", "-Wall", str(HERE / "unit_host.c"), "-ldl", "-o", program], check=True, timeout=60)
    guid = (tmp_path / "a b/modelDescription.xml").read_text(encoding="utf-8").split('guid="')[1].split('"')[0]
    environment = {name: value for name, value in os.environ.items() if name != "PYTHONPATH"}
    resources = (tmp_path / "a b/resources").as_uri()
    done = subprocess.run(
        [program, library, guid, resources], capture_output=True, text=True, env=environment, timeout=300, check=False
    )
    assert done.returncode == 0, done.stdout[-500:] + done.stderr
    refused, first, other, second, wild, status, again, new, negative, last = done.stdout.splitlines()
    assert refused == "wrong, status 3: the instantiation token (GUID) is not that of the unit"
    assert wild == "first, status 2: failed: z = 1.0: must be a number from -0.1 to 0.1 m (2 mm is 0.002)"
    assert (status, last) == ("status 2", "status 3")
    assert negative.startswith("again, status 3: Wheelset: left.friction = -1")
    for line, row in zip((first, second), expected, strict=True):
        *values, failed = line.split()
        assert [float.fromhex(value) for value in values] == row
        assert failed == "0"
    assert first == again == new
    *values, _ = other.split()
    assert [float.fromhex(value) for value in values] == numbers(scene, PLACES[:1], left=SLIPPERY)[0]


@pytest.mark.parametrize("fmi", ["2.0", "3.0"])
def test_fmpy_validates_and_drives_the_unit(fmi: str, scene: Path, request: pytest.FixtureRequest) -> None:
    fmpy = pytest.importorskip("fmpy")
    from fmpy.validation import validate_fmu

    unit: Path = request.getfixturevalue("unit" if fmi == "2.0" else "unit3")
    assert validate_fmu(str(unit)) == []
    loaded, outputs = wr.load(scene), np.zeros(len(OUTPUTS))
    assert isinstance(loaded, wr.Wheelset)
    names = [variable.name for variable in OUTPUTS[:12]]
    signal = np.array([(0.0, -2.5e-4), (3e-3, -2.8e-4)], dtype=[("time", float), ("z", float)])
    for kind in ("ModelExchange", "CoSimulation"):
        run = fmpy.simulate_fmu(
            str(unit), fmi_type=kind, stop_time=3e-3, output_interval=1e-3, step_size=1e-3, input=signal, output=names
        )
        assert len(run) == 4
        inputs = loaded_inputs(loaded)
        inputs[1] = -2.5e-4
        loaded.element().solve_array(inputs, outputs)
        assert list(run[0])[1:] == pytest.approx(outputs[:12].tolist(), rel=1e-6)
        assert run["left_Fz"][-1] > run["left_Fz"][0] > 1e4
    description = fmpy.read_model_description(str(unit))
    starts = {variable.name: float(variable.start) for variable in description.modelVariables if variable.start}
    assert starts["speed"] == 45.0
    assert starts["right_friction"] == 0.3
    start = fmpy.simulate_fmu(str(unit), stop_time=1e-3, step_size=1e-3, output=["left_Fz", "right_Fz"])
    assert [start[side][0] for side in ("left_Fz", "right_Fz")] == pytest.approx([57e3, 57e3], rel=1e-4)
    described = [variable.name for variable in description.modelVariables if variable.name != "time"]
    assert described[: len(INPUTS)] == [variable.name for variable in INPUTS]
    assert description.fmiVersion == fmi


def test_the_example_with_fmpy(unit: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """Of the how-to page, as it stands."""
    pytest.importorskip("fmpy")
    page = (HERE.parents[1] / "docs/how-to/export.md").read_text(encoding="utf-8")
    (example,) = re.findall(r"^```python\n([^`]*simulate_fmu.*?)^```", page, flags=re.MULTILINE | re.DOTALL)
    assert len([line for line in example.splitlines() if line and "import" not in line]) <= 6
    monkeypatch.chdir(unit.parent)
    shutil.copy(unit, "contact.fmu")
    names: dict[str, Any] = {}
    exec(compile(example, "export.md", "exec"), names)
    force = names["run"]["left_Fz"]
    assert force[0] == pytest.approx(57e3, rel=1e-4)
    assert force[-1] > 1.15 * force[0]  # Hertz: by 3/2 of the approach, 20 of some 150 um


@pytest.mark.parametrize(("load", "total"), [("axle_load = 120e3", 120e3), ("wheel_load = 57e3", 114e3)])
def test_start_values_carry_the_load(load: str, total: float, tmp_path: Path) -> None:
    """On an element of its own; both wheels carry it, also off the middle of the track."""
    text = (SCENES / "wheelset.toml").read_text(encoding="utf-8").replace("wheel_load = 57e3", load)
    (tmp_path / "scene.toml").write_text(text.replace('model = "condensed"', 'model = "standard"'))
    wheelset = wr.load(tmp_path / "scene.toml")
    assert isinstance(wheelset, wr.Wheelset)
    inputs, outputs = loaded_inputs(wheelset), np.zeros(len(OUTPUTS))
    assert wheelset.element().solve_array(inputs, outputs) == "converged"
    assert float(outputs[2] + outputs[8]) == pytest.approx(total, rel=1e-4)
    assert outputs[2] == pytest.approx(0.5 * total, rel=1e-4)
    assert inputs[0] == -0.002


def test_units_of_fmi_3_live_side_by_side(unit3: Path, scene: Path, tmp_path: Path) -> None:
    """Two in one process: the element's numbers to the last bit, both derivatives; reset, freed and made again."""
    fmpy = pytest.importorskip("fmpy")
    from fmpy.fmi1 import FMICallException
    from fmpy.fmi3 import FMU3Slave

    folder = fmpy.extract(str(unit3), str(tmp_path / "a b"))
    description = fmpy.read_model_description(str(unit3))
    identifier, token = description.coSimulation.modelIdentifier, description.guid
    outputs, forces, patch = [100 + k for k in range(14)], [100 + k for k in range(12)], [301]

    def made(name: str) -> Any:
        slave = FMU3Slave(guid=token, modelIdentifier=identifier, unzipDirectory=folder, instanceName=name)
        slave.instantiate()
        slave.enterInitializationMode()
        return slave

    def row(slave: Any, y: float, z: float) -> list[float]:
        slave.setFloat64([0, 1], [y, z])
        values = [*slave.getFloat64(outputs), *slave.getDirectionalDerivative(forces, [3], [1.0])]
        values += slave.getFloat64(patch)
        slave.doStep(currentCommunicationPoint=0.0, communicationStepSize=1e-3)
        return values

    first, second = made("first"), made("second")
    second.setFloat64([200], [0.1])
    for slave in (first, second):
        slave.exitInitializationMode()
    expected = numbers(scene, PLACES)
    assert row(first, *PLACES[0]) == expected[0]
    assert row(second, *PLACES[0]) == numbers(scene, PLACES[:1], left=SLIPPERY)[0]
    assert row(first, *PLACES[1]) == expected[1]
    seed = np.linspace(1.0, 2.0, len(forces))
    (adjoint,) = first.getAdjointDerivative(forces, [3], seed, nSensitivity=1)
    assert adjoint == pytest.approx(float(seed @ expected[1][14:26]), rel=1e-12)
    first.setFloat64([1], [1.0])
    with pytest.raises(FMICallException) as failure:
        first.getFloat64(outputs)
    assert failure.value.status == 2  # fmi3Discard
    first.reset()
    assert row(first, *PLACES[0]) == expected[0]
    for slave in (first, second):
        slave.terminate()
        slave.fmi3FreeInstance(slave.component)
    again = made("again")
    again.exitInitializationMode()
    assert row(again, *PLACES[0]) == expected[0]
    again.fmi3FreeInstance(again.component)
