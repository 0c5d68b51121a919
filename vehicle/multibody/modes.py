"""Linear modes of a vehicle over speed, and its linear critical speed."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass, replace
from itertools import pairwise

import numpy as np
from numpy.typing import NDArray

from wheelrail.support.arrays import Array
from wheelrail.vehicle.integration.step_control import StepStatistics
from wheelrail.vehicle.multibody.equations import VehicleDynamics, VehicleEvaluation
from wheelrail.vehicle.multibody.equilibrium import VehicleEquilibrium, vehicle_equilibrium
from wheelrail.vehicle.multibody.jacobian import VehicleJacobian
from wheelrail.vehicle.steady.modes import Mode
from wheelrail.vehicle.track.track import Track

SLOWEST = 0.8  # Hz: slower modes, of creep along the track and of the speed hold, are no instability of the running


@dataclass(frozen=True)
class CriticalSpeed:
    """Lowest speed of a range at which a mode is no longer damped.

    Parameters:
        speed: m/s.
        mode: with the largest real part at this speed.
    """

    speed: float
    mode: Mode

    @property
    def wavelength(self) -> float:
        """Of the motion along the track, m."""
        return self.speed / self.mode.frequency


def vehicle_modes(dynamics: VehicleDynamics, at: VehicleEquilibrium | None = None) -> list[Mode]:
    """Linear modes in ascending order of frequency; one of each complex conjugate pair.

    Parameters:
        dynamics: equations of motion.
        at: equilibrium; None: computed.

    The contact is linearised by its tangent, creep forces included, or by central differences. The wheelsets' angles
    of rolling, on which no force depends, are left out. Raises EquilibriumError, and StepFailure where a contact solve
    fails.
    """
    solution = at or vehicle_equilibrium(dynamics)
    linearise = VehicleJacobian(solution.dynamics, StepStatistics(), central=True)
    evaluation = VehicleEvaluation(np.zeros_like(solution.state), solution.contacts)
    matrix = linearise(0.0, solution.state, evaluation).by_state
    return _modes_of(solution.dynamics, matrix, fixed=())


def held_wheelset_modes(dynamics: VehicleDynamics) -> list[Mode]:
    """Modes of the bodies above wheelsets that are held on straight level track, without the contact.

    Parameters:
        dynamics: equations of motion, of which track and contact are not used.
    """
    coordinates, n = dynamics.coordinates, dynamics.size
    straight = replace(dynamics, track=Track())
    wrenches = np.zeros((len(coordinates.wheelset_bodies), 6))
    matrix = np.zeros((n, n))
    matrix[: coordinates.count, coordinates.count : 2 * coordinates.count] = np.eye(coordinates.count)
    bodies = straight.bodies.derivatives(straight.speed_profile(0.0), 0.0, np.zeros(n), wrenches)
    matrix[coordinates.count :] = bodies.by_state
    fixed = np.concatenate([coordinates.of_body(body) for body in coordinates.wheelset_bodies.tolist()])
    return _modes_of(straight, matrix, fixed=fixed.tolist())


def modes_over_speed(dynamics: VehicleDynamics, speeds: Sequence[float]) -> list[list[Mode]]:
    """Linear modes on the track of the dynamics at speeds (n,) m/s, each equilibrium the guess of the next one.

    Raises EquilibriumError, StepFailure.
    """
    modes, guess = [], None
    for speed in speeds:
        at = _equilibrium_at(dynamics, speed, guess)
        modes.append(vehicle_modes(at.dynamics, at))
        guess = at.state
    return modes


def least_damped(modes: Iterable[Mode]) -> Mode:
    """The oscillating mode above 0.8 Hz with the largest real part. Raises ValueError without such a mode."""
    candidates = [mode for mode in modes if mode.eigenvalue.imag > 2 * np.pi * SLOWEST]
    if not candidates:
        raise ValueError(f"no mode oscillates above {SLOWEST:g} Hz")
    return max(candidates, key=lambda mode: mode.eigenvalue.real)


def critical_speed(
    dynamics: VehicleDynamics, speeds: tuple[float, float], *, interval: float = 10.0, tolerance: float = 0.01
) -> CriticalSpeed | None:
    """Linear critical speed on the track of the dynamics: the largest real part of the eigenvalues crosses zero.

    Parameters:
        dynamics: equations of motion.
        speeds: lowest and highest of the range, m/s.
        interval: largest distance of the speeds between which a crossing is looked for, m/s.
        tolerance: of the critical speed, m/s.

    Returns None if all modes are damped at all speeds looked at; the lowest speed if one is not damped there. Raises
    EquilibriumError, StepFailure, and ValueError for a range that is not positive and increasing.
    """
    from scipy.optimize import brentq

    if not 0.0 < speeds[0] < speeds[1]:
        raise ValueError(f"speeds {speeds} m/s: must be positive and increase")
    modes: dict[float, Mode] = {}
    guess: Array | None = None

    def growth(speed: float) -> float:
        nonlocal guess
        if speed not in modes:
            at = _equilibrium_at(dynamics, speed, guess)
            guess, modes[speed] = at.state, least_damped(vehicle_modes(at.dynamics, at))
        return modes[speed].eigenvalue.real

    count = int(np.ceil((speeds[1] - speeds[0]) / interval)) + 1
    samples = np.linspace(*speeds, count).tolist()
    if growth(samples[0]) >= 0.0:
        return CriticalSpeed(samples[0], modes[samples[0]])
    for low, high in pairwise(samples):
        if growth(high) >= 0.0:
            speed = float(brentq(growth, low, high, xtol=tolerance, rtol=1e-12))
            growth(speed)
            return CriticalSpeed(speed, modes[speed])
    return None


def _equilibrium_at(dynamics: VehicleDynamics, speed: float, guess: Array | None) -> VehicleEquilibrium:
    return vehicle_equilibrium(replace(dynamics, speed=speed), guess=guess)


def _modes_of(dynamics: VehicleDynamics, matrix: Array, *, fixed: Sequence[int]) -> list[Mode]:
    """Modes of the first-order system with some coordinates (and their rates) fixed, without angles of rolling."""
    coordinates = dynamics.coordinates
    removed = {i + part for i in fixed for part in (0, coordinates.count)} | set(coordinates.rolling_angles.tolist())
    free = [i for i in range(len(matrix)) if i not in removed]
    values, vectors = np.linalg.eig(matrix[np.ix_(free, free)])
    shapes = np.zeros((len(matrix), len(values)), dtype=complex)
    shapes[free] = vectors
    order = np.argsort(np.abs(values), kind="stable")
    return [_mode(dynamics, complex(values[i]), shapes[:, i]) for i in order if values[i].imag >= 0.0]


def _mode(dynamics: VehicleDynamics, value: complex, vector: NDArray[np.complex128]) -> Mode:
    c = dynamics.coordinates.count
    energy = dynamics.coordinates.inertia * np.abs(vector[c : 2 * c]) ** 2
    shape = vector[:c]
    return Mode(value, shape / shape[np.argmax(np.abs(shape))], energy / energy.sum(), dynamics.coordinates.names)
