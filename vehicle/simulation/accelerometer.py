"""Virtual accelerometers at points of the bodies of a vehicle."""

from __future__ import annotations

from dataclasses import dataclass
from typing import NamedTuple

import numpy as np

from wheelrail.contact.kinematics.frames import cross
from wheelrail.support.arrays import Array
from wheelrail.vehicle.multibody.body_equations import BodyEquations
from wheelrail.vehicle.multibody.equations import VehicleDynamics
from wheelrail.vehicle.track.speed_profile import TrackPosition


class BodyMotion(NamedTuple):
    """Acceleration minus gravity m/s2 of a body's centre, angular acceleration rad/s2 and velocity rad/s, each (3,) in
    the body's axes.
    """

    centre: Array
    angular: Array
    rate: Array

    def at(self, lever: Array) -> Array:
        """Acceleration minus gravity (3,) m/s2 of a point at (3,) m from the centre."""
        turning = cross(self.angular, lever) + cross(self.rate, cross(self.rate, lever))
        return np.asarray(self.centre + turning)


def body_motion(bodies: BodyEquations, travel: TrackPosition, state: Array, name: str) -> BodyMotion:
    """Motion of a body that no contact acts on, by Newton's and Euler's equations with the force and moment of
    suspension, loads and speed hold.

    Parameters:
        bodies: equations of motion.
        travel: reference motion along the track.
        state: (2 c + m,).
        name: of the body, without held coordinates.
    """
    vehicle = bodies.coordinates.vehicle
    index, body = vehicle.names.index(name), vehicle.bodies[name]
    motions, wrenches = bodies.motions(travel, state)
    rate, (force, moment) = motions[index, 5], wrenches[index]
    rate, force, moment = (motions[index, 2:5] @ vector for vector in (rate, force, moment))
    inertia = np.array(body.inertia)
    return BodyMotion(force / body.mass, (moment - cross(rate, inertia * rate)) / inertia, rate)


@dataclass(frozen=True)
class Accelerometer:
    """Sensor at a point of a body, with axes x, y, z of the body; it measures acceleration minus gravity.

    Parameters:
        dynamics: equations of motion.
        body: name, of no wheelset.
        point: (3,) m in the nominal position: x forward of the vehicle's reference point, y to the left, height above
            top of rail.

    Raises ValueError for another body.
    """

    dynamics: VehicleDynamics
    body: str
    point: tuple[float, float, float]

    def __post_init__(self) -> None:
        vehicle = self.dynamics.vehicle
        allowed = [name for name in vehicle.names if name not in vehicle.wheelsets]
        if self.body not in allowed:
            raise ValueError(f"accelerometer: body {self.body!r}: must be one of {', '.join(allowed)}")

    def __call__(self, time: float, state: Array) -> Array:
        """Acceleration minus gravity (3,) m/s2 at the point, in the body's axes.

        Parameters:
            time: s.
            state: (2 c + m,).
        """
        d, body = self.dynamics, self.dynamics.vehicle.bodies[self.body]
        lever = np.array(self.point) - (body.x, 0.0, body.height)
        return body_motion(d.bodies, d.speed_profile(time), state, self.body).at(lever)
