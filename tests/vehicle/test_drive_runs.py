"""Runs at a changing speed against closed forms."""

from __future__ import annotations

import numpy as np
import pytest
from standin_contact import CONTACT, FunctionContact

from wheelrail.contact.kinematics.frames import Side
from wheelrail.contact.kinematics.wheelset_state import WheelsetState
from wheelrail.contact.results.result import ContactResult
from wheelrail.vehicle.integration.integrate import StepSettings
from wheelrail.vehicle.multibody.plane_wagon import COUNT, wagon_dynamics
from wheelrail.vehicle.simulation.simulate import simulate
from wheelrail.vehicle.simulation.time_run import Recording
from wheelrail.vehicle.track.speed_profile import SpeedProfile
from wheelrail.vehicle.track.track import Track
from wheelrail.vehicle.wagon.wagon import Wagon

BRAKES = SpeedProfile.through((0.0, 4.0), (40.0, 30.0))


@FunctionContact
def no_contact(state: WheelsetState, side: Side, guess: ContactResult | None = None) -> ContactResult:
    return ContactResult.separated()


def test_free_wheel_keeps_its_spin() -> None:
    dynamics = wagon_dynamics(Wagon(), Track(), no_contact, BRAKES)
    run = simulate(dynamics, (0.0, 3.0), initial=np.zeros(2 * COUNT), steps=StepSettings("ode45"))
    assert run.status == "completed"
    np.testing.assert_allclose((run.state[:, 19] + run.speeds / 0.46), 40.0 / 0.46, rtol=1e-4)
    np.testing.assert_allclose((run.state[:, 9] + run.distance / 0.46), 40.0 / 0.46 * run.time, rtol=1e-4, atol=1e-6)


def test_rails_decelerate_the_wheelset_during_braking() -> None:
    """Both contacts together push forward by -J dV/dt / r^2; the pitch is what was rolled, but for the creepage."""
    dynamics, steps = wagon_dynamics(Wagon(), Track(), CONTACT, BRAKES), StepSettings("rosenbrock", 1e-5, 1e-8)
    run = simulate(dynamics, (0.0, 4.5), steps=steps, recording=Recording(0.05))
    assert run.status == "completed"
    deceleration = np.array([BRAKES(t).acceleration for t in run.time])
    pull = run.force[:, 0, :, 0].sum(axis=1)
    radius = 0.46 + run.state[:, 7]
    np.testing.assert_allclose(pull, -112.0 * deceleration / radius**2, atol=0.01 * 112.0 * 4.7 / 0.46**2)
    assert pull.max() > 2000.0
    np.testing.assert_allclose((run.state[:, 9] + run.distance / 0.46) * 0.46, run.distance, rtol=1e-3)
    assert run.speeds[-1] == 30.0
    assert run.distance[-1] == pytest.approx(0.5 * (40 + 30) * 4.0 + 30 * 0.5, rel=1e-14)


def test_constant_speed_equals_a_constant_profile() -> None:
    one, other = (
        simulate(wagon_dynamics(Wagon(), Track(), CONTACT, speed), (0.0, 0.1), steps=StepSettings("rosenbrock"))
        for speed in (40.0, SpeedProfile.of(40.0))
    )
    np.testing.assert_array_equal(one.state, other.state)
    np.testing.assert_array_equal(one.distance, 40.0 * one.time)
