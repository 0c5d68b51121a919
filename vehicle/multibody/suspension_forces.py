"""Forces and moments of suspension elements and rotational springs on the bodies."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import NamedTuple

import numpy as np

from wheelrail.contact.kinematics.frames import cross
from wheelrail.support.arrays import Array, Nodes
from wheelrail.vehicle.multibody.body_motion import BodyMotion
from wheelrail.vehicle.multibody.coordinates import Coordinates
from wheelrail.vehicle.multibody.rotations import (
    moment_of_gradient,
    rotate,
    rotate_back,
    rotation_matrix,
    rotation_vector,
)
from wheelrail.vehicle.multibody.static_loads import static_loads
from wheelrail.vehicle.wagon.force_law import ForceLaw, Law


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


class Ends(NamedTuple):
    """Upper and lower bodies of p parts.

    Parameters:
        upper, lower: (p,) indices of the bodies.
        incidence: (n, p) 1 where a body is the upper one, -1 where it is the lower one.
    """

    upper: Nodes
    lower: Nodes
    incidence: Array

    @classmethod
    def of(cls, names: tuple[str, ...], pairs: Sequence[tuple[str, str]]) -> Ends:
        """Parameters: names of the bodies, and of the upper and lower body of each part."""
        indices = np.array([[names.index(name) for name in pair] for pair in pairs], dtype=np.int64).reshape(-1, 2)
        incidence = np.zeros((len(names), len(pairs)))
        incidence[indices[:, 0], np.arange(len(pairs))] = 1.0
        incidence[indices[:, 1], np.arange(len(pairs))] = -1.0
        upper, lower = np.ascontiguousarray(indices.T)  # of one type for compiled code, whatever their number
        return cls(upper, lower, incidence)


@dataclass(frozen=True)
class SuspensionForces:
    """Suspension of a vehicle as arrays.

    Parameters:
        coordinates: of the vehicle.
    """

    coordinates: Coordinates

    @cached_property
    def ends(self) -> Ends:
        pairs = [(part.upper, part.lower) for part in self.coordinates.vehicle.elements.values()]
        return Ends.of(self.coordinates.vehicle.names, pairs)

    @cached_property
    def rotational_ends(self) -> Ends:
        pairs = [(part.upper, part.lower) for part in self.coordinates.vehicle.rotational_springs.values()]
        return Ends.of(self.coordinates.vehicle.names, pairs)

    @cached_property
    def arms(self) -> tuple[Array, Array]:
        """Points (e, 3) m of the elements from the centres of their upper and lower bodies, in the bodies' axes."""
        vehicle = self.coordinates.vehicle
        points = np.array([part.point for part in vehicle.elements.values()]).reshape(-1, 3)
        centres = np.array([(body.x, 0.0, body.height) for body in vehicle.bodies.values()])
        return points - centres[self.ends.upper], points - centres[self.ends.lower]

    @cached_property
    def turn(self) -> Array:
        return np.array([part.turn for part in self.coordinates.vehicle.elements.values()])

    @cached_property
    def static_loads(self) -> Array:
        return static_loads(self.coordinates.vehicle)

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
        (upper, lower, incidence), (upper_arm, lower_arm) = self.ends, self.arms
        a_upper = rotate(motion.axes[..., upper, :, :], upper_arm)
        a_lower = rotate(motion.axes[..., lower, :, :], lower_arm)
        p_upper, p_lower = motion.position[..., upper, :] + a_upper, motion.position[..., lower, :] + a_lower
        gap = p_upper - p_lower
        gap_rate = motion.velocity[..., upper, :] + cross(motion.rate[..., upper, :], a_upper)
        gap_rate -= motion.velocity[..., lower, :] + cross(motion.rate[..., lower, :], a_lower)
        axes, axes_rate = self._element_axes(motion)
        deflection = rotate_back(axes, gap)
        deflection_rate = rotate_back(axes, gap_rate - cross(axes_rate, gap))
        element_force, series_rate = self._element_forces(deflection, deflection_rate, series)
        force = rotate(axes, element_force)
        point = p_lower + (1.0 - self.turn)[:, None] * gap
        on_upper = cross(point - motion.position[..., upper, :], force)
        on_lower = cross(point - motion.position[..., lower, :], force)
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
        upper, lower, _ = self.ends
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
        force[..., 2] += self.static_loads
        for e, j, law in spring_laws:
            force[..., e, j] -= law(deflection[..., e, j])
        for e, j, law in damper_laws:
            force[..., e, j] -= law(deflection_rate[..., e, j])
        series_rate = np.empty_like(series)
        elements = list(self.coordinates.vehicle.elements.values())
        for m, (e, j) in enumerate(self.coordinates.maxwell):
            spring_force = elements[e].series_stiffness[j] * series[..., m]
            force[..., e, j] -= spring_force
            series_rate[..., m] = deflection_rate[..., e, j] - _damper_velocity(elements[e].damping[j], spring_force)
        return force, series_rate

    def _rotational_moments(self, motion: BodyMotion) -> Array:
        """Moments (..., n, 3) N m of the rotational springs, which have the potential r.K r / 2 of rotations r."""
        rotation = self.rotations(motion)
        moment = -moment_of_gradient(rotation, self.rotational_stiffness * rotation)
        _, lower, incidence = self.rotational_ends
        return np.asarray(incidence @ rotate(motion.axes[..., lower, :, :], moment))

    def rotations(self, motion: BodyMotion) -> Array:
        """Rotation vectors (..., p, 3) rad of the rotational springs, in the axes of the lower bodies."""
        upper, lower, _ = self.rotational_ends
        return rotation_vector(np.swapaxes(motion.axes[..., lower, :, :], -1, -2) @ motion.axes[..., upper, :, :])


def _split_laws(rows: Sequence[tuple[Law, ...]]) -> tuple[Array, tuple[tuple[int, int, ForceLaw], ...]]:
    """Linear coefficients (e, 3), and force laws with element and direction."""
    linear = np.array([[0.0 if isinstance(law, ForceLaw) else law for law in row] for row in rows]).reshape(-1, 3)
    laws = ((e, j, law) for e, row in enumerate(rows) for j, law in enumerate(row) if isinstance(law, ForceLaw))
    return linear, tuple((e, j, law) for e, j, law in laws)


def _damper_velocity(law: Law, force: Array) -> Array:
    """Velocity (...) m/s at which a damper has a force (...) N."""
    return law.inverse(force) if isinstance(law, ForceLaw) else np.asarray(force / law)
