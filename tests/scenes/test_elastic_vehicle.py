"""Scenes of vehicle files with elastic axles and tracks: of all wheelsets, and of single ones."""

from __future__ import annotations

from copy import deepcopy
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from plane import mirror_signs

from wheelrail.contact.loading.co_running_structure import CoRunningStructure
from wheelrail.contact.loading.flexible_contact import FlexibleContact
from wheelrail.contact.loading.quasi_static_structure import QuasiStaticStructure
from wheelrail.scenes.builders.vehicle import vehicle_on
from wheelrail.scenes.builders.wheelset import run_contact
from wheelrail.scenes.datasets.run import dataset
from wheelrail.scenes.runs.resume import inputs
from wheelrail.scenes.schema.errors import SceneError
from wheelrail.scenes.schema.scene import RunScene, parse_scene
from wheelrail.vehicle.integration.integrate import StepSettings
from wheelrail.vehicle.multibody.equations import VehicleDynamics
from wheelrail.vehicle.simulation.checkpoint import Checkpoint, Checkpoints
from wheelrail.vehicle.simulation.simulate import simulate
from wheelrail.vehicle.simulation.time_run import Recording
from wheelrail.vehicle.steady.equilibrium import equilibrium
from wheelrail.vehicle.track.constant_curve import ConstantCurve
from wheelrail.vehicle.track.track import Track

SCENES = Path(__file__).parents[2] / "scenes"
FILE = SCENES / "manchester_vehicle.toml"
OWN = """
[track.pads]
[wheelset.axle]
[wheelsets.wheelset_1]
ballast = true
[wheelsets.wheelset_2]
axle = false
pads = false
[wheelsets.wheelset_3]
axle = { weight = false }
"""


def scene(keys: str = "") -> RunScene:
    text = (SCENES / "vehicle_elastic.toml").read_text().replace("strips = 8 ", "strips = 4 ")
    parsed = parse_scene(text + keys, SCENES / "scene.toml")
    assert isinstance(parsed, RunScene)
    return parsed


def test_wheelsets_have_their_own_structures_and_results() -> None:
    vehicle = vehicle_on(scene(OWN), FILE)
    contact, structures = run_contact(scene(OWN), vehicle.wheelsets)
    assert isinstance(contact, FlexibleContact)
    first, second, third, fourth = structures or ()
    assert isinstance(first, CoRunningStructure)
    assert second is None
    assert isinstance(third, QuasiStaticStructure)
    assert isinstance(fourth, QuasiStaticStructure)
    assert not third.unloaded.any()
    assert fourth.unloaded.any()
    dynamics = VehicleDynamics(vehicle, Track(), contact, 30.0, structures)
    assert dynamics.size == dynamics.coordinates.size + 32 + 18 + 18
    data = dataset(simulate(dynamics, (0.0, 2e-3), steps=StepSettings("rosenbrock", 1e-3, 1e-6)))
    absent = {name: np.isnan(data[name].values).all(axis=(0, 2, 3)) for name in ("hub_motion", "sleeper_motion")}
    assert absent["hub_motion"].tolist() == [False, True, False, False]
    assert absent["sleeper_motion"].tolist() == [False, True, True, True]
    z = data["body_z"].sel(body=list(vehicle.wheelsets)).values[0]
    assert 1e3 * z == pytest.approx([-0.762, -0.247, -0.540, -0.540], abs=0.01)  # of vehicles with four such wheelsets


def test_one_structure_serves_equal_wheelsets() -> None:
    _, structures = run_contact(scene("[track.pads]\n"), ("a", "b"))
    assert structures is not None
    assert structures[0] is structures[1]


@pytest.mark.parametrize(
    ("keys", "reason"),
    [
        ("[wheelsets.wheelset_1]\nballast = true\n", r"wheelsets\.wheelset_1\.ballast = true: allowed only with pads"),
        ("[track.pads]\n[track.sleepers]\n[wheelsets.a]\npads = false\n", r"wheelsets\.a\.sleepers.*pads"),
        ("[wheelsets.wheelset_1]\npad = true\n", r"wheelsets\.wheelset_1\.pad.*did you mean"),
    ],
)
def test_refuses_what_does_not_fit(keys: str, reason: str) -> None:
    with pytest.raises(SceneError, match=reason):
        scene(keys)


STANDARD = (SCENES / "vehicle.toml").read_text()


@pytest.mark.parametrize("key", ['normal = "hertz"', 'tangential = "polach"', "falling = { share = 0.5, rate = 0.1 }"])
def test_standard_contact_needs_derivatives_on_elastic_track(key: str) -> None:
    assert parse_scene(STANDARD + "[track.pads]\n", SCENES / "scene.toml").model == "standard"
    with pytest.raises(SceneError, match=r"track\.pads.*derivatives"):
        parse_scene(f"{key}\n{STANDARD}[track.pads]\n", SCENES / "scene.toml")


def test_standard_contact_on_elastic_axle_and_track() -> None:
    """The wheels carry the vehicle, which sinks by its track; mirrored curves have mirrored forces."""
    own = parse_scene(STANDARD + "[track.pads]\n[track.ballast]\n[wheelset.axle]\n", SCENES / "scene.toml")
    assert isinstance(own, RunScene)
    vehicle = vehicle_on(own, FILE)
    contact, structures = run_contact(own, vehicle.wheelsets)
    dynamics = VehicleDynamics(vehicle, Track(), contact, 25.0, structures)
    curves = [replace(dynamics, track=ConstantCurve(25.0, k, 0.1, 1.5).track) for k in (1 / 600, -1 / 600)]
    left, right = (equilibrium(curve) for curve in curves)
    forces = {name: (sides["left"].force, sides["right"].force) for name, sides in left.contacts.items()}
    for name, sides in right.contacts.items():
        np.testing.assert_allclose(sides["left"].force * [1, -1, 1], forces[name][1], rtol=1e-6, atol=1e-2)
    wheelset = [dynamics.coordinates.index("wheelset_1", k) for k in (1, 2)]
    assert 1e3 * left.state[wheelset[0]] == pytest.approx(-7.3, abs=0.2)
    straight = equilibrium(dynamics)
    assert 1e3 * straight.state[wheelset[1]] == pytest.approx(-0.76, abs=0.03)  # as with elastic contact
    load = sum(result.force[2] for sides in straight.contacts.values() for result in sides.values())
    assert load == pytest.approx(8 * vehicle.mean_wheel_load, abs=1.0)


def test_wheelsets_are_those_of_the_vehicle() -> None:
    other = scene("[wheelsets.front]\naxle = true\n")
    assert other.is_flexible
    assert other.keys_of_vehicle_files == ["wheelsets"]
    with pytest.raises(SceneError, match=r"wheelsets\.front: must be one of wheelset_1, .* the wheelsets of"):
        vehicle_on(other, FILE)


def test_a_wheelset_without_axle_is_another_run() -> None:
    whole, one = scene("[wheelset.axle]\n"), scene("[wheelset.axle]\n[wheelsets.wheelset_1]\naxle = false\n")
    assert inputs(one)["wheelsets"] == {"wheelset_1": {"axle": False}}
    assert "wheelsets" not in inputs(whole)


def test_resumed_runs_are_the_same_to_the_last_bit() -> None:
    own = parse_scene(STANDARD + "[track.pads]\n[track.ballast]\n[wheelset.axle]\n", SCENES / "scene.toml")
    assert isinstance(own, RunScene)
    vehicle = vehicle_on(own, FILE)
    contact, structures = run_contact(own, vehicle.wheelsets)
    track = Track.curve(curvature=1 / 600, cant=0.06, transition=15.0, length=50.0)
    dynamics, steps = VehicleDynamics(vehicle, track, contact, 45.0, structures), StepSettings("rosenbrock", 3e-3, 3e-5)
    written = list[Checkpoint]()
    every = Checkpoints(4, lambda own: written.append(deepcopy(own)))  # whose rows go on
    whole = simulate(dynamics, (0.0, 0.1), steps=steps, recording=Recording(None, every))
    assert len(written) > 2
    resumed = Recording(None, replace(every, latest=written[1]))
    again = simulate(dynamics, (0.0, 0.1), steps=steps, recording=resumed)
    np.testing.assert_array_equal(again.time, whole.time)
    np.testing.assert_array_equal(again.state, whole.state)
    np.testing.assert_array_equal(again.force, whole.force)


@pytest.mark.parametrize("kind", ["standard", "strips"])
def test_mirrored_runs_are_mirror_images_to_the_last_bit(kind: str) -> None:
    own = scene(OWN) if kind == "strips" else parse_scene(STANDARD + OWN, SCENES / "scene.toml")
    assert isinstance(own, RunScene)
    vehicle, runs = vehicle_on(own, FILE), []
    contact, structures = run_contact(own, vehicle.wheelsets)
    steps = StepSettings("rosenbrock", 3e-3, 3e-5)
    for hand in (1.0, -1.0):
        track = Track.curve(curvature=hand / 600, cant=0.06, transition=15.0, length=50.0)
        runs.append(simulate(VehicleDynamics(vehicle, track, contact, 45.0, structures), (0.0, 0.03), steps=steps))
    left, right = runs
    np.testing.assert_array_equal(right.time, left.time)
    d = left.dynamics
    np.testing.assert_array_equal(right.state, mirror_signs(d.coordinates, d.structures) * left.state)
    np.testing.assert_array_equal(right.force[:, :, ::-1], left.force * [1.0, -1.0, 1.0])
    assert np.abs(left.state[-1, 1]) > 1e-5
