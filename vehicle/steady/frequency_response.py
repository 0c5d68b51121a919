"""Linear response of a vehicle on straight track to irregularities of the rails, over frequency."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from wheelrail.support.arrays import Array
from wheelrail.vehicle.multibody.coordinates import PITCH, ROLL, YAW, Y, Z
from wheelrail.vehicle.multibody.equations import VehicleDynamics
from wheelrail.vehicle.steady.equilibrium import Equilibrium, equilibrium
from wheelrail.vehicle.steady.modes import linearised
from wheelrail.vehicle.track.irregularity import QUANTITIES, Irregularities
from wheelrail.vehicle.track.track import Track

AMPLITUDE = 1e-6  # m, of the waves by which the forces are differentiated
PER_WAVE = 40  # stations of a wave
BESIDE = 20.0  # m of waves ahead of and behind the vehicle


@dataclass(frozen=True)
class FrequencyResponse:
    """Amplitudes by an amplitude of 1 m of each irregularity at the vehicle's reference point, complex.

    Parameters:
        frequency: (f,) Hz.
        state: (f, 4, n) of the states, by alignment, level, cross level, gauge.
        solution: equilibrium about which motions are linearised.
    """

    frequency: Array
    state: NDArray[np.complex128]
    solution: Equilibrium

    def coordinate(self, body: str, index: int) -> NDArray[np.complex128]:
        """Amplitudes (f, 4) m or rad of a coordinate of a body; 0 for a held one."""
        coordinates = self.solution.dynamics.coordinates
        if coordinates.held[coordinates.vehicle.names.index(body), index]:
            return np.zeros(self.state.shape[:2], dtype=complex)
        return np.asarray(self.state[..., coordinates.index(body, index)])

    def acceleration(self, body: str, point: Sequence[float]) -> NDArray[np.complex128]:
        """Lateral and vertical acceleration minus gravity (f, 4, 2) m/s2 of a point in the body's axes.

        Parameters:
            body: name.
            point: (3,) m in the nominal position, as of `Accelerometer`.
        """
        own, vehicle = self.solution.dynamics.vehicle.bodies[body], self.solution.dynamics.vehicle
        x, y, z = np.array(point) - (own.x, 0.0, own.height)
        squared = -((2.0 * np.pi * self.frequency[:, None]) ** 2)
        of = {index: self.coordinate(body, index) for index in (Y, Z, ROLL, PITCH, YAW)}
        lateral = squared * (of[Y] + x * of[YAW] - z * of[ROLL]) + vehicle.gravity * of[ROLL]
        vertical = squared * (of[Z] + y * of[ROLL] - x * of[PITCH])
        return np.stack([lateral, vertical], axis=-1)


def frequency_response(dynamics: VehicleDynamics, frequency: Array) -> FrequencyResponse:
    """Response to harmonic irregularities of the wavelengths of the speed over the frequencies.

    Parameters:
        dynamics: equations of motion on straight track at constant speed.
        frequency: (f,) Hz, positive.

    Forces are differentiated by waves of 1 um at the equilibrium; friction of elements sticks as for `modes`. Raises
    EquilibriumError, StepFailure, and ValueError for frequencies that are not positive.
    """
    if not (frequency > 0.0).all():
        raise ValueError("frequencies: must be positive")
    solution = equilibrium(replace(dynamics, track=Track()))
    state, matrix = linearised(solution)
    still = np.union1d(solution.dynamics.coordinates.forceless, solution.dynamics.coordinates.slider_components)
    free = np.setdiff1d(np.arange(len(matrix)), still)
    speed = dynamics.speed_profile(0.0).speed
    found = np.zeros((len(frequency), len(QUANTITIES), len(matrix)), dtype=complex)
    for i, f in enumerate(frequency.tolist()):
        forced = np.stack([_forcing(solution, state, speed / f, column) for column in range(len(QUANTITIES))], axis=1)
        system = 2j * np.pi * f * np.eye(len(free)) - matrix[np.ix_(free, free)]
        found[i][:, free] = np.linalg.solve(system, forced[free]).T
    return FrequencyResponse(frequency, found, solution)


def _forcing(solution: Equilibrium, state: Array, wavelength: float, column: int) -> NDArray[np.complex128]:
    """Rates (n,) of the state by the amplitude of a wave of an irregularity exp(2 pi i s / wavelength)."""
    d, places = solution.dynamics, solution.dynamics.coordinates.places
    low, high = float(places.min()) - BESIDE, float(places.max()) + BESIDE
    centre = d.speed_profile(solution.time).distance
    count = int(np.ceil((high - low) / min(wavelength, BESIDE) * PER_WAVE)) + 1
    s = np.linspace(low, high, count)
    rates = []
    for wave in (np.cos, np.sin):
        values = np.zeros((count, len(QUANTITIES)))
        values[:, column] = AMPLITUDE * wave(2.0 * np.pi * s / wavelength)
        ends = []
        for sign in (1.0, -1.0):
            irregular = Irregularities.faded(centre + s, sign * values, start=centre + low, fade=0.45 * BESIDE)
            ends.append(replace(d, track=replace(d.track, irregularities=irregular))(solution.time, state).rate)
        rates.append((ends[0] - ends[1]) / (2.0 * AMPLITUDE))
    return np.asarray(rates[0] + 1j * rates[1])


def standard_deviations(response: NDArray[np.complex128], frequency: Array, density: Array) -> Mapping[str, float]:
    """Standard deviations of a quantity by each irregularity, and of all together without correlation.

    Parameters:
        response: (f, 4) amplitudes of the quantity by m.
        frequency: (f,) Hz, increasing.
        density: (f, 4) one-sided spectral densities m2/Hz.
    """
    power = np.abs(response) ** 2 * density
    variances = (0.5 * (power[1:] + power[:-1]) * np.diff(frequency)[:, None]).sum(axis=0)
    found = dict(zip(QUANTITIES, np.sqrt(variances).tolist(), strict=True))
    return found | {"all": float(np.sqrt(variances.sum()))}
