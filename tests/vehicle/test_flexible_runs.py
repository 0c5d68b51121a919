"""Runs with an elastic axle and rails on pads: motions as states, their Jacobian, equilibrium and energy."""

from __future__ import annotations

from dataclasses import replace
from functools import cache
from pathlib import Path

import numpy as np
import pytest
from small_strips import few_strips

from benchmarks.vehicle_complete import mirror
from wheelrail.contact.kinematics.frames import SIDES
from wheelrail.contact.laws.material import Material
from wheelrail.contact.loading.flexible_contact import FlexibleContact
from wheelrail.contact.loading.flexible_state import FlexibleState
from wheelrail.contact.loading.flexible_wheelset import Flexibility, FlexibleWheelset, Loads
from wheelrail.contact.loading.quasi_static_structure import QuasiStaticStructure
from wheelrail.contact.structure.hubs import about_hubs_line, hub_compliance
from wheelrail.contact.structure.pads import RailPads, rail_compliance
from wheelrail.meshes.bodies.axle import AxleShape
from wheelrail.meshes.bodies.outlines import rail_outline, wheel_outline
from wheelrail.meshes.profiles.named import named_profile
from wheelrail.scenes.builders.vehicle_file import load_vehicle
from wheelrail.scenes.datasets.run import dataset
from wheelrail.scenes.schema.errors import SceneError
from wheelrail.scenes.schema.scene import RunScene, load_scene, parse_scene
from wheelrail.vehicle.integration.integrate import StepSettings
from wheelrail.vehicle.integration.step_control import StepStatistics
from wheelrail.vehicle.multibody.coordinates import Y
from wheelrail.vehicle.multibody.equations import VehicleDynamics
from wheelrail.vehicle.multibody.jacobian import VehicleJacobian
from wheelrail.vehicle.multibody.plane_wagon import COUNT, wagon_dynamics
from wheelrail.vehicle.simulation.energy_balance import EnergyBalance, energy_balance
from wheelrail.vehicle.simulation.history import History
from wheelrail.vehicle.simulation.parallel_contact import in_threads
from wheelrail.vehicle.simulation.simulate import Recording, simulate
from wheelrail.vehicle.steady.equilibrium import Equilibrium, equilibrium
from wheelrail.vehicle.steady.modes import modes
from wheelrail.vehicle.steady.static_start import StaticStart
from wheelrail.vehicle.steady.steady_problem import SteadyProblem
from wheelrail.vehicle.track.irregularity_spectrum import ERRI
from wheelrail.vehicle.track.track import Track
from wheelrail.vehicle.wagon.wagon import Wagon

CURVE = Track.curve(curvature=1 / 600, cant=0.06, transition=30.0, length=200.0)
SPEED, STEEL = 45.0, Material()
SPAN = (0.0, 0.25)


@cache
def contact() -> FlexibleContact:
    wheel, rail = named_profile("S1002"), named_profile("UIC60-benchmark")
    hubs = hub_compliance(wheel_outline(wheel, 0.46), AxleShape(), STEEL, wheel_y=0.75)
    pads = rail_compliance(rail_outline(rail), STEEL, RailPads())
    return FlexibleContact(few_strips(), Flexibility(hubs, (pads, pads)))


def dynamics(track: Track = CURVE) -> VehicleDynamics:
    return wagon_dynamics(Wagon(), track, contact(), SPEED, QuasiStaticStructure(contact().pairs))


@cache
def start() -> Equilibrium:
    return equilibrium(dynamics())


@cache
def run(rtol: float) -> History:
    steps = StepSettings("rosenbrock", rtol, 1e-3 * rtol)
    return simulate(dynamics(), SPAN, initial=start().state, steps=steps)


def test_a_rigid_motion_leaves_the_hubs_on_their_line() -> None:
    x, y, z, roll, yaw, half = 1.0, 2.0, 3.0, 0.4, 0.5, 0.75
    left = [x - yaw * half, y, z + roll * half, roll, 0.0, yaw]
    right = np.array([x + yaw * half, y, z - roll * half, roll, 0.0, yaw]) * [1, -1, 1, -1, 1, -1]
    projection = about_hubs_line(half)
    np.testing.assert_allclose(projection @ np.concatenate([left, right]), 0.0, atol=1e-14)
    np.testing.assert_allclose(projection @ projection, projection, atol=1e-14)
    bent = np.zeros(12)
    bent[[3, 9]] = 1e-3  # both wheels tilt, as mirror images
    np.testing.assert_array_equal(projection @ bent, bent)


def test_equilibrium_is_that_of_the_wheelset_under_its_loads() -> None:
    found = start()
    assert found.residual < 1e-6
    load = float(found.contacts["wheelset"]["left"].force[2])
    wheelset = FlexibleWheelset(contact().contact, contact().flexibility)
    state = dynamics().wheelset_states(0.0, found.state)["wheelset"]
    assert isinstance(state, FlexibleState)
    on_journals = wheelset.equilibrium(replace(state, motions=(0.0,) * 18), Loads.wheels(load))
    motions = np.array(state.motions)
    np.testing.assert_allclose(motions[:6], on_journals.hubs["left"], atol=2e-8)
    np.testing.assert_allclose(motions[12:15], on_journals.rails["left"], atol=2e-8)
    # The hubs stand above the line through the journals, which is the frame there.
    assert state.z == pytest.approx(on_journals.state.z + motions[2], abs=2e-8)


def test_mirrored_state() -> None:
    motions = tuple(float(i) for i in range(18))
    mirrored = FlexibleState(y=1e-3, motions=motions).mirrored()
    assert mirrored.y == -1e-3
    assert mirrored.motions == (*motions[6:12], *motions[:6], *motions[15:], *motions[12:15])


@pytest.mark.parametrize("irregular", [False, True])
def test_jacobian_is_that_of_differences(irregular: bool) -> None:
    equations = dynamics(Track(irregularities=ERRI["low"].irregularities(60.0, seed=1)) if irregular else CURVE)
    time, state = (0.5 if irregular else 0.0), start().state.copy()
    if irregular:
        assert equations.track.irregularities is not None
        left_rail, right_rail = (z for _, z in equations.track.irregularities.rails(SPEED * time) or ())
        state[[1, 4, 7]] += 0.5 * (left_rail + right_rail)
        state[[2, 5, 8]] += (left_rail - right_rail) / 1.5
    state[6] += 1e-3
    state[2 * COUNT :] *= 1.01
    at = equations(time, state)
    linear = VehicleJacobian(equations, StepStatistics(), central=True)(time, state, at)
    columns = [6, 7, 8, 23, 22, 32, 33, 34, 35]  # wheelset; roll and z of the left hub; left rail; right rail
    for column in columns:
        h = np.zeros(len(state))
        h[column] = 5e-7
        change = (equations(time, state + h, at).rate - equations(time, state - h, at).rate) / (2 * h[column])
        scale = np.abs(change).max()
        np.testing.assert_allclose(linear.by_state[:, column], change, atol=0.02 * scale)
    if irregular:
        step = 1e-5
        later, earlier = equations(time + step, state, at), equations(time - step, state, at)
        change = (later.rate - earlier.rate) / (2 * step)
        moving = slice(2 * COUNT, None)
        np.testing.assert_allclose(linear.by_time[moving], change[moving], atol=0.03 * np.abs(change[moving]).max())


def test_energy_balance_closes() -> None:
    errors = [energy_balance(run(rtol)).error for rtol in (3e-3, 1e-4)]
    assert errors[1] < 2e-3
    assert errors[0] > 3.0 * errors[1]
    balance = energy_balance(run(1e-4))
    structure = run(1e-4).dynamics.structures.own[0]
    assert structure is not None
    stored = structure.energy(run(1e-4).motions)
    assert np.ptp(stored) > 0.05  # J: not trivial
    without = EnergyBalance(balance.time, balance.energy - stored, balance.power)
    assert without.error > 5.0 * balance.error


def test_elastic_energy_is_half_the_work_of_the_loads() -> None:
    structure = dynamics().structures.own[0]
    assert structure is not None
    elastic, rng = structure.pairs.flexibility, np.random.default_rng(1)
    loads = rng.normal(size=18) * np.tile([1e4, 1e4, 1e4, 1e3, 0.0, 1e3], 3)
    strain = elastic.matrix @ loads
    parts = np.linalg.solve(structure.of_sides, elastic.unloaded + strain)
    np.testing.assert_allclose(structure.rates(parts, structure.of_sides.T @ loads), 0.0, atol=1e-12)
    assert structure.energy(parts) == pytest.approx(0.5 * loads @ strain, rel=1e-6)


def test_rows_between_steps_agree_with_those_at_steps() -> None:
    steps = StepSettings("rosenbrock", 1e-3, 1e-6)
    rows = simulate(dynamics(), SPAN, initial=start().state, steps=steps, recording=Recording(0.01))
    reference = run(1e-4)
    for side in (0, 1):
        expected = np.interp(rows.time, reference.time, reference.force[:, 0, side, 2])
        np.testing.assert_allclose(rows.force[:, 0, side, 2], expected, atol=300.0)


def test_a_second_thread_changes_nothing() -> None:
    span, steps = (0.0, 0.02), StepSettings("rosenbrock", 1e-3, 1e-6)
    alone = simulate(dynamics(), span, initial=start().state, steps=steps)
    with in_threads(contact(), 2) as parallel:
        both = simulate(replace(dynamics(), contact=parallel), span, initial=start().state, steps=steps)
    np.testing.assert_array_equal(alone.state, both.state)
    np.testing.assert_array_equal(alone.force[:, 0], both.force[:, 0])


def test_results_have_the_motions() -> None:
    data = dataset(run(3e-3))
    assert data["hub_motion"].shape[1:] == (1, 2, 6)
    hubs, rails = (data[name].squeeze("wheelset").values for name in ("hub_motion", "rail_motion"))
    assert 1e3 * hubs[0, 0, 3] == pytest.approx(-1.2, abs=0.05)  # the left wheel leans inwards at its top
    np.testing.assert_allclose(hubs[0, 1] * [1, -1, 1, -1, 1, -1], hubs[0, 0], atol=1e-7)
    np.testing.assert_allclose(rails[0, 1] * [-1, 1, -1], rails[0, 0], atol=1e-7)


def test_modes_are_less_stiff() -> None:
    fastest = [
        max(mode.frequency for mode in modes(replace(equations, track=Track())) if mode.oscillates)
        for equations in (wagon_dynamics(Wagon(), CURVE, few_strips(), SPEED), dynamics())
    ]
    assert fastest[1] < 0.98 * fastest[0]


def test_scenes_of_runs_take_axle_and_pads() -> None:
    file = Path(__file__).parents[2] / "scenes" / "curve.toml"
    plain = load_scene(file)
    assert isinstance(plain, RunScene)
    assert not plain.is_flexible
    text = file.read_text(encoding="utf-8")
    flexible = parse_scene(f"{text}\n[wheelset.axle]\n[track.pads]\n")
    assert isinstance(flexible, RunScene)
    assert flexible.is_flexible
    paper = text.replace('laws = "exact"', 'laws = "paper"').replace("strips = 6", "").replace("cells = 10", "")
    with pytest.raises(SceneError, match=r"wheelset\.axle.*lattice"):
        parse_scene(f"{paper}\n[wheelset.axle]\n")


def test_contacts_of_both_sides_are_mirror_images() -> None:
    state = dynamics().wheelset_states(0.0, start().state)["wheelset"]
    moved = replace(state, y=2e-3, frame_rate=(0.0, 0.0, 0.0))
    forces = {side: contact()(moved, side).force for side in SIDES}
    assert isinstance(moved, FlexibleState)
    images = {side: contact()(moved.mirrored(), side).force for side in SIDES}
    np.testing.assert_allclose(images["left"], forces["right"] * [1, -1, 1], rtol=1e-9)
    np.testing.assert_allclose(images["right"], forces["left"] * [1, -1, 1], rtol=1e-9)


def test_jacobian_of_a_vehicle_on_several_wheelsets() -> None:
    """Each wheelset has its own motions or none, and moves along the track: by central differences of some columns."""
    pads = replace(contact().flexibility, hubs=None)
    structures = (
        QuasiStaticStructure(contact().pairs),
        None,
        QuasiStaticStructure(replace(contact().pairs, flexibility=pads)),
    )
    d = VehicleDynamics(load_vehicle(), CURVE, contact(), SPEED, (*structures, structures[0]))
    assert d.size == d.coordinates.size + 3 * 18
    state, random = StaticStart(SteadyProblem.of(replace(d, track=Track()), 0.0))(), np.random.default_rng(4)
    c, first = d.coordinates.count, d.coordinates.size
    state[:c] += 1e-5 * random.normal(size=c)
    state[c : 2 * c] += 1e-2 * random.normal(size=c)
    at = d(1.0, state)
    linear = VehicleJacobian(d, StepStatistics())(1.0, state, at)
    second, third = (d.coordinates.index(f"wheelset_{number}", 0) for number in (2, 3))
    for column in (second, c + second, third, c + third, third + Y, first + 2, first + 18 + 2):
        h = np.zeros(d.size)
        h[column] = 2e-7
        change = (d(1.0, state + h, at).rate - d(1.0, state - h, at).rate) / (2 * h[column])
        for rows in (slice(c, 2 * c), slice(first, None)):
            within = 1e-6 * np.abs(change[rows]).max()
            np.testing.assert_allclose(linear.by_state[rows, column], change[rows], rtol=0.0, atol=within)


def test_mirror_images_of_a_vehicle_on_elastic_track_are_equal_to_the_last_bit() -> None:
    (check,) = mirror(0.05, (True,))
    assert check.value == 0.0
