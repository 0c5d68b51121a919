"""Dipped joints in a scene: parabolas, kink and depth, rails, messages."""

from __future__ import annotations

from itertools import pairwise
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from wheelrail.scenes.schema.errors import SceneError
from wheelrail.scenes.schema.scene import checked, load_scene
from wheelrail.scenes.schema.toml import parse, read_text
from wheelrail.vehicle.track.irregularity import Irregularities

SCENE = Path(__file__).parents[2] / "scenes" / "vehicle_joint.toml"


@pytest.mark.parametrize("seed", range(3))
def test_parabolas_that_meet_at_an_angle(seed: int) -> None:
    """Closed form within 2 % of the depth at the kink, 0.01 % elsewhere; rails are straight between joints."""
    draw = np.random.default_rng(seed)
    angle, length = draw.uniform(1e-3, 2e-2), draw.uniform(0.3, 2.0)
    places = 20.0 + np.cumsum(draw.uniform(2.0 * length, 3.0 * length, 4))
    own = Irregularities.joints(places.tolist(), angle, length)
    s = np.linspace(places[0] - 3.0 * length, places[-1] + 3.0 * length, 4001)
    nearest = np.abs(s[:, None] - places).min(axis=1)
    depth = 0.25 * angle * length
    dip = -depth * np.maximum(1.0 - nearest / length, 0.0) ** 2
    alignment, level, cross, gauge = own.at(s).T
    assert not np.any([alignment, cross, gauge])
    far = nearest > 0.05 * length
    np.testing.assert_allclose(level[far], dip[far], atol=1e-4 * depth)
    np.testing.assert_allclose(level, dip, atol=0.02 * depth)
    for place in places:
        before, after = own.derivatives(np.array([place - 0.1 * length, place + 0.1 * length]))[1, :, 1]
        assert (after - before) / (0.9 * angle) == pytest.approx(1.0, abs=1e-3)


def test_one_rail() -> None:
    own = Irregularities.joints([5.0, 7.1], 4e-3, 1.0, ("right",))
    (left, right) = own.rails(5.0) or ((), ())
    assert left == pytest.approx((0.0, 0.0), abs=1e-12)
    assert right == pytest.approx((0.0, -1e-3))
    assert [own.rails(s) for s in (3.0, 9.0)] == [None, None]


def test_joints_that_touch_have_increasing_stations() -> None:
    places = [10.0, 12.0, 14.5]
    own = Irregularities.joints(places, 4e-3, 1.0)
    assert all(after > before for before, after in pairwise(own.stations.tolist()))
    assert own.at(np.array([11.0]))[0, 1] == pytest.approx(0.0, abs=1e-6)


@pytest.mark.parametrize(
    ("joints", "message"),
    [
        ({"at": [30.0, 31.0]}, "track.irregularities.joints.at"),
        ({"at": [0.5]}, "the first joint must be at 1.12 m at least"),
        ({"at": [30.0], "angle": 0.5}, "track.irregularities.joints.angle = 0.5"),
        ({"at": []}, "track.irregularities.joints.at"),
    ],
)
def test_joints_that_are_refused(joints: dict[str, Any], message: str) -> None:
    data = parse(read_text(SCENE), SCENE)
    data["track"]["irregularities"] = {"joints": joints}
    with pytest.raises(SceneError) as refused:
        checked(data, SCENE)
    assert message in str(refused.value)
    assert str(refused.value).count("\n") == 0


def test_keys_that_do_not_belong() -> None:
    for key, value in (("spectrum", "low"), ("fade", 5.0), ("seed", 3), ("band", "D1")):
        data = parse(read_text(SCENE), SCENE)
        data["track"]["irregularities"][key] = value
        with pytest.raises(SceneError, match=key):
            checked(data, SCENE)


def test_the_example_has_its_joint() -> None:
    scene = load_scene(SCENE)
    assert scene.kind == "run"
    track = scene.track.track(10.78)
    assert track.irregularities is not None
    assert track.irregularities.at(np.array([13.0]))[0, 1] == pytest.approx(-1e-3)
