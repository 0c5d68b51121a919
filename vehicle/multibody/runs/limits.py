"""Limits of a run of a vehicle: overturning and derailment."""

from __future__ import annotations

from collections.abc import Iterator

from wheelrail.support.arrays import Array
from wheelrail.vehicle.multibody.coordinates import ROLL, YAW, Y, Z
from wheelrail.vehicle.multibody.equations import VehicleDynamics
from wheelrail.vehicle.simulation.limits import LIMITS, OutOfBounds


def check_limits(dynamics: VehicleDynamics, time: float, state: Array) -> None:
    """Raises OutOfBounds, with body, time and place, for a vehicle that has overturned or derailed.

    Parameters:
        dynamics: equations of motion.
        time: s.
        state: (2 c + m,).

    The limits are those of the plane wagon: roll and yaw of every body, displacement of the wheelsets.
    """
    position, _, _ = dynamics.coordinates.split(state)
    where = f"at t = {time:.4g} s, {dynamics.speed_profile(time).distance:.4g} m"
    for name, q in zip(dynamics.vehicle.names, position.tolist(), strict=True):
        if max(abs(q[ROLL]), abs(q[YAW])) > LIMITS.roll:
            raise OutOfBounds(f"{name} overturns: roll {q[ROLL]:.3f} rad, yaw {q[YAW]:.3f} rad {where}")
        if dynamics.vehicle.bodies[name].wheelset and (abs(q[Y]) > LIMITS.shift or q[Z] > LIMITS.lift):
            raise OutOfBounds(f"{name} has left the rails: y {1e3 * q[Y]:.1f} mm, z {1e3 * q[Z]:.1f} mm {where}")


def describe_wheelsets(dynamics: VehicleDynamics, state: Array) -> str:
    """Positions of the wheelsets in words, for the status of a run with a failed contact solve.

    Parameters:
        dynamics: equations of motion.
        state: (2 c + m,).
    """
    return "; ".join(_positions(dynamics, state))


def _positions(dynamics: VehicleDynamics, state: Array) -> Iterator[str]:
    position, _, _ = dynamics.coordinates.split(state)
    for name, body in zip(dynamics.vehicle.wheelsets, dynamics.coordinates.wheelset_bodies, strict=True):
        q = position[body]
        yield f"{name}: y {1e3 * q[Y]:.2f} mm, z {1e3 * q[Z]:.2f} mm, yaw {1e3 * q[YAW]:.2f} mrad"
