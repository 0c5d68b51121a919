"""Virtual accelerometers, and comfort by EN 12299 and Sperling."""

from __future__ import annotations

from typing import Literal

import numpy as np
import pytest
from linear_creep import LinearCreep
from numpy_vehicle import kinematics, rotate

from wheelrail.contact.kinematics.frames import cross
from wheelrail.scenes.builders.vehicle_file import load_vehicle
from wheelrail.vehicle.evaluation.comfort import (
    WEIGHTINGS,
    block_rms,
    mean_comfort,
    sperling_comfort,
)
from wheelrail.vehicle.multibody.coordinates import ROLL
from wheelrail.vehicle.multibody.equations import VehicleDynamics
from wheelrail.vehicle.simulation.accelerometer import Accelerometer
from wheelrail.vehicle.steady.equilibrium import equilibrium
from wheelrail.vehicle.track.constant_curve import ConstantCurve
from wheelrail.vehicle.track.track import Track

FLOOR = (7.0, 0.8, 1.1)  # m


@pytest.mark.parametrize("body", ["car_body", "front_bogie"])
def test_an_accelerometer_measures_the_rate_of_its_point_s_velocity(body: str) -> None:
    """At a random state on straight track, where the common axes do not rotate; minus gravity, in the body's axes."""
    dynamics = VehicleDynamics(load_vehicle(), Track(), LinearCreep(), 30.0)
    random, index = np.random.default_rng(4), dynamics.vehicle.names.index(body)
    state = np.concatenate([np.full(42, 1e-2), np.full(42, 0.1)]) * random.normal(size=84)
    lever = np.array(FLOOR) - (dynamics.vehicle.bodies[body].x, 0.0, dynamics.vehicle.bodies[body].height)
    rate = dynamics(0.0, state).rate

    def velocity(h: float) -> np.ndarray:
        motion = kinematics(dynamics)(dynamics.speed_profile(h), state + h * rate)
        return motion.velocity[index] + cross(motion.rate[index], rotate(motion.axes[index], lever))

    h = 1e-6
    acceleration = (velocity(h) - velocity(-h)) / (2 * h) + (0.0, 0.0, 9.81)
    axes = kinematics(dynamics)(dynamics.speed_profile(0.0), state).axes[index]
    measured = Accelerometer(dynamics, body, FLOOR)(0.0, state)
    np.testing.assert_allclose(measured, acceleration @ axes, atol=1e-7)


def test_lateral_acceleration_in_a_curve_is_the_unbalanced_one() -> None:
    """V2/R cos b - g sin b, of the track's cant angle less the roll of the body; the sensor at the centre of mass."""
    curve = ConstantCurve(speed=25.0, curvature=1 / 600, cant=0.1)
    vehicle = load_vehicle()
    at = equilibrium(VehicleDynamics(vehicle, curve.track, LinearCreep(), curve.speed))
    roll = at.state[at.dynamics.coordinates.index("car_body", ROLL)]
    measured = Accelerometer(at.dynamics, "car_body", (0.0, 0.0, 1.8))(0.0, at.state)
    y = at.state[at.dynamics.coordinates.index("car_body", 1)]
    angle = -np.arcsin(0.1 / 1.5) + roll  # of the body's floor, positive to the right
    radius = 600.0 - y * np.cos(np.arcsin(0.1 / 1.5)) - 1.8 * np.sin(np.arcsin(0.1 / 1.5))
    speed = curve.speed * radius / 600.0
    lateral = speed**2 / radius
    expected = lateral * np.cos(angle) + 9.81 * np.sin(angle), -lateral * np.sin(angle) + 9.81 * np.cos(angle)
    np.testing.assert_allclose(measured[1:], expected, atol=2e-4)
    with pytest.raises(ValueError, match="must be one of car_body, front_bogie, rear_bogie"):
        Accelerometer(at.dynamics, "wheelset_1", FLOOR)


def test_weightings_of_en_12299() -> None:
    """Magnitudes calculated from the formulas of comfpy and PyRidy, which agree."""
    f = np.array([0.5, 1.0, 2.0, 4.0, 5.0, 8.0, 10.0, 16.0, 20.0, 40.0])
    wb = [0.3354, 0.3911, 0.4367, 0.8218, 0.9570, 1.0559, 1.0484, 0.9183, 0.7979, 0.4142]
    wd = [0.8528, 1.0110, 0.8902, 0.5119, 0.4091, 0.2531, 0.2017, 0.1254, 0.1002, 0.0494]
    np.testing.assert_allclose(np.abs(WEIGHTINGS["Wb"](f)), wb, atol=6e-5)
    np.testing.assert_allclose(np.abs(WEIGHTINGS["Wd"](f)), wd, atol=6e-5)


def test_mean_comfort_of_harmonic_accelerations() -> None:
    interval = 5e-3
    time = np.arange(0.0, 60.0, interval)
    lateral, vertical = 0.3 * np.sin(2 * np.pi * time), 0.4 * np.sin(2 * np.pi * 8.0 * time)
    value = mean_comfort(np.stack([0.0 * time, lateral, vertical], axis=1), interval)
    assert value == pytest.approx(6.0 * np.hypot(1.0110 * 0.3, 1.0559 * 0.4) / np.sqrt(2.0), rel=2e-4)
    with pytest.raises(ValueError, match="must be 5 s at least"):
        block_rms(lateral[:100], interval)


@pytest.mark.parametrize(
    ("frequency", "expected"), [(1.0, 2.609), (2.0, 2.788), (5.0, 3.039), (8.0, 2.828), (12.0, 2.443)]
)
def test_sperling_comfort_of_harmonic_accelerations(frequency: float, expected: float) -> None:
    """Amplitude of 0.5 m/s2: (A^2 B^2)^(1/6.67) with A in cm/s2, which differs from the rms form by 0.1 %."""
    time = np.arange(0.0, 20.0, 5e-3)
    acceleration = 0.5 * np.sin(2 * np.pi * frequency * time)
    vertical, lateral = (sperling_comfort(acceleration, 5e-3, way) for way in DIRECTIONS)
    assert vertical == pytest.approx(expected, rel=2e-3)
    assert lateral == pytest.approx(vertical * (0.737 / 0.588) ** 0.3, rel=1e-9)


DIRECTIONS: tuple[Literal["vertical", "lateral"], ...] = ("vertical", "lateral")
