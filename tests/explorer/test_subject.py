"""Values of the explorer's page as calls, Python text and scene files: all solve the very same contact."""

from __future__ import annotations

import asyncio
import random
import tomllib
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import wheelrail as wr
from wheelrail.explorer import jobs
from wheelrail.explorer.controls import HERTZ, WHEELSET, Control
from wheelrail.explorer.engine import Latest
from wheelrail.explorer.subject import CHOSEN, CLASSES, Subject
from wheelrail.scenes.contacts.solve import solve_contact
from wheelrail.scenes.schema.scene import RunScene, load_scene

SCENES = Path(wr.__file__).parents[1] / "scenes"
CONTACTS: dict[str, Any] = {
    "wheelset": lambda: wr.Wheelset(friction=0.3, strips=6, cells=8, y=1.2e-3),
    "radii": lambda: wr.Wheelset(model="standard", right={"radius": 0.4595}, wheel_load=5.5e4, roll="solve", y=1e-3),
    "hertz": lambda: wr.Hertz((0.5, float("inf")), load=2e4, strips=6, cells=8, creepage=(1e-3, 0.0, 0.1)),
    "shift": lambda: wr.Hertz(approach=4e-5, shift=(3e-6, 0.0), strips=6, cells=8),
}


def values_of(data: Any) -> dict[str, Any]:
    """Fields and forces of a solution."""
    return {name: data[name].values for name in ("pressure", "traction", "longitudinal_force", "vertical_force")}


def same(first: dict[str, Any], second: dict[str, Any]) -> bool:
    return all(np.array_equal(first[name], second[name], equal_nan=True) for name in first)


def moved(subject: Subject, seed: int) -> dict[str, Any]:
    """Random values of the sliders near the first ones; some are left alone."""
    chance = random.Random(seed)
    values: dict[str, Any] = {}
    for control in subject.controls:
        now = subject.initial[control.name]
        if control.choices is not None or control.text or chance.random() < 0.4 or control.step == 1.0:
            continue
        if control.key.split(".")[0] in ("radius", "right", "load", "approach", "wheel_load", "axle_load", "shift"):
            continue
        value = float(f"{now + chance.choice((-2, -1, 1, 2)) * control.step:.9g}")
        values[control.name] = min(max(value, control.low), control.high)
    return values


@pytest.mark.parametrize("name", CONTACTS)
def test_values_at_first_are_the_contact_itself(name: str) -> None:
    contact = CONTACTS[name]()
    subject = Subject.of(contact)
    calls = subject.calls({})
    assert same(
        values_of(contact.solve().data), values_of(CLASSES[calls.kind](**calls.contact).solve(**calls.solve).data)
    )


@pytest.mark.parametrize("name", CONTACTS)
@pytest.mark.parametrize("seed", [1, 2])
def test_python_text_and_scene_file_give_what_is_seen(name: str, seed: int, tmp_path: Path) -> None:
    subject = Subject.of(CONTACTS[name]())
    calls = subject.calls(moved(subject, seed))
    shown = values_of(CLASSES[calls.kind](**calls.contact).solve(**calls.solve).data)
    space: dict[str, Any] = {}
    exec(subject.python(calls), space)  # as a user pastes it
    assert same(shown, values_of(space["solution"].data))
    file = tmp_path / "seen.toml"
    file.write_text(subject.scene(calls))
    scene = load_scene(file)
    assert not isinstance(scene, RunScene)
    assert same(shown, values_of(solve_contact(scene)))


def test_moved_values_arrive_in_si_units() -> None:
    subject = Subject.of(wr.Wheelset(speed=20.0))
    calls = subject.calls({"at_y": -1.25, "at_pitch_rate": 0.2, "at_right_radius": -0.35, CHOSEN: "axle_load"})
    assert calls.solve["y"] == -1.25e-3
    assert calls.solve["pitch_rate"] == 20.0 / 0.46 + 0.2
    assert calls.contact["right"] == {"radius": 0.46 - 0.35e-3}
    assert calls.solve["axle_load"] == 114e3
    assert "wheel_load" not in calls.solve
    assert (
        subject.calls({"at_right_radius": 0.0, "at_falling_share": 1.0}).contact.keys().isdisjoint({"right", "falling"})
    )


def test_differences_follow_what_they_are_added_to() -> None:
    subject = Subject.of(wr.Wheelset(speed=20.0, pitch_rate=20.0 / 0.46 + 0.1, right={"radius": 0.4595}))
    calls = subject.calls({"at_speed": 40.0, "at_radius": 500.0})
    assert calls.solve["pitch_rate"] == pytest.approx(40.0 / 0.5 + 0.1, rel=1e-12)
    assert calls.contact["right"] == {"radius": pytest.approx(0.4995, rel=1e-12)}
    calls = subject.calls({"at_radius": 0.0})
    with pytest.raises(ValueError, match=r"radius = 0\.0: must be"):
        wr.Wheelset(**calls.contact)


def test_numbers_of_strips_and_cells_are_whole() -> None:
    subject = Subject.of(wr.Wheelset(bodies="half-space"))
    with pytest.raises(ValueError, match=r"strips across = 6\.7: must be a whole number"):
        subject.calls({"at_strips": 6.7})
    for control in subject.controls:
        if control.key in ("strips", "cells"):
            for end in (control.low, control.high):
                wr.Wheelset(**subject.calls({control.name: end}).contact)


def test_scene_of_elastic_bodies_after_the_standard_model(tmp_path: Path) -> None:
    subject = Subject.of(wr.Hertz(load=1e4, model="standard"))
    calls = subject.calls({"at_model": "elastic bodies", "at_strips": 5, "at_cells": 6})
    (tmp_path / "seen.toml").write_text(subject.scene(calls))
    scene = wr.load(tmp_path / "seen.toml")
    assert same(values_of(wr.Hertz(**calls.contact).solve(**calls.solve).data), values_of(scene.solve().data))


def test_geometry_of_sides_that_differ_in_friction_only() -> None:
    same_sides, other = (Subject.of(wr.Wheelset(**more)).calls({}) for more in ({}, {"left": {"friction": 0.2}}))
    assert jobs.geometry(other) == jobs.geometry(same_sides)
    smaller = Subject.of(wr.Wheelset(right={"radius": 0.459, "friction": 0.2})).calls({})
    assert jobs.geometry(smaller) != jobs.geometry(same_sides)


def test_other_rails_have_their_own_inclination() -> None:
    subject = Subject.of(wr.Wheelset())
    assert "laying_angle" not in subject.calls({"at_rail": "UIC60-benchmark"}).contact
    assert subject.calls({"at_laying_angle": "1:20"}).contact["laying_angle"] == 0.05


def test_standard_model_takes_no_elements() -> None:
    subject = Subject.of(wr.Wheelset(strips=8, cells=10, surface_size=1e-3))
    calls = subject.calls({"at_model": "standard (no elements)", "at_error_estimate": "yes"})
    assert wr.Wheelset(**calls.contact).solve(**calls.solve).ok
    assert tomllib.loads(subject.scene(calls)).keys().isdisjoint({"strips", "cells", "surface_size"})


@pytest.mark.parametrize("control", [*WHEELSET, *HERTZ], ids=lambda own: own.key)
def test_values_come_back_exactly(control: Control) -> None:
    if control.choices is not None:
        assert [control.shown(control.argument(text)) for text in control.choices] == list(control.choices)
        return
    for count in range(50):
        shown = float(f"{control.low + count * control.step:.9g}")
        assert float(control.shown(control.argument(shown))) == shown


def test_texts_that_are_no_numbers_are_named() -> None:
    subject = Subject.of(wr.Hertz(load=1e4))
    with pytest.raises(ValueError, match="upper radius in x = 'wide': must be a number"):
        subject.calls({"at_upper_radii_0": "wide"})
    assert subject.calls({"at_upper_radii_0": "straight"}).contact["upper"]["radii"][0] == float("inf")


def test_dropped_profile_is_a_file_in_the_texts() -> None:
    subject, name = Subject.of(wr.Wheelset()).with_profile(wr.profile("S1002"), "worn.prw")
    calls = subject.calls({"at_wheel": name})
    assert "wheel = wr.profile('worn.prw', 'wheel')" in subject.python(calls)
    assert "contact = wr.Wheelset(wheel=wheel)" in subject.python(calls)
    assert tomllib.loads(subject.scene(calls))["profiles"]["wheel"] == "worn.prw"


@pytest.mark.parametrize("file", ['my "worn" wheel.txt', "it's\\ worn\n.txt", "ü.txt", "S1002"])
def test_files_of_any_name_are_themselves_in_the_texts(file: str, tmp_path: Path, monkeypatch: Any) -> None:
    monkeypatch.chdir(tmp_path)
    points = 1e3 * wr.profile("S1002").point(wr.profile("S1002").samples(0.5e-3))
    Path(file).write_text("".join(f"{y - 0.7:.6f} {z:.6f}\n" for y, z in points))
    read = wr.profile(tmp_path / file, "wheel")
    subject, name = Subject.of(wr.Wheelset(model="standard")).with_profile(read, file)
    calls = subject.calls({"at_wheel": name})
    space: dict[str, Any] = {}
    exec(subject.python(calls), space)
    assert space["wheel"].digest() == read.digest()
    Path("seen.toml").write_text(subject.scene(calls))
    expected = wr.Wheelset(read, model="standard").solve().data["lateral_force"].values
    assert wr.load("seen.toml").solve().data["lateral_force"].values.tolist() == expected.tolist()


@pytest.mark.parametrize("scene", ["hertz", "wheelset"])
def test_example_scenes_are_explored_as_they_are(scene: str) -> None:
    contact = wr.load(SCENES / f"{scene}.toml")
    calls = Subject.of(contact).calls({})
    given = {key: value for key, value in contact.arguments.items() if value is not None and key != "laying_angle"}
    assert {**calls.contact, **calls.solve} == given


def test_a_file_of_the_same_name_replaces_the_earlier_one() -> None:
    subject, first = Subject.of(wr.Wheelset(wheel=wr.profile("S1002"))).with_profile(wr.profile("60E1"), "mine.txt")
    subject, wheel = subject.with_profile(wr.profile("S1002"), "mine.txt")
    given = subject.given.keys() - {first, wheel}
    subject, second = subject.with_profile(wr.profile("60E1").inclined(0.01), "mine.txt")
    assert subject.files == {wheel: "mine.txt", second: "mine.txt"}
    assert subject.given.keys() == {*given, wheel, second}


def test_moves_begin_from_the_last_place_and_settle_to_the_same_bits() -> None:
    contact, chance, views = CONTACTS["wheelset"](), random.Random(6), ("pressure", "forces")
    subject, y, jobs.Kept.latest = Subject.of(contact), 1.2, None
    assert jobs.solve(subject.calls({"at_y": y}), views, True)["settled"]
    for _ in range(12):
        y = round(min(max(y + chance.choice((-1.5, -0.4, -0.05, 0.05, 0.3, 1.0)), -6.6), 6.6), 3)
        calls = subject.calls({"at_y": y})
        moved, settled = jobs.solve(calls, views, True), jobs.solve(calls, views)
        exact = contact.solve(**calls.solve).data
        for name, values in settled["values"].items():
            assert values == exact[name].values.tolist()
            assert np.allclose(moved["values"][name], values, rtol=0.0, atol=1e-6 * 57e3)
        assert not moved["settled"]


def test_another_view_of_the_same_contact_is_no_solve() -> None:
    subject, jobs.Kept.latest = Subject.of(CONTACTS["hertz"]()), None
    found = jobs.solve(subject.calls({}), ("pressure",), True)
    solution = jobs.Kept.latest[1]  # type: ignore[unreachable]
    assert jobs.solve(subject.calls({}), ("slip",), True)["values"] == found["values"]
    assert jobs.Kept.latest[1] is solution
    assert jobs.solve(subject.calls({"at_load": 30.0}), ("pressure",), True)["settled"]  # a pair begins anew


@pytest.mark.parametrize("more", [{"roll": "solve"}, {"axle_load": 1e5, "wheel_load": None}, {"z": -1e-4}])
def test_wheels_without_heights_of_their_own_begin_anew(more: dict[str, Any]) -> None:
    contact = wr.Wheelset(model="condensed", bodies="half-space", strips=6, cells=8, **more)
    subject, jobs.Kept.latest = Subject.of(contact), None
    assert all(jobs.solve(subject.calls({"at_y": y}), (), True)["settled"] for y in (0.0, 0.1))


def test_a_request_ends_a_pause() -> None:
    async def asked_after(seconds: float) -> bool:
        async def nothing() -> bool:
            return False

        latest = Latest(nothing, nothing)  # type: ignore[arg-type]
        asyncio.get_running_loop().call_later(seconds, latest.ask)
        return await latest.quiet(0.2)

    assert asyncio.run(asked_after(1.0))
    assert not asyncio.run(asked_after(0.01))
