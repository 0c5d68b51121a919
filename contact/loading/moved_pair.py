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

from wheelrail.bindings._contact import (
    MovedStates,
    WheelPairs,
    moved_load_slopes,
    moved_loads,
    moved_pairs,
    moved_slopes,
)
from wheelrail.contact.kinematics.frames import MIRROR, Pose, RigidMotion
from wheelrail.contact.kinematics.left_pair import motion_of, pose_of
from wheelrail.contact.kinematics.wheelset_state import Mounting, WheelsetState
from wheelrail.contact.results.result import ContactResult, ForceTangent, LazyPatches, Patch
from wheelrail.support.arrays import Array

COORDINATES = len(WheelsetState.coordinates)  # of the wheelset, the first columns of all slopes
HUB = slice(COORDINATES, COORDINATES + 6)
RAIL = slice(COORDINATES + 6, COORDINATES + 9)


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
    def _states(self) -> MovedStates:
        moves, (y, z) = np.concatenate([self.hub, self.rail])[None], self.foot.tolist()
        return MovedStates(np.array([self.state.values]), moves, self.mounting.dimensions, (y, z), False)

    @cached_property
    def _moved(self) -> tuple[WheelPairs, Array]:
        """The pair, and the axes (1, 3, 3) of its rail."""
        return moved_pairs(self._states)

    @property
    def rail_axes(self) -> Array:
        """Axes of the moved rail as columns (3, 3), in the track's axes."""
        return np.asarray(self._moved[1][0])

    @property
    def pose(self) -> Pose:
        """Pose of the wheel in the frame of the moved rail."""
        return pose_of(self._moved[0], 0)

    @property
    def motion(self) -> RigidMotion:
        """Velocities of both bodies in the frame of the moved rail, that of the wheel about the hub's centre."""
        return motion_of(self._moved[0], 0)

    def in_track(self, result: ContactResult) -> ContactResult:
        """The result in the track's axes, with the moment about the wheelset's centre and patches as seen on the track;
        fields stay those of the moved rail.

        Parameters:
            result: in the frame of the moved rail, its moment about that frame's origin.
        """
        axes, about_centre = self.rail_axes, result.about(self._moved[0].centre[0])
        tangent = about_centre.force_tangent
        return replace(
            about_centre,
            force=axes @ about_centre.force,
            moment=axes @ about_centre.moment,
            patches=LazyPatches(partial(turned, result.patches, axes, float(self.rail[2]))),
            force_tangent=None if tangent is None else RotatedTangent(tangent, axes),
        )

    def wrench_slopes(self, result: ContactResult) -> Array:
        """Derivative (6, 18) of force and moment about the wheelset's centre in the track's axes.

        Columns: coordinates of the wheelset's state, the hub's and the rail's motion.

        Parameters:
            result: from `in_track`.
        """
        own = result.force_tangent
        tangent = own.tangent() if isinstance(own, RotatedTangent) else result.tangent()  # zero without contact
        wrench = np.concatenate([result.force, result.moment])
        return np.asarray(moved_slopes(self._states, tangent[None], wrench[None])[0])

    @cached_property
    def load_matrix(self) -> Array:
        """Loads (9, 6) on the structure by force N and moment N m on the wheel about the wheelset's centre, in the
        track's axes: force and moment on the hub, in the wheelset's axes about the hub's centre (6); y and z force and
        roll moment on the rail about the foot (3).
        """
        return np.asarray(moved_loads(self._states)[0])

    def load_change(self, wrench: Array) -> Array:
        """Derivative (9, 18) of the loads by a constant wrench, columns as of `wrench_slopes`.

        Parameters:
            wrench: (6,) force N and moment N m as for `load_matrix`.
        """
        return np.asarray(moved_load_slopes(self._states, wrench[None])[0])


def turned(patches: Sequence[Patch], axes: Array, roll: float) -> tuple[Patch, ...]:
    """Patches of a moved rail, with axes (3, 3) and roll rad, in the track's axes."""
    return tuple(
        replace(patch, force=axes @ patch.force, contact_angle=patch.contact_angle + roll) for patch in patches
    )
