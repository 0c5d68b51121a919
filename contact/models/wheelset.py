"""Both wheels of a wheelset through one contact model of the left pair."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from wheelrail.contact.kinematics.frames import Pose, RigidMotion, Side
from wheelrail.contact.kinematics.wheelset_state import Mounting, WheelsetState
from wheelrail.contact.results.result import ContactResult
from wheelrail.contact.results.vehicle_contact import VehicleContact
from wheelrail.contact.solvers.tangent import MIRRORED
from wheelrail.support.arrays import Array

ContactModel = Callable[[Pose, RigidMotion, ContactResult | None], ContactResult]


@dataclass(frozen=True)
class WheelsetContact(VehicleContact):
    """Contact of one side: state of the wheelset in, `ContactResult` in the track's axes out.

    The moment is about the wheelset's centre. `guess` is an earlier result of the same side.
    """

    model: ContactModel
    mounting: Mounting

    def __call__(self, state: WheelsetState, side: Side, guess: ContactResult | None = None) -> ContactResult:
        seen = state if side == "left" else state.mirrored()
        pose, motion = self.mounting.left_pair(seen)
        result = self.model(pose, motion, guess).about(motion.wheel.reference)
        return result if side == "left" else result.mirrored()

    def tangent(self, state: WheelsetState, side: Side, result: ContactResult) -> Array:
        """Change (6, 8) of force and moment by y, z, roll, yaw, y_rate, z_rate, roll_rate and pitch_rate, to first
        order: of a result of this state and side, its moment about the wheelset's centre wherever that moves.

        Zero when separated. Raises ValueError for a result without a tangent.
        """
        slope = pair_slope(self.mounting, state if side == "left" else state.mirrored())
        if side == "right":
            slope = np.tile(MIRRORED, 2)[:, None] * slope * STATE_MIRRORED
        change = result.tangent() @ slope
        x, y, z = result.force
        change[3:, 0] += [-z, 0.0, x]  # the centre moves: F x e_y
        change[3:, 1] += [y, -x, 0.0]  # .. and F x e_z
        return change


STATE_MIRRORED = np.array([-1.0, 1.0, -1.0, -1.0, -1.0, 1.0, -1.0, 1.0])  # of the state in `WheelsetContact.tangent`


def pair_slope(mounting: Mounting, state: WheelsetState) -> Array:
    """Change (12, 8) of `Mounting.left_pair` by y, z, roll, yaw and the rates, as `ContactResult.tangent` counts it.

    The wheelset turns about its centre, which stays the reference of the wheel's motion.
    """
    axle = state.rotation[:, 1]
    turns = np.array([[np.cos(state.yaw), np.sin(state.yaw), 0.0], [0.0, 0.0, 1.0]])  # by roll and by yaw
    turned_axle = np.cross(turns, axle).T
    slope = np.zeros((12, 8))
    slope[1, 0] = slope[2, 1] = 1.0
    slope[:3, 2:4], slope[3:6, 2:4] = mounting.wheel_y * turned_axle, turns.T
    slope[9:, 2:4] = state.pitch_rate * turned_axle
    slope[7, 4] = slope[8, 5] = slope[9, 6] = 1.0
    slope[9:, 7] = axle
    return slope
