"""Runs over discrete sleepers: the height of the rail, forces at the sleeper passing frequency, energy, Jacobian."""

from __future__ import annotations

from dataclasses import replace
from functools import cache
from pathlib import Path

import numpy as np
import pytest
from small_strips import few_strips

from wheelrail.contact.laws.material import Material
from wheelrail.contact.loading.co_running_structure import CoRunningStructure
from wheelrail.contact.loading.flexible_contact import FlexibleContact
from wheelrail.contact.loading.flexible_wheelset import Flexibility
from wheelrail.contact.loading.quasi_static_structure import QuasiStaticStructure
from wheelrail.contact.structure.ballast import Ballast
from wheelrail.contact.structure.ballasted_sleepers import sleeper_track
from wheelrail.contact.structure.pads import RailPads, rail_compliance
from wheelrail.contact.structure.sleepers import sleeper_compliance
from wheelrail.meshes.bodies.outlines import rail_outline
from wheelrail.meshes.profiles.named import named_profile
from wheelrail.scenes.builders.wheelset import flexibility, side_profiles
from wheelrail.scenes.schema.errors import SceneError
from wheelrail.scenes.schema.scene import RunScene, parse_scene
from wheelrail.vehicle.integration.integrate import StepSettings
from wheelrail.vehicle.integration.step_control import StepStatistics
from wheelrail.vehicle.multibody.equations import VehicleDynamics
from wheelrail.vehicle.multibody.jacobian import VehicleJacobian
from wheelrail.vehicle.multibody.plane_wagon import COUNT, wagon_dynamics
from wheelrail.vehicle.simulation.energy_balance import EnergyBalance, energy_balance
from wheelrail.vehicle.simulation.history import History
from wheelrail.vehicle.simulation.simulate import simulate
from wheelrail.vehicle.track.track import Track
from wheelrail.vehicle.wagon.wagon import Wagon

SPACING = 0.6  # m


@cache
def contact() -> FlexibleContact:
    rail = sleeper_compliance(rail_outline(named_profile("UIC60-benchmark")), Material(), RailPads())
    return FlexibleContact(few_strips(), Flexibility(None, (rail, rail)))


@cache
def on_ballast() -> CoRunningStructure:
    outline = rail_outline(named_profile("UIC60-benchmark"))
    track = sleeper_track(outline, Material(), RailPads(), Ballast())
    pairs = replace(contact().pairs, flexibility=Flexibility(None, (track.rail, track.rail)))
    return CoRunningStructure(pairs, tracks=(track, track))


def dynamics(speed: float, ballast: bool = False) -> VehicleDynamics:
    structure = on_ballast() if ballast else QuasiStaticStructure(contact().pairs)
    moving = FlexibleContact(few_strips(), structure.pairs.flexibility)
    return wagon_dynamics(Wagon(), Track(), moving, speed, structure)


@cache
def run(speed: float, spans: float, ballast: bool = False) -> History:
    steps = StepSettings("rosenbrock", 3e-4, 3e-7)
    return simulate(dynamics(speed, ballast), (0.0, spans * SPACING / speed), steps=steps)


@pytest.mark.parametrize(("ballast", "swing"), [(False, 16.0), (True, 12.0)])
def test_slow_wheels_follow_the_rail(ballast: bool, swing: float) -> None:
    # Far below every resonance, at 3 Hz, each wheel carries its load and stands on c_zz(x) times that load.
    history = run(2.0, 1.0, ballast)
    structure = history.dynamics.structures.own[0]
    assert structure is not None
    elastic = structure.pairs.flexibility
    assert elastic.rails is not None
    rail = elastic.rails[0]
    load = history.force[:, 0][0, 0, 2]
    np.testing.assert_allclose(history.force[:, 0, :, 2], load, rtol=0.01)
    depth = np.array([rail.at(s)[1, 1] for s in history.distance]) * load
    expected = -(depth - depth[0])
    height = history.state[:, 7] - history.state[0, 7]
    assert 1e6 * np.ptp(expected) == pytest.approx(swing, abs=1.0)
    np.testing.assert_allclose(height, expected, atol=0.06 * np.ptp(expected))


def test_forces_at_the_sleeper_passing_frequency() -> None:
    speed, spans = 45.0, 9.0
    history = run(speed, spans)
    assert history.status == "completed"
    later = np.linspace(5.0, 9.0, 129)[:-1]  # four spans, when the start has died away
    force = np.interp(later, history.distance / SPACING, history.force[:, 0, 0, 2])
    amplitude = 2.0 * np.abs(np.fft.rfft(force - force.mean())) / len(force)
    assert int(np.argmax(amplitude)) == 4  # 75 Hz
    assert amplitude[4] > 200.0  # N
    assert np.diff(history.time).max() <= SPACING / (3.0 * speed) * (1 + 1e-12)


@pytest.mark.parametrize("ballast", [False, True])
def test_energy_balance_has_the_work_along_the_track(ballast: bool) -> None:
    history = run(45.0, 3.0 if ballast else 9.0, ballast)
    balance = energy_balance(history)
    structure = history.dynamics.structures.own[0]
    assert structure is not None
    along = np.array(
        [
            45.0 * structure.at(s).energy_by_distance(motions)
            for s, motions in zip(history.distance, history.motions, strict=True)
        ]
    )
    power = balance.power.copy()
    power[:, 0] -= along
    without = EnergyBalance(balance.time, balance.energy, power)
    assert balance.error < (0.005 if ballast else 0.03)
    assert without.error > 5.0 * balance.error


@pytest.mark.parametrize("ballast", [False, True])
def test_jacobian_by_time_is_that_of_differences(ballast: bool) -> None:
    equations = dynamics(45.0, ballast)
    state, time, step = run(45.0, 3.0 if ballast else 9.0, ballast).state[-1], 0.2 * SPACING / 45.0, 1e-6
    at = equations(time, state)
    linear = VehicleJacobian(equations, StepStatistics())(time, state, at)
    change = (equations(time + step, state, at).rate - equations(time - step, state, at).rate) / (2 * step)
    moving = slice(2 * COUNT, None)
    scale = np.abs(change[moving]).max()
    assert scale > 1.0  # the rail gives way
    np.testing.assert_allclose(linear.by_time[moving], change[moving], atol=1e-3 * scale)


def test_start_between_sleepers() -> None:
    between = contact().flexibility.moved(0.3)
    structure = QuasiStaticStructure(replace(contact().pairs, flexibility=between))
    np.testing.assert_array_equal(structure.at(0.3).pairs.flexibility.matrix, contact().flexibility.moved(0.6).matrix)
    assert between.matrix[13, 13] > 1.04 * contact().flexibility.matrix[13, 13]


@pytest.mark.parametrize("layer", ["", "[track.ballast]"])
def test_scenes_of_runs_take_sleepers(layer: str) -> None:
    text = (Path(__file__).parents[2] / "scenes" / "curve.toml").read_text(encoding="utf-8")
    scene = parse_scene(f"{text}\n[track.pads]\n{layer}\n[track.sleepers]\nposition = 0.3\n")
    assert isinstance(scene, RunScene)
    elastic = flexibility(scene, side_profiles(scene))
    assert elastic.varies
    assert elastic.place == 0.3
    with pytest.raises(SceneError, match=r"track\.sleepers.*pads"):
        parse_scene(f"{text}\n[track.sleepers]\n")
    with pytest.raises(SceneError, match=r"track\.sleepers\.length.*0\.6 m"):
        parse_scene(f"{text}\n[track.pads]\n[track.sleepers]\nlength = 0.7\n")


def test_a_run_on_spread_pads_has_no_places() -> None:
    rail = rail_compliance(rail_outline(named_profile("UIC60-benchmark")), Material(), RailPads())
    structure = QuasiStaticStructure(replace(contact().pairs, flexibility=Flexibility(None, (rail, rail))))
    assert structure.at(0.3) is structure
    assert structure.period == np.inf
    assert not structure.rates_by_distance(np.ones(18), np.ones(18)).any()
