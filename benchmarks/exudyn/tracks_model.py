"""The vehicle on moving tracks in Exudyn, its smooth law of contact written for absolute axes."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from scipy.linalg import block_diag

from benchmarks.exudyn.on_tracks import OnTracks
from benchmarks.exudyn.smooth_pair import SmoothLaw
from benchmarks.exudyn.vehicle_model import CircularTrack, Motion, MovingTrack, TimeSteps, VehicleForces, trajectory
from wheelrail.support.arrays import Array

SIDES = np.array([1.0, -1.0])  # left, right
MOTIONS = 5  # of the track under a wheel: y, z, roll of the rail, y, z of its sleepers


@dataclass(frozen=True)
class SmoothForces(VehicleForces):
    """The law in absolute axes, on straight track whose rails move.

    Parameters:
        law: of all wheels.
        wheel_y, rail_y: m, of the left wheel from the centre of the wheelset, of the left rail's origin.
        foot: m, y outwards and z of the centre of the rail's roll from its origin.
        own_tracks: by wheelset, motions (10,) of the left and the right track, outwards and upwards.
    """

    law: SmoothLaw
    wheel_y: float
    rail_y: float
    foot: tuple[float, float]
    own_tracks: Sequence[MovingTrack]

    @property
    def tracks(self) -> Sequence[MovingTrack]:
        return self.own_tracks

    def contact(self, motion: Motion, i: int) -> tuple[Array, Array]:
        number = self.vehicle.wheelsets.index(self.vehicle.names[i])
        wheels = self._wheels(motion, number)
        forces = [force for force, _, _ in wheels]
        moments = [np.cross(point - motion.position[i], force) for force, point, _ in wheels]
        return sum(forces), sum(moments)  # type: ignore[return-value]

    def rail_loads(self, motion: Motion, number: int) -> Array:
        loads = np.zeros((2, MOTIONS))
        for k, (force, point, foot) in enumerate(self._wheels(motion, number)):
            roll = np.cross(point - foot, -force)[0]
            loads[k, :3] = -SIDES[k] * force[1], -force[2], SIDES[k] * roll
        return loads.ravel()

    def _wheels(self, motion: Motion, number: int) -> list[tuple[Array, Array, Array]]:
        """Force (3,) N, its point and the rail's foot (3,) m by wheel."""
        i = self.vehicle.names.index(self.vehicle.wheelsets[number])
        axes, centre, found = self.level_axes(motion, i), motion.position[i], []
        for side, (y, z, roll) in zip(SIDES, motion.rails[number].reshape(2, MOTIONS)[:, :3], strict=True):
            outwards, upwards = self.foot
            foot = np.array([centre[0], side * (self.rail_y + outwards + y), upwards + z])
            c, s = np.cos(side * roll), np.sin(side * roll)
            rail = np.array([[1.0, 0.0, 0.0], [0.0, c, -s], [0.0, s, c]])  # axes as columns
            top = foot - rail @ np.array([0.0, side * outwards, upwards])
            wheel = centre + side * self.wheel_y * axes[:, 1]
            across = side * float((wheel - top) @ rail[:, 1]) - (self.wheel_y - self.rail_y)
            point = self.law.point(wheel, axes[:, 2], across)
            slip = rail.T @ (motion.velocity[i] + np.cross(motion.rate[i], point - centre))
            local = self.law.force(across, float((point - top) @ rail[:, 2]), slip[:2] * [1.0, side])
            found.append((rail @ (local * [1.0, side, 1.0]), point, foot))
        return found


def theirs(case: OnTracks, end: float, step: float) -> Array:
    """Coordinates (n, 6) of the bodies at the end by Exudyn at a fixed step s, pitch as zero."""
    vehicle, structure = case.dynamics.vehicle, case.structure
    mounting, (outwards, upwards) = structure.pairs.mountings[0], structure.pairs.flexibility.foot(0)
    parts = [[own.mass, own.stiffness, own.damping] for own in structure.tracks]
    track = MovingTrack(*(block_diag(*both) for both in zip(*parts, strict=True)), case.rest)
    forces = SmoothForces(
        vehicle,
        CircularTrack(),
        case.law,
        mounting.wheel_y,
        mounting.rail_y,
        (float(outwards), float(upwards)),
        [track] * len(vehicle.wheelsets),
    )
    bodies = case.initial[: case.dynamics.coordinates.size]
    return np.asarray(trajectory(forces, bodies, case.law.speed, TimeSteps(end, step, end))[-1])
