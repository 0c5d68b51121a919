"""Wheelset with elastic axle on rails on pads: derivatives, equilibrium, and the places of the patches."""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import cache
from typing import Any

import numpy as np
import pytest

import wheelrail as wr
from wheelrail.contact.elasticity.waveguide.bodies import GRADING, REACH
from wheelrail.contact.elasticity.waveguide.influence import ElementInfluence
from wheelrail.contact.elasticity.waveguide.spectrum import sample
from wheelrail.contact.kinematics.frames import SIDES
from wheelrail.contact.kinematics.wheelset_state import Mounting, WheelsetState
from wheelrail.contact.laws.material import Material
from wheelrail.contact.laws.parameters import ContactLaws
from wheelrail.contact.loading.flexible_wheelset import Flexibility, FlexibleEquilibrium, FlexibleWheelset, Loads
from wheelrail.contact.loading.load_search import LoadError
from wheelrail.contact.loading.moved_pair import MovedPair
from wheelrail.contact.loading.wheelset import axle_under_load, wheels_under_load
from wheelrail.contact.models.builders import wheel_rail_pair
from wheelrail.contact.models.discretisation import Discretisation
from wheelrail.contact.models.lattice.model import LatticeContact
from wheelrail.contact.models.lattice.resolution import LatticeResolution
from wheelrail.contact.models.wheelset import WheelsetContact
from wheelrail.contact.results.result import ContactResult, ForceTangent
from wheelrail.contact.structure.hubs import hub_compliance
from wheelrail.contact.structure.padded_section import PaddedSection
from wheelrail.contact.structure.pads import RailPads, rail_compliance
from wheelrail.meshes.bodies.axle import AxleShape
from wheelrail.meshes.bodies.outlines import rail_outline, wheel_outline
from wheelrail.meshes.bodies.solids import Strip, section
from wheelrail.meshes.profiles.named import named_profile
from wheelrail.support.arrays import Array

LOAD, SPEED, RADIUS, STEEL = 57e3, 10.0, 0.46, Material()
PROFILES = named_profile("S1002"), named_profile("UIC60-benchmark")
MOUNTING = Mounting(0.75, PROFILES[1].gauge_offset(1.435, 0.014), RADIUS)
ROLLING = WheelsetState(speed=SPEED, pitch_rate=SPEED / RADIUS)

# Left wheel, no friction, roll solved, 57 kN on each wheel: y of the wheelset mm, place of every patch on the rail mm
# and its share of the load. Another implementation, on 12 fitted strips, whose clamped bodies agree with an independent
# finite-element code within 0.03 mm. Axle of 160 mm without its weight; pads 100 and 40 kN/mm every 0.6 m.
PLACES = {
    ("axle", 0): [(-5.49, 1.0)],
    ("axle", 1): [(-9.40, 1.0)],
    ("axle", 2): [(-14.62, 1.0)],
    ("axle", 5): [(-21.65, 1.0)],
    ("axle", 6): [(-23.15, 0.710), (-33.92, 0.290)],
    ("pads", 0): [(-9.99, 1.0)],
    ("pads", 1): [(-14.98, 1.0)],
    ("pads", 2): [(-18.92, 1.0)],
    ("pads", 5): [(-23.13, 0.892), (-33.81, 0.108)],
    ("pads", 6): [(-34.05, 0.831), (-24.27, 0.169)],
    ("both", 0): [(-5.52, 1.0)],
    ("both", 1): [(-9.30, 1.0)],
    ("both", 2): [(-14.38, 1.0)],
    ("both", 5): [(-21.53, 1.0)],
    ("both", 6): [(-23.02, 0.842), (-33.86, 0.158)],
}
# The same with friction 0.3 at 10 m/s.
WITH_FRICTION = {
    ("axle", 2): [(-15.16, 1.0)],
    ("pads", 5): [(-23.26, 0.743), (-33.87, 0.257)],
    ("both", 2): [(-14.81, 1.0)],
}
# Peak pressure MPa without friction, on 40 strips.
PEAKS = {"axle": (760, 725, 1076), "pads": (753, 1092, 1281), "both": (760, 717, 1064)}  # y = 0, 1, 2 mm
HUB_ROLL = {0: -1.466, 1: -1.493, 2: -1.541, 5: -1.646, 6: -1.776}  # mrad, with the axle alone


@cache
def contact(friction: float = 0.0) -> WheelsetContact:
    model = wheel_rail_pair(PROFILES, RADIUS, (STEEL, STEEL), ContactLaws(friction=friction), Discretisation(1e-3))
    return WheelsetContact(model, MOUNTING)


@cache
def flexibility(name: str, weight: bool = False) -> Flexibility:
    hubs = hub_compliance(wheel_outline(PROFILES[0], RADIUS), AxleShape(), STEEL, wheel_y=0.75, weight=weight)
    rail = rail_compliance(rail_outline(PROFILES[1]), STEEL, RailPads())
    axle, pads = hubs if name in ("axle", "both") else None, (rail, rail) if name in ("pads", "both") else None
    return Flexibility(axle, pads)


@cache
def solved(name: str, y: float, friction: float = 0.0, weight: bool = False) -> FlexibleEquilibrium:
    rigid = wheels_under_load(contact(friction), replace(ROLLING, y=y), LOAD, expected=1e-4)
    wheelset = FlexibleWheelset(contact(friction), flexibility(name, weight))
    return wheelset.equilibrium(rigid.state, Loads.wheels(LOAD), rigid.results)


@pytest.mark.parametrize(("name", "y"), PLACES)
def test_places_and_shares_of_the_patches(name: str, y: int) -> None:
    result = solved(name, 1e-3 * y).results["left"]
    total = sum(patch.normal_force for patch in result.patches)
    patches = [(1e3 * patch.rail_y, patch.normal_force / total) for patch in result.patches]
    for (place, part), (expected, expected_part) in zip(patches, PLACES[name, y], strict=True):
        assert place == pytest.approx(expected, abs=0.05)
        assert part == pytest.approx(expected_part, abs=0.01)


@pytest.mark.parametrize(("name", "y"), WITH_FRICTION)
def test_places_and_shares_with_friction(name: str, y: int) -> None:
    patches = solved(name, 1e-3 * y, friction=0.3).results["left"].patches
    total = sum(patch.normal_force for patch in patches)
    for patch, (place, part) in zip(patches, WITH_FRICTION[name, y], strict=True):
        assert 1e3 * patch.rail_y == pytest.approx(place, abs=0.05)
        assert patch.normal_force / total == pytest.approx(part, abs=0.01)


@pytest.mark.parametrize("name", PEAKS)
def test_peak_pressures(name: str) -> None:
    peaks = [1e-6 * solved(name, 1e-3 * y).results["left"].patches[0].max_pressure for y in (0, 1, 2)]
    assert peaks == pytest.approx(PEAKS[name], rel=0.02)


@pytest.mark.parametrize("y", HUB_ROLL)
def test_hubs_roll_under_the_load(y: int) -> None:
    equilibrium = solved("axle", 1e-3 * y)
    assert 1e3 * equilibrium.hubs["left"][3] == pytest.approx(HUB_ROLL[y], abs=0.003)
    assert equilibrium.hubs["right"][3] > 0.0  # the right wheel tilts the other way


def test_own_weight_tilts_the_wheels_less() -> None:
    # Of the load at the rail only 91 % reach the journals. The contact moves outwards with it, which tilts them again.
    light, heavy = (solved("axle", 0.0, weight=weight) for weight in (False, True))
    sag = flexibility("axle", weight=True).unloaded[3]
    assert heavy.hubs["left"][3] - light.hubs["left"][3] == pytest.approx(sag, rel=0.05)
    assert 0.09 < sag / -light.hubs["left"][3] < 0.13
    shift = heavy.results["left"].patches[0].rail_y - light.results["left"].patches[0].rail_y
    assert -0.5e-3 < shift < -0.2e-3


def test_newton_converges_quadratically() -> None:
    errors = solved("both", 2e-3).errors
    assert len(errors) <= 6
    assert errors[-1] < 100 * errors[-2] ** 2 or errors[-1] < 1e-8
    equilibrium = solved("both", 2e-3)
    forces = [equilibrium.results[side].force[2] for side in SIDES]
    assert forces == pytest.approx([LOAD, LOAD], rel=1e-7)


def test_motions_are_those_of_the_loads() -> None:
    equilibrium, elastic = solved("both", 2e-3), flexibility("both")
    loads = np.concatenate([equilibrium.hub_loads[side] for side in SIDES])
    mirrored = equilibrium.hubs["right"] * [1, -1, 1, -1, 1, -1]
    np.testing.assert_allclose(
        np.concatenate([equilibrium.hubs["left"], mirrored]), elastic.matrix[:12, :12] @ loads, atol=2e-9
    )
    assert equilibrium.rails["left"][1] == pytest.approx(-2.89e-4, rel=0.01)
    left = equilibrium.results["left"]
    by_patches = sum(patch.force for patch in left.patches)
    np.testing.assert_allclose(by_patches, left.force, atol=1e-6 * LOAD)


def test_mirror_image() -> None:
    left, right = solved("both", 2e-3), solved("both", -2e-3)
    np.testing.assert_allclose(left.results["left"].force * [1, -1, 1], right.results["right"].force, atol=1e-4 * LOAD)
    np.testing.assert_allclose(left.hubs["left"] * [1, -1, 1, -1, 1, -1], right.hubs["right"], atol=1e-7)
    np.testing.assert_allclose(left.rails["left"] * [-1, 1, -1], right.rails["right"], atol=1e-7)
    assert left.results["left"].patches[0].contact_angle == pytest.approx(
        -right.results["right"].patches[0].contact_angle, rel=1e-3
    )


def test_nothing_flexible_is_the_rigid_wheelset() -> None:
    rigid = wheels_under_load(contact(), replace(ROLLING, y=2e-3), LOAD, expected=1e-4)
    equilibrium = FlexibleWheelset(contact(), Flexibility()).equilibrium(rigid.state, Loads.wheels(LOAD))
    for side in SIDES:
        result, expected = equilibrium.results[side], rigid.results[side]
        np.testing.assert_allclose(result.force, expected.force, atol=1e-6 * LOAD)
        np.testing.assert_allclose(result.moment, expected.moment, atol=1e-6 * LOAD)
        tangent = contact().tangent(rigid.state, side, expected)
        mine = equilibrium.tangent[SIDES.index(side), :, :9]
        np.testing.assert_allclose(mine, tangent, atol=1e-5 * np.abs(tangent).max())


def test_axle_load_keeps_the_roll() -> None:
    start = solved("both", 2e-3)
    held = replace(start.state, roll=start.state.roll + 1e-4)
    equilibrium = FlexibleWheelset(contact(), flexibility("both")).equilibrium(held, Loads.axle(2 * LOAD))
    forces = [equilibrium.results[side].force[2] for side in SIDES]
    assert sum(forces) == pytest.approx(2 * LOAD, rel=1e-7)
    assert forces[1] > forces[0] + 5e3  # the right wheel is pressed down
    assert equilibrium.state.roll == held.roll


def test_axle_load_on_one_wheel() -> None:
    """A wheel in the air needs no contact; at 06d44fc it was "no contact to start from"."""
    own = FlexibleWheelset(contact(), flexibility("axle"))
    rigid = axle_under_load(contact(), replace(ROLLING, roll=5e-3), LOAD, expected=8e-5)
    found = own.equilibrium(rigid.state, Loads.axle(LOAD), rigid.results)
    statuses = {side: result.status for side, result in found.results.items()}
    assert sorted(statuses.values()) == ["converged", "separated"]
    assert sum(result.force[2] for result in found.results.values()) == pytest.approx(LOAD, rel=1e-6)
    assert max(abs(hub).max() for hub in found.hubs.values()) > 1e-6


def test_condensed_tangent_is_that_of_the_equilibria() -> None:
    few = LatticeResolution(8, 8)
    exact = contact().changed(lambda model: replace(model, tolerance=1e-9, resolution=few))  # type: ignore[call-arg]
    wheelset, given = FlexibleWheelset(exact, flexibility("both")), solved("both", 2e-3)
    start = wheelset.equilibrium(given.state, Loads(), given.results)
    for column, name in enumerate(("y", "z", "roll", "yaw")):
        h, forces = 5e-7, []  # m and rad: a strip enters 1 to 2 um behind y = 2 mm
        for sign in (1, -1):
            state = replace(start.state, **{name: getattr(start.state, name) + sign * h})
            moved = wheelset.equilibrium(state, Loads(), start.results).results
            forces.append(np.stack([np.concatenate([moved[side].force, moved[side].moment]) for side in SIDES]))
        slope = (forces[0] - forces[1]) / (2 * h)
        np.testing.assert_allclose(start.tangent[:, :, column], slope, atol=1e-5 * np.abs(slope).max())


def test_stiffness_is_that_of_springs_in_series() -> None:
    # On the tread both wheels move as one on the bending of the axle, the pads and the contact itself.
    elastic, equilibrium = flexibility("both"), solved("both", 0.0)
    assert elastic.hubs is not None
    assert elastic.rails is not None
    local = -solved("rigid", 0.0).tangent[0, 2, 1]
    springs = elastic.hubs.bending[0, 0, 0] + elastic.rails[0].matrix[1, 1] + 1 / local
    assert local == pytest.approx(1.0e9, rel=0.1)
    assert -equilibrium.tangent[0, 2, 1] == pytest.approx(1 / springs, rel=0.03)


@dataclass(frozen=True, eq=False)
class Linear(ForceTangent):
    """A given derivative (6, 12)."""

    matrix: Array

    def __call__(self) -> Array:
        return self.matrix

    def about(self, centre: Array) -> Linear:
        change = self.matrix.copy()
        change[3:] -= np.cross(centre, change[:3].T).T
        return Linear(change)

    def mirrored(self) -> Linear:
        raise NotImplementedError


def test_slopes_of_a_moved_pair() -> None:
    """Wrench and loads of a contact that is linear in pose and motion, against differences."""
    rng = np.random.default_rng(7)
    state = WheelsetState(0.002, -2e-4, 1e-3, 2e-3, 0.01, 0.002, -0.003, 0.004, 21.7, SPEED, (1e-3, -2e-4, 0.01))
    hub, rail, foot = 1e-3 * rng.normal(size=6), 1e-3 * rng.normal(size=3), np.array([-0.0032, -0.172])
    wrench, tangent, h = rng.normal(size=6), rng.normal(size=(6, 12)), 1e-5

    def pair(change: Array) -> MovedPair:
        names = WheelsetState.coordinates
        moved = {name: getattr(state, name) + change[i] for i, name in enumerate(names)}
        return MovedPair(MOUNTING, replace(state, **moved), hub + change[9:15], rail + change[15:], foot)

    at = pair(np.zeros(18))

    def result(change: Array, derivative: Array) -> tuple[MovedPair, ContactResult]:
        own = pair(change)
        turn, wheels = own.pose.rotation @ at.pose.rotation.T, (own.motion.wheel, at.motion.wheel)
        moved = [
            own.pose.origin - at.pose.origin,
            0.5 * np.array([turn[2, 1] - turn[1, 2], turn[0, 2] - turn[2, 0], turn[1, 0] - turn[0, 1]]),
            wheels[0].velocity - wheels[1].velocity,
            wheels[0].rotation - wheels[1].rotation,
        ]
        force, moment = np.split(wrench + derivative @ np.concatenate(moved), 2)
        solved = ContactResult(force=force, moment=moment, status="converged", force_tangent=Linear(derivative))
        return own, own.in_track(solved)

    slopes = at.wrench_slopes(result(np.zeros(18), tangent)[1])
    constant = result(np.zeros(18), tangent)[1]
    given = np.concatenate([constant.force, constant.moment])
    change = at.load_change(given)
    for column, direction in enumerate(np.eye(18)):
        ends = [result(way * h * direction, tangent) for way in (1.0, -1.0)]
        wrenches = [np.concatenate([own.force, own.moment]) for _, own in ends]
        np.testing.assert_allclose(slopes[:, column], (wrenches[0] - wrenches[1]) / (2 * h), atol=1e-7)
        loads = [moved.load_matrix @ given for moved, _ in ends]
        np.testing.assert_allclose(change[:, column], (loads[0] - loads[1]) / (2 * h), atol=1e-7)


def test_without_motion_the_pair_is_that_of_the_mounting() -> None:
    state = WheelsetState(0.002, -2e-4, 1e-3, 2e-3, 0.01, 0.002, -0.003, 0.004, 21.7, SPEED, (1e-3, -2e-4, 0.01))
    pair = MovedPair(MOUNTING, state, np.zeros(6), np.zeros(3), np.array([-0.0032, -0.172]))
    pose, motion = MOUNTING.left_pair(state)
    points = np.array([[0.01, 0.02, -0.01], [0.0, -0.03, 0.0]])
    np.testing.assert_allclose(pair.pose.origin, pose.origin, atol=1e-15)
    np.testing.assert_allclose(pair.pose.rotation, pose.rotation, atol=1e-15)
    np.testing.assert_allclose(pair.motion.wheel.at(points), motion.wheel.at(points), atol=1e-13)
    np.testing.assert_allclose(pair.motion.rail.at(points), motion.rail.at(points), atol=1e-13)


def test_refuses_to_start_without_contact() -> None:
    with pytest.raises(LoadError, match="no contact to start from"):
        FlexibleWheelset(contact(), flexibility("both")).equilibrium(replace(ROLLING, z=0.01), Loads.wheels(LOAD))


@cache
def contact_on_padded_spectrum() -> WheelsetContact:
    """The pads in the spectrum of the rail itself: no motions of the rail as unknowns."""
    outline, size = rail_outline(PROFILES[1]), 1e-3
    strip = Strip.on(outline, half_length=size, size=size)
    mesh = section(outline, strip, grading=GRADING)
    along, lateral, vertical = (stiffness / STEEL.E for stiffness in RailPads().per_length)
    body = PaddedSection(mesh, Material(1.0, STEEL.nu), (along, lateral, vertical))
    samples = sample(body.flexibility, shift=1 / 0.172, largest=REACH / size, step=size, tolerance=1e-3)
    model = contact().model
    assert isinstance(model, LatticeContact)
    lower = model.operators.lower
    assert isinstance(lower, ElementInfluence)
    operators = replace(model.operators, lower=replace(lower, spectrum=lambda: samples))
    return replace(contact(), model=replace(model, operators=operators))


@pytest.mark.parametrize("y", [0.0, 1e-3, 2e-3])
def test_agrees_with_pads_in_the_spectrum_of_the_rail(y: float) -> None:
    whole = wheels_under_load(contact_on_padded_spectrum(), replace(ROLLING, y=y), LOAD, expected=4e-4)
    split = solved("pads", y)
    for side in SIDES:  # what is left, 0.4 um in height, is 0.14 % of the pads' part: no rigid motion of the section
        expected, patch = whole.results[side].patches[0], split.results[side].patches[0]
        assert patch.rail_y == pytest.approx(expected.rail_y, abs=1e-5)
    assert split.state.z == pytest.approx(whole.state.z, abs=1e-6)


def test_a_rail_that_is_pushed_aside_is_named() -> None:
    """Its equilibria end: 69 mm beside the track the lateral load grows as the rail gives way, at 0.998 times the
    compliance of its pads by 12 mm.
    """
    wheelset = wr.Wheelset(
        "S1002",
        "60E1",
        laying_angle=0.05,
        radius=0.50297,
        flange_back_distance=1.358,
        friction=0.704496,
        bodies="half-space",
        strips=5,
        cells=12,
        right={"radius": 0.503114},
        pads=True,
    )
    velocities = {"speed": 25.98, "y_rate": -0.250485, "z_rate": -0.0179661, "yaw_rate": 0.0140482}
    solution = wheelset.solve(y=0.069273, yaw=0.00223017, wheel_load=70185.5, roll="solve", **velocities)
    assert "loads at the start would move them by 9 mm or mrad" in solution.status


@pytest.mark.parametrize("loads", [Loads.wheels(LOAD), Loads.axle(2 * LOAD)])
def test_wheels_far_too_deep_are_lifted_before_a_solve(loads: Loads, monkeypatch: pytest.MonkeyPatch) -> None:
    """As with rails far aside, where one on a flange would carry meganewtons."""
    start = solved("pads", 0.0)
    wheelset, results = FlexibleWheelset(contact(), flexibility("pads")), tuple(start.results.values())
    trial = wheelset._trial(start.state, start.motions, results)
    solve, approaches = LatticeContact.__call__, []

    def observed(*given: Any) -> ContactResult:
        result = solve(*given)
        approaches.append(result.approach)
        return result

    monkeypatch.setattr(LatticeContact, "__call__", observed)
    deep = replace(start.state, z=start.state.z - 1.5e-3)
    found, _ = wheelset._carrying(deep, start.motions, trial, loads, 1e-4)
    assert found.state.z == pytest.approx(start.state.z, abs=1e-7)
    assert max(approaches) < 2 * results[0].approach
