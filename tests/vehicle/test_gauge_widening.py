"""Gauge that widens by segments: places of the rails, equilibria, steps, mirror image, invalid values."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from linear_creep import LinearCreep

from wheelrail.scenes.builders.vehicle_file import MANCHESTER, load_vehicle
from wheelrail.scenes.builders.wheelset import wheelset_contact
from wheelrail.scenes.runs.steady import curve_of
from wheelrail.scenes.schema.errors import SceneError
from wheelrail.scenes.schema.scene import RunScene, parse_scene
from wheelrail.vehicle.integration.integrate import StepSettings
from wheelrail.vehicle.multibody.coordinates import Y
from wheelrail.vehicle.multibody.equations import VehicleDynamics, side_wrenches
from wheelrail.vehicle.simulation.excitation import Excitation
from wheelrail.vehicle.simulation.simulate import simulate
from wheelrail.vehicle.steady.equilibrium import equilibrium
from wheelrail.vehicle.track.alignment import AlignmentError, Segment
from wheelrail.vehicle.track.constant_curve import ConstantCurve
from wheelrail.vehicle.track.irregularity import Irregularities
from wheelrail.vehicle.track.track import Track

SCENE = (MANCHESTER.parent / "vehicle.toml").read_text(encoding="utf-8")
STEPS = StepSettings("rosenbrock", 3e-3, 3e-5)
WIDE = [Segment("tangent", 20.0), Segment("transition", 10.0), Segment("arc", 50.0, 1 / 300, 0.05, widening=0.016)]


def scene(text: str) -> RunScene:
    found = parse_scene(text, "scene.toml")
    assert isinstance(found, RunScene)
    return found


def test_each_rail_moves_by_half() -> None:
    track = Track.of(WIDE)
    assert track.rails(10.0) == ((0.0, 0.0), (0.0, 0.0))
    assert track.rails(25.0) == ((pytest.approx(4e-3), 0.0), (pytest.approx(-4e-3), 0.0))  # half of a quintic ramp
    assert track.rails(60.0) == ((8e-3, 0.0), (-8e-3, 0.0))
    s, h = np.array([23.0, 28.5]), 1e-5
    found = [np.ravel([track.rails(x + h) for x in s.tolist()]), np.ravel([track.rails(x - h) for x in s.tolist()])]
    assert track.rail_slopes(s).ravel() == pytest.approx((found[0] - found[1]) / (2 * h), abs=1e-8)
    assert not Track.of([replace(part, widening=None) for part in WIDE]).moves_rails


def test_widening_adds_to_irregularities() -> None:
    values = np.zeros((41, 4))
    values[10:30] = [1e-3, 2e-3, 3e-3, 4e-3]
    rough = Irregularities(np.linspace(0.0, 80.0, 41), values)
    both, alone = Track.of(WIDE, irregularities=rough), Track.of(WIDE)
    left, right = np.array(both.rails(40.0)) - np.array(rough.rails(40.0)) - np.array(alone.rails(40.0))
    assert np.abs([left, right]).max() < 1e-18
    s = np.array([27.0, 40.0])
    assert both.rail_slopes(s) == pytest.approx(rough.derivatives(s)[1] + alone.rail_slopes(s), abs=1e-15)


@pytest.mark.parametrize("widening", [0.004, 0.013])
def test_a_gauge_that_is_widened_is_a_wider_gauge(widening: float) -> None:
    """Equilibria in a curve against those on rails that are mounted so far apart."""
    own, speed = load_vehicle(), 25.0
    wide = SCENE.replace("gauge = 1.435", f"gauge = {1.435 + widening}")
    at = []
    for text, extra in ((SCENE, widening), (wide, 0.0)):
        track = ConstantCurve(speed, 1 / 300, 0.1, widening=extra).track
        at.append(equilibrium(VehicleDynamics(own, track, wheelset_contact(scene(text)), speed)))
    here, there = at
    assert here.state == pytest.approx(there.state, abs=2e-7)
    for name, sides in here.contacts.items():
        assert side_wrenches(sides) == pytest.approx(side_wrenches(there.contacts[name]), abs=5.0)


def test_a_scene_widens_the_gauge_of_its_segments() -> None:
    head = SCENE[: SCENE.index("curvature = 1.6")] + "cant_base = 1.5\n" + SCENE[SCENE.index("[wheelset]") :]
    layout = '[[track.segments]]\nkind = "transition"\nlength = 20.0\n[[track.segments]]\nkind = "arc"\nlength = 50.0\n'
    found = scene(f"{head}{layout}radius = 300.0\nwidening = 0.01\n")
    assert found.track.track().widening(40.0)[0] == 0.01
    assert curve_of(found).widening == 0.01
    with pytest.raises(SceneError, match=r"widening = 10.0: must be a number from 0 to 0.05 m"):
        scene(f"{head}{layout}radius = 300.0\nwidening = 10.0\n")


def test_widening_of_tangents_and_jumps_are_refused() -> None:
    with pytest.raises(AlignmentError, match="segment 0, counted from 0, widening: must be 0 or left out"):
        Track.of([Segment("tangent", 20.0, widening=0.01)])
    with pytest.raises(AlignmentError, match=r"segment 1, counted from 0, widening: jumps .* 0.01 m of widening"):
        Track.of([Segment("arc", 20.0, 1 / 300), Segment("arc", 20.0, 1 / 300, widening=0.01)])
    with pytest.raises(AlignmentError, match="must not be negative"):
        Track.of([Segment("arc", 20.0, 1 / 300, widening=-0.01)])


def test_steps_meet_a_change_of_the_gauge_alone() -> None:
    """Between arcs of the same curvature nothing else changes."""
    own = load_vehicle()
    arcs = [
        Segment("arc", 100.0, 1 / 600, 0.1),
        Segment("transition", 2.0, 1 / 600, 0.1, widening=0.02),
        Segment("arc", 100.0, 1 / 600, 0.1, widening=0.02),
    ]
    d = VehicleDynamics(own, Track.of(arcs), LinearCreep(load=own.mean_wheel_load), 25.0)
    state = np.zeros(d.size)
    meets = Excitation(d, 1e-5)
    assert meets.longest_step(0.0, state, d(0.0, state), 20.0) * 25.0 < 110.0
    without = replace(d, track=Track.of([replace(part, widening=None) for part in arcs]))
    assert Excitation(without, 1e-5).longest_step(0.0, state, d(0.0, state), 20.0) == 20.0


def test_a_run_into_a_widened_curve_is_the_mirror_image_bit_by_bit() -> None:
    own, contact, ends = load_vehicle(), wheelset_contact(scene(SCENE)), []
    for way in (1.0, -1.0):
        segments = [
            replace(part, curvature=part.curvature and way * part.curvature)
            for part in (Segment("transition", 10.0), Segment("arc", 50.0, 1 / 300, 0.05, widening=0.016))
        ]
        run = simulate(VehicleDynamics(own, Track.of(segments), contact, 20.0), (0.0, 0.35), steps=STEPS)
        assert run.status == "completed"
        ends.append([run.position(name)[-1, Y] for name in own.names])
    assert np.array_equal(ends[0], -np.array(ends[1]))
    assert max(np.abs(ends[0])) > 2e-3
