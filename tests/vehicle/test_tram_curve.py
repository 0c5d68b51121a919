"""Curves of street tracks: a bogie of 1.8 m with independent wheels at R = 25 and 15 m, on the standard contact."""

from __future__ import annotations

from copy import deepcopy
from functools import cache

import numpy as np
import pytest

from benchmarks.vehicle_complete import TRAM
from wheelrail.scenes.builders.vehicle_file import MANCHESTER, parse_vehicle
from wheelrail.scenes.builders.wheelset import wheelset_contact
from wheelrail.scenes.schema.errors import SceneError
from wheelrail.scenes.schema.messages import warn_of_unusual
from wheelrail.scenes.schema.scene import RunScene, parse_scene
from wheelrail.vehicle.integration.integrate import StepSettings
from wheelrail.vehicle.multibody.equations import VehicleDynamics, WheelContacts
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


def bogie(track: Track) -> VehicleDynamics:
    return VehicleDynamics(parse_vehicle(TRAM, "bogie.toml"), track, wheelset_contact(scene()), V)


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


def test_a_resumed_run_repeats_the_whole_one_to_the_last_bit() -> None:
    """With independent wheels, a gauge that widens and friction that falls."""
    segments = [Segment("transition", 3.0), Segment("arc", 10.0, 1 / 100, widening=0.01)]
    d = bogie(Track.of(segments, friction=PiecewiseFunction((2.0, 3.0), (1.0, 0.5))))
    written, steps = list[Checkpoint](), StepSettings("rosenbrock", 3e-3, 3e-5)
    every = Checkpoints(30, lambda at: written.append(deepcopy(at)))
    whole = simulate(d, (0.0, 1.5), steps=steps, recording=Recording(checkpoints=every))
    assert whole.status == "completed"
    again = Recording(checkpoints=Checkpoints(30, lambda _: None, written[0]))
    resumed = simulate(d, (0.0, 1.5), steps=steps, recording=again)
    assert np.array_equal(resumed.state, whole.state)
    assert np.array_equal(resumed.force, whole.force)
    assert np.abs(whole.state[-1, d.coordinates.twist_rates]).min() > 1e-3


def test_scenes_of_sharp_curves_name_what_is_neglected() -> None:
    """k x^2 / 2 at 28 mm."""
    sharp = SCENE.replace("curvature = 1.6666666666666667e-3", "curvature = -0.04")
    with pytest.warns(UserWarning, match=r"track.curvature = -0.04: below 50 m: .* straight, 16 um at a flange 28 mm"):
        warn_of_unusual(scene(sharp), "sharp.toml")
    with pytest.raises(SceneError, match=r"track.curvature = 0.07: must be a number from -0.067 to 0.067 1/m"):
        scene(SCENE.replace("curvature = 1.6666666666666667e-3", "curvature = 0.07"))
