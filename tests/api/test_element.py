"""Contact elements of the public package: tangents, restored states, Hertz, scenes, and what is no number in range."""

from __future__ import annotations

import pickle
from collections.abc import Callable
from dataclasses import replace
from functools import cache
from multiprocessing import get_context
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import wheelrail as wr
from wheelrail.contact.analytical.hertz import hertz, modulus
from wheelrail.contact.element.element_solution import ElementSolution
from wheelrail.contact.loading.quasi_static_contact import QuasiStaticContact
from wheelrail.contact.models.hertz import HertzContact
from wheelrail.contact.models.wheelset import WheelsetContact
from wheelrail.support.arrays import Array

SCENES = Path(__file__).parents[2] / "scenes"
PLACE = {"y": -1e-3, "z": -2.8e-4, "yaw": 5e-3, "y_rate": 0.01, "yaw_rate": 0.02, "speed": 20.0}
SIDES = ("left", "right")


@cache
def wheelset() -> wr.Wheelset:
    return wr.Wheelset(
        "S1002", "UIC60-benchmark", friction=0.3, bodies="half-space", points="lattice", strips=8, cells=8
    )


@cache
def standard() -> wr.Wheelset:
    return wr.Wheelset("S1002", "UIC60-benchmark", friction=0.3, model="standard", curvature=1 / 600)


def exact() -> wr.WheelsetElement:
    """The element with the last Newton step small enough for differences."""
    element = wheelset().element()
    contact = element.contact
    assert isinstance(contact, WheelsetContact)
    element.contact = replace(contact, model=replace(contact.model, tolerance=1e-8))  # type: ignore[type-var]
    return element


@cache
def hertz_element() -> wr.HertzElement:
    return wr.Hertz(bodies="half-space", points="lattice", strips=8, cells=8).element(load=60e3)


def wrench(solution: ElementSolution[Any, Any]) -> Array:
    """Force and moment (sides, 6)."""
    return np.array([np.concatenate([solution.force[side], solution.moment[side]]) for side in solution.results])


def differences(solve: Callable[..., ElementSolution[Any, Any]], place: dict[str, float], names: Any) -> Array:
    """Central differences (sides, 6, n) over 20 nm and 20 um/s, and as many rad and rad/s.

    On few cells slopes change by per mille over 0.2 um, as a cell starts to slide.
    """
    columns = []
    for name in names:
        h = 2e-5 if name.endswith("rate") else 2e-8
        ahead, behind = (wrench(solve(**{**place, name: place.get(name, 0.0) + sign * h})) for sign in (1, -1))
        columns.append((ahead - behind) / (2 * h))
    return np.stack(columns, axis=2)


def test_tangent_of_a_wheelset() -> None:
    """All nine coordinates, both sides, to 1e-4 of the largest entry of a row, of positions and of rates."""
    element = exact()
    place = {**PLACE, "pitch_rate": 20.0 / 0.46}
    element.solve(**place)
    element.accept()
    tangent = element.tangent()
    assert tangent.columns == ("y", "z", "roll", "yaw", "y_rate", "z_rate", "roll_rate", "yaw_rate", "pitch_rate")
    expected = differences(element.solve, place, tangent.columns)
    for columns, bound in ((slice(0, 4), 1e-4), (slice(4, 9), 1e-3)):
        error = np.abs(tangent.values - expected)[..., columns]
        assert (error / np.abs(expected[..., columns]).max(axis=2, keepdims=True)).max() < bound


def test_rejected_trials_and_accepted_states() -> None:
    """Trials change no bit; the accepted state changes forces by less than 1e-6."""

    def path(trials: int) -> list[bytes]:
        element, random, forces = wheelset().element(), np.random.default_rng(0), []
        for y in (-1e-3, -1.2e-3, -1.4e-3):
            for dy, dz in random.normal(size=(trials, 2)) * [2e-3, 2e-4]:
                element.solve(**{**PLACE, "y": dy, "z": dz})
            forces.append(wrench(element.solve(**{**PLACE, "y": y})).tobytes())
            element.accept()
        return forces

    assert path(8) == path(0)
    element = exact()
    cold = wrench(element.solve(**PLACE))
    element.solve(y=-1.3e-3, z=-2.6e-4, speed=20.0)
    element.accept()
    np.testing.assert_allclose(wrench(element.solve(**PLACE)), cold, rtol=0, atol=1e-6 * np.abs(cold).max())


def continued(state: bytes) -> bytes:
    """Wrenches of two states after a stored one."""
    element = wheelset().element()
    element.restore(pickle.loads(state))
    wrenches = []
    for y in (-1.1e-3, -1.2e-3):
        wrenches.append(wrench(element.solve(**{**PLACE, "y": y})))
        element.accept()
    return np.array(wrenches).tobytes()


def test_restored_in_another_process() -> None:
    element = wheelset().element()
    element.solve(**PLACE)
    element.accept()
    stored = pickle.dumps(element.state())
    wrenches = []
    for y in (-1.1e-3, -1.2e-3):
        wrenches.append(wrench(element.solve(**{**PLACE, "y": y})))
        element.accept()
    with get_context("spawn").Pool(1) as pool:
        assert pool.apply(continued, (stored,)) == np.array(wrenches).tobytes()
    assert len(stored) < 3e6  # most of it the factors of both sides, with which the next solve begins


def test_hertz() -> None:
    steel = (2.1e11, 0.3)
    closed = hertz(0.5 / 0.46, 0.5 / 0.30, modulus(steel, steel), force=60e3)
    element = hertz_element()
    solution = element.solve(z=-closed.approach)
    assert solution.status == "converged"
    assert solution.force["contact"][2] == pytest.approx(60e3, rel=5e-3)
    assert solution.approach["contact"] == pytest.approx(closed.approach, rel=1e-12)
    (patch,) = element.patches()["contact"]
    assert patch.max_pressure == pytest.approx(closed.peak, rel=0.02)
    stiffness = -element.tangent().by("z")[0, 2, 0]
    assert stiffness == pytest.approx(1.5 * 60e3 / closed.approach, rel=0.02)  # by eight strips
    # the rolling speed is the mean of both materials
    xi, eta, spin, speed = 4e-4, -3e-4, 0.2, 10.0
    pair = wr.Hertz(bodies="half-space", points="lattice", strips=8, cells=8, load=60e3)
    alone = pair.solve(approach=closed.approach, creepage=(xi, eta, spin), speed=speed).results["contact"]
    rolling = element.solve(
        z=-closed.approach,
        x_rate=xi * speed,
        y_rate=eta * speed,
        yaw_rate=spin * speed,
        speed=speed * (1 + xi / 2),
    )
    np.testing.assert_allclose(rolling.force["contact"], alone.force, rtol=1e-7, atol=1e-3)


def test_tangent_of_hertz() -> None:
    """All six coordinates, to 1e-4 of the largest entry of a row, from an accepted state.

    A shift along the straight body changes nothing.
    """
    element = wr.Hertz(bodies="half-space", points="lattice", strips=8, cells=8).element(load=60e3)
    assert isinstance(element.contact, HertzContact)
    element.contact = HertzContact(replace(element.contact.model, tolerance=1e-10))  # type: ignore[type-var]
    place = {"x": 1e-3, "z": -7.2e-5, "x_rate": 4e-3, "y_rate": 2e-3, "yaw_rate": 0.5, "speed": 10.0}
    element.solve(**place)
    element.accept()
    element.solve(**place)
    tangent = element.tangent()
    expected = differences(element.solve, place, tangent.columns)
    for columns in (slice(0, 3), slice(3, 6)):
        error = np.abs(tangent.values - expected)[:, [0, 1, 5], columns]
        assert (error / np.abs(expected[:, [0, 1, 5], columns]).max(axis=2, keepdims=True)).max() < 1e-4
    np.testing.assert_allclose(tangent.values[0, 2:5], expected[0, 2:5], rtol=1e-4, atol=1e-8 * np.abs(expected).max())
    assert np.abs(tangent.by("x")).max() < 1e-6 * np.abs(tangent.by("y")).max()


def test_defaults_are_those_of_the_wheelset_and_its_scene(tmp_path: Path) -> None:
    text = (SCENES / "wheelset.toml").read_text().replace('model = "condensed"', 'model = "standard"')
    (tmp_path / "wheelset.toml").write_text(text)
    loaded = wr.load(tmp_path / "wheelset.toml")
    assert isinstance(loaded, wr.Wheelset)
    for made in (loaded, standard()):
        element = made.element()
        for given in ({}, {"speed": 30.0}, {"yaw": 2e-3, "y_rate": 0.02, "yaw_rate": -0.05}):
            expected = made.solve(z=-2.5e-4, roll=0.0, **given).results
            solution = element.solve(z=-2.5e-4, **given)
            for side in SIDES:
                assert expected[side].force.tobytes() == solution.results[side].force.tobytes()  # type: ignore[index]
                assert expected[side].moment.tobytes() == solution.results[side].moment.tobytes()  # type: ignore[index]
    state = standard().element().solve(z=-2.5e-4, speed=30.0).state
    assert (state.pitch_rate, state.frame_rate) == (30.0 / 0.46, (0.0, 0.0, 30.0 / 600))
    straight = {"speed": 20.0, "frame_rate": (0.0, 0.0, 0.0)}
    shifted = element.solve(y=1e-3, z=0.75e-3, rail_shift=((1e-3, 1e-3), (1e-3, 1e-3)), **straight)
    level = element.solve(y=0.0, z=-0.25e-3, **straight)
    np.testing.assert_allclose(shifted.force["left"], level.force["left"], rtol=1e-6)
    turning = element.solve(z=-2.5e-4, frame_rate=np.array([0.0, 0.0, 0.1]), speed=20.0)
    assert turning.state.frame_rate == (0.0, 0.0, 0.1)


def test_what_cannot_be_solved_is_a_status() -> None:
    element = standard().element()
    assert element.solve(z=1e-2).status == "separated"
    standing = element.solve(z=-2.5e-4, speed=0.0)
    assert standing.status.startswith("failed: left: friction needs a positive rolling speed")
    off = element.solve(y=0.02, z=-3e-2)
    assert off.status.startswith("failed: ")
    assert np.isnan(off.force["left"]).all()
    assert element.solve(z=-2.5e-4).ok
    without = wr.Wheelset("S1002", "UIC60-benchmark", friction=0.3, model="standard", tangential="polach").element()
    assert without.solve(z=-2.5e-4).ok
    with pytest.raises(ValueError, match="no tangent"):
        without.tangent()


@pytest.mark.parametrize(
    ("arguments", "says"),
    [
        ({"y": 2.0}, "solve: y = 2.0: must be a number from -0.1 to 0.1 m (2 mm is 0.002)"),
        ({"y": float("nan")}, "solve: y = nan: must be a number from"),
        ({"z": "low"}, "solve: z = 'low': must be a number from -0.1 to 0.1 m"),
        ({"z": True}, "solve: z = True: must be a number"),
        ({"yaw": 1.5}, "solve: yaw = 1.5: must be a number from -0.2 to 0.2 rad (1/40 is 0.025)"),
        ({"speed": -1.0}, "solve: speed = -1.0: must be a number from 0 to 200 m/s"),
        ({"yaw_rate": float("inf")}, "solve: yaw_rate = inf: must be a number from -1000 to 1000 per second"),
        ({"pitch_rate": np.zeros(1)}, "solve: pitch_rate = array([0.]): must be a number"),
        ({"frame_rate": 0.1}, "solve: frame_rate = 0.1: must be three numbers in rad/s"),
        ({"frame_rate": (0.0, 0.0, float("nan"))}, "solve: frame_rate[2] = nan: must be a number"),
        ({"rail_shift": (0.0, 0.0)}, "solve: rail_shift[0] = 0.0: must be (y, z) in m"),
        ({"rail_shift": ((0.0, 0.0), (0.0, 3.0))}, "solve: rail_shift[1] = 3.0: must be a number from -0.1 to 0.1 m"),
    ],
)
def test_invalid_arguments_are_named(arguments: dict[str, Any], says: str) -> None:
    element = standard().element()
    with pytest.raises(wr.SceneError) as caught:
        element.solve(**arguments)
    assert says in str(caught.value)


def test_unknown_arguments_and_tangential_displacements() -> None:
    with pytest.raises(TypeError, match="unexpected keyword argument 'y_speed'"):
        standard().element().solve(y_speed=1.0)  # type: ignore[call-arg]
    with pytest.raises(TypeError, match="unexpected keyword argument 'roll'"):
        hertz_element().solve(roll=1.0)  # type: ignore[call-arg]
    with pytest.raises(wr.SceneError, match="exactly one of load and approach"):
        wr.Hertz().element()
    with pytest.raises(wr.SceneError, match="shift: an element rolls"):
        wr.Hertz(shift=(1e-6, 0.0)).element(load=1e4)


@cache
def flexible() -> wr.Wheelset:
    return wr.Wheelset(
        "S1002", "UIC60-benchmark", friction=0.3, bodies="half-space", strips=6, cells=8, axle=True, pads=True
    )


LOADED = {"y": 2e-3, "z": -6e-4, "roll": 1e-4, "yaw": 1e-3, "speed": 20.0}


@cache
def landed() -> wr.WheelsetElement:
    """An element with axle and pads, and the accepted state of its first solve, which takes seconds."""
    element = flexible().element()
    assert element.solve(**LOADED).ok
    element.accept()
    return element


def test_an_element_with_axle_and_pads_is_the_wheelset_under_the_same_loads() -> None:
    element = landed()
    solution = element.solve(**LOADED)
    assert solution.ok
    hubs = {side: hub for side, (hub, _) in element.motions().items()}
    left, right = hubs["left"], hubs["right"]
    # The line through the journals, by the motions of both hubs against it, to first order.
    on_journals = {
        "y": LOADED["y"] - 0.5 * (left[1] + right[1]),
        "z": LOADED["z"] - 0.5 * (left[2] + right[2]),
        "roll": LOADED["roll"] - (left[2] - right[2]) / 1.5,
        "yaw": LOADED["yaw"] + (left[0] - right[0]) / 1.5,
        "speed": 20.0,
    }
    expected = flexible().solve(**on_journals)
    for side in SIDES:
        force = expected.results[side].force
        np.testing.assert_allclose(solution.force[side], force, atol=2e-4 * force[2])
        np.testing.assert_allclose(hubs[side], expected.data["hub_motion"].sel(side=side), atol=1e-7)
        rail = element.motions()[side][1]
        np.testing.assert_allclose(rail, expected.data["rail_motion"].sel(side=side), atol=1e-7)


def test_the_tangent_of_an_element_has_hubs_and_rails_follow() -> None:
    element = landed()
    element.solve(**LOADED)
    slopes = element.tangent().values
    for name in ("z", "roll"):
        column, h, ends = element.solve(**LOADED).state.coordinates.index(name), 2e-6, []
        for sign in (1, -1):
            ends.append(wrench(element.solve(**{**LOADED, name: LOADED[name] + sign * h})))
        change = (ends[0] - ends[1]) / (2 * h)
        np.testing.assert_allclose(slopes[:, :, column], change, atol=0.01 * np.abs(change).max())
    assert -slopes[0, 2, 1] < 2.5e8  # N/m: pads, not the contact's 1e9


def test_a_restored_element_with_axle_and_pads_repeats_its_solves() -> None:
    element, other = landed(), flexible().element()
    other.restore(pickle.loads(pickle.dumps(element.state())))
    moved = {**LOADED, "y": 2.2e-3}
    np.testing.assert_array_equal(wrench(element.solve(**moved)), wrench(other.solve(**moved)))


def test_an_element_with_axle_and_pads_may_leave_the_rails() -> None:
    element = flexible().element()
    solution = element.solve(**{**LOADED, "z": 5e-3})
    assert solution.ok
    assert not wrench(solution).any()
    element.accept()
    assert element.solve(**LOADED).ok  # and land again
    rigid = wheelset().element()
    rigid.solve(**PLACE)
    with pytest.raises(ValueError, match="rigid"):
        rigid.motions()


@cache
def waveguides() -> wr.Wheelset:
    return wr.Wheelset("S1002", "UIC60-benchmark", friction=0.3, strips=8, cells=8)


def test_a_host_that_moves_rims_and_rails_as_clamped_bodies_would_finds_the_same_forces() -> None:
    """What is taken out of the contact comes back as the motion that the host gives, by loads in closed form."""
    plain, hosted = waveguides().element(), waveguides().element(host=["wheels", "rails"])
    place = {"y": 2e-3, "z": -3e-4, "speed": 20.0}
    solution, contact = plain.solve(**place), hosted.contact
    assert isinstance(contact, QuasiStaticContact)
    wheels, rails = [], []
    for index, (side, sign) in enumerate((("left", 1.0), ("right", -1.0))):
        force, moment = solution.force[side], solution.moment[side]
        about_wheel = moment - np.cross([0.0, sign * 0.75, 0.0], force)
        rim = -contact.wheelset.flexibility.matrix[6 * index : 6 * index + 6, 6 * index : 6 * index + 6]
        mirror = np.array([1, -1, 1, -1, 1, -1]) if index else np.ones(6)
        wheels.append(mirror * (rim @ (mirror * np.concatenate([force, about_wheel]))))
        mounting, at = waveguides().mounting, 12 + 3 * index
        foot_y, foot_z = contact.wheelset.flexibility.foot(index)
        centre = np.array([0.0, place["y"], mounting.radius + place["z"]])
        foot = np.array([0.0, sign * (mounting.rail_y + foot_y), foot_z])
        about_foot = moment + np.cross(centre - foot, force)
        mirror = np.array([-1, 1, -1]) if index else np.ones(3)
        loads = -np.array([force[1], force[2], about_foot[0]])
        rails.append(mirror * (-contact.wheelset.flexibility.matrix[at : at + 3, at : at + 3] @ (mirror * loads)))
    again = hosted.solve(**place, wheel_motion=wheels, rail_motion=rails)
    still = hosted.solve(**place)  # rims and rails that do not give way
    for side in ("left", "right"):
        load = solution.force[side][2]
        np.testing.assert_allclose(again.force[side], solution.force[side], atol=2e-6 * load)
    assert still.force["left"][2] > 1.2 * solution.force["left"][2]


def test_tangent_by_given_motions() -> None:
    element = flexible_host().element(host=["axle", "rails"])
    place = {"y": 2e-3, "z": -3e-4, "speed": 20.0}
    element.solve(**place)
    element.accept()
    tangent = element.tangent()
    assert tangent.values.shape == (2, 6, 27)
    column, h = element.solve(**place).state.coordinates.index("right_rail_z"), 1e-6
    ends = [wrench(element.solve(**place, rail_motion=((0.0, 0.0, 0.0), (0.0, sign * h, 0.0)))) for sign in (1.0, -1.0)]
    change = (ends[0] - ends[1]) / (2 * h)
    np.testing.assert_allclose(tangent.values[:, :, column], change, atol=0.01 * np.abs(change).max())


def flexible_host() -> wr.Wheelset:
    return wr.Wheelset("S1002", "UIC60-benchmark", friction=0.3, bodies="half-space", strips=6, cells=8)


def test_hosts_are_refused_where_bodies_would_count_twice() -> None:
    with pytest.raises(wr.SceneError, match="not allowed with axle or pads"):
        flexible().element(host=["rails"])
    with pytest.raises(wr.SceneError, match="axle, wheels or rails"):
        flexible_host().element(host=["bogie"])  # type: ignore[list-item]
    with pytest.raises(wr.SceneError, match="rail_motion"):
        flexible_host().element().solve(y=0.0, z=-3e-4, speed=20.0, rail_motion=((0, 0, 0), (0, 0, 0)))
    with pytest.raises(wr.SceneError, match=r"wheel_motion\[0\]"):
        flexible_host().element(host=["wheels"]).solve(z=-3e-4, speed=20.0, wheel_motion=((1e-3,), (1e-3,)))
