"""The library without Python: numbers of the element to the last bit, errors as text, damaged files, threads."""

from __future__ import annotations

import ctypes
import shutil
import subprocess
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

import numpy as np
import pytest
from typer.testing import CliRunner

import wheelrail as wr
from wheelrail.api.elements.variables import FORCES, INPUTS, OUTPUTS, PATCH
from wheelrail.api.elements.wheelset_arrays import state_of
from wheelrail.bindings._contact import sphere_approach
from wheelrail.cli.main import app
from wheelrail.contact.kinematics.frames import SIDES
from wheelrail.contact.loading.wheelset import axle_under_load, wheel_under_load
from wheelrail.contact.models.wheelset import WheelsetContact
from wheelrail.export.host import loaded_inputs
from wheelrail.scenes.builders.wheelset import wheel_sphere
from wheelrail.support.arrays import Array

HERE = Path(__file__).parent
SCENE = HERE.parents[1] / "scenes/wheelset.toml"
STRIPS = "strips = 6\ncells = 8\n"
LEFT = "left = { friction = 0.1 }\n"  # of the profiles
STRIBECK = '{ law = "stribeck", static = 0.3, kinetic = 0.2, speed = 1.0 }'
KINDS = {  # values of the scene, and of its profiles
    "standard": ('model = "standard"\n', LEFT),
    "polach": ('model = "standard"\ntangential = "polach"\n', ""),
    "half-space": (f'bodies = "half-space"\n{STRIPS}', LEFT),
    "law": (f'bodies = "half-space"\n{STRIPS}', f"left = {{ friction = {STRIBECK} }}\n"),
    "waveguide": (STRIPS, ""),
}
DIFFERENT = ("standard", "half-space", "waveguide")  # with a tangent, in one test each


def numbers(values: Array) -> ctypes.c_void_p:
    return ctypes.c_void_p(values.ctypes.data)


class Native:
    """An element of an exported library.

    Parameters:
        folder: of the library.
        options: JSON object.
    """

    def __init__(self, folder: Path, options: str = "") -> None:
        self.library = ctypes.CDLL(str(folder / "libwheelrail.so"))
        self.number = self.library.wheelrail_open(options.encode(), None)
        if not self.number:
            raise ValueError(self.error())

    def close(self) -> None:
        assert self.library.wheelrail_close(self.number) == 0

    def error(self) -> str:
        text = ctypes.create_string_buffer(500)
        self.library.wheelrail_error(getattr(self, "number", 0), text, len(text))
        return text.value.decode()

    def start(self) -> Array:
        inputs = np.zeros(len(INPUTS))
        assert self.library.wheelrail_start(self.number, numbers(inputs)) == 0
        return inputs

    def solve(self, inputs: Array) -> tuple[str, Array]:
        """Text of a failure, and outputs."""
        outputs = np.zeros(len(OUTPUTS))
        failed = self.library.wheelrail_solve(self.number, numbers(inputs), numbers(outputs))
        return (self.error() if failed else ""), outputs

    def load(self, wheels: int, load: float, inputs: Array) -> tuple[str, Array, Array]:
        """Text of a failure, inputs under a load and outputs."""
        inputs, outputs = inputs.copy(), np.zeros(len(OUTPUTS))
        force = ctypes.c_double(load)
        failed = self.library.wheelrail_load(self.number, wheels, force, numbers(inputs), numbers(outputs))
        return (self.error() if failed else ""), inputs, outputs

    def accept(self) -> None:
        assert self.library.wheelrail_accept(self.number) == 0

    def tangent(self) -> Array:
        columns = np.zeros((len(INPUTS), len(FORCES)))
        for number, column in enumerate(columns):
            assert self.library.wheelrail_tangent(self.number, number, numbers(column)) == 0, self.error()
        return columns.T

    def patches(self) -> Array:
        values = np.zeros((2, len(PATCH)))
        assert self.library.wheelrail_patches(self.number, numbers(values)) == 0
        return values


@pytest.fixture(scope="module")
def folders(tmp_path_factory: pytest.TempPathFactory) -> dict[str, Path]:
    """Exported folders by kind, as far as they were asked for."""
    return {"": tmp_path_factory.mktemp("exported")}


def exported(folders: dict[str, Path], kind: str) -> tuple[Path, wr.Wheelset]:
    """Folder of the library, and the wheelset."""
    place = folders[""] / kind
    scene = place / "scene.toml"
    if kind not in folders:
        place.mkdir()
        text = SCENE.read_text(encoding="utf-8").replace('model = "condensed"', "#")
        values, profiles = KINDS[kind]
        scene.write_text(values + text.replace("[profiles]\n", f"[profiles]\n{profiles}"), encoding="utf-8")
        done = CliRunner().invoke(app, ["export", str(scene), "--c", str(place / "made")])
        assert done.exit_code == 0, done.stderr
        folders[kind] = place / "made"
    loaded = wr.load(scene)
    assert isinstance(loaded, wr.Wheelset)
    return folders[kind], loaded


def drawn(start: Array, count: int, seed: int) -> Array:
    """States (count, 17), most of them loaded, some separated, some too deep."""
    rng = np.random.default_rng(seed)
    states = np.tile(start, (count, 1))
    states[:, 0] += rng.uniform(-1e-3, 1e-3, count)
    states[:, 1] += rng.uniform(-3e-5, 3e-5, count)
    states[:, 2:4] += rng.normal(0.0, 3e-4, (count, 2))
    states[:, 4:9] *= rng.uniform(0.99, 1.01, (count, 5))
    states[:, 4:8] += rng.normal(0.0, 0.02, (count, 4))
    states[:, 10:13] += rng.normal(0.0, 5e-3, (count, 3))
    states[:, 13:] += rng.normal(0.0, 1e-5, (count, 4))
    states[::9, 1] -= 2e-2
    states[4::9, 1] += 1e-3
    return states


@pytest.mark.parametrize("kind", KINDS)
def test_forces_have_the_bits_of_the_element(kind: str, folders: dict[str, Path]) -> None:
    folder, wheelset = exported(folders, kind)
    native, element, expected = Native(folder), wheelset.element(), np.zeros(len(OUTPUTS))
    start = native.start()
    np.testing.assert_array_equal(start, loaded_inputs(wheelset))
    solved = failed = 0
    for i, state in enumerate(drawn(start, 9, 1)):
        status = element.solve_array(state, expected)
        failure, outputs = native.solve(state)
        np.testing.assert_array_equal(outputs, expected)
        if status.startswith("failed"):
            assert failure == status
            failed += 1
            continue
        assert not failure
        solved += 1
        if i % 3 == 1:
            np.testing.assert_array_equal(native.patches(), element.patch_array())
        if i == 2 and kind in DIFFERENT:
            np.testing.assert_array_equal(native.tangent(), element.tangent_array())
        if i % 3 == 0:
            native.accept()
            element.accept()
    assert solved > 5
    assert failed == 1


@pytest.mark.parametrize("kind", KINDS)
def test_loads_have_the_bits_of_python(kind: str, folders: dict[str, Path]) -> None:
    folder, wheelset = exported(folders, kind)
    native, contact = Native(folder), wheelset.element().contact
    assert isinstance(contact, WheelsetContact)
    start = native.start()
    level, arguments = start.copy(), wheelset.arguments
    level[1:3] = 0.0
    failure, inputs, outputs = native.load(3, arguments["wheel_load"], level)  # each wheel, as that of the scene
    assert not failure
    np.testing.assert_array_equal(inputs, start)
    assert outputs[[2, 8]] == pytest.approx(arguments["wheel_load"], rel=1e-6)
    sphere = wheel_sphere(arguments["E"], arguments["nu"])
    for wheels, sides in enumerate((("left",), ("right",), SIDES)):
        load, expected = 40e3 * len(sides), sphere_approach(40e3, *sphere)
        failure, inputs, outputs = native.load(wheels, load, level)
        assert not failure
        if wheels < 2:
            found = wheel_under_load(contact, state_of(level.tolist()), sides[0], load, expected=expected)
        else:
            found = axle_under_load(contact, state_of(level.tolist()), load, expected=expected)
        assert inputs[1] == found.state.z
        for side in sides:
            first = 6 * SIDES.index(side)
            own = found.results[side]
            np.testing.assert_array_equal(outputs[first : first + 6], [*own.force, *own.moment])
        native.accept()  # it is the last solved state


def test_loads_that_cannot_be_carried_are_named(folders: dict[str, Path]) -> None:
    native = Native(exported(folders, "half-space")[0])
    start = native.start()
    still = start.copy()
    still[8:10] = 0.0  # spin and speed
    failures = [native.load(4, 57e3, start), native.load(0, np.nan, start), native.load(0, 57e3, still)]
    assert [failure.partition(":")[0] for failure, _, _ in failures] == ["load", "load = nan", "left wheel"]
    assert all(np.isnan(outputs).all() for _, _, outputs in failures)
    assert native.library.wheelrail_accept(native.number) == 1  # nothing was solved


def test_states_are_stored(folders: dict[str, Path]) -> None:
    folder, _ = exported(folders, "half-space")
    native = Native(folder)
    start = native.start()
    moved = start + np.array([1e-3, -2e-5, *[0.0] * 15])
    native.solve(start)
    native.accept()
    assert native.library.wheelrail_save(native.number, 7) == 0
    after = native.solve(moved)[1]
    native.accept()
    again = native.solve(moved)[1]
    assert native.library.wheelrail_restore(native.number, 7) == 0
    assert native.library.wheelrail_accept(native.number) == 1  # nothing was solved since
    np.testing.assert_array_equal(native.solve(moved)[1], after)
    assert not np.array_equal(again, after)  # of other starts
    assert native.library.wheelrail_restore(native.number, 8) == 1
    assert native.error() == "restore: no state has been saved at 8"


def test_threads_solve_at_the_same_time(folders: dict[str, Path]) -> None:
    """Each with an element, from a file whose tables all share."""
    folder, _ = exported(folders, "half-space")

    def solved(seed: int) -> Array:
        native = Native(folder)
        return np.array([native.solve(state)[1] for state in drawn(native.start(), 5, seed)])

    with ThreadPoolExecutor(4) as pool:
        together = list(pool.map(solved, (1, 2, 1, 2)))
    np.testing.assert_array_equal(together[0], together[2])
    np.testing.assert_array_equal(together[1], solved(2))


def test_friction_can_be_set(folders: dict[str, Path]) -> None:
    folder, wheelset = exported(folders, "half-space")
    native = Native(folder, '{"friction": 0.2, "left_friction": 0.0}')
    other = wr.Wheelset(**{**wheelset.arguments, "friction": 0.2, "left": {"friction": 0.0}})
    expected = np.zeros(len(OUTPUTS))
    other.element().solve_array(native.start(), expected)
    np.testing.assert_array_equal(native.solve(native.start())[1], expected)
    with pytest.raises(ValueError, match="has a law of friction, which remains"):
        Native(exported(folders, "law")[0], '{"left_friction": 0.2}')


@pytest.mark.skipif(shutil.which("cc") is None, reason="no C compiler")
@pytest.mark.parametrize("kind", ["standard", "waveguide"])
def test_a_host_in_c(kind: str, folders: dict[str, Path], tmp_path: Path) -> None:
    """Moved, without any environment, with two elements in threads."""
    made, wheelset = exported(folders, kind)
    folder = tmp_path / "moved"
    shutil.copytree(made, folder)
    link = ["-L.", "-lwheelrail", "-Wl,-rpath,$ORIGIN", "-lm", "-lpthread", "-o", "host"]
    subprocess.run(["cc", "-Wall", "-I.", str(HERE / "host.c"), *link], cwd=folder, check=True, timeout=60)
    first, second, *errors = output(folder / "host", "{}", "{}")
    expected: list[float] = []
    element, outputs, inputs = wheelset.element(), np.zeros(len(OUTPUTS)), loaded_inputs(wheelset)
    for inputs[0], inputs[1] in ((-1e-3, -2.8e-4), (-1.2e-3, -2.7e-4), (-1.4e-3, -2.6e-4)):  # of host.c
        assert element.solve_array(inputs, outputs) == "converged"
        expected += [*outputs, *element.tangent_array([3])[:, 0], *element.patch_array().ravel()]
        element.accept()
    assert [float.fromhex(text) for text in first.split()] == expected
    assert second == first
    assert errors[0] == "failed: z = nan: must be a number from -0.1 to 0.1 m (2 mm is 0.002)"[:59]
    assert errors[3] == "failed: y = 1e+300: must be a number from -0.1 to 0.1 m (2 mm is 0.002)"[:59]
    assert errors[4:] == [
        "1.14000e+05",
        "Wheelset: friction = -1: must be a number from 0 to 2 (0 skips the tangential problem)",
        "options: must be a JSON object of texts and numbers, wrong at: ",
        f"{folder}/none.toml: cannot be read: No such file or directory",
        "3 11 -1",
        "element 3: not open",
    ]


def output(program: Path, *arguments: str) -> list[str]:
    """What a program prints without environment."""
    done = subprocess.run([program, *arguments], capture_output=True, text=True, timeout=60, env={}, check=False)
    assert done.returncode == 0, done.stdout[-500:] + done.stderr
    return done.stdout.splitlines()


@pytest.mark.skipif(shutil.which("ldd") is None, reason="no ldd")
def test_the_library_needs_the_c_library_only(folders: dict[str, Path]) -> None:
    folder, _ = exported(folders, "standard")
    done = subprocess.run(["ldd", folder / "libwheelrail.so"], capture_output=True, text=True, check=True)
    names = {line.split()[0].rpartition("/")[2].partition(".so")[0] for line in done.stdout.splitlines()}
    assert names <= {"linux-vdso", "libm", "libc", "ld-linux-x86-64"}


@pytest.mark.parametrize("kind", ["standard", "half-space"])
def test_damaged_files_are_refused(kind: str, folders: dict[str, Path], tmp_path: Path) -> None:
    folder, rng = tmp_path / "copy", np.random.default_rng(1)
    shutil.copytree(exported(folders, kind)[0], folder)
    for file in (folder / "contact.wheelset", *folder.glob("law-*.so")):
        whole = file.read_bytes()
        Native(folder).close()  # files that are open are not read again
        for _ in range(20):
            damaged = bytearray(whole)
            damaged[int(rng.integers(len(whole)))] ^= 1 << int(rng.integers(8))
            for content in (bytes(damaged), whole[: int(rng.integers(len(whole)))]):
                file.unlink()  # what is loaded stays as it is
                file.write_bytes(content)
                with pytest.raises(ValueError, match=f"{file}: is "):
                    Native(folder)
        file.write_bytes(whole)
