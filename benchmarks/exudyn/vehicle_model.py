"""The vehicle of `wheelrail.vehicle.multibody` in Exudyn (J. Gerstmayr, Multibody System Dynamics 60 (2024), DOI
10.1007/s11044-023-09937-1), with the contact element of this package in its wheels, or on moving tracks.

Exudyn has the rigid bodies in absolute coordinates, gravity, the tracks and the integrator. Forces are user functions,
written for absolute axes without the vehicle's own equations: suspension elements, rotational springs, and the motion
of each wheelset in its section of the track as the element's inputs.
"""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property

import exudyn as exu
import exudyn.itemInterface as item
import numpy as np
from exudyn.rigidBodyUtilities import RotationMatrix2RotationVector
from scipy.spatial.transform import Rotation

from wheelrail.api.elements.wheelset_element import WheelsetElement
from wheelrail.support.arrays import Array
from wheelrail.vehicle.multibody.coordinates import Coordinates
from wheelrail.vehicle.multibody.suspension_arrays import SuspensionArrays
from wheelrail.vehicle.multibody.vehicle import Vehicle
from wheelrail.vehicle.wagon.force_law import Law

UP = np.array([0.0, 0.0, 1.0])


@dataclass(frozen=True)
class MovingTrack:
    """Linear equations of the track under a wheelset; mass, stiffness and damping (n, n), motions (n,) at the start."""

    mass: Array
    stiffness: Array
    damping: Array
    start: Array


@dataclass(frozen=True)
class CircularTrack:
    """Straight track along x, or a circle about (0, 1 / curvature, 0).

    Parameters:
        curvature: 1/m, positive to the left.
        cant_angle: rad, positive lowers the left rail.
    """

    curvature: float = 0.0
    cant_angle: float = 0.0

    def section(self, distance: float) -> tuple[Array, Array]:
        """Point (3,) m of the centre line, and axes (3, 3) of the track there as columns: forward, left, up."""
        angle = self.curvature * distance
        forward, left = np.array([np.cos(angle), np.sin(angle), 0.0]), np.array([-np.sin(angle), np.cos(angle), 0.0])
        c, s = np.cos(self.cant_angle), np.sin(self.cant_angle)
        axes = np.column_stack([forward, c * left - s * UP, c * UP + s * left])
        if self.curvature == 0.0:
            return np.array([distance, 0.0, 0.0]), axes
        return np.array([np.sin(angle), 1.0 - np.cos(angle), 0.0]) / self.curvature, axes

    def distance(self, point: Array) -> float:
        """Distance m along the track of the section through a point."""
        if self.curvature == 0.0:
            return float(point[0])
        return float(np.arctan2(point[0], 1.0 / self.curvature - point[1])) / self.curvature


@dataclass(frozen=True)
class Motion:
    """Motion of n bodies in absolute axes.

    Parameters:
        position, velocity: (n, 3) m and m/s of the centres of mass.
        rotation: (n, 3, 3), axes of the bodies as columns.
        rate: (n, 3) rad/s.
        rails: motions of the track under each wheelset; none: at rest.
    """

    position: Array
    velocity: Array
    rotation: Array
    rate: Array
    rails: Sequence[Array] = ()


@dataclass(frozen=True)
class VehicleForces(ABC):
    """Forces on the bodies of a vehicle.

    Parameters:
        vehicle: bodies and suspension, without Maxwell elements and speed hold.
        track: below it.
    """

    vehicle: Vehicle
    track: CircularTrack

    @abstractmethod
    def contact(self, motion: Motion, i: int) -> tuple[Array, Array]:
        """Force and moment (3,) of both contacts on wheelset i, the number of its body."""

    def accept(self) -> None:  # noqa: B027
        """The state of the last call is that of an accepted step; nothing to do here."""

    @property
    def tracks(self) -> Sequence[MovingTrack]:
        """Track under each wheelset; none: rails at rest."""
        return ()

    def rail_loads(self, motion: Motion, number: int) -> Array:
        """Loads on the motions of the track under a wheelset, by its number."""
        raise NotImplementedError

    @cached_property
    def static_loads(self) -> Array:
        return SuspensionArrays(Coordinates(self.vehicle)).static_loads

    def __call__(self, motion: Motion) -> tuple[Array, Array]:
        """Force and moment (n, 3) on each body without gravity, N and N m about its centre of mass."""
        force, moment = np.zeros((2, len(self.vehicle.names), 3))
        axes, rates = motion.rotation.copy(), motion.rate.copy()
        for name in self.vehicle.wheelsets:
            i = self.vehicle.names.index(name)
            force[i], moment[i] = self.contact(motion, i)
            axes[i] = self.level_axes(motion, i)
            axle = axes[i, :, 1]
            rates[i] -= (rates[i] @ axle) * axle  # points of the axle do not feel the spin
        self._add_suspension(motion, axes, rates, force, moment)
        for spring in self.vehicle.rotational_springs.values():
            upper, lower = (self.vehicle.names.index(name) for name in (spring.upper, spring.lower))
            turned = Rotation.from_matrix(axes[lower].T @ axes[upper]).as_rotvec()
            gradient = np.array(spring.stiffness) * turned
            second = np.cross(turned, np.cross(turned, gradient)) / 12.0  # to the fourth power of the angle
            torque = -axes[lower] @ (gradient + 0.5 * np.cross(turned, gradient) + second)
            moment[upper] += torque
            moment[lower] -= torque
        return force, moment

    def level_axes(self, motion: Motion, i: int) -> Array:
        """Axes (3, 3) of wheelset i that do not spin, as columns."""
        axle = motion.rotation[i, :, 1]
        _, section = self.track.section(self.track.distance(motion.position[i]))
        level = section @ np.array([section[:, 1] @ axle, -section[:, 0] @ axle, 0.0])
        level /= np.linalg.norm(level)
        return np.column_stack([level, axle, np.cross(level, axle)])

    def _add_suspension(self, motion: Motion, axes: Array, rates: Array, force: Array, moment: Array) -> None:
        """Add forces and moments of all suspension elements."""
        names, bodies = self.vehicle.names, list(self.vehicle.bodies.values())
        for part, load in zip(self.vehicle.elements.values(), self.static_loads, strict=True):
            up, low = names.index(part.upper), names.index(part.lower)
            arms = [axes[i] @ (np.array(part.point) - (bodies[i].x, 0.0, bodies[i].height)) for i in (up, low)]
            gap = motion.position[up] + arms[0] - motion.position[low] - arms[1]
            rate = motion.velocity[up] + np.cross(rates[up], arms[0])
            rate = rate - motion.velocity[low] - np.cross(rates[low], arms[1])
            body = up if part.turn == 1.0 else low
            deflection, speed = gap @ axes[body], (rate - np.cross(rates[body], gap)) @ axes[body]
            local = [0.0, 0.0, load]
            for j in range(3):
                local[j] -= _law(part.stiffness[j], deflection[j]) + _law(part.damping[j], speed[j])
            pull = axes[body] @ np.array(local)
            point = motion.position[low] + arms[1] + (1.0 - part.turn) * gap
            force[up] += pull
            force[low] -= pull
            moment[up] += np.cross(point - motion.position[up], pull)
            reaction = np.cross(point - motion.position[low], -pull)
            if bodies[low].wheelset:
                axle = axes[low, :, 1]
                reaction = reaction - (reaction @ axle) * axle
            moment[low] += reaction


@dataclass(frozen=True)
class ElementForces(VehicleForces):
    """Forces with a contact element of this package in the wheels of each wheelset.

    Parameters:
        elements: of the wheelsets, in their order.
    """

    elements: Sequence[WheelsetElement]

    def accept(self) -> None:
        for element in self.elements:
            element.accept()

    def contact(self, motion: Motion, i: int) -> tuple[Array, Array]:
        """Force and moment (3,) of both contacts. Raises ValueError for a contact that fails."""
        axes, inputs = self.wheelset_inputs(motion, i)
        outputs = np.zeros(14)
        element = self.elements[self.vehicle.wheelsets.index(self.vehicle.names[i])]
        status = element.solve_array(inputs, outputs)
        if status.startswith("failed"):
            raise ValueError(status)
        sides = outputs[:12].reshape(2, 2, 3).sum(axis=0)
        return axes @ sides[0], axes @ sides[1]

    def wheelset_inputs(self, motion: Motion, i: int) -> tuple[Array, Array]:
        """Axes of the track's section of a wheelset, and inputs (17,) of its contact element."""
        origin, axes = self.track.section(self.track.distance(motion.position[i]))
        offset = motion.position[i] - origin
        horizontal_left = np.cross(UP, axes[:, 0])
        speed = motion.velocity[i] @ axes[:, 0] / (1.0 - self.track.curvature * (offset @ horizontal_left))
        frame_rate = self.track.curvature * speed * UP
        axle = axes.T @ motion.rotation[i, :, 1]
        roll, yaw = np.arcsin(axle[2]), np.arctan2(-axle[0], axle[1])
        rate = axes.T @ (motion.rate[i] - frame_rate)
        of_roll = np.array([np.cos(yaw), np.sin(yaw), 0.0])
        roll_rate, pitch_rate, yaw_rate = np.linalg.solve(np.column_stack([of_roll, axle, UP]), rate)
        _, y, z = axes.T @ offset
        _, y_rate, z_rate = axes.T @ (motion.velocity[i] - np.cross(frame_rate, offset))
        rates = (y_rate, z_rate, roll_rate, yaw_rate, pitch_rate, speed)
        return axes, np.array([y, z - self.vehicle.radius, roll, yaw, *rates, *(axes.T @ frame_rate), *np.zeros(4)])


def _law(law: Law, value: float) -> float:
    return law * value if isinstance(law, float | int) else float(law(value))


@dataclass(frozen=True)
class TimeSteps:
    """Times of a run, s: its end, its step and the interval of its rows."""

    end: float
    step: float
    every: float


def trajectory(forces: VehicleForces, initial: Array, speed: float, times: TimeSteps) -> Array:
    """Coordinates (rows, n, 6) of the bodies as in `wheelrail.vehicle.multibody.coordinates`, pitch as zero.

    Parameters:
        forces: on the bodies and their tracks.
        initial: (12 n,) coordinates and their rates.
        speed: of the reference motion, m/s.
        times: of the run; every must be a multiple of step.
    """
    mbs = exu.SystemContainer().AddSystem()
    nodes = _add_bodies(mbs, forces, initial, speed)
    output, rows = exu.OutputVariableType, []
    tracks = [
        mbs.AddNode(
            item.NodeGenericODE2(
                referenceCoordinates=[0.0] * len(own.mass),
                initialCoordinates=own.start.tolist(),
                initialCoordinates_t=[0.0] * len(own.mass),
                numberOfODE2Coordinates=len(own.mass),
            )
        )
        for own in forces.tracks
    ]

    def motion() -> Motion:
        values = [
            np.array([mbs.GetNodeOutput(node, variable) for node in nodes])
            for variable in (output.Position, output.Velocity, output.RotationMatrix, output.AngularVelocity)
        ]
        rails = [np.array(mbs.GetNodeOutput(node, output.Coordinates)) for node in tracks]
        return Motion(values[0], values[1], values[2].reshape(-1, 3, 3), values[3], rails)

    latest: list[object] = [b"", None]

    def wrenches() -> tuple[Array, Array, list[Array]]:
        key = mbs.systemData.GetODE2Coordinates().tobytes() + mbs.systemData.GetODE2Coordinates_t().tobytes()
        if latest[0] != key:
            at = motion()
            latest[:] = key, (*forces(at), [forces.rail_loads(at, k) for k in range(len(tracks))])
        return latest[1]  # type: ignore[return-value]

    for k, (node, own) in enumerate(zip(tracks, forces.tracks, strict=True)):
        mbs.AddObject(
            item.ObjectGenericODE2(
                nodeNumbers=[node],
                massMatrix=own.mass,
                stiffnessMatrix=own.stiffness,
                dampingMatrix=own.damping,
                forceUserFunction=lambda mbs, t, number, q, rates, k=k: wrenches()[2][k],
            )
        )

    for i, node in enumerate(nodes):
        marker = mbs.AddMarker(item.MarkerNodeRigid(nodeNumber=node))
        zero = [0.0, 0.0, 0.0]
        mbs.AddLoad(
            item.LoadForceVector(
                markerNumber=marker, loadVector=zero, loadVectorUserFunction=lambda mbs, t, load, i=i: wrenches()[0][i]
            )
        )
        mbs.AddLoad(
            item.LoadTorqueVector(
                markerNumber=marker, loadVector=zero, loadVectorUserFunction=lambda mbs, t, load, i=i: wrenches()[1][i]
            )
        )

    def after_step(mbs: object, time: float) -> bool:
        wrenches()  # of the accepted state, from which the next step starts
        forces.accept()
        if abs(time / times.every - round(time / times.every)) < 0.5 * times.step / times.every:
            rows.append(coordinates(forces, motion(), speed * time))
        return True

    mbs.SetPostStepUserFunction(after_step)
    mbs.Assemble()
    settings = exu.SimulationSettings()
    settings.timeIntegration.endTime = times.end
    settings.timeIntegration.numberOfSteps = round(times.end / times.step)
    settings.timeIntegration.verboseMode = 0
    settings.timeIntegration.explicit.computeEndOfStepAccelerations = False
    settings.solution.file.write = False
    mbs.SolveDynamic(settings, solverType=exu.DynamicSolverType.RK44)
    if not np.isclose(mbs.systemData.GetTime(), times.end):
        raise RuntimeError("Exudyn did not reach the end")
    return np.array(rows)


def _add_bodies(mbs: exu.MainSystem, forces: VehicleForces, initial: Array, speed: float) -> list[int]:
    """Add the bodies at their initial state, with gravity; returns their nodes."""
    vehicle, nodes = forces.vehicle, []
    position, rate = initial.reshape(2, -1, 6)
    for body, q, v in zip(vehicle.bodies.values(), position, rate, strict=True):
        origin, axes = forces.track.section(body.x + q[0])
        offset = axes @ np.array([0.0, q[1], body.height + q[2]])
        section_speed = speed + v[0]
        frame_rate = forces.track.curvature * section_speed * UP
        velocity = section_speed * axes[:, 0] + np.cross(frame_rate, offset) + axes @ np.array([0.0, v[1], v[2]])
        yawed = axes @ Rotation.from_euler("z", q[5]).as_matrix()
        rolled = yawed @ Rotation.from_euler("x", q[3]).as_matrix()
        rotation = rolled @ Rotation.from_euler("y", q[4]).as_matrix()
        spin = v[4] + (speed / vehicle.radius if body.wheelset else 0.0)
        angular = frame_rate + v[5] * axes[:, 2] + v[3] * yawed[:, 0] + spin * rolled[:, 1]
        node = mbs.AddNode(
            item.NodeRigidBodyRotVecLG(
                referenceCoordinates=[*(origin + offset), *RotationMatrix2RotationVector(rotation)],
                initialVelocities=[*velocity, *(rotation.T @ angular)],
            )
        )
        inertia = [*body.inertia, 0.0, 0.0, 0.0]
        number = mbs.AddObject(item.ObjectRigidBody(nodeNumber=node, mass=body.mass, inertia=inertia))
        centre = mbs.AddMarker(item.MarkerBodyMass(bodyNumber=number))
        weight = [0.0, 0.0, -vehicle.gravity]
        mbs.AddLoad(item.LoadMassProportional(markerNumber=centre, loadVector=weight))
        nodes.append(node)
    return nodes


def coordinates(forces: VehicleForces, motion: Motion, travel: float) -> Array:
    """Coordinates (n, 6) of the bodies; travel: distance m of the reference motion."""
    rows = []
    for i, body in enumerate(forces.vehicle.bodies.values()):
        distance = forces.track.distance(motion.position[i])
        origin, axes = forces.track.section(distance)
        _, y, z = axes.T @ (motion.position[i] - origin)
        axle = axes.T @ motion.rotation[i, :, 1]
        roll, yaw = np.arcsin(axle[2]), np.arctan2(-axle[0], axle[1])
        rows.append([distance - body.x - travel, y, z - body.height, roll, 0.0, yaw])
    return np.array(rows)
