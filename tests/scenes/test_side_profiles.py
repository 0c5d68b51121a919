"""Profiles, radius and friction of the left and the right side of scenes, runs and wheelsets."""

from __future__ import annotations

import logging
from dataclasses import replace
from pathlib import Path
from types import SimpleNamespace

import numpy as np
import pytest
from spring_contact import SpringContact

import wheelrail as wr
from wheelrail.contact.kinematics.wheelset_state import Mounting, WheelsetState
from wheelrail.contact.models.wheelset import WheelsetContact
from wheelrail.contact.solvers.tangent import ContactTangent
from wheelrail.meshes.profiles.named import named_profile
from wheelrail.scenes.builders.wheelset import side_profiles, wheelset_contact
from wheelrail.scenes.schema.errors import SceneError
from wheelrail.scenes.schema.profiles import Side
from wheelrail.scenes.schema.scene import RunScene, WheelsetScene, parse_scene
from wheelrail.scenes.views.view import bodies_of_scene

ROOT = Path(__file__).parents[2]
WHEELSET, CURVE = ((ROOT / "scenes" / f"{name}.toml").read_text(encoding="utf-8") for name in ("wheelset", "curve"))
STANDARD = WHEELSET.replace('model = "condensed"', 'model = "standard"')
LOADED = {"model": "standard", "friction": 0.3}


def columns(points: np.ndarray) -> str:
    return "\n".join(f"{1e3 * y:.6f} {1e3 * z:.6f}" for y, z in points)


def wheel_points(noise: float = 0.0, depth: float = 0.0) -> np.ndarray:
    """Points (n, 2) m of a wheel, 0.2 mm apart, with a hollow of a depth m and noise m."""
    wheel = named_profile("S1002")
    s = np.arange(wheel.s_range[0] + 5e-4, wheel.s_at_y(58e-3), 2e-4)
    points = wheel.point(s)
    points[:, 1] -= depth * np.exp(-((points[:, 0] / 0.03) ** 2))
    return points + noise * np.random.default_rng(2).standard_normal(points.shape)


def scene_with(table: str, text: str = STANDARD, folder: Path = ROOT) -> WheelsetScene:
    scene = parse_scene(f"{text}\n{table}", folder / "scene.toml")
    assert isinstance(scene, WheelsetScene)
    return scene


@pytest.mark.parametrize("back", [1.360, 1.300])
def test_flanges_wider_than_the_gauge_are_refused(back: float) -> None:
    """S1002 is 32.5 mm thick at 10 mm above the rolling circle: 5 mm of play at 1435 mm are 10 mm of the gauge."""
    text = STANDARD.replace("flange_back_distance = 1.360", f"flange_back_distance = {back}")
    wide, narrow = (text.replace("gauge = 1.435", f"gauge = {back + width:.4f}") for width in (0.0656, 0.0644))
    side_profiles(scene_with("", wide))
    with pytest.raises(
        SceneError, match=rf"track\.gauge = {back + 0.0644:g}: must be at least {back + 0.065:.3f}"
    ) as no:
        side_profiles(scene_with("", narrow))
    assert str(no.value).endswith("m, the width of the wheelset over its flanges")


def test_alike_sides_share_one_model() -> None:
    for table in ("", "[profiles.left]", '[profiles.right]\nradius = 0.46\nfriction = 0.3\nwheel = "S1002"'):
        scene = scene_with(table)
        assert scene.sides_alike
        contact = wheelset_contact(scene)
        assert contact.right is None
        assert contact.of("right") is contact


def test_sides_differ(tmp_path: Path) -> None:
    (tmp_path / "hollow.txt").write_text(columns(wheel_points(depth=1e-3)))
    table = '[profiles.right]\nwheel = "hollow.txt"\nradius = 0.458\nfriction = 0.1\n'
    scene = scene_with(table, folder=tmp_path)
    assert not scene.sides_alike
    left, right = (scene.side(side) for side in ("left", "right"))
    assert (left.wheel, left.radius, left.friction) == ("S1002", 0.46, 0.3)
    assert (right.wheel, right.radius, right.friction) == (str(tmp_path / "hollow.txt"), 0.458, 0.1)
    assert right.rail == left.rail == "UIC60-benchmark"
    pairs = side_profiles(scene)
    assert pairs["right"][0].name == "hollow"
    assert pairs["left"][0] is named_profile("S1002")
    contact = wheelset_contact(scene)
    assert contact.right is not None
    assert contact.mounting.radius == contact.right.mounting.radius == 0.46  # nominal height of the centre


def test_one_side_is_as_a_wheelset_with_that_side_on_both(tmp_path: Path) -> None:
    """Bit by bit, forces, patches and heights; and the mirror image exchanges the sides."""
    (tmp_path / "hollow.txt").write_text(columns(wheel_points(depth=1e-3)))
    worn = {"wheel": str(tmp_path / "hollow.txt"), "radius": 0.459, "friction": 0.2}
    load = {"wheel_load": 57e3, "y": 2e-3, "yaw": 1e-3}
    mixed = wr.Wheelset(right=worn, **LOADED).solve(**load)
    new = wr.Wheelset(**LOADED).solve(**load)
    old = wr.Wheelset(model="standard", **{**worn, "radius": 0.459}).solve(**load, pitch_rate=10.0 / 0.46)
    for name in ("patch_force", "patch_max_pressure", "wheel_s"):
        np.testing.assert_array_equal(*(data.data[name].sel(side="left") for data in (mixed, new)))
    for name in ("patch_force", "patch_max_pressure", "wheel_s"):
        values = [data.data[name].sel(side="right").values for data in (mixed, old)]
        np.testing.assert_allclose(*values, rtol=1e-6)
    # the centre is at the nominal height of the scene's radius: a smaller wheel is lower by the difference
    assert float(old.data.z.sel(side="right") - mixed.data.z.sel(side="right")) == pytest.approx(1e-3, abs=1e-7)
    mirrored = wr.Wheelset(left=worn, **LOADED).solve(**{**load, "y": -2e-3, "yaw": -1e-3})
    assert float(mirrored.data.z.sel(side="left")) == float(mixed.data.z.sel(side="right"))
    np.testing.assert_array_equal(
        mirrored.data.patch_force.sel(side="left"), mixed.data.patch_force.sel(side="right") * (1.0, -1.0, 1.0)
    )
    assert mixed.data.attrs["friction_right"] == 0.2
    assert mixed.data.attrs["radius_right"] == 0.459
    assert mixed.data["wheel_profile"].dims == ("side", "wheel_point", "plane")
    assert new.data["wheel_profile"].dims == ("wheel_point", "plane")
    for side in ("left", "right"):
        (ax,) = mixed.plot.profiles(side).figure.axes
        assert [line.get_label() for line in ax.lines[:2]] == ["rail", "wheel"]
        assert np.isfinite(ax.lines[1].get_xydata()).all()


@pytest.mark.parametrize("side", ["left", "right"])
def test_model_mounting_and_tangent_are_those_of_the_side(side: Side) -> None:
    spring, other = SpringContact(touch=0.46, stiffness=1e8), SpringContact(touch=0.461, stiffness=3e8)
    left, right = (
        WheelsetContact(spring, Mounting(0.75, 0.76, 0.46)),
        WheelsetContact(other, Mounting(0.74, 0.77, 0.46)),
    )
    contact, alone = replace(left, right=right), {"left": left, "right": right}[side]
    state = WheelsetState(y=1e-3, z=-4e-4, roll=1e-4, yaw=2e-3)
    result = contact(state, side)
    np.testing.assert_array_equal(result.force, alone(state, side).force)
    assert len(spring.poses) == (2 if side == "left" else 0)
    tangent = SimpleNamespace(matrix=np.random.default_rng(0).standard_normal((6, 12)))
    result = replace(result, force_tangent=ContactTangent(tangent))
    np.testing.assert_array_equal(contact.tangent(state, side, result), alone.tangent(state, side, result))


def test_noise_is_reported_and_rough_files_are_refused(tmp_path: Path, caplog: pytest.LogCaptureFixture) -> None:
    (tmp_path / "noisy.txt").write_text(columns(wheel_points(noise=5e-6)))
    measured_wheel = STANDARD.replace('wheel = "S1002"', 'wheel = "noisy.txt"')
    with caplog.at_level(logging.INFO, logger="wheelrail"):
        wheelset_contact(scene_with("", measured_wheel, tmp_path))
    (message,) = (record.getMessage() for record in caplog.records if "noisy.txt" in record.getMessage())
    assert "noise of about 5" in message
    smoother = scene_with("", measured_wheel.replace("laying_angle", "noise = 6e-6\nlaying_angle"), tmp_path)
    assert side_profiles(smoother)["left"][0].measurement.smoothing == 6e-6  # type: ignore[union-attr]
    raw = measured_wheel.replace("laying_angle", "noise = 0.0\nlaying_angle")
    with (
        pytest.warns(UserWarning, match="curve through all of them"),
        pytest.raises(SceneError, match=r'profiles.wheel = "noisy.txt": .*line 1: .*allowed: noise = 5e-06'),
    ):
        scene_with("", raw, tmp_path)
    (tmp_path / "rough.txt").write_text(columns(wheel_points(noise=1e-4)))
    with pytest.raises(SceneError, match=r'profiles.right.wheel = "rough.txt": .*measure again'):
        scene_with('[profiles.right]\nwheel = "rough.txt"', folder=tmp_path)
    with (
        pytest.warns(UserWarning, match="curve through"),
        pytest.raises(SceneError, match="allowed: noise = 5e-06"),
    ):
        wr.Wheelset(wr.profile(tmp_path / "noisy.txt", "wheel", noise=0.0), **LOADED)


@pytest.mark.parametrize(
    ("old", "new", "says"),
    [
        ("[track]", '[profiles.left]\nwheel = "60E1"\n[track]', 'profiles.left.wheel = "60E1": must be S1002'),
        ("[track]", "[profiles.left]\nradius = 460.0\n[track]", "profiles.left.radius = 460.0: must be a number"),
        ("[track]", "[profiles.middle]\n[track]", "profiles.middle: unknown key; allowed are"),
        ("laying_angle", "noise = 1e-6\nlaying_angle", "profiles.noise = 1e-06: allowed only with a file"),
        (
            "[track]",
            "[profiles.right]\nnoise = 1e-6\n[track]",
            "profiles.right.noise = 1e-06: allowed only with a file",
        ),
        ("laying_angle", "wheel_section = 1\nlaying_angle", "profiles.wheel_section = 1: allowed only with a file"),
    ],
)
def test_wrong_keys_are_named(old: str, new: str, says: str) -> None:
    assert old in STANDARD
    with pytest.raises(SceneError) as raised:
        parse_scene(STANDARD.replace(old, new, 1))
    assert says in str(raised.value)


def test_each_side_may_give_everything() -> None:
    pair = 'wheel = "S1002"\nrail = "60E1"\nlaying_angle = 0.025\n'
    text = STANDARD[: STANDARD.index("[profiles]")] + STANDARD[STANDARD.index("[track]") :]
    scene = scene_with(f"[profiles.left]\n{pair}[profiles.right]\n{pair}", text)
    assert scene.sides_alike
    assert scene.side("left").rail == "60E1"


def test_run_takes_profile_objects(tmp_path: Path) -> None:
    """The same run as from the files; a wheel of another radius pulls the wagon to one side of straight track."""
    wheel, hollow = tmp_path / "wheel.txt", tmp_path / "hollow.txt"
    wheel.write_text(columns(wheel_points()))
    hollow.write_text(columns(wheel_points(depth=1e-3)))
    short = {"track.tangent": 5.0, "track.transition_length": 5.0, "track.curve": 5.0, "output.interval": 0.0}
    quick = {"model": "standard", "strips": None, "cells": None, "solver.workers": 1, **short}
    scene = ROOT / "scenes" / "curve.toml"
    sides = {"wheel": str(wheel), "right": {"wheel": str(hollow), "radius": 0.4595}}
    objects = {"wheel": wr.profile(wheel, "wheel"), "right": {"wheel": wr.profile(hollow, "wheel"), "radius": 0.4595}}
    from_files, from_objects = (wr.run(scene, profiles=profiles, **quick) for profiles in (sides, objects))
    assert from_objects.status == "completed"
    for name in ("body_y", "body_roll", "wheel_y"):
        np.testing.assert_array_equal(from_files.data[name], from_objects.data[name])
    alike = wr.run(scene, profiles={"wheel": wheel}, **quick)
    # towards the side of the smaller wheel until its rolling radius is that of the other one
    moved, centred = (float(run.data.body_y.sel(body="wheelset")[0]) for run in (from_objects, alike))
    assert moved < centred - 3e-4
    with pytest.raises(SceneError, match=r"run: wheel = .*must be a wheel profile"):
        wr.run(scene, profiles={"wheel": wr.profile("60E1")}, **quick)


def test_contact_geometry_of_different_sides() -> None:
    """Exchanged sides are the mirror image; equal ones given twice the same as given once."""
    y, smaller = np.array([-2e-3, 0.0, 2e-3]), {"radius": 0.459}
    alike, left, right = (
        wr.contact_geometry("S1002", "UIC60", y, **sides) for sides in ({}, {"left": smaller}, {"right": smaller})
    )
    np.testing.assert_allclose(left.rolling_radius.values, right.rolling_radius.values[::-1, ::-1], atol=1e-9)
    np.testing.assert_allclose(left.z, right.z[::-1], atol=1e-9)
    np.testing.assert_allclose(left["roll"], -right["roll"][::-1], atol=1e-9)
    # the wheelset rolls by the difference of the radii over the track's width, so that the contact points move, too
    assert 1e-3 < right.rolling_radius_difference[1].item() < 2e-3
    assert alike.rolling_radius_difference[1].item() == pytest.approx(0.0, abs=1e-9)
    assert float(right["roll"][1]) > 5e-4
    assert right.attrs["wheel"] == "S1002 (left), S1002 (right)"
    # the motion is about the position of equal radii, farther out than the positions
    assert 0.05 < right.equivalent_conicity.item() < 0.3
    assert right.equivalent_conicity.item() == pytest.approx(left.equivalent_conicity.item(), rel=1e-3)
    same = wr.contact_geometry("S1002", "UIC60", y, left=smaller, right=smaller, radius=0.46)
    np.testing.assert_allclose(same.rolling_radius, alike.rolling_radius - 1e-3, atol=1e-6)


def test_bodies_that_are_drawn_are_those_of_each_side() -> None:
    scene = parse_scene(CURVE.replace("[track]", "[profiles.right]\nradius = 0.4597\n[track]", 1))
    assert isinstance(scene, RunScene)
    bodies = bodies_of_scene(scene)
    assert (bodies.on("left").rolling_radius, bodies.on("right").rolling_radius) == (0.46, 0.4597)
    assert bodies.on("right").rail.name == bodies.on("left").rail.name
