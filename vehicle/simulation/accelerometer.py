"""Virtual accelerometers at points of the bodies of a vehicle."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from wheelrail.contact.kinematics.frames import cross
from wheelrail.support.arrays import Array
from wheelrail.vehicle.multibody.equations import VehicleDynamics
from wheelrail.vehicle.multibody.rotations import rotate_back


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
        suspension and speed hold, and the angular acceleration alpha by their moment.
        """
        d = self.dynamics
        index, body = d.vehicle.names.index(self.body), d.vehicle.bodies[self.body]
        motion = d.kinematics(d.speed_profile(time), state)
        suspension = d.suspension(motion, d.coordinates.split(state).series)
        force = suspension.force + d.hold_force(motion, state)
        axes = motion.axes[index]
        rate, moment = rotate_back(axes, motion.rate[index]), rotate_back(axes, suspension.moment[index])
        inertia, lever = d.inertia[index], np.array(self.point) - (body.x, 0.0, body.height)
        angular = (moment - cross(rate, inertia * rate)) / inertia
        centripetal = cross(rate, cross(rate, lever))
        return np.asarray(rotate_back(axes, force[index]) / body.mass + cross(angular, lever) + centripetal)
