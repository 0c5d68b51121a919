"""Smooth contact for tests of the vehicle: one point per wheel, Hertzian spring, saturating creep force."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace

import numpy as np

from wheelrail.contact.kinematics.frames import Pose, RigidMotion, Side, cross
from wheelrail.contact.kinematics.wheelset_state import Mounting, WheelsetState
from wheelrail.contact.models.wheelset import WheelsetContact
from wheelrail.contact.results.result import ContactResult, Statistics
from wheelrail.contact.results.vehicle_contact import VehicleContact

MOUNTING = Mounting(wheel_y=0.75, rail_y=0.75, radius=0.46)
STIFFNESS = 1.2e9  # N/m at the static load
STATIC = 54.546e3


@dataclass(frozen=True)
class SmoothContact:
    """Rolling radius r0 + cone u + flange exp(u / width) over the shift u towards the flange; contact on the rail's
    top.
    """

    cone: float = 0.05
    flange: float = 2e-5
    width: float = 2e-3
    friction: float = 0.3
    creep: float = 8e6  # N per unit of creepage at the static load

    def rise(self, u: float) -> tuple[float, float]:
        e = self.flange * np.exp(min(u / self.width, 8.0))
        return self.cone * u + e - self.flange, self.cone + e / self.width

    def __call__(self, pose: Pose, motion: RigidMotion, guess: ContactResult | None = None) -> ContactResult:
        u = float(pose.origin[1])
        rise, slope = self.rise(u)
        depth = MOUNTING.radius + rise - float(pose.origin[2])
        if depth <= 0.0:
            return ContactResult.separated(depth)
        hertz = (2 / 3 * STIFFNESS) ** 1.5 / STATIC**0.5  # slope of hertz d^(3/2) is STIFFNESS where it carries STATIC
        normal = np.array([0.0, -slope, 1.0])
        load = hertz * depth**1.5
        along, across = np.array([1.0, 0.0, 0.0]), np.array([0.0, 1.0, slope]) / np.hypot(1.0, slope)
        wheel, rail = (twist.velocity - cross(twist.rotation, twist.reference) for twist in (motion.wheel, motion.rail))
        slip = wheel - rail  # at the origin
        creepage = np.array([slip @ along, slip @ across]) / abs(motion.rail.velocity[0])
        pull = self.creep * (load / STATIC) ** (2 / 3) * creepage
        pull /= np.sqrt(1.0 + (pull @ pull) / (self.friction * load) ** 2) if self.friction else np.inf
        force = load * normal - pull[0] * along - pull[1] * across
        return ContactResult(force, np.zeros(3), approach=depth, status="converged", statistics=Statistics(newton=1))


@dataclass(frozen=True)
class TwoPointContact:
    """A conical tread, and a second stiff contact on a slope that begins at a gap: a kink in the force."""

    gap: float = 6e-3
    slope: float = 1.0
    deepest: float = np.inf

    def __call__(self, pose: Pose, motion: RigidMotion, guess: ContactResult | None = None) -> ContactResult:
        result = SmoothContact(flange=0.0)(pose, motion)
        if result.approach > self.deepest:
            return replace(result, status="failed: off the mesh")
        u, z = pose.origin[1:].tolist()
        depth = (self.slope * (u - self.gap) + MOUNTING.radius - z) / np.hypot(1.0, self.slope)
        if depth <= 0.0:
            return result
        force = 8e10 * depth**1.5 * np.array([0.0, -self.slope, 1.0]) / np.hypot(1.0, self.slope)
        moment = cross(np.array([0.0, -0.03, -0.005]), force)
        return replace(result, force=result.force + force, moment=result.moment + moment, status="converged")


@dataclass(frozen=True)
class FunctionContact(VehicleContact):
    """A contact given as a function of state, side and guess, without a tangent."""

    solve: Callable[[WheelsetState, Side, ContactResult | None], ContactResult]

    def __call__(self, state: WheelsetState, side: Side, guess: ContactResult | None = None) -> ContactResult:
        return self.solve(state, side, guess)


CONTACT = WheelsetContact(SmoothContact(), MOUNTING)
