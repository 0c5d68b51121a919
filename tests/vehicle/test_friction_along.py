"""Friction that changes along the track: factors, equilibria, derivatives by time, steps, invalid values."""

from __future__ import annotations

from dataclasses import replace
from functools import cache

import numpy as np
import pytest
from linear_creep import LinearCreep

from wheelrail.contact.kinematics.wheelset_state import WheelsetState
from wheelrail.contact.laws.friction import Coulomb, FallingFriction, Stribeck, scaled
from wheelrail.contact.results.result import Patch
from wheelrail.scenes.builders.vehicle_file import MANCHESTER, load_vehicle
from wheelrail.scenes.builders.wheelset import run_contact
from wheelrail.scenes.runs.steady import curve_of
from wheelrail.scenes.schema.errors import SceneError
from wheelrail.scenes.schema.scene import RunScene, parse_scene
from wheelrail.scenes.wear.lifted import LiftedContact
from wheelrail.vehicle.integration.integrate import StepSettings
from wheelrail.vehicle.integration.step_control import StepStatistics
from wheelrail.vehicle.multibody.coordinates import Y
from wheelrail.vehicle.multibody.equations import VehicleDynamics, side_wrenches
from wheelrail.vehicle.multibody.jacobian import VehicleJacobian
from wheelrail.vehicle.simulation.excitation import Excitation
from wheelrail.vehicle.simulation.simulate import simulate
from wheelrail.vehicle.steady.equilibrium import equilibrium
from wheelrail.vehicle.track.constant_curve import ConstantCurve
from wheelrail.vehicle.track.piecewise import PiecewiseFunction
from wheelrail.vehicle.track.track import Track

SCENE = (MANCHESTER.parent / "vehicle.toml").read_text(encoding="utf-8")
PADS = "[track.pads]\nvertical = 100e6\nlateral = 40e6\n"
WET = PiecewiseFunction((20.0, 25.0, 40.0, 45.0), (1.0, 0.4, 0.4, 1.0))
V = 20.0


@cache
def scene(text: str) -> RunScene:
    found = parse_scene(text, "scene.toml")
    assert isinstance(found, RunScene)
    return found


def dynamics(text: str, track: Track) -> VehicleDynamics:
    own = load_vehicle()
    contact, structures = run_contact(scene(text), own.wheelsets)
    return VehicleDynamics(own, track, contact, V, structures)


@pytest.mark.parametrize(
    ("law", "expected"),
    [
        (Coulomb(0.3), Coulomb(0.15)),
        (FallingFriction(0.4, 0.5, 0.6), FallingFriction(0.2, 0.5, 0.6)),
        (Stribeck(0.4, 0.2, 1.0), Stribeck(0.2, 0.1, 1.0)),
    ],
)
def test_a_factor_multiplies_the_coefficient(law: Coulomb, expected: Coulomb) -> None:
    assert scaled(law, 0.5) == expected


@pytest.mark.parametrize(
    "text", [SCENE, SCENE + PADS, SCENE.replace('"standard"', '"standard"\ntangential = "polach"')]
)
def test_a_curve_with_a_third_of_the_friction_is_that_of_a_scene_with_it(text: str) -> None:
    at = []
    for own, factor in ((text, 1.0 / 3.0), (text.replace("friction = 0.3", "friction = 0.1"), 1.0)):
        at.append(equilibrium(dynamics(own, ConstantCurve(V, 1 / 300, 0.1, friction=factor).track)))
    less, low = at
    assert less.state == pytest.approx(low.state, abs=1e-9)
    for name, sides in less.contacts.items():
        assert side_wrenches(sides) == pytest.approx(side_wrenches(low.contacts[name]), abs=1e-2)


def test_each_wheelset_has_the_friction_of_its_place() -> None:
    d = dynamics(SCENE, replace(Track(), friction=WET))
    for time in (0.5, 1.3, 1.9):
        for name, state in d.wheelset_states(time, np.zeros(d.size)).items():
            assert state.friction == WET(V * time + d.vehicle.bodies[name].x)[0]
            assert state.mirrored().friction == state.friction


@pytest.mark.parametrize("text", [SCENE, SCENE + PADS])
def test_derivative_by_time_on_a_ramp(text: str) -> None:
    """All wheelsets that slide on ramps, against differences of the rates over time on straight track."""
    d = dynamics(text, replace(Track(), friction=WET))
    state = equilibrium(dynamics(text, Track())).state
    c = d.coordinates
    state[c.count + np.array([c.index(name, 5) for name in d.vehicle.wheelsets])] = 0.05
    time, h = (22.0 - d.vehicle.bodies["wheelset_1"].x) / V, 1e-4
    at = d(time, state)
    found = VehicleJacobian(d, StepStatistics())(time, state, at).by_time
    expected = (d(time + h, state, at).rate - d(time - h, state, at).rate) / (2 * h)
    assert np.abs(expected).max() > 1e-2
    assert found == pytest.approx(expected, rel=1e-2, abs=5e-3 * np.abs(expected).max())


def test_steps_meet_a_wet_place() -> None:
    own = load_vehicle()
    d = VehicleDynamics(own, replace(Track(), friction=WET), LinearCreep(load=own.mean_wheel_load), V)
    state = np.zeros(d.size)
    dry = replace(d, track=Track())
    at = dry(0.0, state)
    assert Excitation(dry, 1e-5).longest_step(0.0, state, at, 10.0) == 10.0
    assert V * Excitation(d, 1e-5).longest_step(0.0, state, at, 10.0) < 30.0


def test_a_run_over_a_wet_place_in_a_curve() -> None:
    """Tangential forces of the front wheelset are bounded by the friction of its place."""
    curve = ConstantCurve(V, 1 / 300, 0.1).track
    wet, dry = (dynamics(SCENE, replace(curve, friction=f)) for f in (WET, curve.friction))
    start = equilibrium(dry).state
    runs = [simulate(d, (0.0, 1.6), initial=start, steps=StepSettings("rosenbrock", 3e-3, 3e-5)) for d in (wet, dry)]
    assert [run.status for run in runs] == ["completed"] * 2
    places = V * runs[0].time + load_vehicle().bodies["wheelset_1"].x
    inside = [row for row, at in zip(runs[0].rows, places.tolist(), strict=True) if 27.0 < at < 39.0]
    assert len(inside) > 2
    used = [_used(patch) for row in inside for own in row.patches[0] for patch in own]
    assert 0.1 < max(used) <= 0.3 * 0.4 * (1 + 1e-9)
    assert max(_used(patch) for patch in runs[1].rows[-1].patches[0][1]) > 0.2


def test_contacts_on_changing_friction_are_solved_in_all_stages() -> None:
    d = dynamics(SCENE, replace(Track(), friction=WET))
    start = equilibrium(replace(d, track=Track())).state
    start[d.coordinates.index("wheelset_1", Y)] = 2e-3
    own, plain = (
        simulate(d, (0.6, 0.8), initial=start, steps=StepSettings(method, 3e-3, 3e-5))
        for method in ("rosenbrock_ends", "rosenbrock")
    )
    assert np.array_equal(own.state, plain.state)


def test_wear_has_the_friction_of_the_place() -> None:
    own = scene(SCENE)
    contact, _ = run_contact(own, ["wheelset_1"])
    found = []
    for mu, factor in ((own, 0.5), (scene(SCENE.replace("friction = 0.3", "friction = 0.15")), 1.0)):
        model, _ = run_contact(mu, ["wheelset_1"])
        state = WheelsetState(y=2e-3, z=-2e-4, yaw=4e-3, speed=V, pitch_rate=V / 0.46, friction=factor)
        at = {"wheelset_1": {"left": contact(state, "left")}}
        motion = LiftedContact(mu, {"wheelset_1": model}, model).motion()
        found.append(motion.results({"wheelset_1": state}, at)["wheelset_1"]["left"].force)
    assert found[0] == pytest.approx(found[1], rel=1e-6)


def _used(patch: Patch) -> float:
    return float(np.hypot(*patch.tangential_force)) / patch.normal_force


def test_friction_of_a_scene_and_its_mistakes() -> None:
    own = SCENE.replace("gauge = 1.435", "friction = [[0, 1.0], [100.0, 1], [110.0, 0.5]]\ngauge = 1.435")
    assert scene(own).track.track().friction(220.0)[0] == 0.5
    assert curve_of(scene(own)).friction == 0.5
    for points, message in (
        ("[[0, 1.0], [0, 0.5]]", r"track.friction = .*: distances must increase by at least 0.1 m"),
        ("[[0, 0.0]]", r"track.friction\[0\]\[1\] = 0.0: must be a number from 0.01 to 10 "),
        ("[]", "track.friction"),
    ):
        with pytest.raises(SceneError, match=message):
            scene(own.replace("[[0, 1.0], [100.0, 1], [110.0, 0.5]]", points))
    hertz = own.replace('"standard"', '"condensed"\nsurface_size = 1e-3\npoints = "grid"')
    with pytest.raises(SceneError, match=r"track.friction: friction along the track: not with CondensedContact"):
        run_contact(scene(hertz), ["wheelset_1"])


def test_contacts_without_a_coefficient_are_refused() -> None:
    own = load_vehicle()
    d = VehicleDynamics(own, ConstantCurve(V, 1 / 300, friction=0.5).track, LinearCreep(load=own.mean_wheel_load), V)
    with pytest.raises(ValueError, match="friction along the track: not with LinearCreep"):
        d.element.contact.rubbing(0.5)
    with pytest.raises(ValueError, match=r"must be positive and finite factors"):
        Track(friction=PiecewiseFunction.constant(0.0))
