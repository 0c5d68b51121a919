"""The plane wagon in tests: indices, mirror images, prescribed frames and forces of the suspension."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy_vehicle import BodyMotion, NumpySuspension, kinematics
from track_frame import Frame

from wheelrail.support.arrays import Array
from wheelrail.vehicle.multibody.coordinates import YAW, Coordinates
from wheelrail.vehicle.multibody.coordinates import Y as LATERAL
from wheelrail.vehicle.multibody.equations import VehicleDynamics, WheelContacts, wheelset_wrenches
from wheelrail.vehicle.multibody.plane_wagon import COORDINATES
from wheelrail.vehicle.multibody.structures import Structures
from wheelrail.vehicle.track.speed_profile import TrackPosition

Y, Z, ROLL, PITCH = (COORDINATES.index(f"wheelset_{name}") for name in ("y", "z", "roll", "pitch"))
MIRROR = np.tile([-1.0 if name.endswith(("_y", "_roll")) else 1.0 for name in COORDINATES], 2)


def mirror_signs(coordinates: Coordinates, structures: Structures | None = None) -> Array:
    """Factors (2 c + m + k,) of a state that is mirrored at y = 0: of sums and differences of mirrored springs, too."""
    bodies = np.tile([1.0, -1.0, 1.0, -1.0, 1.0, -1.0], len(coordinates.vehicle.names))[coordinates.free]
    lateral = np.array([-1.0 if j == LATERAL else 1.0 for _, _, j in coordinates.internal])
    differences = np.where(np.diag(coordinates.series) < 0.0, -1.0, 1.0)
    elastic = structures.elastic if structures else ()
    parts = [sign * np.ones(n) for own in elastic for n in own.structure.sizes for sign in (1.0, -1.0)]
    return np.concatenate([bodies, bodies, lateral * differences, *parts])


def wrench_of(contacts: WheelContacts) -> Array:
    """Force N and moment N m (6,) of both contacts on the only wheelset."""
    (wrench,) = wheelset_wrenches(contacts)
    return wrench


def in_frame(dynamics: VehicleDynamics, frame: Frame, state: Array, wrench: Array) -> tuple[Array, float]:
    """Accelerations (10 + m,) in a prescribed frame under a wrench (6,), and the reaction of yaw N m."""
    rate = np.array(frame.rate) / frame.speed
    slope = (np.array(frame.rate_dot) - frame.acceleration * rate) / frame.speed**2
    normal = -np.array(frame.down)
    left = np.cross(normal, [1.0, 0.0, 0.0])
    left /= np.linalg.norm(left)
    axes = np.stack([np.cross(left, normal), left, normal])  # rows: x, y and z in space
    sections = np.array([np.zeros(3), *axes.T, rate, slope])
    at = np.tile(sections, (len(dynamics.vehicle.names), 1, 1))
    travel = TrackPosition(0.0, frame.speed, frame.acceleration)
    rates, reactions = dynamics.bodies.accelerations(travel, state, wrench[None], at)
    return rates, float(reactions[2, YAW] / np.cos(state[ROLL]))


class Suspension(NamedTuple):
    """Forces of the suspension on straight level track.

    Parameters:
        on_bodies: (..., 3, 3) lateral and vertical force N, roll moment N m about the centre, of the three bodies.
        deflection: (..., e, 2) m, lateral and vertical.
        force: (..., e, 2) N on the upper body.
        series_rate: (..., m) m/s.
    """

    on_bodies: Array
    deflection: Array
    force: Array
    series_rate: Array


def motion_of(dynamics: VehicleDynamics, position: Array, rate: Array) -> BodyMotion:
    """Motion at positions and rates (..., 3, 3): y m, z m, roll rad of the three bodies."""
    zero = np.zeros((*position.shape[:-2], 1))
    flat = position.reshape(*position.shape[:-2], 9), zero, rate.reshape(*rate.shape[:-2], 9), zero
    state = np.concatenate([*flat, np.zeros((*zero.shape[:-1], len(dynamics.coordinates.maxwell)))], axis=-1)
    return kinematics(dynamics)(TrackPosition(0.0, 1.0, 0.0), state)


def suspension(dynamics: VehicleDynamics, position: Array, rate: Array, series: Array | None = None) -> Suspension:
    """Forces at positions and rates (..., 3, 3) and spring deflections (..., m) m of Maxwell elements."""
    if series is None:
        series = np.zeros((*position.shape[:-2], len(dynamics.coordinates.maxwell)))
    found = NumpySuspension(dynamics.suspension)(motion_of(dynamics, position, rate), series)
    on_bodies = np.concatenate([found.force[..., 1:], found.moment[..., :1]], axis=-1)
    return Suspension(on_bodies, found.deflection[..., 1:], found.element_force[..., 1:], found.series_rate)


def constants(dynamics: VehicleDynamics) -> Array:
    """(5, 3): mass kg, roll, pitch and yaw inertia kg m2 and height m of the three bodies."""
    return np.array([(b.mass, *b.inertia, b.height) for b in dynamics.vehicle.bodies.values()]).T
