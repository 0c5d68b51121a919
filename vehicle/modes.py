"""Linear modes of car body and bogie above a wheelset that is held."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import Literal

import numpy as np
from numpy.typing import NDArray

from vehicle.suspension import Assembly
from vehicle.wagon import Wagon

Array = NDArray[np.float64]
Weight = Literal["full", "pendulum"]


@dataclass(frozen=True)
class Mode:
    """frequency Hz, |eigenvalue| / 2 pi; damping ratio; shape (6,) complex: y, z, roll of car body and bogie."""

    frequency: float
    damping: float
    shape: NDArray[np.complex128]


def modes(wagon: Wagon, *, weight: Weight = "full", step: float = 1e-6) -> list[Mode]:
    """Six modes on straight level track, lowest first, by central differences of the suspension's forces.

    weight "full" is the linearisation of the equations of motion, in which the springs carry their loads in the
    displaced position and lateral displacement of the car body overturns the bogie. "pendulum" keeps of this only the
    moment of the car body's weight about the secondary springs, as the usual linear models do.
    """
    plane = wagon.plane
    masses = np.array([[b.mass, b.mass, b.roll_inertia] for b in (plane.car_body, plane.bogie)]).ravel()
    weightless = weight == "pendulum"
    assembly = Assembly.of(replace(wagon, gravity=0.0) if weightless else wagon)

    def accelerations(state: Array) -> Array:
        full = np.zeros((2, 3, 3))
        full[:, :2] = state.reshape(2, 2, 3)
        return np.asarray(assembly.forces(full[0], full[1]).on_bodies[:2].ravel() / masses)

    jacobian = np.stack([accelerations(e) - accelerations(-e) for e in step * np.eye(12)], axis=1) / (2 * step)
    if weightless:
        arm = plane.car_body.height - plane.secondary.spring_height
        jacobian[2, 2] += plane.gravity * plane.car_body.mass * arm / plane.car_body.roll_inertia
    values, vectors = np.linalg.eig(np.vstack([np.eye(12)[6:], jacobian]))
    chosen = [i for i in np.argsort(np.abs(values)) if values[i].imag > 0.0]
    return [
        Mode(float(abs(values[i]) / (2 * np.pi)), float(-values[i].real / abs(values[i])), vectors[:6, i])
        for i in chosen
    ]
