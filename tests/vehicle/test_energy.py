"""Energy balance of runs: work of all forces equals the change of the mechanical energy."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from linear_creep import LinearCreep
from standard_pair import wheel_on_rail
from standin_contact import CONTACT

from wheelrail.scenes.builders.vehicle_file import load_vehicle
from wheelrail.scenes.datasets.run import dataset
from wheelrail.scenes.datasets.run_derived import with_energy
from wheelrail.vehicle.integration.integrate import StepSettings
from wheelrail.vehicle.multibody.equations import VehicleDynamics
from wheelrail.vehicle.multibody.plane_wagon import COORDINATES, COUNT, wagon_dynamics
from wheelrail.vehicle.simulation.energy_balance import POWERS, EnergyBalance, energy_balance
from wheelrail.vehicle.simulation.history import History
from wheelrail.vehicle.simulation.simulate import simulate
from wheelrail.vehicle.steady.equilibrium import equilibrium
from wheelrail.vehicle.steady.start_state import start_state
from wheelrail.vehicle.track.irregularity_spectrum import ERRI
from wheelrail.vehicle.track.speed_profile import SpeedProfile
from wheelrail.vehicle.track.track import Track
from wheelrail.vehicle.wagon.wagon import Wagon

CURVE = Track.curve(curvature=1 / 600, cant=0.06, transition=30.0, length=200.0, gradient=0.01)
SPAN = (0.0, 0.3)


def run(wagon: Wagon, track: Track, speed: float | SpeedProfile, rtol: float, method: str = "ode45") -> History:
    return simulate(wagon_dynamics(wagon, track, CONTACT, speed), SPAN, steps=StepSettings(method, rtol, 1e-3 * rtol))


def series_wagon() -> Wagon:
    standard = Wagon()
    primary = replace(standard.primary, lateral_series_stiffness=7.5e6, vertical_series_stiffness=1e6)
    secondary = replace(standard.secondary, lateral_series_stiffness=6e6, vertical_series_stiffness=6e6)
    return replace(standard, primary=primary, secondary=secondary)


@pytest.mark.parametrize(
    ("wagon", "track", "speed"),
    [
        (Wagon(), CURVE, 45.0),
        (Wagon(), replace(CURVE, irregularities=ERRI["low"].irregularities(60.0, seed=1)), 45.0),
        (Wagon(), CURVE, SpeedProfile.through((0.0, 2.0), (45.0, 40.0))),
        (series_wagon(), CURVE, 45.0),
    ],
    ids=["curve and slope", "irregular rails", "braking", "dampers on springs"],
)
def test_energy_balance_closes(wagon: Wagon, track: Track, speed: float | SpeedProfile) -> None:
    history = run(wagon, track, speed, 1e-5)
    assert history.status == "completed"
    found = energy_balance(history)
    assert found.error < 1e-4
    if track.irregularities is None:  # which do the work
        assert abs(found.work[-1, POWERS.index("inertial")]) > 1.0  # J: not trivial
    assert (found.power[:, POWERS.index("dampers")] <= 0.0).all()


@pytest.mark.parametrize("held", [(), ("x",)])
def test_energy_balance_of_a_vehicle_in_three_dimensions(held: tuple[str, ...]) -> None:
    """In transitions elements deflect between frames that turn against each other; bodies move along the track."""
    vehicle, track = (
        load_vehicle(),
        Track.curve(curvature=1 / 600, cant=0.08, transition=30.0, length=60.0, gradient=0.01),
    )
    bodies = {name: replace(body, held=(*held, *body.held)) for name, body in vehicle.bodies.items()}
    dynamics = VehicleDynamics(replace(vehicle, bodies=bodies), track, LinearCreep(), 25.0)
    found = energy_balance(simulate(dynamics, (0.0, 4.0), steps=StepSettings("rosenbrock", 1e-3, 1e-6)))
    assert found.error < 5e-4
    assert abs(found.work[:, POWERS.index("inertial")]).max() > 1e3  # J


def test_frames_on_straight_track_do_no_work() -> None:
    """Where no body moves along the track against the others, but for bearings that turn about their axles."""
    dynamics = VehicleDynamics(load_vehicle(), Track(), LinearCreep(), 25.0)
    random, c = np.random.default_rng(3), dynamics.coordinates.count
    state, wrenches = start_state(dynamics), random.normal(size=(4, 6)) * 1e4
    state[: 2 * c] += 1e-2 * random.normal(size=2 * c)
    state[c : 2 * c][dynamics.coordinates.free % 6 == 0] = 0.0
    _, _, *powers = dynamics.bodies.energy_rates(dynamics.speed_profile(0.0), state, wrenches)
    assert abs(powers[POWERS.index("inertial")]) < 1e-3 * abs(powers[POWERS.index("dampers")])


def test_gap_decreases_with_the_tolerance() -> None:
    runs = (run(Wagon(), CURVE, 45.0, rtol, "rosenbrock") for rtol in (1e-2, 1e-3, 1e-4))
    errors = [energy_balance(history).error for history in runs]
    assert errors[0] > 3.0 * errors[1] > 9.0 * errors[2]


def test_energy_balance_closes_where_wheels_lift_and_land() -> None:
    """After an impulse; cubic splines through the contact's power, which has kinks, leave less on shorter steps."""
    dynamics = wagon_dynamics(Wagon(), Track(), wheel_on_rail(), 45.0)
    state = equilibrium(dynamics).state.copy()
    state[COUNT + COORDINATES.index("wheelset_roll")] += 0.3  # rad/s
    runs = [
        simulate(dynamics, (0.0, 0.05), initial=state, steps=StepSettings("rosenbrock", rtol, 1e-2 * rtol))
        for rtol in (1e-3, 1e-4, 3e-5)
    ]
    history = runs[-1]
    vertical = np.array([row.force[0, :, 2] for row in history.rows])
    assert (vertical == 0.0).any(axis=0).all()
    assert vertical.max() > 3e5  # N
    coarse, fine, finest = (energy_balance(one).error for one in runs)
    assert coarse > 5 * fine > 10 * finest
    assert finest < 1e-3


def test_omitted_force_opens_the_balance() -> None:
    history = run(Wagon(), CURVE, 45.0, 1e-5)
    found = energy_balance(history)
    for cause in range(len(POWERS)):
        power = found.power.copy()
        power[:, cause] *= 1.05
        assert EnergyBalance(found.time, found.energy, power).error > 5.0 * found.error


def test_work_of_gravity() -> None:
    """On a straight level track the work of gravity is the weight times the descent."""
    wagon, plane = Wagon(), Wagon().plane
    dynamics = wagon_dynamics(wagon, Track(), CONTACT, 45.0)
    aside = simulate(dynamics, (0.0, 0.01)).state[0]
    aside[1] += 0.02
    history = simulate(dynamics, (0.0, 0.5), initial=aside, steps=StepSettings("ode45", 1e-7, 1e-9))
    found = energy_balance(history)
    masses = np.array([plane.car_body.mass, plane.bogie.mass, plane.wheelset.mass])
    down = -(history.state[:, [1, 4, 7]] - aside[[1, 4, 7]]) @ masses
    gravity = found.work[:, POWERS.index("gravity")]
    np.testing.assert_allclose(gravity, plane.gravity * down, atol=1e-5 * np.abs(gravity).max())
    assert found.error < 1e-4


def test_results_contain_the_energy_balance() -> None:
    history = run(Wagon(), CURVE, 45.0, 1e-4)
    data = with_energy(dataset(history), history)
    assert data["power"].sel(cause="dampers").max() <= 0.0
    assert data.attrs["energy_balance_error"] < 1e-3
    change = data["mechanical_energy"] - data["mechanical_energy"].isel(time=0)
    np.testing.assert_allclose(data["work"].sum("cause"), change, atol=1e-3 * float(np.abs(data["work"]).max()))
    assert all(data[name].attrs["units"] for name in ("power", "work", "mechanical_energy"))
