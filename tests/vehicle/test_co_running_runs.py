"""Runs on a track with mass that moves along: rest, Jacobian, energy, and the limit of slow motion."""

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
from wheelrail.contact.loading.structure import Structure
from wheelrail.contact.structure.ballast import Ballast, CoRunningTrack, co_running_track
from wheelrail.contact.structure.hubs import hub_compliance
from wheelrail.contact.structure.pads import RailPads
from wheelrail.meshes.bodies.axle import AxleShape
from wheelrail.meshes.bodies.outlines import rail_outline, wheel_outline
from wheelrail.meshes.profiles.named import named_profile
from wheelrail.scenes.builders.wheelset import flexibility, side_profiles
from wheelrail.scenes.datasets.run import dataset
from wheelrail.scenes.schema.errors import SceneError
from wheelrail.scenes.schema.scene import RunScene, parse_scene
from wheelrail.vehicle.integration.integrate import StepSettings
from wheelrail.vehicle.integration.step_control import StepStatistics
from wheelrail.vehicle.multibody.equations import VehicleDynamics
from wheelrail.vehicle.multibody.jacobian import VehicleJacobian
from wheelrail.vehicle.multibody.plane_wagon import COUNT, wagon_dynamics
from wheelrail.vehicle.simulation.energy_balance import energy_balance
from wheelrail.vehicle.simulation.history import History
from wheelrail.vehicle.simulation.simulate import Recording, simulate
from wheelrail.vehicle.steady.equilibrium import Equilibrium, equilibrium
from wheelrail.vehicle.steady.modes import modes
from wheelrail.vehicle.track.track import Track
from wheelrail.vehicle.wagon.wagon import Wagon

CURVE = Track.curve(curvature=1 / 600, cant=0.06, transition=30.0, length=200.0)
SPEED, STEEL = 45.0, Material()


@cache
def track() -> CoRunningTrack:
    return co_running_track(rail_outline(named_profile("UIC60-benchmark")), STEEL, RailPads(), Ballast())


@cache
def contact() -> FlexibleContact:
    hubs = hub_compliance(wheel_outline(named_profile("S1002"), 0.46), AxleShape(), STEEL, wheel_y=0.75)
    return FlexibleContact(few_strips(), Flexibility(hubs, (track().rail, track().rail)))


def dynamics(structure: Structure) -> VehicleDynamics:
    return wagon_dynamics(Wagon(), CURVE, contact(), SPEED, structure)


def with_mass() -> CoRunningStructure:
    return CoRunningStructure(contact().pairs, tracks=(track(), track()))


@cache
def rest() -> Equilibrium:
    return equilibrium(dynamics(with_mass()))


@cache
def run(rtol: float, massless: bool = False) -> History:
    steps, start = StepSettings("rosenbrock", rtol, 1e-3 * rtol), rest().state
    if massless:
        structure = QuasiStaticStructure(contact().pairs)
        return simulate(dynamics(structure), (0.0, 0.15), initial=start[: 2 * COUNT + 18 + series()], steps=steps)
    return simulate(dynamics(with_mass()), (0.0, 0.15), initial=start, steps=steps)


def series() -> int:
    return len(dynamics(with_mass()).coordinates.maxwell)


def test_rests_where_the_massless_track_does() -> None:
    massless = equilibrium(dynamics(QuasiStaticStructure(contact().pairs)))
    motions = len(massless.state)
    np.testing.assert_allclose(rest().state[:motions], massless.state, atol=2e-8)
    assert with_mass().size == len(rest().state) - motions + 18
    # The sleepers go down with the foot of the rail in the ratio of the layers' stiffness, pads over both.
    (lateral, normal), load = rest().state[motions : motions + 2], rest().contacts["wheelset"]["left"].force[2]
    foot = load * track().rail.matrix[1, 1]
    assert -normal == pytest.approx(foot * 100 / (100 + 80), rel=0.03)
    assert abs(lateral) < 0.2 * abs(normal)
    np.testing.assert_array_equal(rest().state[motions + 4 :], 0.0)


def test_jacobian_is_that_of_differences() -> None:
    equations, state = dynamics(with_mass()), rest().state.copy()
    state[6] += 1e-3
    state[2 * COUNT :] *= 1.01
    state[-10:] += 1e-3
    at = equations(0.0, state)
    linear = VehicleJacobian(equations, StepStatistics(), central=True)(0.0, state, at)
    first = 2 * COUNT + series()
    for column in (7, first + 3, first + 13, first + 16, first + 19, first + 23, first + 30):
        h = np.zeros(len(state))
        h[column] = 5e-7
        change = (equations(0.0, state + h, at).rate - equations(0.0, state - h, at).rate) / (2 * h[column])
        np.testing.assert_allclose(linear.by_state[:, column], change, atol=0.02 * np.abs(change).max())


def test_energy_balance_closes() -> None:
    errors = [energy_balance(run(rtol)).error for rtol in (3e-3, 1e-4)]
    assert errors[1] < 3e-3
    assert errors[0] > 2.0 * errors[1]


def test_slow_motion_is_that_of_the_massless_track() -> None:
    # The transition takes a second: inertia of rails and sleepers moves their equilibrium by (omega / 700)^2.
    fast, slow = run(1e-4), run(1e-4, massless=True)
    for index, tolerance in ((6, 2e-6), (7, 2e-6), (8, 2e-6)):
        expected = np.interp(fast.time, slow.time, slow.state[:, index])
        np.testing.assert_allclose(fast.state[:, index], expected, atol=tolerance)


def test_bounce_is_that_on_the_receptance_of_the_track() -> None:
    # Half the wheelset, m, on track and contact: m omega^2 (receptance + 1 / k) = 1, for complex omega.
    straight = replace(dynamics(with_mass()), track=Track())
    oscillating = [mode for mode in modes(straight) if mode.oscillates]
    bounce = max(oscillating, key=lambda mode: mode.energy_fraction[7])
    at = equilibrium(straight)
    tangents = VehicleJacobian(straight, StepStatistics()).tangents(
        straight.wheelset_states(0.0, at.state), at.contacts
    )
    stiffness = -tangents.values[0, 0, 2, 1]
    omega = -1j * bounce.eigenvalue
    compliance = track().receptance(omega / (2 * np.pi))[1, 1] + 1 / stiffness
    mass = 0.5 * Wagon().wheelset.mass
    assert mass * omega**2 * compliance == pytest.approx(1.0, abs=0.05)


def test_rows_between_steps_and_results() -> None:
    steps = StepSettings("rosenbrock", 1e-3, 1e-6)
    rows = simulate(dynamics(with_mass()), (0.0, 0.1), initial=rest().state, steps=steps, recording=Recording(0.01))
    reference = run(1e-4)
    for side in (0, 1):
        expected = np.interp(rows.time, reference.time, reference.force[:, 0, side, 2])
        np.testing.assert_allclose(rows.force[:, 0, side, 2], expected, atol=300.0)
    data = dataset(rows)
    assert data["sleeper_motion"].shape == (len(rows.time), 1, 2, 2)
    left, right = data["sleeper_motion"].values[0, 0]
    np.testing.assert_allclose(right * [-1.0, 1.0], left, atol=1e-8)
    assert data["rail_motion"].shape == (len(rows.time), 1, 2, 3)


def test_scenes_of_runs_take_ballast() -> None:
    text = (Path(__file__).parents[2] / "scenes" / "curve.toml").read_text(encoding="utf-8")
    scene = parse_scene(f"{text}\n[track.pads]\n[track.ballast]\nvertical = 60e6\n")
    assert isinstance(scene, RunScene)
    softer = flexibility(scene, side_profiles(scene)).matrix[13, 13]
    assert softer > 1.1 * track().rail.matrix[1, 1]
    with pytest.raises(SceneError, match=r"track\.ballast.*pads"):
        parse_scene(f"{text}\n[track.ballast]\n")
