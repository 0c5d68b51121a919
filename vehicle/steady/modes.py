"""Linear modes of the wagon about an equilibrium."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from wheelrail.contact.kinematics.frames import Side
from wheelrail.contact.kinematics.wheelset_state import WheelsetState
from wheelrail.contact.results.result import ContactResult
from wheelrail.contact.results.vehicle_contact import VehicleContact
from wheelrail.support.arrays import Array
from wheelrail.vehicle.dynamics.equations import Dynamics, Evaluation
from wheelrail.vehicle.dynamics.jacobian import Jacobian
from wheelrail.vehicle.dynamics.state import COORDINATES, COUNT, PITCH
from wheelrail.vehicle.integration.step_control import StepStatistics
from wheelrail.vehicle.steady.equilibrium import Equilibrium, equilibrium
from wheelrail.vehicle.track.track import Track
from wheelrail.vehicle.wagon.wagon import Wagon

AT_REST = 5e-2  # of the motions of axle and rails in a mode: largest motion of the bodies that is not a mode of theirs


@dataclass(frozen=True)
class Mode:
    """A motion Re(shape exp(eigenvalue t)) of n coordinates, the ten of the plane wagon by default.

    Parameters:
        eigenvalue: 1/s.
        shape: (n,) m and rad.
        energy_fraction: (n,) fraction of the kinetic energy in each coordinate.
        names: of the coordinates.
    """

    eigenvalue: complex
    shape: NDArray[np.complex128]
    energy_fraction: Array
    names: tuple[str, ...] = COORDINATES

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


def modes(dynamics: Dynamics, at: Equilibrium | None = None, *, time: float = 0.0) -> list[Mode]:
    """Linear modes in ascending order of frequency; one of each complex conjugate pair.

    Parameters:
        dynamics: equations of motion.
        at: equilibrium at the time; None: computed.
        time: s, at which speed and track are taken.

    The contact is linearised by its tangent, creep forces included, or by differences. The zero mode of the rolling
    angle is left out, and so is the decay of motions of axle and rails that hardly moves the bodies. Raises
    EquilibriumError, and StepFailure where a contact solve fails.
    """
    solution = at or equilibrium(dynamics, time=time)
    return _modes_of(dynamics, _matrix(dynamics, time, solution), fixed=())


def fixed_wheelset_modes(wagon: Wagon) -> list[Mode]:
    """Modes of car body and bogie on straight level track with a fixed wheelset, without a contact model."""
    dynamics = Dynamics(wagon, Track(), _ConstantLoad(wagon.wheel_load), speed=1.0)
    state = np.zeros(dynamics.size)
    contacts = dynamics.solve_contacts(dynamics.track.frame(0.0, 1.0), state, None)
    return _modes_of(dynamics, _matrix(dynamics, 0.0, Equilibrium(state, contacts, 0, 0.0)), fixed=range(6, COUNT))


@dataclass(frozen=True)
class _ConstantLoad(VehicleContact):
    """A constant load N on each wheel."""

    load: float

    def __call__(self, state: WheelsetState, side: Side, guess: ContactResult | None = None) -> ContactResult:
        return ContactResult(np.array([0.0, 0.0, self.load]), np.zeros(3), status="converged")


def _matrix(dynamics: Dynamics, time: float, at: Equilibrium) -> Array:
    evaluation = Evaluation(np.zeros_like(at.state), at.contacts, 0.0)
    return Jacobian(dynamics, StepStatistics(), central=True)(time, at.state, evaluation).by_state


def _modes_of(dynamics: Dynamics, matrix: Array, *, fixed: Iterable[int]) -> list[Mode]:
    """Modes of the first-order system with some coordinates (and their rates) fixed."""
    removed = {i + part for i in fixed for part in (0, COUNT)}
    free = [i for i in range(len(matrix)) if i not in removed]
    values, vectors = np.linalg.eig(matrix[np.ix_(free, free)])
    shapes = np.zeros((len(matrix), len(values)), dtype=complex)
    shapes[free] = vectors
    first = len(matrix) - dynamics.motions
    last = len(matrix) - (0 if dynamics.structure is None else dynamics.structure.velocities)
    all_modes = [
        _mode(dynamics, complex(values[i]), shapes[:COUNT, i])
        for i in np.argsort(np.abs(values), kind="stable")
        if np.abs(shapes[:COUNT, i]).max() > AT_REST * np.abs(shapes[first:last, i]).max(initial=0.0)
    ]
    return [
        m
        for m in all_modes
        if m.eigenvalue.imag >= 0.0 and not (m.eigenvalue == 0.0 and m.energy_fraction[PITCH] == 1.0)
    ]


def _mode(dynamics: Dynamics, value: complex, shape: NDArray[np.complex128]) -> Mode:
    mass, roll, pitch, _, _ = dynamics.constants
    energy = np.append(np.stack([mass, mass, roll], axis=1).ravel(), pitch[2]) * np.abs(shape) ** 2
    return Mode(value, shape / shape[np.argmax(np.abs(shape))], energy / energy.sum())
