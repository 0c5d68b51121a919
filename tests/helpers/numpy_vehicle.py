"""Motion, forces and energy of the bodies of a vehicle in NumPy: the definition of what the compiled core computes."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import NamedTuple

import numpy as np

from wheelrail.contact.kinematics.frames import cross
from wheelrail.support.arrays import Array
from wheelrail.vehicle.multibody.applied_forces import AppliedForces
from wheelrail.vehicle.multibody.coordinates import PITCH, ROLL, YAW, Coordinates, X, Y, Z
from wheelrail.vehicle.multibody.equations import VehicleDynamics
from wheelrail.vehicle.multibody.suspension_arrays import Ends, SuspensionArrays
from wheelrail.vehicle.track.section_poses import SectionPoses, TrackSections
from wheelrail.vehicle.track.speed_profile import TrackPosition
from wheelrail.vehicle.wagon.force_law import ForceLaw, Law


def body_rotation(roll: Array, pitch: Array, yaw: Array) -> Array:
    """Rz(yaw) Rx(roll) Ry(pitch) of angles (...) rad."""
    (cr, sr), (cp, sp), (cy, sy) = ((np.cos(a), np.sin(a)) for a in (roll, pitch, yaw))
    rows = [
        [cy * cp - sy * sr * sp, -sy * cr, cy * sp + sy * sr * cp],
        [sy * cp + cy * sr * sp, cy * cr, sy * sp - cy * sr * cp],
        [-cr * sp, sr, cr * cp],
    ]
    return np.stack([np.stack(row, axis=-1) for row in rows], axis=-2)


def rotate(matrices: Array, vectors: Array) -> Array:
    """Products (..., 3) of matrices and vectors."""
    return np.asarray((matrices @ vectors[..., None])[..., 0])


def rotate_back(matrices: Array, vectors: Array) -> Array:
    """Products (..., 3) of transposed matrices and vectors."""
    return np.asarray((vectors[..., None, :] @ matrices)[..., 0, :])


def rotation_vector(matrices: Array) -> Array:
    """Rotation vectors rad of rotations by less than pi."""
    m = matrices
    axial = 0.5 * np.stack([m[..., 2, 1] - m[..., 1, 2], m[..., 0, 2] - m[..., 2, 0], m[..., 1, 0] - m[..., 0, 1]], -1)
    sine = np.linalg.norm(axial, axis=-1)
    angle = np.arctan2(sine, 0.5 * (np.trace(m, axis1=-2, axis2=-1) - 1.0))
    small = sine < 1e-8
    return np.asarray(axial * np.where(small, 1.0, angle / np.where(small, 1.0, sine))[..., None])


def rotation_matrix(vectors: Array) -> Array:
    """Rotations by rotation vectors rad, Rodrigues' formula."""
    angle = np.linalg.norm(vectors, axis=-1)[..., None, None]
    x, y, z = np.moveaxis(vectors, -1, 0)
    zero = np.zeros_like(x)
    cross = np.stack([np.stack(row, -1) for row in ((zero, -z, y), (z, zero, -x), (-y, x, zero))], -2)
    half_sine = np.sinc(angle / (2 * np.pi))
    return np.asarray(np.eye(3) + np.sinc(angle / np.pi) * cross + 0.5 * half_sine**2 * cross @ cross)


def moment_of_gradient(rotation: Array, gradient: Array) -> Array:
    """Moments (..., 3) that do the work of the gradient of a potential by the rotation vector.

    Parameters:
        rotation: (..., 3) rad, by less than pi, of the upper in the axes of the lower body.
        gradient: (..., 3) of the potential by these components.

    Transposed inverse of the left Jacobian of rotations: m = g + r x g / 2 + c r x (r x g), c = 1/12 for small r.
    """
    angle = np.linalg.norm(rotation, axis=-1, keepdims=True)
    small = angle < 1e-3
    a = np.where(small, 1.0, angle)
    factor = np.where(small, 1 / 12 + angle**2 / 720, 1 / a**2 - (1 + np.cos(a)) / (2 * a * np.sin(a)))
    first = cross(rotation, gradient)
    return np.asarray(gradient + 0.5 * first + factor * cross(rotation, first))


class RelativeMotion(NamedTuple):
    """Motion of n bodies in the track frames at their own distances, components in these frames.

    Parameters:
        speed: (..., n) m/s of the frame along the track.
        offset, offset_rate: (..., n, 3) centre of mass from the centre line, m, and its rate in the frame, m/s.
        frame_rate: (..., n, 3) angular velocity of the frame, rad/s.
        roll_axis, axle: (..., n, 3) axes of the roll rate and of the spin.
        spin: (..., n) rad/s about the axle.
        rotation: (..., n, 3, 3) axes of the bodies as columns; those of wheelsets do not spin.
    """

    speed: Array
    offset: Array
    offset_rate: Array
    frame_rate: Array
    roll_axis: Array
    axle: Array
    spin: Array
    rotation: Array


class BodyMotion(NamedTuple):
    """Motion of n bodies in common axes.

    Parameters:
        sections: track sections at the bodies.
        relative: motion in the sections.
        position, velocity: (..., n, 3) m and m/s of the centres of mass.
        axes: (..., n, 3, 3) of the bodies as columns; those of wheelsets do not spin.
        rate: (..., n, 3) rad/s, angular velocity of these axes.
    """

    sections: SectionPoses
    relative: RelativeMotion
    position: Array
    velocity: Array
    axes: Array
    rate: Array


@dataclass(frozen=True)
class BodyKinematics:
    """Motion of the bodies of a vehicle on a track.

    Parameters:
        coordinates: of the vehicle.
        sections: of the track.
    """

    coordinates: Coordinates
    sections: TrackSections

    @cached_property
    def nominal(self) -> Array:
        """(n, 3): place along the vehicle m, height m, and 1 for a wheelset."""
        return np.array([(b.x, b.height, float(b.wheelset)) for b in self.coordinates.vehicle.bodies.values()])

    def distances(self, travel: TrackPosition, state: Array) -> Array:
        """Distances (..., n) m of the bodies along the track."""
        position, _, _ = self.coordinates.split(state)
        return np.asarray(travel.distance + self.nominal[:, 0] + position[..., X])

    def __call__(self, travel: TrackPosition, state: Array) -> BodyMotion:
        """Motion in the axes of the heading near the reference's distance, as the core.

        Parameters:
            travel: reference motion along the track.
            state: (..., 2 c + m).
        """
        q, rate, _ = self.coordinates.split(state)
        ahead = 100.0 * np.floor(0.01 * q[..., 0, X].flat[0] + 0.5)
        sections = self.sections.at(self.distances(travel, state), travel.distance + ahead)
        relative = self._relative(travel, sections, q, rate)
        velocity = relative.offset_rate + cross(relative.frame_rate, relative.offset)
        velocity[..., 0] += relative.speed
        wheelset = self.nominal[:, 2] > 0.0
        axes_rate = relative.frame_rate + rate[..., ROLL, None] * relative.roll_axis
        axes_rate[..., 2] += rate[..., YAW]
        axes_rate = axes_rate + np.where(wheelset, 0.0, relative.spin)[..., None] * relative.axle
        return BodyMotion(
            sections,
            relative,
            sections.position + rotate(sections.axes, relative.offset),
            rotate(sections.axes, velocity),
            sections.axes @ relative.rotation,
            rotate(sections.axes, axes_rate),
        )

    def _relative(self, travel: TrackPosition, sections: SectionPoses, q: Array, rate: Array) -> RelativeMotion:
        _, height, wheelset = self.nominal.T
        speed = travel.speed + rate[..., X]
        zero = np.zeros_like(speed)
        roll, yaw = q[..., ROLL], q[..., YAW]
        return RelativeMotion(
            speed,
            offset=np.stack([zero, q[..., Y], height + q[..., Z]], axis=-1),
            offset_rate=np.stack([zero, rate[..., Y], rate[..., Z]], axis=-1),
            frame_rate=speed[..., None] * sections.rate,
            roll_axis=np.stack([np.cos(yaw), np.sin(yaw), zero], axis=-1),
            axle=np.stack([-np.sin(yaw) * np.cos(roll), np.cos(yaw) * np.cos(roll), np.sin(roll)], axis=-1),
            spin=rate[..., PITCH] + wheelset * travel.speed / self.coordinates.vehicle.radius,
            rotation=body_rotation(roll, np.where(wheelset > 0.0, 0.0, q[..., PITCH]), yaw),
        )


def kinematics(dynamics: VehicleDynamics) -> BodyKinematics:
    """Motion of the bodies of a vehicle on its track."""
    return BodyKinematics(dynamics.coordinates, TrackSections(dynamics.track))


class SuspensionState(NamedTuple):
    """Forces of e elements on n bodies, and the motion of m Maxwell elements.

    Parameters:
        force, moment: (..., n, 3) N and N m about the centres of mass, in common axes.
        series_rate: (..., m) m/s, rates of the spring deflections of Maxwell elements.
        deflection: (..., e, 3) m in the elements' axes.
        deflection_rate: (..., e, 3) m/s.
        element_force: (..., e, 3) N on the upper bodies in the elements' axes, static loads included.
    """

    force: Array
    moment: Array
    series_rate: Array
    deflection: Array
    deflection_rate: Array
    element_force: Array


@dataclass(frozen=True)
class NumpySuspension:
    """Suspension of a vehicle.

    Parameters:
        of: the vehicle's arrays.
    """

    of: SuspensionArrays

    @property
    def coordinates(self) -> Coordinates:
        return self.of.coordinates

    @cached_property
    def turn(self) -> Array:
        return np.array([part.turn for part in self.coordinates.vehicle.elements.values()])

    @cached_property
    def lengths(self) -> Array:
        """Lengths (e,) m of rods, 0 of other elements."""
        return np.array([part.length for part in self.coordinates.vehicle.elements.values()])

    @cached_property
    def stiffness(self) -> tuple[Array, tuple[tuple[int, int, ForceLaw], ...]]:
        """Linear stiffness (e, 3) N/m, and force laws with their element and direction."""
        return _split_laws([part.stiffness for part in self.coordinates.vehicle.elements.values()])

    @cached_property
    def damping(self) -> tuple[Array, tuple[tuple[int, int, ForceLaw], ...]]:
        """Linear damping (e, 3) N s/m of dampers without springs in series, and force laws."""
        maxwell = self.coordinates.maxwell
        elements = list(self.coordinates.vehicle.elements.values())
        return _split_laws(
            [tuple(0.0 if (e, j) in maxwell else part.damping[j] for j in range(3)) for e, part in enumerate(elements)]
        )

    @cached_property
    def rotational_stiffness(self) -> Array:
        """(p, 3) N m/rad."""
        springs = self.coordinates.vehicle.rotational_springs.values()
        return np.array([part.stiffness for part in springs]).reshape(-1, 3)

    def __call__(self, motion: BodyMotion, series: Array) -> SuspensionState:
        """Forces at a motion of the bodies and spring deflections (..., m) m of Maxwell elements."""
        (upper, lower), (upper_arm, lower_arm) = self.of.ends, self.of.arms
        incidence = incidence_of(self.of.ends, motion.position.shape[-2])
        a_upper = rotate(motion.axes[..., upper, :, :], upper_arm)
        a_lower = rotate(motion.axes[..., lower, :, :], lower_arm)
        p_upper, p_lower = motion.position[..., upper, :] + a_upper, motion.position[..., lower, :] + a_lower
        gap = p_upper - p_lower
        gap_rate = motion.velocity[..., upper, :] + cross(motion.rate[..., upper, :], a_upper)
        gap_rate -= motion.velocity[..., lower, :] + cross(motion.rate[..., lower, :], a_lower)
        axes, axes_rate = self._element_axes(motion)
        deflection = rotate_back(axes, gap)
        deflection_rate = rotate_back(axes, gap_rate - cross(axes_rate, gap))
        rods = self.lengths > 0.0
        size = np.linalg.norm(gap, axis=-1)
        along = gap / np.where(rods, size, 1.0)[..., None]
        for values, own in ((deflection, size - self.lengths), (deflection_rate, (along * gap_rate).sum(axis=-1))):
            values[..., rods, :] = 0.0
            values[..., rods, 0] = own[..., rods]
        element_force, series_rate = self._element_forces(deflection, deflection_rate, series)
        force = np.where(rods[:, None], element_force[..., :1] * along, rotate(axes, element_force))
        point = p_lower + (1.0 - self.turn)[:, None] * gap
        on_upper = cross(np.where(rods[:, None], p_upper, point) - motion.position[..., upper, :], force)
        on_lower = cross(np.where(rods[:, None], p_lower, point) - motion.position[..., lower, :], force)
        # Bearings transmit no moment about the axle of a wheelset.
        axle = motion.axes[..., 1][..., lower, :]
        wheelset = np.isin(lower, self.coordinates.wheelset_bodies)[:, None]
        on_lower -= np.where(wheelset, (on_lower * axle).sum(axis=-1, keepdims=True), 0.0) * axle
        moment = np.maximum(incidence, 0.0) @ on_upper + np.minimum(incidence, 0.0) @ on_lower
        return SuspensionState(
            incidence @ force,
            moment + self._rotational_moments(motion),
            series_rate,
            deflection,
            deflection_rate,
            element_force,
        )

    def _element_axes(self, motion: BodyMotion) -> tuple[Array, Array]:
        """Axes (..., e, 3, 3) of the elements and their angular velocity (..., e, 3) rad/s.

        Between lower (turn 0) and upper body (turn 1) the angular velocity is interpolated, which is exact for
        rotations about one axis.
        """
        upper, lower = self.of.ends
        axes, upper_axes = motion.axes[..., lower, :, :].copy(), motion.axes[..., upper, :, :]
        with_upper, between = self.turn == 1.0, (self.turn > 0.0) & (self.turn < 1.0)
        axes[..., with_upper, :, :] = upper_axes[..., with_upper, :, :]
        if between.any():
            relative = np.swapaxes(axes[..., between, :, :], -1, -2) @ upper_axes[..., between, :, :]
            part = rotation_matrix(self.turn[between, None] * rotation_vector(relative))
            axes[..., between, :, :] = axes[..., between, :, :] @ part
        turn = self.turn[:, None]
        rate = (1.0 - turn) * motion.rate[..., lower, :] + turn * motion.rate[..., upper, :]
        return axes, np.asarray(rate)

    def _element_forces(self, deflection: Array, deflection_rate: Array, series: Array) -> tuple[Array, Array]:
        """Forces (..., e, 3) N on the upper bodies and rates (..., m) m/s of the series springs' deflections."""
        (stiffness, spring_laws), (damping, damper_laws) = self.stiffness, self.damping
        force = -stiffness * deflection - damping * deflection_rate
        force[..., 2] += self.of.static_loads
        for e, j, law in spring_laws:
            force[..., e, j] -= law(deflection[..., e, j])
        for e, j, law in damper_laws:
            force[..., e, j] -= law(deflection_rate[..., e, j])
        series_rate = np.empty_like(series)
        elements = list(self.coordinates.vehicle.elements.values())
        load = np.array([part.stiffness[2] if isinstance(part.stiffness[2], float) else 0.0 for part in elements])
        load = self.of.static_loads - load * deflection[..., 2]
        for e, j, law in spring_laws:
            if j == 2:
                load[..., e] -= law(deflection[..., e, 2])
        for (kind, e, j), m in self.coordinates.internal.items():
            part = elements[e]
            if kind == "slider":
                limit = part.friction[j] + part.friction_coefficient[j] * np.maximum(load[..., e], 0.0)
                spring = part.friction_stiffness[j] * (deflection[..., e, j] - series[..., m])
                force[..., e, j] -= np.clip(spring, -limit, limit)
                series_rate[..., m] = 0.0
                continue
            if kind == "flow":
                v, w = series[..., m], series[..., self.coordinates.internal["series", e, j]]
                damper, law = part.surge_exponent[j], part.damping[j]
                resistance = law(v) if isinstance(law, ForceLaw) else law * np.abs(v) ** damper * np.sign(v)
                series_rate[..., m] = (part.series_stiffness[j] * w - resistance) / part.surge_mass[j]
                continue
            spring_force = part.series_stiffness[j] * series[..., m]
            force[..., e, j] -= spring_force
            flow = self.coordinates.internal.get(("flow", e, j))
            velocity = series[..., flow] if flow is not None else _damper_velocity(part.damping[j], spring_force)
            series_rate[..., m] = deflection_rate[..., e, j] - velocity
        return force, series_rate

    def _rotational_moments(self, motion: BodyMotion) -> Array:
        """Moments (..., n, 3) N m of the rotational springs, which have the potential r.K r / 2 of rotations r."""
        rotation = self.rotations(motion)
        moment = -moment_of_gradient(rotation, self.rotational_stiffness * rotation)
        upper, lower = self.of.rotational_ends
        turning = rotate_back(motion.axes[..., lower, :, :], motion.rate[..., upper, :] - motion.rate[..., lower, :])
        springs = self.coordinates.vehicle.rotational_springs.values()
        moment = moment - np.array([part.damping for part in springs]).reshape(-1, 3) * turning
        incidence = incidence_of(self.of.rotational_ends, motion.position.shape[-2])
        return np.asarray(incidence @ rotate(motion.axes[..., lower, :, :], moment))

    def rotations(self, motion: BodyMotion) -> Array:
        """Rotation vectors (..., p, 3) rad of the rotational springs, in the axes of the lower bodies."""
        upper, lower = self.of.rotational_ends
        return rotation_vector(np.swapaxes(motion.axes[..., lower, :, :], -1, -2) @ motion.axes[..., upper, :, :])


def _split_laws(rows: Sequence[tuple[Law, ...]]) -> tuple[Array, tuple[tuple[int, int, ForceLaw], ...]]:
    """Linear coefficients (e, 3), and force laws with element and direction."""
    linear = np.array([[0.0 if isinstance(law, ForceLaw) else law for law in row] for row in rows]).reshape(-1, 3)
    laws = ((e, j, law) for e, row in enumerate(rows) for j, law in enumerate(row) if isinstance(law, ForceLaw))
    return linear, tuple((e, j, law) for e, j, law in laws)


def _damper_velocity(law: Law, force: Array) -> Array:
    """Velocity (...) m/s at which a damper has a force (...) N."""
    return law.inverse(force) if isinstance(law, ForceLaw) else np.asarray(force / law)


def incidence_of(ends: Ends, count: int) -> Array:
    """(n, p) 1 where a body is the upper one of a part, -1 where it is the lower one."""
    incidence = np.zeros((count, len(ends.upper)))
    incidence[ends.upper, np.arange(len(ends.upper))] = 1.0
    incidence[ends.lower, np.arange(len(ends.upper))] = -1.0
    return incidence


class AppliedState(NamedTuple):
    """Torques and forces at one time, in common axes unless another is named.

    Parameters:
        torque: (p,) N m, of each torque on its wheelset, about the axle.
        components: (f, 3) N, of each force along the axes of the track section at its body.
        force, moment: (n, 3) N and N m about the centres of mass, on the bodies.
    """

    torque: Array
    components: Array
    force: Array
    moment: Array


def applied_state(of: AppliedForces, travel: TrackPosition, motion: BodyMotion, state: Array) -> AppliedState:
    """Torques and forces of a state.

    Parameters:
        travel: reference motion along the track.
        motion: of the bodies.
        state: (2 c + m,).
    """
    distance = travel.distance + of.coordinates.split(state).position[:, X]
    force, moment = np.zeros_like(motion.position), np.zeros_like(motion.position)
    owners = [*of.wheelsets.tolist(), *np.repeat(of.bodies, 3).tolist()]
    values = np.array([table.at(travel.time, distance[i]) for table, i in zip(of.loads.tables, owners, strict=True)])
    axle = motion.axes[of.wheelsets, :, 1]
    torque = _with_brakes(of, values[: len(axle)], motion, axle)
    np.add.at(moment, of.wheelsets, torque[:, None] * axle)
    np.add.at(moment, of.reactions, -torque[:, None] * axle)
    components = values[len(axle) :].reshape(-1, 3)
    own = rotate(motion.sections.axes[of.bodies], components)
    turning = cross(rotate(motion.axes[of.bodies], of.arms), own)
    # Bearings transmit no moment about the axle of a wheelset.
    about = motion.axes[of.bodies, :, 1]
    is_wheelset = np.isin(of.bodies, of.coordinates.wheelset_bodies)[:, None]
    turning = turning - np.where(is_wheelset, (turning * about).sum(axis=1, keepdims=True), 0.0) * about
    np.add.at(force, of.bodies, own)
    np.add.at(moment, of.bodies, turning)
    return AppliedState(torque, components, force, moment)


def _with_brakes(of: AppliedForces, values: Array, motion: BodyMotion, axle: Array) -> Array:
    """Torques (p,) N m of values (p,), of which those of friction brakes act against the rotation."""
    spin = motion.relative.spin[of.wheelsets]
    spin = spin + ((motion.rate[of.wheelsets] - motion.rate[of.reactions]) * axle).sum(axis=1)
    return np.where(of.brakes, -values * np.clip(spin / of.release, -1.0, 1.0), values)


def hold_force(dynamics: VehicleDynamics, motion: BodyMotion, state: Array) -> Array:
    """Force (..., n, 3) N in common axes that keeps the speed."""
    hold, force = dynamics.vehicle.speed_hold, np.zeros_like(motion.position)
    if hold is not None:
        i = dynamics.vehicle.names.index(hold.body)
        position, rate, _ = dynamics.coordinates.split(state)
        size = -hold.stiffness * position[..., i, X] - hold.damping * rate[..., i, X]
        force[..., i, :] = size[..., None] * motion.sections.axes[..., i, :, 0]
    return force


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
    motion = kinematics(dynamics)(dynamics.speed_profile(time), state)
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
    suspension = NumpySuspension(dynamics.suspension)
    deflection = suspension(motion, series).deflection
    stiffness, laws = suspension.stiffness
    springs = 0.5 * (stiffness * deflection**2).sum() - suspension.of.static_loads @ deflection[:, 2]
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
    motion = kinematics(dynamics)(travel, state)
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
        _, _, force, moment = applied_state(dynamics.applied, travel, motion, state)
        applied = float((force * motion.velocity).sum() + (moment * angular).sum())
    return VehiclePower(float(contact), damper_power(dynamics, motion, series), float(hold), applied)


def damper_power(dynamics: VehicleDynamics, motion: BodyMotion, series: Array) -> float:
    """Power W of all dampers, those of Maxwell elements included; parameters as for `spring_energy`."""
    suspension = NumpySuspension(dynamics.suspension)
    state = suspension(motion, series)
    damping, laws = suspension.damping
    dissipated = (damping * state.deflection_rate**2).sum()
    for e, j, law in laws:
        dissipated += float(law(state.deflection_rate[e, j])) * state.deflection_rate[e, j]
    elements = list(dynamics.vehicle.elements.values())
    for w, w_rate, (e, j) in zip(series, state.series_rate, dynamics.coordinates.maxwell, strict=True):
        dissipated += elements[e].series_stiffness[j] * w * (state.deflection_rate[e, j] - w_rate)
    return -float(dissipated)
