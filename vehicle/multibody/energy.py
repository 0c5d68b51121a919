"""Mechanical energy of a vehicle on level track, and the power of all forces that have no potential."""

from __future__ import annotations

from typing import NamedTuple

from wheelrail.support.arrays import Array
from wheelrail.vehicle.multibody.body_motion import BodyMotion
from wheelrail.vehicle.multibody.coordinates import X
from wheelrail.vehicle.multibody.equations import VehicleDynamics
from wheelrail.vehicle.multibody.rotations import rotate, rotate_back


class VehiclePower(NamedTuple):
    """Powers at one time, W; their sum is the rate of the mechanical energy.

    Parameters:
        contact: of the contact forces on the wheelsets, against rails at rest.
        dampers: of the dampers, not positive.
        hold: of the force that keeps the speed.
        applied: of torques with their reactions, and of forces.
    """

    contact: float
    dampers: float
    hold: float
    applied: float


def mechanical_energy(dynamics: VehicleDynamics, time: float, state: Array) -> float:
    """Kinetic energy, potential energy of gravity and of all springs but that of `speed_hold`, J.

    Parameters:
        dynamics: on a level track.
        time: s.
        state: (2 c + m,).
    """
    motion = dynamics.kinematics(dynamics.speed_profile(time), state)
    _, _, series = dynamics.coordinates.split(state)
    angular = rotate_back(motion.axes, motion.rate)
    angular[dynamics.coordinates.wheelset_bodies, 1] += motion.relative.spin[dynamics.coordinates.wheelset_bodies]
    kinetic = dynamics.mass @ (motion.velocity**2).sum(axis=1) + (dynamics.inertia * angular**2).sum()
    weight = dynamics.vehicle.gravity * dynamics.mass
    return float(0.5 * kinetic + weight @ motion.position[:, 2]) + spring_energy(dynamics, motion, series)


def spring_energy(dynamics: VehicleDynamics, motion: BodyMotion, series: Array) -> float:
    """Potential energy J of all springs and static loads, zero in the nominal position.

    Parameters:
        dynamics: equations of motion.
        motion: of the bodies.
        series: (m,) m, spring deflections of Maxwell elements.
    """
    suspension = dynamics.suspension
    deflection = suspension(motion, series).deflection
    stiffness, laws = suspension.stiffness
    springs = 0.5 * (stiffness * deflection**2).sum() - suspension.static_loads @ deflection[:, 2]
    springs += sum(float(law.energy(deflection[e, j])) for e, j, law in laws)
    springs += 0.5 * (suspension.rotational_stiffness * suspension.rotations(motion) ** 2).sum()
    elements = list(dynamics.vehicle.elements.values())
    for w, (e, j) in zip(series, dynamics.coordinates.maxwell, strict=True):
        springs += 0.5 * elements[e].series_stiffness[j] * w**2
    return float(springs)


def power(dynamics: VehicleDynamics, time: float, state: Array, wrenches: Array) -> VehiclePower:
    """Powers under given contact forces.

    Parameters:
        dynamics: equations of motion.
        time: s.
        state: (2 c + m,).
        wrenches: (w, 6) force N and moment N m about the centre of each wheelset, in its track frame.
    """
    travel = dynamics.speed_profile(time)
    motion = dynamics.kinematics(travel, state)
    position, rate, series = dynamics.coordinates.split(state)
    wheelsets = dynamics.coordinates.wheelset_bodies
    axes = motion.sections.axes[wheelsets]
    angular = motion.rate.copy()
    angular[wheelsets] += motion.relative.spin[wheelsets, None] * motion.axes[wheelsets, :, 1]
    contact = (rotate(axes, wrenches[:, :3]) * motion.velocity[wheelsets]).sum()
    contact += (rotate(axes, wrenches[:, 3:]) * angular[wheelsets]).sum()
    hold = 0.0
    if (part := dynamics.vehicle.speed_hold) is not None:
        i = dynamics.vehicle.names.index(part.body)
        along = motion.velocity[i] @ motion.sections.axes[i, :, 0]
        hold = -(part.stiffness * position[i, X] + part.damping * rate[i, X]) * along
    applied = 0.0
    if dynamics.loads:
        _, _, force, moment = dynamics.applied(travel, motion, state)
        applied = float((force * motion.velocity).sum() + (moment * angular).sum())
    return VehiclePower(float(contact), damper_power(dynamics, motion, series), float(hold), applied)


def damper_power(dynamics: VehicleDynamics, motion: BodyMotion, series: Array) -> float:
    """Power W of all dampers, those of Maxwell elements included; parameters as for `spring_energy`."""
    suspension = dynamics.suspension
    state = suspension(motion, series)
    damping, laws = suspension.damping
    dissipated = (damping * state.deflection_rate**2).sum()
    for e, j, law in laws:
        dissipated += float(law(state.deflection_rate[e, j])) * state.deflection_rate[e, j]
    elements = list(dynamics.vehicle.elements.values())
    for w, w_rate, (e, j) in zip(series, state.series_rate, dynamics.coordinates.maxwell, strict=True):
        dissipated += elements[e].series_stiffness[j] * w * (state.deflection_rate[e, j] - w_rate)
    return -float(dissipated)
