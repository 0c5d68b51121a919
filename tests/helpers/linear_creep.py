"""A contact with linear springs and creep forces, whose point stays at a place on the axle."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from wheelrail.contact.kinematics.frames import Side, cross
from wheelrail.contact.kinematics.wheelset_state import WheelsetState
from wheelrail.contact.results.result import ContactResult
from wheelrail.contact.results.vehicle_contact import VehicleContact


@dataclass(frozen=True)
class LinearCreep(VehicleContact):
    """Wheel radius r0 + conicity y outwards; vertical spring; forces -c11 and -c22 times creepage; lateral spring."""

    radius: float = 0.46
    wheel_y: float = 0.75
    conicity: float = 0.15
    load: float = 54546.0
    vertical: float = 2.0e8
    longitudinal_creep: float = 9.0e6
    lateral_creep: float = 8.0e6
    lateral: float = 2.0e5

    def __call__(self, state: WheelsetState, side: Side, guess: ContactResult | None = None) -> ContactResult:
        sign = 1.0 if side == "left" else -1.0
        axle = state.rotation[:, 1]
        centre = np.array([0.0, state.y, self.radius + state.z])
        arm = sign * self.wheel_y * axle
        load = self.load - self.vertical * (centre[2] + arm[2] - self.radius)
        arm = arm - [0.0, 0.0, self.radius + self.conicity * sign * state.y]
        rotation = state.roll_rate * state.nodes + state.pitch_rate * axle + [0.0, 0.0, state.yaw_rate]
        wheel = np.array([0.0, state.y_rate, state.z_rate]) + cross(rotation, arm)
        rail = -np.array([state.speed, 0.0, 0.0]) - cross(np.array(state.frame_rate), centre + arm)
        creepage = (wheel - rail) / state.speed
        along, across = self.creep_force(float(creepage[0]), float(creepage[1]))
        force = np.array([along, across - self.lateral * state.y, load])
        return ContactResult(force, cross(arm, force), status="converged")

    def creep_force(self, along: float, across: float) -> tuple[float, float]:
        """Longitudinal and lateral creep force N by the creepages."""
        return -self.longitudinal_creep * along, -self.lateral_creep * across
