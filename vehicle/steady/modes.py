"""Linear modes of a vehicle about an equilibrium."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from wheelrail.support.arrays import Array
from wheelrail.vehicle.integration.step_control import StepStatistics
from wheelrail.vehicle.multibody.equations import VehicleDynamics, VehicleEvaluation
from wheelrail.vehicle.multibody.jacobian import VehicleJacobian
from wheelrail.vehicle.steady.equilibrium import Equilibrium, equilibrium
from wheelrail.vehicle.track.track import Track

AT_REST = 5e-2  # of the motions of axle and rails in a mode: largest motion of the bodies that is not a mode of theirs


@dataclass(frozen=True)
class Mode:
    """A motion Re(shape exp(eigenvalue t)) of n coordinates.

    Parameters:
        eigenvalue: 1/s.
        shape: (n,) m and rad.
        energy_fraction: (n,) fraction of the kinetic energy in each coordinate.
        names: of the coordinates.
    """

    eigenvalue: complex
    shape: NDArray[np.complex128]
    energy_fraction: Array
    names: tuple[str, ...]

    @property
    def frequency(self) -> float:
        """Natural frequency |eigenvalue| / 2 pi, Hz; of a mode without oscillation 1 / (2 pi time constant)."""
        return abs(self.eigenvalue) / (2 * np.pi)

    @property
    def damping(self) -> float:
        """Damping ratio; 1: decay without oscillation, negative: unstable."""
        return -self.eigenvalue.real / (abs(self.eigenvalue) or 1.0)

    @property
    def oscillates(self) -> bool:
        """Whether the mode oscillates."""
        return self.eigenvalue.imag != 0.0

    @property
    def main_coordinates(self) -> str:
        """Coordinates with at least a tenth of the kinetic energy, in descending order."""
        order = [i for i in np.argsort(-self.energy_fraction) if self.energy_fraction[i] >= 0.1]
        return ", ".join(f"{self.names[i]} {self.energy_fraction[i]:.0%}" for i in order)

    def __str__(self) -> str:
        return f"{self.frequency:9.4g} Hz  damping {self.damping:7.4f}  {self.main_coordinates}"


def modes(dynamics: VehicleDynamics, at: Equilibrium | None = None, *, time: float = 0.0) -> list[Mode]:
    """Linear modes in ascending order of frequency; one of each complex conjugate pair.

    Parameters:
        dynamics: equations of motion.
        at: equilibrium at the time; None: computed.
        time: s, at which speed and track are taken.

    The contact is linearised by its tangent, creep forces included, or by central differences. Motions of which no
    force depends on the coordinates, as of the wheelsets' angles of rolling, are left out, and so is the decay of
    motions of axle and rails that hardly moves the bodies. Friction of elements sticks: what remains is the spring in
    series with each slider. Raises EquilibriumError, and StepFailure where a contact
    solve fails.
    """
    solution = at or equilibrium(dynamics, time=time)
    return _modes_of(solution.dynamics, linearised(solution)[1], fixed=np.empty(0, dtype=np.int64))


def linearised(solution: Equilibrium) -> tuple[Array, Array]:
    """State (n,) about which motions are linearised, its sliders stuck, and matrix (n, n) of their rates."""
    linearise = VehicleJacobian(solution.dynamics, StepStatistics(), central=True)
    evaluation = VehicleEvaluation(np.zeros_like(solution.state), solution.contacts)
    state, d = solution.state, solution.dynamics
    if d.settle is not None:
        state = d.bodies.stuck(d.speed_profile(solution.time), state)
    return state, linearise(solution.time, state, evaluation).by_state


def held_wheelset_modes(dynamics: VehicleDynamics) -> list[Mode]:
    """Modes of the bodies above wheelsets that are held on straight level track, without the contact.

    Parameters:
        dynamics: equations of motion, of which track, contact and structure are not used.
    """
    straight = replace(dynamics, track=Track(), structure=None)
    coordinates, n = straight.coordinates, straight.size
    wrenches = np.zeros((len(coordinates.wheelset_bodies), 6))
    matrix = np.zeros((n, n))
    matrix[: coordinates.count, coordinates.count : 2 * coordinates.count] = np.eye(coordinates.count)
    bodies = straight.bodies.derivatives(straight.speed_profile(0.0), 0.0, np.zeros(n), wrenches)
    places = coordinates.of_bodies
    matrix[places[len(coordinates.free) :, None], places] = bodies.by_state
    fixed = np.concatenate([coordinates.of_body(body) for body in coordinates.wheelset_bodies.tolist()])
    fixed = np.append(fixed, np.arange(n)[coordinates.twists])
    return _modes_of(straight, matrix, fixed=fixed)


def _modes_of(dynamics: VehicleDynamics, matrix: Array, *, fixed: NDArray[np.int64]) -> list[Mode]:
    """Modes of the first-order system with some coordinates (and their rates) fixed."""
    coordinates, c, m = dynamics.coordinates, dynamics.coordinates.count, dynamics.coordinates.size
    rolling = np.setdiff1d(coordinates.forceless, fixed)
    still = np.concatenate([fixed, c + fixed, rolling, coordinates.slider_components])
    free = np.setdiff1d(np.arange(len(matrix)), still)
    values, vectors = np.linalg.eig(matrix[np.ix_(free, free)])
    shapes = np.zeros((len(matrix), len(values)), dtype=complex)
    shapes[free] = vectors
    moving = values != 0.0
    shapes[np.ix_(rolling, moving)] = shapes[np.ix_(c + rolling, moving)] / values[moving]
    largest = np.abs(shapes[:c]).max(axis=0)
    beside = np.abs(shapes[m:][~dynamics.structures.velocities]).max(axis=0, initial=0.0)
    shown = (values.imag >= 0.0) & (largest > AT_REST * beside)
    order = np.argsort(np.abs(values), kind="stable")
    return [_mode(dynamics, complex(values[i]), shapes[:, i]) for i in order if shown[i]]


def _mode(dynamics: VehicleDynamics, value: complex, vector: NDArray[np.complex128]) -> Mode:
    c = dynamics.coordinates.count
    energy = dynamics.coordinates.inertia * np.abs(vector[:c]) ** 2
    shape = vector[:c]
    return Mode(value, shape / shape[np.argmax(np.abs(shape))], energy / energy.sum(), dynamics.coordinates.names)
