"""Newton's and Euler's equations of the bodies of a vehicle in NumPy, the definition of the compiled ones."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy_vehicle import BodyMotion, NumpySuspension, applied_state, hold_force, kinematics, rotate, rotate_back

from wheelrail.contact.kinematics.frames import cross
from wheelrail.support.arrays import Array
from wheelrail.vehicle.multibody.coordinates import PITCH, ROLL, YAW, X
from wheelrail.vehicle.multibody.equations import VehicleDynamics


def accelerations(dynamics: VehicleDynamics, time: float, state: Array, wrenches: Array) -> Array:
    """Accelerations of the free coordinates, then the rates of the springs of Maxwell elements, (..., c + m)."""
    return with_reactions(dynamics, time, state, wrenches)[0]


def with_reactions(dynamics: VehicleDynamics, time: float, state: Array, wrenches: Array) -> tuple[Array, Array]:
    """The same and the forces and moments (..., n, 6) of the constraints of held coordinates, zero for free ones.

    Parameters:
        dynamics: equations of motion.
        time: s.
        state: (..., 2 c + m).
        wrenches: (..., w, 6) force N and moment N m about the centre of each wheelset, in its track frame.
    """
    travel, wheelsets = dynamics.speed_profile(time), dynamics.coordinates.wheelset_bodies
    motion = kinematics(dynamics)(travel, state)
    _, rate, series = dynamics.coordinates.split(state)
    suspension = NumpySuspension(dynamics.suspension)(motion, series)
    force, moment = suspension.force, suspension.moment
    force[..., 2] -= dynamics.vehicle.gravity * dynamics.mass
    force += hold_force(dynamics, motion, state)
    if dynamics.loads:
        for index in np.ndindex(state.shape[:-1]):
            at = BodyMotion(*(part_of(part, index) for part in motion))
            applied = applied_state(dynamics.applied, travel, at, state[index])
            force[index] += applied.force
            moment[index] += applied.moment
    force, moment = rotate_back(motion.sections.axes, force), rotate_back(motion.sections.axes, moment)
    force[..., wheelsets, :] += wrenches[..., :3]
    moment[..., wheelsets, :] += wrenches[..., 3:]
    held, nominal = dynamics.coordinates.held == 1, np.zeros((len(dynamics.mass), 6))
    nominal[:, X] = travel.acceleration
    nominal[:, PITCH] = travel.acceleration / dynamics.vehicle.radius * kinematics(dynamics).nominal[:, 2]
    frame, (_, _, k, _) = motion.relative, motion.sections
    along = np.broadcast_to(np.eye(3), (*force.shape, 3)).copy()
    along[..., 0] += cross(k, frame.offset)
    mass = dynamics.mass[:, None, None] * np.swapaxes(along, -1, -2) @ along
    linear, forces = constrained(_translation(dynamics, motion, force), mass, held[:, :3], nominal[:, :3])
    vertical = np.broadcast_to([0.0, 0.0, 1.0], force.shape)
    turn = rotate_back(frame.rotation[..., None, :, :], np.stack([frame.roll_axis, frame.axle, vertical], axis=-2))
    inertia = (dynamics.inertia[:, None] * turn) @ np.swapaxes(turn, -1, -2)
    rotation = _rotation(dynamics, motion, rate, moment, linear[..., 0])
    angular, moments = constrained(rotation, inertia, held[:, 3:], nominal[:, 3:])
    coordinates = (np.concatenate([linear, angular], axis=-1) - nominal).reshape(*state.shape[:-1], -1)
    series_rate = suspension.series_rate @ dynamics.coordinates.from_series.T
    rates = np.concatenate([coordinates[..., dynamics.coordinates.free], series_rate], axis=-1)
    return rates, np.concatenate([forces, moments], axis=-1)


def constrained(free: Array, mass: Array, held: Array, nominal: Array) -> tuple[Array, Array]:
    """Accelerations (..., n, 3) next to free ones in which held coordinates have nominal ones, and what holds them.

    Parameters:
        free: (..., n, 3) of three coordinates of n bodies without constraints.
        mass: (..., n, 3, 3) matrices of the coordinates, which measure the distance: Gauss' principle.
        held: (n, 3) whether a coordinate is held.
        nominal: (n, 3).
    """
    result, reactions = free.copy(), np.zeros_like(free)
    for body in np.flatnonzero(held.any(axis=1)):
        which, inverse = held[body], np.linalg.inv(mass[..., body, :, :])
        misfit = (nominal[body] - free[..., body, :])[..., which]
        force = np.linalg.solve(inverse[..., which, :][..., which], misfit[..., None])[..., 0]
        reactions[..., body, which] = force
        result[..., body, :] += rotate(inverse[..., which], force)
        result[..., body, which] = nominal[body, which]
    return result, reactions


def part_of(part: Any, index: tuple[int, ...]) -> Any:
    """Those of the arrays of a motion that belong to one of its states."""
    return part[index] if isinstance(part, np.ndarray) else type(part)(*(part_of(inner, index) for inner in part))


def _translation(dynamics: VehicleDynamics, motion: BodyMotion, force: Array) -> Array:
    """Accelerations (..., n, 3) m/s2 along the path, in y and in z under forces (..., n, 3) N in the track frames."""
    frame, (_, _, k, k_slope) = motion.relative, motion.sections
    rate, tangent = frame.frame_rate, np.array([1.0, 0.0, 0.0])
    speed = frame.speed[..., None]
    inertial = speed**2 * cross(k_slope, frame.offset) + cross(rate, cross(rate, frame.offset))
    inertial += 2.0 * cross(rate, frame.offset_rate) + speed * cross(rate, np.broadcast_to(tangent, rate.shape))
    acceleration, lever = force / dynamics.mass[:, None] - inertial, cross(k, frame.offset)
    path = acceleration[..., 0] / (1.0 + lever[..., 0])
    lateral, vertical = (acceleration[..., i] - path * lever[..., i] for i in (1, 2))
    return np.stack([path, lateral, vertical], axis=-1)


def _rotation(dynamics: VehicleDynamics, motion: BodyMotion, rate: Array, moment: Array, path: Array) -> Array:
    """Second derivatives (..., n, 3) rad/s2 of roll, pitch and yaw.

    Parameters:
        dynamics: equations of motion.
        motion: of the bodies.
        rate: (..., n, 6) of the coordinates.
        moment: (..., n, 3) N m in the track frames.
        path: (..., n) m/s2 along the path.
    """
    frame, (_, _, k, k_slope) = motion.relative, motion.sections
    yaw_rate = np.zeros_like(moment)
    yaw_rate[..., 2] = rate[..., YAW]
    roll_rate, spin = rate[..., ROLL, None] * frame.roll_axis, frame.spin[..., None] * frame.axle
    before_roll = frame.frame_rate + yaw_rate
    before_spin = before_roll + roll_rate
    bias = path[..., None] * k + frame.speed[..., None] ** 2 * k_slope + cross(frame.frame_rate, yaw_rate)
    bias += cross(before_roll, roll_rate) + cross(before_spin, spin)
    angular = rotate_back(frame.rotation, before_spin + spin)
    right = rotate_back(frame.rotation, moment) - cross(angular, dynamics.inertia * angular)
    x, y, z = np.moveaxis(rotate(frame.rotation, right / dynamics.inertia) - bias, -1, 0)
    cos_yaw, sin_yaw = frame.roll_axis[..., 0], frame.roll_axis[..., 1]
    sin_roll = frame.axle[..., 2]
    pitch = (cos_yaw * y - sin_yaw * x) / np.sqrt(1.0 - sin_roll**2)
    return np.stack([cos_yaw * x + sin_yaw * y, pitch, z - sin_roll * pitch], axis=-1)
