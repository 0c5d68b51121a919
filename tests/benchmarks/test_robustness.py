"""Runs at the limits: wheel lift, overturning, flange climb, low friction, high speed, irregular track. They complete,
or their status names the reason.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import cache

import numpy as np
import pytest
from plane import MIRROR, ROLL, Y, Z
from small_strips import few_strips
from standin_contact import CONTACT

from wheelrail.contact.geometry.rigid_surfaces import RigidWheelRail
from wheelrail.contact.kinematics.frames import Side
from wheelrail.contact.kinematics.wheelset_state import Mounting, WheelsetState
from wheelrail.contact.laws.parameters import ContactLaws
from wheelrail.contact.models.standard.model import StandardContact
from wheelrail.contact.models.wheelset import WheelsetContact
from wheelrail.contact.results.result import ContactResult
from wheelrail.contact.results.vehicle_contact import VehicleContact
from wheelrail.contact.solvers.active_set import CachedFactors, CoupledPressure
from wheelrail.contact.solvers.options import IterationCount
from wheelrail.meshes.profiles.named import named_profile
from wheelrail.vehicle.integration.integrate import StepSettings
from wheelrail.vehicle.multibody.plane_wagon import COORDINATES, COUNT, wagon_dynamics
from wheelrail.vehicle.simulation.history import History
from wheelrail.vehicle.simulation.limits import Limits, OutOfBounds, wheels
from wheelrail.vehicle.simulation.parallel_contact import in_threads
from wheelrail.vehicle.simulation.simulate import simulate
from wheelrail.vehicle.steady.equilibrium import equilibrium
from wheelrail.vehicle.track.irregularity import Irregularities
from wheelrail.vehicle.track.irregularity_spectrum import ERRI
from wheelrail.vehicle.track.track import Track
from wheelrail.vehicle.wagon.wagon import Wagon

V = 45.0
WHEEL, RAIL = named_profile("S1002"), named_profile("UIC60-benchmark")
MOUNTING = Mounting(0.75, RAIL.gauge_offset(1.435, 0.014), 0.46)


@cache
def standard(friction: float = 0.3) -> WheelsetContact:
    return WheelsetContact(StandardContact(RigidWheelRail(WHEEL, RAIL, 0.46), ContactLaws(friction=friction)), MOUNTING)


def kicked(contact: VehicleContact, **rates: float) -> np.ndarray:
    """State at rest on straight track with additional rates, m/s or rad/s."""
    state = equilibrium(wagon_dynamics(Wagon(), Track(), contact, V)).state
    for name, rate in rates.items():
        state[COUNT + COORDINATES.index(name)] += rate
    return state


def run(  # type: ignore[no-untyped-def]
    contact: VehicleContact, seconds: float, track: Track | None = None, *, rtol: float = 3e-3, **options
) -> History:
    dynamics = wagon_dynamics(Wagon(), track or Track(), contact, options.pop("speed", V))
    return simulate(dynamics, (0.0, seconds), steps=StepSettings("rosenbrock", rtol, 1e-3 * rtol), **options)


def in_the_air(history: History) -> np.ndarray:
    """(n, 2): which wheels."""
    return np.array([row.contact_status[0] for row in history.rows]) == "separated"


def momentum_gap(history: History) -> float:
    """Vertical impulse of the rails and the weight less what the three bodies have gained, over that of the rails."""
    plane, force = Wagon().plane, history.force[:, 0, :, 2].sum(axis=1)
    mass = np.array([plane.car_body.mass, plane.bogie.mass, plane.wheelset.mass])
    given = 0.5 * (force[1:] + force[:-1]) @ np.diff(history.time)
    weight = plane.gravity * mass.sum() * history.time[-1]
    gained = mass @ (history.state[-1] - history.state[0])[[COUNT + 1, COUNT + 4, COUNT + 7]]
    return float((given - weight - gained) / given)


def test_a_wheel_lifts_and_lands_again() -> None:
    start = kicked(standard(), wheelset_roll=0.25)
    history = run(standard(), 0.04, initial=start, rtol=1e-3)
    assert history.status == "completed"
    off = in_the_air(history)
    assert (off[:, 0] & ~off[:, 1]).any()
    assert (np.diff(off.astype(int), axis=0) < 0).any(axis=0).all()  # both wheels lifted and landed
    assert abs(momentum_gap(history)) < 0.01
    tight = run(standard(), 0.04, initial=start, rtol=2e-4)
    for i in (Y, Z, ROLL):
        even = np.interp(tight.time, history.time, history.state[:, i])
        assert np.abs(even - tight.state[:, i]).max() < 0.05 * np.ptp(tight.state[:, i])


def test_a_wheel_on_strips_lifts_and_lands_again() -> None:
    """From a result without cells, and with a tangent of zeros, to a contact; steps are as long as before then."""
    contact = few_strips()
    history = run(contact, 0.012, initial=kicked(contact, wheelset_roll=0.15))
    assert history.status == "completed"
    off = in_the_air(history)
    assert (off[:, 0] ^ off[:, 1]).any()
    assert (np.diff(off.astype(int), axis=0) < 0).any()
    assert history.cost.steps.failed <= 2
    assert abs(momentum_gap(history)) < 0.02


def test_a_wagon_that_overturns_ends_the_run() -> None:
    """45 m/s into 250 m without cant: 8.1 m/s2."""
    history = run(standard(), 2.0, Track.curve(curvature=1 / 250, transition=20.0, length=500.0))
    assert history.status.startswith("failed: the car body overturns to the right: roll 0.3")
    assert history.status.endswith(f"at t = {history.time[-1]:.4g} s, {history.distance[-1]:.4g} m")
    assert 0.3 < history.state[-1, 2] < 0.35
    assert (history.state[:-1, 2] <= 0.3).all()
    assert in_the_air(history)[-1].any()
    assert history.cost.steps.failed < 5


def test_flange_climb_ends_the_run() -> None:
    """The flange runs over the rail; forces on the way accelerate the bodies as the momentum says."""
    history = run(standard(), 0.2, initial=kicked(standard(), car_body_roll=2.5))
    assert history.status.startswith("failed: the wheelset has left the rails to the left: lateral shift 4")
    assert history.state[-1, Z] > 15e-3  # of the wheelset, with its left wheel on the flange
    assert abs(momentum_gap(history)) < 0.02
    assert history.cost.steps.failed < 40


@pytest.mark.parametrize(
    ("rates", "limits", "says"),
    [
        ({"wheelset_y": 4.0}, Limits(), "the wheelset has left the rails to the right: lateral shift 4"),
        ({"wheelset_y": 2.0}, Limits(shift=0.012), "the wheelset has left the rails to the right: lateral shift 1"),
    ],
)
def test_derailment_ends_the_run(rates: dict[str, float], limits: Limits, says: str) -> None:
    history = run(standard(), 0.2, initial=kicked(standard(), **rates), limits=limits)
    assert says in history.status
    assert history.status.startswith("failed: ")
    assert len(history) > 10


def test_wheel_positions() -> None:
    """After a rotation about the right rail the right wheel is in its place."""
    state, roll = np.zeros(20), 0.2
    c, s = np.cos(roll), np.sin(roll)
    state[[Y, Z, ROLL]] = -0.75 * (1 - c) - 0.46 * s, 0.75 * s - 0.46 * (1 - c), roll
    dynamics = wagon_dynamics(Wagon(), Track(), CONTACT, V)
    left, right = wheels(dynamics, dynamics.wheelset_states(0.0, state))["wheelset"]
    np.testing.assert_allclose(right, (0.0, 0.0), atol=1e-15)
    np.testing.assert_allclose(left, (-1.5 * (1 - c), 1.5 * s), rtol=1e-12)
    mirrored = wheels(dynamics, dynamics.wheelset_states(0.0, state * MIRROR))["wheelset"]
    np.testing.assert_allclose(mirrored[0], (0.0, 0.0), atol=1e-15)
    stations = np.arange(0.0, 200.0)
    values = np.tile([3e-3, 2e-3, 0.0, 0.0], (200, 1))  # both rails 3 mm to the left, 2 mm up
    uneven = Track(irregularities=Irregularities.faded(stations, values))
    dynamics = wagon_dynamics(Wagon(), uneven, CONTACT, V)
    moved = wheels(dynamics, dynamics.wheelset_states(2.0, state))["wheelset"]
    np.testing.assert_allclose(moved[1], (-3e-3, -2e-3), atol=1e-9)


def test_limits() -> None:
    dynamics, state = wagon_dynamics(Wagon(), Track(), CONTACT, V), np.zeros(20)
    Limits().check(dynamics, 0.0, state)
    for i, value, says in (
        (2, 0.31, "overturns to the right"),
        (Y, 0.041, "to the left: lateral shift 41 mm"),
        (Z, 0.04, "both"),
    ):
        out = np.zeros(20)
        out[i] = value
        with pytest.raises(OutOfBounds, match=says):
            Limits().check(dynamics, 0.0, out)
        Limits(np.inf, np.inf, np.inf).check(dynamics, 0.0, out)
    for name in ("roll", "shift", "lift"):
        for value in (0.0, np.nan):
            with pytest.raises(ValueError, match=name):
                Limits(**{name: value})


@pytest.mark.parametrize("friction", [0.05, 0.6])
def test_high_speed_and_low_friction(friction: float) -> None:
    """60 m/s, 1200 m, 60 mm of cant: 2.6 m/s2 in the plane of the rails; the inner wheel remains loaded."""
    track = Track.curve(curvature=1 / 1200, cant=0.06, tangent=5.0, transition=90.0, length=200.0)
    history = run(standard(friction), 2.0, track, speed=60.0)
    assert history.status == "completed"
    load = history.force[-1, 0, :, 2]
    assert 0.0 < load[0] < 0.5 * load[1]
    assert load.sum() == pytest.approx(Wagon().axle_load, rel=0.05)
    assert np.abs(history.state[:, 6]).max() < 8e-3
    pull = np.hypot(*history.force[:, 0, :, :2].transpose(2, 0, 1))
    assert (pull <= 3.5 * history.force[:, 0, :, 2]).all()  # 70 degrees of flange and 31 of friction


def test_irregular_rails() -> None:
    track = Track(irregularities=ERRI["high"].irregularities(60.0, seed=1))
    history = run(standard(), 0.5, track, speed=60.0)
    assert history.status == "completed"
    assert history.time[-1] == 0.5
    assert np.ptp(history.force[:, 0, 0, 2]) > 20e3
    assert abs(momentum_gap(history)) < 0.01


def test_pressure_without_loaded_points_has_no_derivative() -> None:
    pressure = CoupledPressure(CachedFactors(np.eye(3)), np.ones(3), np.ones((3, 6)))
    assert pressure.slope(np.zeros(3, dtype=bool), IterationCount()).shape == (0, 6)
    np.testing.assert_array_equal(pressure.slope(np.array([True, False, True]), IterationCount()), np.ones((2, 6)))


@dataclass(frozen=True)
class Ending(VehicleContact):
    """The smooth contact; that of the right wheel fails from a shift m to the right on."""

    shift: float = 1e-3

    def __call__(self, state: WheelsetState, side: Side, guess: ContactResult | None = None) -> ContactResult:
        if side == "right" and state.y < -self.shift:
            return replace(ContactResult.separated(), status="failed: beyond the profile")
        return CONTACT(state, side, guess)


def test_a_contact_that_fails_in_a_second_thread_ends_the_run_as_in_one() -> None:
    options = {"initial": kicked(CONTACT, wheelset_y=-1.0)}
    one = run(Ending(), 0.5, **options)
    with in_threads(Ending(), 2) as both:
        two = run(both, 0.5, **options)
    assert "right contact: failed: beyond the profile" in one.status
    assert two.status == one.status
    np.testing.assert_array_equal(two.state, one.state)
    assert one.cost.steps.failed < 40  # a failure takes few iterations
