"""Curves of street tracks: a bogie of 1.8 m with independent wheels at R = 25 and 15 m, on the standard contact."""

from __future__ import annotations

import warnings
from copy import deepcopy
from functools import cache

import numpy as np
import pytest

from benchmarks.vehicle_complete import TRAM
from wheelrail.contact.kinematics.frames import Side
from wheelrail.contact.results.result import Patch
from wheelrail.scenes.builders.vehicle_file import MANCHESTER, parse_vehicle
from wheelrail.scenes.builders.wheelset import run_contact
from wheelrail.scenes.schema.errors import SceneError
from wheelrail.scenes.schema.scene import RunScene, parse_scene, warned
from wheelrail.vehicle.integration.integrate import StepSettings
from wheelrail.vehicle.multibody.equations import VehicleDynamics, WheelContacts
from wheelrail.vehicle.multibody.wheel_forces import check_rail_force
from wheelrail.vehicle.simulation.checkpoint import Checkpoint, Checkpoints
from wheelrail.vehicle.simulation.simulate import simulate
from wheelrail.vehicle.simulation.time_run import Recording
from wheelrail.vehicle.steady.equilibrium import equilibrium
from wheelrail.vehicle.track.alignment import Segment
from wheelrail.vehicle.track.constant_curve import ConstantCurve
from wheelrail.vehicle.track.piecewise import PiecewiseFunction
from wheelrail.vehicle.track.track import Track

V, MASS = 3.0, 14400.0
SCENE = (MANCHESTER.parent / "vehicle.toml").read_text(encoding="utf-8")


@cache
def scene(text: str = SCENE) -> RunScene:
    found = parse_scene(text, "tram.toml")
    assert isinstance(found, RunScene)
    return found


def bogie(track: Track, keys: str = "") -> VehicleDynamics:
    """On the standard contact, with keys of check rails."""
    own = scene(SCENE.replace("[wheelset]", f"check_rail = {{ {keys} }}\n[wheelset]") if keys else SCENE)
    return VehicleDynamics(parse_vehicle(TRAM, "bogie.toml"), track, run_contact(own, ())[0], V)


def lateral(contacts: WheelContacts) -> float:
    return sum(float(result.force[1]) for sides in contacts.values() for result in sides.values())


@pytest.mark.parametrize(("radius", "widening"), [(25.0, 0.0), (15.0, 0.0), (15.0, 0.008)])
def test_the_wheels_carry_the_centrifugal_force(radius: float, widening: float) -> None:
    """Lateral forces are those in the frames of the wheelsets, 0.9 m from the middle: R less by 0.9^2 / 2 R^2."""
    at = equilibrium(bogie(ConstantCurve(V, 1 / radius, widening=widening).track))
    assert lateral(at.contacts) == pytest.approx(MASS * V**2 / radius, rel=1e-2)
    front, rear = at.dynamics.wheelset_states(0.0, at.state).values()
    assert front.yaw == pytest.approx(-0.9 / radius + (front.y - rear.y) / 1.8, abs=5e-4)  # of a stiff bogie
    for state in (front, rear):
        assert state.twist_rate / state.pitch_rate == pytest.approx(-0.75 / radius, rel=0.3)


def test_a_run_into_a_curve_of_25_m_ends_in_its_equilibrium() -> None:
    track = Track.of([Segment("transition", 10.0), Segment("arc", 10.0, 1 / 25)])
    run = simulate(bogie(track), (0.0, 6.0), steps=StepSettings("rosenbrock", 3e-3, 3e-5))
    assert run.status == "completed"
    at = equilibrium(bogie(ConstantCurve(V, 1 / 25).track))
    expected = at.dynamics.wheelset_states(0.0, at.state)
    for name, state in run.dynamics.wheelset_states(6.0, run.rows[-1].state).items():
        assert (state.y, state.yaw) == pytest.approx((expected[name].y, expected[name].yaw), abs=1e-4)
        assert state.twist_rate == pytest.approx(expected[name].twist_rate, rel=1e-2)


def on_check_rails(contacts: WheelContacts, name: str, side: Side) -> list[Patch]:
    """Patches of the flange's back of a wheel."""
    return [patch for patch in contacts[name][side].patches if check_rail_force([patch], side)]


@pytest.mark.parametrize("stiffness", [20e6, 200e6])
def test_check_rails_take_the_flange_off_the_outer_rail(stiffness: float) -> None:
    """The sum of Y stays m V^2 / R; the force is that of the spring and of Hertz, at the end of the chord ahead."""
    keys = f"flangeway = 0.0425, stiffness = {stiffness}, friction = 0.15"
    curve = ConstantCurve(V, 1 / 25).track
    free, at = equilibrium(bogie(curve)), equilibrium(bogie(curve, keys))
    assert lateral(at.contacts) == pytest.approx(MASS * V**2 / 25, rel=1e-2)
    outer = [min(patch.contact_angle for patch in own.contacts["front"]["right"].patches) for own in (free, at)]
    assert outer[0] < -1.0 < -0.2 < outer[1]  # on the flange, and off
    (patch,) = on_check_rails(at.contacts, "front", "left")
    # the edge of the disc (radius 0.4695, rounding 0.0205 m) touches that of the rail (0.01 m) at an angle to the face
    height = 0.46 + 0.01 - 0.0305 * np.sin(0.5 * np.pi + patch.contact_angle)
    yaw = at.dynamics.wheelset_states(0.0, at.state)["front"].yaw
    assert patch.x == pytest.approx(np.sqrt(0.4695**2 - height**2) - 0.7 * yaw, abs=4e-3)
    assert patch.force[1] > 15e3
    assert not on_check_rails(at.contacts, "front", "right")


def test_a_run_on_check_rails_ends_in_its_equilibrium_and_mirrors() -> None:
    keys, ends = "flangeway = 0.044, stiffness = 50e6, friction = 0.15", []
    for hand in (1.0, -1.0):
        d = bogie(Track.of([Segment("transition", 8.0), Segment("arc", 10.0, hand / 25)]), keys)
        run = simulate(d, (0.0, 5.0), steps=StepSettings("rosenbrock", 3e-3, 3e-5))
        assert run.status == "completed"
        ends.append(run)
    assert np.array_equal(ends[0].force * [1.0, -1.0, 1.0], ends[1].force[:, :, ::-1])
    at = equilibrium(bogie(ConstantCurve(V, 1 / 25).track, keys))
    expected = at.dynamics.wheelset_states(0.0, at.state)
    for name, state in ends[0].dynamics.wheelset_states(5.0, ends[0].rows[-1].state).items():
        assert (state.y, state.yaw) == pytest.approx((expected[name].y, expected[name].yaw), abs=1e-4)
    assert on_check_rails(at.contacts, "front", "left")
    assert on_check_rails(at.contacts, "rear", "right")


def test_distant_check_rails_change_no_bit() -> None:
    track = Track.of([Segment("transition", 0.5), Segment("arc", 10.0, 1 / 100)])
    steps = StepSettings("rosenbrock", 3e-3, 3e-5)
    free, far = (simulate(bogie(track, keys), (0.0, 0.3), steps=steps) for keys in ("", "flangeway = 0.08"))
    assert np.array_equal(free.state, far.state)
    assert np.array_equal(free.force, far.force)


@pytest.mark.parametrize(
    ("keys", "message"),
    [
        (
            "flangeway = 0.037",
            r"flangeway = 0.037: must be greater than 0.0375 m, at which flanges of a centred",
        ),
        ("flangeway = 41.0", r"flangeway = 41.0: must be a number from 0.02 to 0.2 m \(41 mm is 0.041\)"),
        ("height = 0.0", r"check_rail.flangeway: missing"),
        ("flangeway = 0.041, stiffness = 50.0", r"stiffness = 50.0: must be a number from 100000 to 1e\+12 N/m"),
        (
            "flangeway = 0.041, back_height = 0.01",
            r"back_rounding: missing: back_height and back_rounding are",
        ),
        ('flangeway = 0.041, sides = ["left", "left"]', r"sides = .*: must contain each side at most once"),
    ],
)
def test_check_rails_that_do_not_fit_are_refused(keys: str, message: str) -> None:
    with pytest.raises(SceneError, match=r"tram.toml: track.check_rail." + message.removeprefix("check_rail.")):
        bogie(ConstantCurve(V, 0.04).track, keys)


def test_a_resumed_run_repeats_the_whole_one_to_the_last_bit() -> None:
    """With independent wheels, check rails, a gauge that widens and friction that falls."""
    segments = [Segment("transition", 1.0), Segment("arc", 10.0, 1 / 100, widening=0.01)]
    d = bogie(Track.of(segments, friction=PiecewiseFunction((0.5, 1.5), (1.0, 0.5))), "flangeway = 0.039")
    written, steps = list[Checkpoint](), StepSettings("rosenbrock", 3e-3, 3e-5)
    every = Checkpoints(30, lambda at: written.append(deepcopy(at)))
    whole = simulate(d, (0.0, 0.35), steps=steps, recording=Recording(checkpoints=every))
    assert whole.status == "completed"
    again = Recording(checkpoints=Checkpoints(30, lambda _: None, written[2]))
    resumed = simulate(d, (0.0, 0.35), steps=steps, recording=again)
    assert np.array_equal(resumed.state, whole.state)
    assert np.array_equal(resumed.force, whole.force)
    assert np.abs(whole.state[-1, d.coordinates.twist_rates]).min() > 1e-3
    assert sum(check_rail_force(row.patches[0][0], "left") > 0.0 for row in whole.rows[90:]) > 5


def test_tables_in_sharp_curves_warn_of_straight_rails() -> None:
    elastic = (
        SCENE.replace('model = "standard"', 'model = "condensed"\nlaws = "exact"\nsurface_size = 1e-3')
        + "[tabulated]\n"
    )
    for curvature, said in (("-0.04", True), ("-0.01", False)):
        own = scene(elastic.replace("curvature = 1.6666666666666667e-3", f"curvature = {curvature}"))
        with warnings.catch_warnings(record=True) as seen:
            warnings.simplefilter("always")
            warned(own, "sharp.toml")
        assert [str(one.message).startswith("sharp.toml: track: tables of forces") for one in seen] == [True] * said
    with pytest.raises(SceneError, match=r"track.curvature = 0.07: must be a number from -0.067 to 0.067 1/m"):
        scene(SCENE.replace("curvature = 1.6666666666666667e-3", "curvature = 0.07"))
