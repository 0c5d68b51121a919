"""Pose and motion of a left-hand pair whose hub and rail have moved, their derivatives, and the loads on both.

The hub's motion (x, y, z m, rotation vector rad, in the wheelset's axes) tilts the wheel against the wheelset; it
stands still in space while the wheel spins. The rail's motion (y, z m, roll rad about its foot) moves its profile.
Rates of both motions are neglected, as those of quasi-static deformation. Derivatives leave out that the velocity of
the rail against a rotating track frame changes as it moves: 1e-7 of the speed in a curve of 300 m.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import cached_property, partial

import numpy as np

from wheelrail.contact.kinematics.frames import MIRROR, Pose, RigidMotion, Twist
from wheelrail.contact.kinematics.sensitivity import skew
from wheelrail.contact.kinematics.wheelset_state import Mounting, WheelsetState
from wheelrail.contact.results.result import ContactResult, ForceTangent, LazyPatches, Patch
from wheelrail.support.arrays import Array

COORDINATES = len(WheelsetState.coordinates)  # of the wheelset, the first columns of all slopes
HUB = slice(COORDINATES, COORDINATES + 6)
RAIL = slice(COORDINATES + 6, COORDINATES + 9)
SLOPES = COORDINATES + 9  # columns: wheelset, hub, rail
X, Z = np.array([1.0, 0.0, 0.0]), np.array([0.0, 0.0, 1.0])


@dataclass(frozen=True, eq=False)
class RotatedTangent(ForceTangent):
    """Derivative of a force and its moment, both and the changes of pose and motion in rotated axes.

    Parameters:
        tangent: in the axes of the body.
        axes: of the body as columns (3, 3).
    """

    tangent: ForceTangent
    axes: Array

    def __call__(self) -> Array:
        rotated = np.kron(np.eye(4), self.axes)
        return np.asarray(rotated[:6, :6] @ self.tangent() @ rotated.T)

    def about(self, centre: Array) -> RotatedTangent:
        """The derivative with the moment about another point (3,) m, in the rotated axes."""
        return replace(self, tangent=self.tangent.about(self.axes.T @ centre))

    def mirrored(self) -> RotatedTangent:
        """The derivative in the mirror y = 0."""
        return RotatedTangent(self.tangent.mirrored(), MIRROR[:, None] * self.axes * MIRROR)


def rotation(vector: Array) -> Array:
    """Rotation matrix (3, 3) of a rotation vector (3,) rad, by Rodrigues' formula."""
    angle, K = float(np.linalg.norm(vector)), skew(vector)
    return np.asarray(np.eye(3) + np.sinc(angle / np.pi) * K + 0.5 * np.sinc(angle / (2 * np.pi)) ** 2 * K @ K)


def rotation_rate(vector: Array) -> Array:
    """Jacobian (3, 3): rotation in space by the change of a rotation vector (3,) rad, to the third order in it."""
    K = skew(vector)
    return np.asarray(np.eye(3) + 0.5 * K + K @ K / 6)


@dataclass(frozen=True, eq=False)
class MovedPair:
    """A left-hand pair with moved hub and rail.

    Parameters:
        mounting: dimensions of wheelset and track.
        state: of the wheelset.
        hub: (6,) m and rad.
        rail: (3,) m and rad.
        foot: (2,) m, y and z of the centre of the rail's roll in its own frame.

    The pose is that of the wheel in the frame of the moved rail; loads are in the track's axes.
    """

    mounting: Mounting
    state: WheelsetState
    hub: Array
    rail: Array
    foot: Array

    @cached_property
    def arm(self) -> Array:
        """Vector (3,) m from the wheelset's centre to the hub's, in the track's axes."""
        return np.asarray(self.state.rotation @ (self.hub[:3] + np.array([0.0, self.mounting.wheel_y, 0.0])))

    @cached_property
    def wheel_axes(self) -> Array:
        """Axes of the wheel as columns (3, 3), in the track's axes."""
        return np.asarray(self.state.rotation @ rotation(self.hub[3:]))

    @cached_property
    def rail_axes(self) -> Array:
        """Axes of the moved rail as columns (3, 3), in the track's axes."""
        return rotation(X * self.rail[2])

    @cached_property
    def pose(self) -> Pose:
        """Pose of the wheel in the frame of the moved rail."""
        return Pose(self._seen(self._rigid.wheel.reference + self.arm), self.rail_axes.T @ self.wheel_axes)

    @cached_property
    def motion(self) -> RigidMotion:
        """Velocities of both bodies in the frame of the moved rail, that of the wheel about the hub's centre."""
        wheel, rail, axes = self._rigid.wheel, self._rigid.rail, self.rail_axes.T
        spin = self._slow + self.state.pitch_rate * self.wheel_axes[:, 1]
        return RigidMotion(
            Twist(axes @ (wheel.velocity + np.cross(self._slow, self.arm)), axes @ spin, self.pose.origin),
            Twist(axes @ rail.velocity, axes @ rail.rotation, self._seen(rail.reference)),
        )

    @cached_property
    def slopes(self) -> Array:
        """Derivative (12, 18) of pose and wheel's motion, rows as in `ContactResult.tangent`, by the coordinates of the
        wheelset's state, the hub's and the rail's motion.
        """
        state, rigid = self.state, self.state.rotation
        turn, arm_change = self._turn, self._arm_change
        translation = arm_change.copy()
        translation[1, 0] += 1.0
        translation[2, 1] += 1.0
        wheel_turn = turn.copy()
        wheel_turn[:, HUB.start + 3 : HUB.stop] = rigid @ rotation_rate(self.hub[3:])
        slow = np.zeros((3, SLOPES))
        slow[:, 3] = state.roll_rate * np.cross(Z, state.nodes)
        slow[:, 6], slow[:, 7] = state.nodes, Z
        velocity = skew(self._slow) @ arm_change - skew(self.arm) @ slow
        velocity[1, 4] += 1.0
        velocity[2, 5] += 1.0
        axle = self.wheel_axes[:, 1]
        rates = slow - state.pitch_rate * skew(axle) @ wheel_turn
        rates[:, 8] = axle
        translation[1:, RAIL.start : RAIL.start + 2] -= np.eye(2)
        back = self.rail_axes.T
        out = np.concatenate([back @ part for part in (translation, wheel_turn, velocity, rates)])
        pivoted, motion = self.pose.origin - self._pivot, self.motion.wheel
        out[:, RAIL.stop - 1] -= np.concatenate(
            [np.cross(X, pivoted), X, np.cross(X, motion.velocity), np.cross(X, motion.rotation)]
        )
        return np.asarray(out)

    def in_track(self, result: ContactResult) -> ContactResult:
        """The result in the track's axes, with the moment about the wheelset's centre and patches as seen on the track;
        fields stay those of the moved rail.

        Parameters:
            result: in the frame of the moved rail, its moment about that frame's origin.
        """
        axes, about_centre = self.rail_axes, result.about(self.pose.origin - self.rail_axes.T @ self.arm)
        tangent = about_centre.force_tangent
        return replace(
            about_centre,
            force=axes @ about_centre.force,
            moment=axes @ about_centre.moment,
            patches=LazyPatches(partial(_turned, result.patches, axes, float(self.rail[2]))),
            force_tangent=None if tangent is None else RotatedTangent(tangent, axes),
        )

    def wrench_slopes(self, result: ContactResult) -> Array:
        """Derivative (6, 18) of force and moment about the wheelset's centre in the track's axes, columns as of
        `slopes`.

        Parameters:
            result: from `in_track`.
        """
        slopes = np.kron(np.eye(4), self.rail_axes) @ self.slopes
        out: Array = result.tangent() @ slopes
        out[3:] += skew(result.force) @ (slopes[:3] - self._arm_change)
        turned = np.cross(X, result.force)
        about_hub = result.moment - np.cross(self.arm, result.force)
        out[:, RAIL.stop - 1] += np.concatenate([turned, np.cross(X, about_hub) + np.cross(self.arm, turned)])
        return out

    @cached_property
    def load_matrix(self) -> Array:
        """Loads (9, 6) on the structure by force N and moment N m on the wheel about the wheelset's centre, in the
        track's axes: force and moment on the hub, in the wheelset's axes about the hub's centre (6); y and z force and
        roll moment on the rail about the foot (3).
        """
        axes, out = self.state.rotation.T, np.zeros((9, 6))
        out[:3, :3], out[3:6, :3], out[3:6, 3:] = axes, -axes @ skew(self.arm), axes
        out[6, 1] = out[7, 2] = out[8, 3] = -1.0
        out[8, :3] = -skew(self._above_foot)[0]
        return out

    def load_change(self, wrench: Array) -> Array:
        """Derivative (9, 18) of the loads by a constant wrench, columns as of `slopes`.

        Parameters:
            wrench: (6,) force N and moment N m as for `load_matrix`.
        """
        (force, moment), axes, turn = np.split(wrench, 2), self.state.rotation.T, self._turn
        about_hub = moment - np.cross(self.arm, force)
        out = np.zeros((9, SLOPES))
        out[:3] = axes @ skew(force) @ turn
        out[3:6] = axes @ (skew(force) @ self._arm_change + skew(about_hub) @ turn)
        lever = np.zeros((3, SLOPES))
        lever[1:, :2], lever[1:, RAIL.start : RAIL.start + 2] = np.eye(2), -np.eye(2)
        out[8] = (skew(force) @ lever)[0]
        return out

    @cached_property
    def _rigid(self) -> RigidMotion:
        return self.mounting.left_pair(self.state)[1]

    @cached_property
    def _slow(self) -> Array:
        """Angular velocity (3,) rad/s of the wheelset without its spin."""
        return np.asarray(self.state.roll_rate * self.state.nodes + self.state.yaw_rate * Z)

    @cached_property
    def _turn(self) -> Array:
        """Rotation (3, 18) of the wheelset by its coordinates."""
        turn = np.zeros((3, SLOPES))
        turn[:, 2], turn[:, 3] = self.state.nodes, Z
        return turn

    @cached_property
    def _arm_change(self) -> Array:
        """Derivative (3, 18) of `arm`, by rotation of the wheelset and translation of the hub."""
        change = -skew(self.arm) @ self._turn
        change[:, HUB.start : HUB.start + 3] = self.state.rotation
        return change

    @property
    def _pivot(self) -> Array:
        return np.array([0.0, *self.foot])

    @property
    def _above_foot(self) -> Array:
        """Vector (3,) m from the foot of the moved rail to the wheelset's centre, in the track's axes."""
        return np.asarray(self._rigid.wheel.reference - self._pivot - np.array([0.0, *self.rail[:2]]))

    def _seen(self, point: Array) -> Array:
        """A point (3,) m of the unmoved rail's frame in that of the moved rail."""
        return np.asarray(self.rail_axes.T @ (point - self._pivot - np.array([0.0, *self.rail[:2]])) + self._pivot)


def _turned(patches: Sequence[Patch], axes: Array, roll: float) -> tuple[Patch, ...]:
    return tuple(
        replace(patch, force=axes @ patch.force, contact_angle=patch.contact_angle + roll) for patch in patches
    )
