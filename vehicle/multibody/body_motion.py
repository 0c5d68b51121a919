"""Position, velocity and axes of the bodies, each in the track frame at its own distance."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from typing import NamedTuple

import numpy as np

from wheelrail.contact.kinematics.frames import cross
from wheelrail.support.arrays import Array
from wheelrail.vehicle.multibody.coordinates import PITCH, ROLL, YAW, Coordinates, X, Y, Z
from wheelrail.vehicle.multibody.rotations import body_rotation, rotate
from wheelrail.vehicle.track.section_poses import SectionPoses, TrackSections
from wheelrail.vehicle.track.speed_profile import TrackPosition


class RelativeMotion(NamedTuple):
    """Motion of n bodies in the track frames at their own distances, components in these frames.

    Parameters:
        speed: (..., n) m/s of the frame along the track.
        offset, offset_rate: (..., n, 3) centre of mass from the centre line, m, and its rate in the frame, m/s.
        frame_rate: (..., n, 3) angular velocity of the frame, rad/s.
        roll_axis, axle: (..., n, 3) axes of the roll rate and of the spin.
        spin: (..., n) rad/s about the axle.
        rotation: (..., n, 3, 3) axes of the bodies as columns; those of wheelsets do not spin.
    """

    speed: Array
    offset: Array
    offset_rate: Array
    frame_rate: Array
    roll_axis: Array
    axle: Array
    spin: Array
    rotation: Array


class BodyMotion(NamedTuple):
    """Motion of n bodies in common axes.

    Parameters:
        sections: track sections at the bodies.
        relative: motion in the sections.
        position, velocity: (..., n, 3) m and m/s of the centres of mass.
        axes: (..., n, 3, 3) of the bodies as columns; those of wheelsets do not spin.
        rate: (..., n, 3) rad/s, angular velocity of these axes.
    """

    sections: SectionPoses
    relative: RelativeMotion
    position: Array
    velocity: Array
    axes: Array
    rate: Array


@dataclass(frozen=True)
class BodyKinematics:
    """Motion of the bodies of a vehicle on a track.

    Parameters:
        coordinates: of the vehicle.
        sections: of the track.
    """

    coordinates: Coordinates
    sections: TrackSections

    @cached_property
    def nominal(self) -> Array:
        """(n, 3): place along the vehicle m, height m, and 1 for a wheelset."""
        return np.array([(b.x, b.height, float(b.wheelset)) for b in self.coordinates.vehicle.bodies.values()])

    def distances(self, travel: TrackPosition, state: Array) -> Array:
        """Distances (..., n) m of the bodies along the track."""
        position, _, _ = self.coordinates.split(state)
        return np.asarray(travel.distance + self.nominal[:, 0] + position[..., X])

    def __call__(self, travel: TrackPosition, state: Array) -> BodyMotion:
        """Motion in the axes of the heading near the reference's distance, see `compiled.equations.near`.

        Parameters:
            travel: reference motion along the track.
            state: (..., 2 c + m).
        """
        q, rate, _ = self.coordinates.split(state)
        ahead = 100.0 * np.floor(0.01 * q[..., 0, X].flat[0] + 0.5)
        sections = self.sections.at(self.distances(travel, state), travel.distance + ahead)
        relative = self._relative(travel, sections, q, rate)
        velocity = relative.offset_rate + cross(relative.frame_rate, relative.offset)
        velocity[..., 0] += relative.speed
        wheelset = self.nominal[:, 2] > 0.0
        axes_rate = relative.frame_rate + rate[..., ROLL, None] * relative.roll_axis
        axes_rate[..., 2] += rate[..., YAW]
        axes_rate = axes_rate + np.where(wheelset, 0.0, relative.spin)[..., None] * relative.axle
        return BodyMotion(
            sections,
            relative,
            sections.position + rotate(sections.axes, relative.offset),
            rotate(sections.axes, velocity),
            sections.axes @ relative.rotation,
            rotate(sections.axes, axes_rate),
        )

    def _relative(self, travel: TrackPosition, sections: SectionPoses, q: Array, rate: Array) -> RelativeMotion:
        _, height, wheelset = self.nominal.T
        speed = travel.speed + rate[..., X]
        zero = np.zeros_like(speed)
        roll, yaw = q[..., ROLL], q[..., YAW]
        return RelativeMotion(
            speed,
            offset=np.stack([zero, q[..., Y], height + q[..., Z]], axis=-1),
            offset_rate=np.stack([zero, rate[..., Y], rate[..., Z]], axis=-1),
            frame_rate=speed[..., None] * sections.rate,
            roll_axis=np.stack([np.cos(yaw), np.sin(yaw), zero], axis=-1),
            axle=np.stack([-np.sin(yaw) * np.cos(roll), np.cos(yaw) * np.cos(roll), np.sin(roll)], axis=-1),
            spin=rate[..., PITCH] + wheelset * travel.speed / self.coordinates.vehicle.radius,
            rotation=body_rotation(roll, np.where(wheelset > 0.0, 0.0, q[..., PITCH]), yaw),
        )
