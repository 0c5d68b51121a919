"""Compiled: rigid motion of wheel and rail, rolling speed and creepages at a point."""

from __future__ import annotations

from typing import NamedTuple

from wheelrail.contact.kinematics.frames import RigidMotion
from wheelrail.support.arrays import Array
from wheelrail.support.compiled import borrowing


class RigidVelocities(NamedTuple):
    """Rigid motion of wheel and rail, as in `wheelrail.contact.kinematics.frames.Twist`: velocity m/s, angular velocity
    rad/s and reference point m, (3,) each.
    """

    wheel: Array
    wheel_turn: Array
    wheel_at: Array
    rail: Array
    rail_turn: Array
    rail_at: Array

    @classmethod
    def of(cls, motion: RigidMotion) -> RigidVelocities:
        wheel, rail = motion.wheel, motion.rail
        return cls(wheel.velocity, wheel.rotation, wheel.reference, rail.velocity, rail.rotation, rail.reference)


@borrowing
def velocity_along(turn: Array, at: Array, velocity: Array, point: Array, axis: Array) -> float:
    """Velocity m/s of a body's point along an axis; turn, at and velocity: its angular velocity and reference point."""
    x, y, z = point[0] - at[0], point[1] - at[1], point[2] - at[2]
    return float(
        (velocity[0] + turn[1] * z - turn[2] * y) * axis[0]
        + (velocity[1] + turn[2] * x - turn[0] * z) * axis[1]
        + (velocity[2] + turn[0] * y - turn[1] * x) * axis[2]
    )


@borrowing
def relative_velocity(v: RigidVelocities, point: Array, axis: Array) -> float:
    """Velocity of the wheel relative to the rail along an axis, m/s."""
    return velocity_along(v.wheel_turn, v.wheel_at, v.wheel, point, axis) - velocity_along(
        v.rail_turn, v.rail_at, v.rail, point, axis
    )


@borrowing
def relative_rotation(v: RigidVelocities, axis: Array) -> float:
    """Angular velocity rad/s of the wheel relative to the rail about the upward normal, opposite to an outward axis."""
    return float(
        -(v.wheel_turn[0] - v.rail_turn[0]) * axis[0]
        - (v.wheel_turn[1] - v.rail_turn[1]) * axis[1]
        - (v.wheel_turn[2] - v.rail_turn[2]) * axis[2]
    )


@borrowing
def rolling_speed(v: RigidVelocities, point: Array, forward: Array) -> float:
    """Rolling speed m/s: mean backward velocity of both bodies' material at a point."""
    return -0.5 * (
        velocity_along(v.wheel_turn, v.wheel_at, v.wheel, point, forward)
        + velocity_along(v.rail_turn, v.rail_at, v.rail, point, forward)
    )


@borrowing
def creepages(v: RigidVelocities, point: Array, axes: Array, speed: float) -> tuple[float, float, float]:
    """Longitudinal and lateral creepage, and spin 1/m, at a point (3,) m with axes (3, 3); zero without rolling."""
    if not speed > 0.0:
        return 0.0, 0.0, 0.0
    return (
        relative_velocity(v, point, axes[0]) / speed,
        relative_velocity(v, point, axes[1]) / speed,
        relative_rotation(v, axes[2]) / speed,
    )
