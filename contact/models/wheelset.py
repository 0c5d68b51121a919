"""Contact of both wheels of a wheelset by one contact model of the left-hand pair."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace

import numpy as np

from wheelrail.contact.kinematics.frames import Pose, RigidMotion, Side, cross
from wheelrail.contact.kinematics.wheelset_state import Mounting, WheelsetState
from wheelrail.contact.results.result import ContactResult
from wheelrail.contact.results.vehicle_contact import VehicleContact
from wheelrail.contact.solvers.tangent import MIRRORED
from wheelrail.support.arrays import Array

ContactModel = Callable[[Pose, RigidMotion, ContactResult | None], ContactResult]


@dataclass(frozen=True)
class WheelsetContact(VehicleContact):
    """Contact of one side: state of the wheelset in, `ContactResult` in the track's axes out.

    Parameters:
        model: contact model of the left-hand pair, and of the mirror image of the right-hand one.
        mounting: dimensions of wheelset and track.
        right: contact of the right-hand pair, where profiles, radius or friction differ.

    The moment is about the wheelset's centre; the guess is an earlier result of the same side.
    """

    model: ContactModel
    mounting: Mounting
    right: WheelsetContact | None = None

    def of(self, side: Side) -> WheelsetContact:
        """Contact whose model and mounting are those of a side."""
        return self.right if side == "right" and self.right is not None else self

    def changed(self, change: Callable[[ContactModel], ContactModel]) -> WheelsetContact:
        """The contact with the models of both sides changed by a function."""
        right = None if self.right is None else self.right.changed(change)
        return replace(self, model=change(self.model), right=right)

    def __call__(self, state: WheelsetState, side: Side, guess: ContactResult | None = None) -> ContactResult:
        own, left_state = self.of(side), state if side == "left" else state.mirrored()
        pose, motion = own.mounting.left_pair(left_state)
        result = own.model(pose, motion, guess).about(motion.wheel.reference)
        return result if side == "left" else result.mirrored()

    def tangent(self, state: WheelsetState, side: Side, result: ContactResult) -> Array:
        """Derivatives (6, 9) of force N and moment N m by `WheelsetState.coordinates`.

        Parameters:
            state: of the wheelset, m, rad, m/s and rad/s.
            side: of the contact.
            result: of this state and side.

        The moment is about the wheelset's centre, which moves with y and z. Zero when separated. Raises ValueError for
        a result without a tangent.
        """
        slope = pair_slope(self.of(side).mounting, state if side == "left" else state.mirrored())
        if side == "right":
            slope = MIRRORED_SLOPE * slope
        derivative = result.tangent() @ slope
        x, y, z = result.force
        derivative[3:, 0] += [-z, 0.0, x]  # the centre moves: F x e_y
        derivative[3:, 1] += [y, -x, 0.0]  # .. and F x e_z
        return derivative


EVEN = ("z", "z_rate", "pitch_rate")  # unchanged in the mirror y = 0
STATE_MIRRORED = np.array([1.0 if name in EVEN else -1.0 for name in WheelsetState.coordinates])
MIRRORED_SLOPE = np.outer(np.tile(MIRRORED, 2), STATE_MIRRORED)
VERTICAL = np.array([0.0, 0.0, 1.0])


def pair_slope(mounting: Mounting, state: WheelsetState) -> Array:
    """Derivatives (12, 9) of `Mounting.left_pair` by `WheelsetState.coordinates`, rows as in `ContactResult.tangent`.

    The wheelset rotates about its centre, which remains the reference point of the wheel's motion.
    """
    axle, nodes = state.rotation[:, 1], state.nodes
    slope = np.zeros((12, 9))
    slope[1, 0] = slope[2, 1] = slope[7, 4] = slope[8, 5] = 1.0
    slope[9:, 8] = axle
    for column, axis in ((2, nodes), (3, VERTICAL)):  # rotation axes of roll and yaw
        axle_change = cross(axis, axle)
        slope[:3, column], slope[3:6, column] = mounting.wheel_y * axle_change, axis
        slope[9:, column], slope[9:, 4 + column] = state.pitch_rate * axle_change, axis
    slope[9:, 3] += state.roll_rate * cross(VERTICAL, nodes)
    return slope
