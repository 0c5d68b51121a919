"""Frequency response to irregularities against a chain of masses, and a wave in time."""

from __future__ import annotations

import numpy as np
import pytest
from standin_contact import CONTACT, STIFFNESS

from wheelrail.scenes.builders.vehicle_file import load_vehicle
from wheelrail.vehicle.integration.integrate import StepSettings
from wheelrail.vehicle.multibody.coordinates import ROLL, Y, Z
from wheelrail.vehicle.multibody.equations import VehicleDynamics
from wheelrail.vehicle.simulation.simulate import simulate
from wheelrail.vehicle.simulation.time_run import Recording
from wheelrail.vehicle.steady.frequency_response import FrequencyResponse, frequency_response, standard_deviations
from wheelrail.vehicle.track.irregularity import Irregularities
from wheelrail.vehicle.track.track import Track

SPEED = 45.0
FREQUENCY = np.array([0.6, 1.1, 2.3, 5.0, 9.0, 14.0])


@pytest.fixture(scope="module")
def response() -> FrequencyResponse:
    return frequency_response(VehicleDynamics(load_vehicle(), Track(), CONTACT, SPEED), FREQUENCY)


def test_bounce_is_that_of_three_masses(response: FrequencyResponse) -> None:
    """The symmetric vehicle bounces by the part of the level that is even in its middle: cosines of its distances."""
    w = 2 * np.pi * FREQUENCY
    for i, (omega, k) in enumerate(zip(w, w / SPEED, strict=True)):
        steel, primary = 8 * STIFFNESS, 8 * (1.220e6 + 4e3j * omega)
        secondary = 4 * (430e3 + 20e3j * omega)
        stiffness = np.array(
            [
                [secondary, -secondary, 0.0],
                [-secondary, secondary + primary, -primary],
                [0.0, -primary, primary + steel],
            ]
        )
        mass = np.array([32000.0, 2 * 2615.0, 4 * 1813.0])
        level = np.cos(9.5 * k) * np.cos(1.28 * k)
        car, *_ = np.linalg.solve(stiffness - omega**2 * np.diag(mass), [0.0, 0.0, steel * level])
        assert response.coordinate("car_body", Z)[i, 1] == pytest.approx(car, rel=0.01, abs=1e-4)
        assert response.acceleration("car_body", (0.0, 0.0, 1.2))[i, 1, 1] == pytest.approx(
            -(omega**2) * response.coordinate("car_body", Z)[i, 1]
        )
    # level moves a symmetric vehicle neither sideways nor in roll; alignment does
    assert np.abs(response.coordinate("car_body", Y)[:, 1]).max() < 1e-6
    assert np.abs(response.coordinate("car_body", ROLL)[:, 1]).max() < 1e-6
    assert np.abs(response.coordinate("car_body", Y)[0, 0]) > 0.1
    with pytest.raises(ValueError, match="frequencies: must be positive"):
        frequency_response(response.solution.dynamics, np.array([0.0, 1.0]))


def test_a_wave_of_the_alignment_in_time(response: FrequencyResponse) -> None:
    """Amplitude of the wheelset and the bogie on a small wave, after its start has died out."""
    i = 3
    wavelength, size = SPEED / FREQUENCY[i], 1e-5
    s = np.linspace(0.0, 300.0, 3001)
    values = np.zeros((len(s), 4))
    values[:, 0] = size * np.cos(2 * np.pi * s / wavelength)
    track = Track(irregularities=Irregularities.faded(s, values, start=15.0))
    dynamics = VehicleDynamics(load_vehicle(), track, CONTACT, SPEED)
    steps = StepSettings("rosenbrock", rtol=1e-4, atol=3e-9)
    end = 3.0
    run = simulate(dynamics, (0.0, end), initial=response.solution.state, steps=steps, recording=Recording(0.01))
    late = run.time > end - 5.0 / FREQUENCY[i] + 1e-9
    basis = np.exp(-2j * np.pi * FREQUENCY[i] * run.time[late])
    for body in ("wheelset_2", "front_bogie"):
        y = run.state[late][:, dynamics.coordinates.index(body, Y)]
        found = 2 * np.mean(basis * (y - y.mean()))
        assert found == pytest.approx(size * response.coordinate(body, Y)[i, 0], abs=0.03 * size)


def test_standard_deviations_of_white_noise() -> None:
    """Response 2 and density 3 over 10 Hz: variance 120; the four are independent."""
    found = standard_deviations(np.full((11, 4), 2.0j), np.linspace(1.0, 11.0, 11), np.full((11, 4), 3.0))
    assert found["level"] == pytest.approx(120.0**0.5)
    assert found["all"] == pytest.approx(480.0**0.5)
