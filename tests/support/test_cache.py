"""The disk cache: files are complete or absent, and damaged ones are recomputed."""

from __future__ import annotations

import errno
import logging
import os
import re
import subprocess
import sys
import tempfile
import warnings
from collections.abc import Callable
from itertools import count
from pathlib import Path
from threading import Event, Thread
from typing import Any

import numpy as np
import pytest

from wheelrail.contact.elasticity.solid_compliance import SurfaceCompliance, solid_compliance
from wheelrail.contact.elasticity.waveguide.bodies import block_waveguide
from wheelrail.contact.geometry.surface_grid import ContactGrid
from wheelrail.contact.laws.material import Material
from wheelrail.meshes.bodies import solids as bodies
from wheelrail.meshes.bodies.solids import block
from wheelrail.meshes.bodies.triangulation import Grading
from wheelrail.support.cache import cached, digest, load, one_process, store

ROOT = Path(__file__).parents[2]
ARRAYS = {"points": np.linspace(0.0, 1.0, 12).reshape(4, 3), "cells": np.arange(8), "mask": np.array([True, False])}
COARSE = Grading(1.0, 1.0)


@pytest.fixture(autouse=True)
def folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """A separate cache for each test."""
    monkeypatch.setenv("WHEELRAIL_CACHE", str(tmp_path / "cache"))
    return tmp_path / "cache"


def same(found: Any, expected: Any) -> bool:
    return set(found) == set(expected) and all(
        found[name].dtype == expected[name].dtype and np.array_equal(found[name], expected[name]) for name in expected
    )


def test_stored_arrays_are_loaded(folder: Path) -> None:
    assert load("kind/name") is None
    store("kind/name", ARRAYS)
    assert same(load("kind/name"), ARRAYS)
    assert [path.name for path in folder.rglob("*") if path.is_file()] == ["name.npz"]


def test_several_folders(folder: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """Arrays of a later folder are read, and copied to the first, to which new ones go."""
    store("kind/name", ARRAYS)
    first = folder.with_name("first")
    monkeypatch.setenv("WHEELRAIL_CACHE", f"{first}{os.pathsep}{folder}")
    assert same(load("kind/name"), ARRAYS)
    store("kind/other", ARRAYS)
    assert sorted(path.name for path in first.rglob("*.npz")) == ["name.npz", "other.npz"]
    assert [path.name for path in folder.rglob("*.npz")] == ["name.npz"]


def test_key_depends_on_every_part() -> None:
    parts: dict[str, Any] = {"size": 1e-3, "radii": ("inf", 0.3), "rest": np.arange(3.0), "cells": (4, 2)}
    keys = {digest(**parts)}
    for name, other in {"size": 1.0000001e-3, "radii": ("inf", 0.30001), "rest": np.arange(3), "cells": (2, 4)}.items():
        keys.add(digest(**{**parts, name: other}))
    keys.add(digest(**parts, more=None))
    assert len(keys) == 6
    assert digest(**parts) == digest(**dict(reversed(parts.items())))
    with pytest.raises(TypeError, match="cannot hash a set"):
        digest(bad={1})


@pytest.fixture
def breaking(monkeypatch: pytest.MonkeyPatch) -> Callable[[BaseException], None]:
    """Interrupts writing after a few bytes by an exception."""

    def arm(error: BaseException) -> None:
        def half(file: Any, values: Any, **options: Any) -> None:
            file.write(b"PK\x03\x04 half a file")
            raise error

        monkeypatch.setattr(np, "save", half)

    return arm


@pytest.mark.parametrize("before", [None, ARRAYS])
def test_half_written_files_are_never_read(before: Any, breaking: Callable[[BaseException], None]) -> None:
    if before is not None:
        store("kind/name", before)
    breaking(KeyboardInterrupt())
    with pytest.raises(KeyboardInterrupt):
        store("kind/name", {"points": np.zeros(3)})
    found = load("kind/name")
    assert found is None if before is None else same(found, before)  # the previous file is unchanged


def test_full_disk_warns_and_leaves_no_file(folder: Path, breaking: Callable[[BaseException], None]) -> None:
    breaking(OSError(errno.ENOSPC, "No space left on device"))
    with pytest.warns(UserWarning, match="cannot be written"):
        store("kind/name", ARRAYS)
    assert not [path for path in folder.rglob("*") if path.is_file()]


def test_cache_that_cannot_be_written_only_warns(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    blocked = tmp_path / "file"
    blocked.write_text("not a folder")
    monkeypatch.setenv("WHEELRAIL_CACHE", str(blocked / "cache"))
    with pytest.warns(UserWarning, match="cannot be written"):
        assert same(cached("kind/name", lambda: ARRAYS, list(ARRAYS)), ARRAYS)


def test_read_only_cache_is_used_with_a_warning(folder: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    store("kind/old", ARRAYS)

    def denied(**options: Any) -> None:  # chmod would not stop root
        raise PermissionError(errno.EACCES, "Permission denied")

    monkeypatch.setattr(tempfile, "mkstemp", denied)
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        assert same(cached("kind/old", lambda: pytest.fail("built again"), list(ARRAYS)), ARRAYS)
    with pytest.warns(UserWarning, match="cannot be written"):
        assert same(cached("kind/new", lambda: ARRAYS, list(ARRAYS)), ARRAYS)


def test_truncated_file_is_rebuilt(folder: Path) -> None:
    store("kind/name", ARRAYS)
    path = folder / "kind" / "name.npz"
    whole = path.read_bytes()
    for length in range(0, len(whole), 7):
        path.write_bytes(whole[:length])
        assert load("kind/name") is None
    assert same(cached("kind/name", lambda: ARRAYS, list(ARRAYS)), ARRAYS)
    assert path.read_bytes()[:2] == b"PK"
    assert same(load("kind/name"), ARRAYS)


def test_any_flipped_bit_is_detected_or_harmless(folder: Path) -> None:
    """Two bits of every byte, in turns."""
    store("kind/name", ARRAYS)
    path = folder / "kind" / "name.npz"
    whole = path.read_bytes()
    noticed = 0
    for place in range(len(whole)):
        for bit in (place % 4, 4 + place % 4):
            path.write_bytes(whole[:place] + bytes([whole[place] ^ 1 << bit]) + whole[place + 1 :])
            found = load("kind/name")
            if found is None or not set(ARRAYS) <= set(found):  # the latter is rebuilt by `cached`
                noticed += 1
            else:
                assert same(found, ARRAYS), f"bit {bit} of byte {place}"
    assert noticed > len(whole)  # other bytes are dates and padding


def test_wrong_arrays_are_rebuilt(folder: Path) -> None:
    store("kind/name", {"points": ARRAYS["points"]})
    assert same(cached("kind/name", lambda: ARRAYS, list(ARRAYS)), ARRAYS)
    assert same(load("kind/name"), ARRAYS)


def test_a_valid_file_with_other_content_is_rebuilt(folder: Path) -> None:
    path = folder / "kind" / "name.npz"
    store("kind/other", ARRAYS)
    others: list[Callable[[], Any]] = [
        lambda: np.savez(path, **{**ARRAYS, "points": 1.2 * ARRAYS["points"]}),
        lambda: np.savez(path, **ARRAYS),  # without a digest
        lambda: path.write_bytes((folder / "kind" / "other.npz").read_bytes()),  # of another name
    ]
    for write in others:
        write()
        assert load("kind/name") is None
        assert same(cached("kind/name", lambda: ARRAYS, list(ARRAYS)), ARRAYS)
        assert same(load("kind/name"), ARRAYS)


@pytest.mark.parametrize(
    "values", [np.array(2.5), np.zeros((0, 3)), np.asfortranarray(np.ones((2, 3))), np.array(["a"])]
)
def test_every_array_is_read_again(values: np.ndarray[Any, Any]) -> None:
    store("kind/name", {"values": values})
    assert same(load("kind/name"), {"values": values})


@pytest.mark.parametrize("damage", ["truncate", "flip", "empty", "other", "pickle"])
def test_damaged_mesh_is_regenerated(folder: Path, damage: str) -> None:
    solid, key = block((2, 2), half_width=4.0, grading=COARSE)
    path = folder / "mesh" / f"{key}.npz"
    whole = path.read_bytes()
    if damage == "truncate":
        path.write_bytes(whole[: len(whole) // 2])
    elif damage == "flip":
        path.write_bytes(whole[:2000] + bytes([whole[2000] ^ 16]) + whole[2001:])
    elif damage == "empty":
        path.write_bytes(b"")
    elif damage == "other":
        store(f"mesh/{key}", {"points": solid.points})
    else:
        np.savez(path, **{name: np.array([{}], dtype=object) for name in vars(solid)})
    again, _ = block((2, 2), half_width=4.0, grading=COARSE)
    for name, value in vars(solid).items():
        np.testing.assert_array_equal(getattr(again, name), value)
    assert same(load(f"mesh/{key}"), vars(solid))


def test_cached_mesh_is_not_regenerated(monkeypatch: pytest.MonkeyPatch) -> None:
    first, key = block((2, 2), half_width=4.0, grading=COARSE)
    monkeypatch.setattr(bodies, "triangulate", lambda *args, **options: pytest.fail("meshed again"))
    second, same_key = block((2, 2), half_width=4.0, grading=COARSE)
    assert key == same_key
    np.testing.assert_array_equal(first.points, second.points)
    with pytest.raises(pytest.fail.Exception):
        block((2, 2), half_width=4.5, grading=COARSE)


def test_long_computations_log_memory_and_remaining_time(
    folder: Path, monkeypatch: pytest.MonkeyPatch, caplog: pytest.LogCaptureFixture
) -> None:
    solid, key = block((2, 2), half_width=4.0, grading=COARSE)
    found = solid_compliance(solid, key, Material(), 1)
    clock = count(0, 10)  # s, ten for each group of nodes
    monkeypatch.setattr("wheelrail.support.terminal.monotonic", lambda: float(next(clock)))
    with caplog.at_level(logging.INFO, "wheelrail"):
        found.block(np.arange(found.shape[0] * found.shape[1]), (2,))
    heard = [record.getMessage() for record in caplog.records]
    assert [record.name for record in caplog.records] == ["wheelrail.contact.elasticity.solid_body"] + [
        "wheelrail.contact.elasticity.solid_compliance"
    ] * (len(heard) - 1)
    groups = found.shape[1]
    assert heard[0].startswith(f"stiffness of a solid: {3 * len(solid.points)} unknowns, about ")
    assert heard[0].endswith("GB of memory, 0.0 s")
    assert [text.split(": ")[1] for text in heard[1:]] == [
        f"{done} of {groups}, {10 * (groups - done)} s left" for done in range(2, groups + 1)
    ]
    assert len(heard) == groups


def test_sampling_a_spectrum_logs_the_remaining_time(
    folder: Path, monkeypatch: pytest.MonkeyPatch, caplog: pytest.LogCaptureFixture
) -> None:
    clock = count(0, 10)  # s, ten for each wavenumber
    monkeypatch.setattr("wheelrail.support.terminal.monotonic", lambda: float(next(clock)))
    body, _ = block_waveguide((2, 2), Material(), size=1.0, half_width=50.0)
    with caplog.at_level(logging.INFO, "wheelrail"):
        body.block(np.arange(4))
    first, *heard = [record.getMessage() for record in caplog.records]
    assert re.fullmatch(r"compliance of a prismatic body by wavenumbers: \d+ unknowns in its section", first)
    numbers = [re.search(r": (\d+) of (\d+), (\d+) s left$", text) for text in heard]
    figures = [tuple(int(group) for group in found.groups()) for found in numbers if found]
    assert [done for done, _, _ in figures] == list(range(2, len(heard) + 2))
    assert all(left == 10 * (total - done) for done, total, left in figures)
    assert figures[-1][0] == figures[-1][1] > figures[0][1]  # refined meanwhile
    caplog.clear()
    block_waveguide((2, 2), Material(), size=1.0, half_width=50.0)[0].block(np.arange(4))  # from the cache
    assert not caplog.records


def test_damaged_compliance_is_solved_again(folder: Path) -> None:
    from wheelrail.contact.elasticity.solid_body import ElasticBody

    solid, key = block((2, 2), half_width=4.0, grading=COARSE)
    shape = ContactGrid.on(solid, 1).shape
    body = ElasticBody(solid, Material())
    nodes = np.arange(shape[0] * shape[1])

    def fresh() -> SurfaceCompliance:
        return SurfaceCompliance(key, shape, lambda: body)

    first = fresh()
    expected = first.block(nodes)
    assert first.columns_solved == 3 * len(nodes)
    second = SurfaceCompliance(key, shape, lambda: pytest.fail("no body is needed"))
    np.testing.assert_array_equal(second.block(nodes), expected)
    assert second.columns_solved == 0
    files = sorted((folder / "compliance" / key).glob("*.npz"))
    assert len(files) == 3 * shape[1]  # the strip is so short that a file holds one line of nodes
    whole = files[0].read_bytes()
    files[0].write_bytes(whole[: len(whole) // 2])
    files[4].write_bytes(whole[:-30])
    store(f"compliance/{key}/{files[7].stem}", {"columns": np.zeros((2, 2))})
    store(f"compliance/{key}/{files[9].stem}", {"rows": np.zeros((2, 2))})
    third = fresh()
    np.testing.assert_allclose(third.block(nodes), expected, rtol=1e-12)
    assert third.columns_solved == 4 * shape[0]
    fourth = fresh()
    np.testing.assert_array_equal(fourth.block(nodes), third.block(nodes))
    assert fourth.columns_solved == 0


MESHES = """
import sys
from wheelrail.meshes.bodies.solids import block
from wheelrail.meshes.bodies.triangulation import Grading
sys.stdin.readline()
for cells in (2, 3, 4):
    solid, key = block((cells, 2), half_width=6.0, grading=Grading(1.0, 0.6))
    print(key, solid.points.shape, round(solid.volume(), 9))
"""
WRITER = """
import sys
import numpy as np
from wheelrail.support.cache import load, store
sys.stdin.readline()
number = int(sys.argv[1])
for k in range(150):
    value = 1000 * number + k
    store("shared/name", {"values": np.full(5000 + value % 97, value), "value": np.array(value)})
    found = load("shared/name")
    assert found is not None, "a reader met half a file"
    assert (found["values"] == found["value"]).all() and len(found["values"]) == 5000 + int(found["value"]) % 97
"""

BUILDER = """
import sys, time
import numpy as np
from wheelrail.support.cache import cached

def build():
    time.sleep(0.5)
    print("built")
    return {"values": np.arange(3)}

sys.stdin.readline()
assert list(cached("shared/slow", build, ("values",))["values"]) == [0, 1, 2]
"""


def together(script: str) -> list[str]:
    """What two processes print that start the script at the same time."""
    running = [
        subprocess.Popen(
            [sys.executable, "-c", script, str(number)],
            stdin=subprocess.PIPE,
            stdout=subprocess.PIPE,
            stderr=subprocess.PIPE,
            cwd=ROOT,
            env=dict(os.environ),
            text=True,
        )
        for number in (1, 2)
    ]
    for process in running:
        assert process.stdin is not None
        process.stdin.write("go\n")
        process.stdin.flush()
    ended = [process.communicate(timeout=120) for process in running]
    assert [process.returncode for process in running] == [0, 0], ended
    return [out for out, _ in ended]


@pytest.mark.parametrize("script", [MESHES, WRITER], ids=["meshes", "arrays"])
def test_two_processes_share_a_cache(folder: Path, script: str) -> None:
    first, second = together(script)
    assert first == second
    files = [path for path in folder.rglob("*") if path.is_file()]
    assert files
    assert all(path.suffix == ".npz" and not path.name.startswith(".part-") for path in files)


def test_one_process_builds_what_two_need(folder: Path) -> None:
    assert sorted(together(BUILDER)) == ["", "built\n"]
    assert [path.name for path in folder.rglob("*") if path.is_file()] == ["slow.npz"]


def test_one_process_of_three_at_a_time(folder: Path) -> None:
    """Also with one that has waited for a file which is gone."""
    entered, left, last = Event(), Event(), Event()

    def second() -> None:
        with one_process("x"):
            entered.set()
            left.wait(60.0)

    def third() -> None:
        with one_process("x"):
            last.set()

    threads = [Thread(target=second), Thread(target=third)]
    with one_process("x"):
        threads[0].start()
        assert not entered.wait(0.3)
    assert entered.wait(60.0)
    threads[1].start()
    assert not last.wait(0.3)
    left.set()
    assert last.wait(60.0)
    for thread in threads:
        thread.join()
    assert not list(folder.iterdir())
