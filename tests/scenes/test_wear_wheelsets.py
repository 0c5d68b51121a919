"""Wear of each wheelset and of each wheel: means, hands, turned vehicles, contacts on worn profiles, bad files."""

from __future__ import annotations

import json
from collections.abc import Mapping
from functools import cache
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from xarray import Dataset

from wheelrail.contact.kinematics.frames import SIDES
from wheelrail.contact.results.vehicle_contact import ContactsByWheelset
from wheelrail.meshes.profiles.named import named_profile
from wheelrail.scenes.builders.wheelset import run_contact, side_profiles, wheelset_contact
from wheelrail.scenes.schema.errors import SceneError
from wheelrail.scenes.schema.scene import RunScene, load_scene
from wheelrail.scenes.wear.cases import Duty
from wheelrail.scenes.wear.loop import WearLoop
from wheelrail.scenes.wear.schema import check_wear
from wheelrail.support.arrays import Array
from wheelrail.vehicle.multibody.equations import VehicleDynamics
from wheelrail.vehicle.steady.equilibrium import equilibrium
from wheelrail.vehicle.track.constant_curve import ConstantCurve

SCENES = Path(__file__).parents[2] / "scenes"
FILES = {"scene": str(SCENES / "vehicle.toml"), "vehicle": str(SCENES / "manchester_vehicle.toml")}
CURVE = {"curvature": 1.0 / 600.0, "cant": 0.1, "speed": 25.0}
NAMES = [f"wheelset_{number}" for number in (1, 2, 3, 4)]
ICE = {"contacts.ice": {"wheelsets": ["wheelset_2"], "friction": 0.0}}
pytestmark = pytest.mark.usefixtures("coarse_conicities")
ELASTIC = {"wheelset.axle": {"diameter": 0.16}, "track.pads": {}}


def duty(profiles: str, **more: Any) -> Duty:
    case = {"share": 1.0, "steady": CURVE, **more.pop("case", {})}
    table = {**FILES, "law": {"name": "usfd", "scale": 0.18}, "until": 1.0, "step": 1e5, "duty": [case], **more}
    return Duty(check_wear({**table, "profiles": profiles}), Path("wear.toml"))


@cache
def rates(profiles: str, *, both_hands: bool = False, turned: bool = False, scene: str = "{}") -> Array:
    """Sections removed from the cells of each new profile per distance (profiles, n), m; scene: its changes."""
    own = duty(profiles, turned=turned, case={"both_hands": both_hands, "set": json.loads(scene)})
    new = own.unworn()
    with own.contacts(new, new, own.cases) as contacts:
        found = [own.rates(case, contacts[case.contact_key], new, {}).rates.wheels for case in own.cases]
    shares = [case.table.share for case in own.cases]
    return np.array([sum(w * one[name].removed for w, one in zip(shares, found, strict=True)) for name in new])


def close(found: Array, expected: Array, atol: float) -> None:
    np.testing.assert_allclose(found, expected, atol=atol * np.abs(expected).max())


def test_means_of_wheels_are_those_of_sides_and_of_all() -> None:
    """At the start, where all have the new profile."""
    assert list(duty("wheels").unworn()) == [f"{name}, {side}" for name in NAMES for side in SIDES]
    assert list(duty("wheelsets").unworn()) == NAMES
    by_wheel = rates("wheels").reshape(4, 2, -1)
    close(by_wheel.mean(axis=0), rates("sides"), 1e-12)
    close(by_wheel.mean(axis=1), rates("wheelsets"), 1e-12)
    close(by_wheel.mean(axis=(0, 1)), rates("one")[0], 1e-12)
    assert by_wheel[0].sum() > 2.0 * by_wheel[1].sum()  # leading wheelsets of the bogies wear most


def test_both_hands_wear_a_wheelset_alike() -> None:
    """A wheelset in both hands as its two wheels in turn."""
    left, both = rates("wheels").reshape(4, 2, -1), rates("wheels", both_hands=True).reshape(4, 2, -1)
    close(both[:, 0], left.mean(axis=1), 1e-6)
    close(both[:, 1], left.mean(axis=1), 1e-6)
    np.testing.assert_array_equal(rates("wheelsets", both_hands=True), rates("wheelsets"))


def test_a_turned_vehicle_exchanges_its_ends() -> None:
    """Wheelset 1 leads one half of the distance and trails the other, and its left wheel is on the right then."""
    turned, plain = (rates("wheels", turned=way).reshape(4, 2, -1) for way in (True, False))
    close(turned, 0.5 * (plain + plain[::-1, ::-1]), 1e-6)
    assert abs(turned - plain).max() > 0.2 * plain.max()


@cache
def worn_wheels() -> Dataset:
    """Wheels after 200 km."""
    return WearLoop(duty("wheels", until=2e5)).run()


def test_wheelsets_are_turned_at_their_own_limits() -> None:
    """Of both wheels of a wheelset one is beyond the limit; all others go on as without limits."""
    heights = worn_wheels()["Sh"].values
    limit = float(heights[-1].max() - 1e-7)
    assert (heights > limit).sum() == 1
    beyond = int(heights[-1].argmax())
    data = WearLoop(duty("wheels", until=2e5, reprofile={"Sh": limit, "apart": True})).run()
    due = np.arange(8) // 2 == beyond // 2
    assert not data["turned"].values[:-1].any()
    np.testing.assert_array_equal(data["turned"].values[-1], due)
    assert not data["depth"].values[-1, due].any()
    assert data["depth"].values[-2, due].any()
    np.testing.assert_array_equal(data["depth"].values[-1, ~due], worn_wheels()["depth"].values[-1, ~due])


def test_wheels_run_on_their_own_worn_profiles() -> None:
    """T-gamma at the second step is that of a vehicle whose wheels are given one by one."""
    data = worn_wheels()
    scene = load_scene(FILES["scene"])
    assert isinstance(scene, RunScene)
    bounds = duty("wheels").unworn()["wheelset_1, left"].grid.bounds
    pairs, own = side_profiles(scene), {}
    for k, name in enumerate(NAMES):
        removed = data["removed_area"].values[1, 2 * k : 2 * k + 2]
        worn = {side: named_profile("S1002").worn(bounds, area) for side, area in zip(SIDES, removed, strict=True)}
        own[name] = wheelset_contact(scene, {side: (worn[side], pairs[side][1]) for side in SIDES})
    curve = ConstantCurve(25.0, 1.0 / 600.0, 0.1)
    vehicle = duty("wheels").cases[0].vehicle
    found = equilibrium(VehicleDynamics(vehicle, curve.track, ContactsByWheelset(own[NAMES[0]], own), 25.0))
    power = [p.frictional_power for sides in found.contacts.values() for one in sides.values() for p in one.patches]
    assert float(data["t_gamma"].values[1, 0]) == pytest.approx(sum(power) / 8 / 25.0, rel=1e-6)
    assert float(data["t_gamma"].values[0, 0]) != pytest.approx(sum(power) / 8 / 25.0, rel=1e-3)


def test_wheels_without_friction_do_not_wear() -> None:
    """A contact by name in the duty."""
    sections = rates("wheelsets", scene=json.dumps(ICE)).sum(axis=1)
    assert sections[1] == 0.0
    assert (sections[[0, 2, 3]] > 0.0).all()


def test_rails_on_stiff_pads_wear_wheels_as_rigid_ones() -> None:
    pads = json.dumps({"track.pads": {"vertical": 1e12, "lateral": 1e12}})
    close(rates("wheelsets", scene=pads), rates("wheelsets"), 2e-4)


def test_wheels_on_elastic_axles_wear_as_in_their_equilibrium() -> None:
    own = duty("wheelsets", case={"set": ELASTIC})
    scene, new, case = own.cases[0].scene, own.unworn(), own.cases[0]
    contact, structures = run_contact(scene, case.vehicle.wheelsets)
    curve = ConstantCurve(25.0, 1.0 / 600.0, 0.1)
    found = equilibrium(VehicleDynamics(case.vehicle, curve.track, contact, 25.0, structures))
    with own.contacts(new, new, own.cases) as contacts:
        wear = own.rates(case, contacts[case.contact_key], new, {}).rates
    for name, sides in found.contacts.items():
        power = [patch.frictional_power for one in sides.values() for patch in one.patches]
        assert wear.wheels[name].t_gamma == pytest.approx(sum(power) / 2 / 25.0, rel=1e-6)
    rigid = rates("wheelsets")
    assert abs(rates("wheelsets", scene=json.dumps(ELASTIC)) - rigid).max() > 0.1 * rigid.max()  # places move


@pytest.mark.parametrize(
    ("profiles", "contact", "says"),
    [
        ("sides", {"radius": 0.459}, 'profiles = "sides": must be "wheels" for wheelsets that differ'),
        ("one", {"radius": 0.459}, 'profiles = "one": must be "wheelsets" for wheelsets that differ'),
        ("one", {"profiles": {"left": {"radius": 0.459}}}, 'profiles = "one": must be "sides" for sides that differ'),
        ("wheelsets", {"profiles": {"left": {"radius": 0.459}}}, 'must be "wheels" for sides that differ'),
        ("axles", {}, 'must be "one" or "sides" or "wheelsets" or "wheels"'),
    ],
)
def test_bad_files(profiles: str, contact: Mapping[str, Any], says: str) -> None:
    with pytest.raises(SceneError, match=says):
        duty(profiles, case={"set": {"contacts.a": {"wheelsets": ["wheelset_2"], **contact}}})


def test_sides_are_not_turned_apart() -> None:
    with pytest.raises(SceneError, match='apart = true: allowed only with profiles = "wheelsets" or "wheels"'):
        duty("sides", reprofile={"Sd": 26e-3, "apart": True})


@pytest.mark.parametrize("resume", [False, True])
def test_a_limit_that_new_wheels_exceed_is_refused(resume: bool, tmp_path: Path) -> None:
    with pytest.raises(SceneError, match=r"reprofile.Sd = 0.04 m: .* is beyond it when new, with 0.03"):
        WearLoop(duty("one", reprofile={"Sd": 40e-3}), tmp_path).run(resume=resume)
