"""Virtual accelerometers at points of the bodies of a vehicle."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from wheelrail.contact.kinematics.frames import cross
from wheelrail.support.arrays import Array
from wheelrail.vehicle.multibody.equations import VehicleDynamics


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

        Newton's and Euler's equations of the body: F / m + alpha x p + omega x (omega x p) with the force F of
        suspension, loads and speed hold, and the angular acceleration alpha by their moment.
        """
        d, travel = self.dynamics, self.dynamics.speed_profile(time)
        index, body = d.vehicle.names.index(self.body), d.vehicle.bodies[self.body]
        motions, wrenches = d.bodies.motions(travel, state)
        rate, (force, moment) = motions[index, 5], wrenches[index]
        rate, force, moment = (motions[index, 2:5] @ vector for vector in (rate, force, moment))
        inertia, lever = d.inertia[index], np.array(self.point) - (body.x, 0.0, body.height)
        angular = (moment - cross(rate, inertia * rate)) / inertia
        return np.asarray(force / body.mass + cross(angular, lever) + cross(rate, cross(rate, lever)))
