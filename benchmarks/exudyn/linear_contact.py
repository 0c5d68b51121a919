"""A wheelset on linear springs, one below each wheel: a contact that can be modelled in any multibody code."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from wheelrail.contact.kinematics.frames import Side
from wheelrail.contact.kinematics.wheelset_state import WheelsetState
from wheelrail.contact.results.result import ContactResult
from wheelrail.contact.results.vehicle_contact import VehicleContact


@dataclass(frozen=True)
class LinearContact(VehicleContact):
    """Spring and damper between the ground and the wheel's lowest point, both in the ground's axes.

    across m from the wheelset's centre to the wheels, radius m; lateral, vertical (stiffness N/m, damping N s/m); load
    N of a wheel at its nominal height. The force acts on the material point of the wheelset, which moves with its roll.
    """

    load: float
    across: float = 0.75
    radius: float = 0.46
    lateral: tuple[float, float] = (2e7, 2e4)
    vertical: tuple[float, float] = (1e8, 5e4)

    def __call__(self, state: WheelsetState, side: Side, guess: ContactResult | None = None) -> ContactResult:
        b = self.across if side == "left" else -self.across
        c, s = np.cos(state.roll), np.sin(state.roll)
        arm_y, arm_z = b * c + self.radius * s, b * s - self.radius * c
        displacement_y, displacement_z = state.y + arm_y - b, state.z + arm_z + self.radius
        rate_y, rate_z = state.y_rate - arm_z * state.roll_rate, state.z_rate + arm_y * state.roll_rate
        fy = -self.lateral[0] * displacement_y - self.lateral[1] * rate_y
        fz = self.load - self.vertical[0] * displacement_z - self.vertical[1] * rate_z
        moment = np.array([arm_y * fz - arm_z * fy, 0.0, 0.0])
        return ContactResult(np.array([0.0, fy, fz]), moment, approach=-displacement_z, status="converged")
