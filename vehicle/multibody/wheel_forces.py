"""Forces of the wheels of a vehicle in the terms of running safety and wear."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property
from math import inf, pi

from wheelrail.contact.kinematics.frames import SIDES, Side
from wheelrail.contact.results.result import ContactResult, Patch
from wheelrail.support.arrays import Array
from wheelrail.vehicle.multibody.coordinates import YAW, X, Y
from wheelrail.vehicle.multibody.equations import VehicleDynamics, WheelContacts

OUTWARDS = {"left": -1.0, "right": 1.0}  # sign of the lateral force on the wheel that pushes the rail outwards

STEEP = pi / 3  # rad: contacts that face the field side, steeper than any on a tread, are those of check rails


def check_rail_force(patches: Sequence[Patch], side: Side) -> float:
    """Normal force N of the check rail on the flange's back of a wheel; patches: of the wheel."""
    return sum(patch.normal_force for patch in patches if OUTWARDS[side] * patch.contact_angle > STEEP)


@dataclass(frozen=True)
class WheelForces:
    """Forces of one wheel.

    Parameters:
        longitudinal: N on the wheel, forward.
        guiding: Y, N, lateral force on the rail, positive outwards.
        vertical: Q, N.
        speed: m/s, of the wheelset along the track.
        patches: contact patches.
    """

    longitudinal: float
    guiding: float
    vertical: float
    speed: float
    patches: tuple[Patch, ...]

    @classmethod
    def of(cls, result: ContactResult, side: Side, speed: float) -> WheelForces:
        x, y, z = result.force.tolist()
        return cls(x, OUTWARDS[side] * y, z, speed, tuple(result.patches))

    @property
    def derailment_quotient(self) -> float:
        """Y/Q; infinite for a wheel without load."""
        return self.guiding / self.vertical if self.vertical > 0.0 else inf

    @cached_property
    def frictional_power(self) -> float:
        """Frictional power, W."""
        return sum(patch.frictional_power for patch in self.patches)

    @property
    def wear_number(self) -> float:
        """T gamma, N: frictional power over the speed."""
        return self.frictional_power / self.speed


@dataclass(frozen=True)
class WheelsetForces:
    """Position of a wheelset and forces of its wheels.

    Parameters:
        y: m.
        yaw: rad.
        left, right: of the wheels.
    """

    y: float
    yaw: float
    left: WheelForces
    right: WheelForces

    @property
    def wheels(self) -> dict[Side, WheelForces]:
        return {"left": self.left, "right": self.right}

    @property
    def track_shifting(self) -> float:
        """Sum of Y, N: lateral force of both wheels on the track, positive to the right."""
        return self.right.guiding - self.left.guiding

    @property
    def axle_load(self) -> float:
        """Sum of Q, N."""
        return self.left.vertical + self.right.vertical


def wheelset_forces(
    dynamics: VehicleDynamics, state: Array, contacts: WheelContacts, time: float = 0.0
) -> dict[str, WheelsetForces]:
    """Forces by wheelset.

    Parameters:
        dynamics: equations of motion.
        state: (2 c + m,).
        contacts: results at this state.
        time: s.
    """
    position, rate, _ = dynamics.coordinates.split(state)
    speed = dynamics.speed_profile(time).speed
    forces = {}
    for body, name in zip(dynamics.coordinates.wheelset_bodies.tolist(), contacts, strict=True):
        own_speed = speed + float(rate[body, X])
        left, right = (WheelForces.of(contacts[name][side], side, own_speed) for side in SIDES)
        forces[name] = WheelsetForces(float(position[body, Y]), float(position[body, YAW]), left, right)
    return forces
