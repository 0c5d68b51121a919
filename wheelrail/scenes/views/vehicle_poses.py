"""Poses and sizes of the bodies of a vehicle in animations."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from typing import TYPE_CHECKING

import numpy as np

from wheelrail.support.arrays import Array
from wheelrail.vehicle.track.section_poses import SectionPoses, TrackSections

if TYPE_CHECKING:
    from wheelrail.vehicle.multibody.vehicle import Vehicle, VehicleBody
    from wheelrail.vehicle.track.track import Track


@dataclass(frozen=True)
class BodyPoses:
    """Positions (n, 3) m and axes (n, 3, 3), columns, of bodies in common axes."""

    position: Array
    axes: Array


@dataclass(frozen=True)
class DrawnVehicle:
    """Where the bodies of a vehicle are drawn.

    Parameters:
        vehicle: bodies and elements.
        track: on which they are.
        scale: displacement magnification factor.

    Displacements are those from the undeflected vehicle, whose wheelsets are centred on the track, each at its own
    distance, and whose other bodies lie on those below them, as their elements join them.
    """

    vehicle: Vehicle
    track: Track
    scale: float

    @cached_property
    def sections(self) -> TrackSections:
        return TrackSections(self.track)

    @cached_property
    def carriers(self) -> dict[str, list[str]]:
        """Bodies below each body that is no wheelset, in the order of their places, bodies below first."""
        below = {
            name: sorted(
                {e.lower for e in self.vehicle.elements.values() if e.upper == name and e.carries},
                key=lambda other: self.vehicle.bodies[other].x,
            )
            for name, body in self.vehicle.bodies.items()
            if not body.wheelset
        }
        ordered: dict[str, list[str]] = {}
        while len(ordered) < len(below):
            ready = {n: c for n, c in below.items() if n not in ordered and not set(c) & (below.keys() - ordered)}
            if not ready:  # bodies that carry each other are drawn at their own places on the track
                return ordered
            ordered |= ready
        return ordered

    def undeflected(self, sections: SectionPoses) -> BodyPoses:
        """Poses of the undeflected vehicle.

        Parameters:
            sections: of the track at the n bodies.
        """
        bodies, names = self.vehicle.bodies, list(self.vehicle.bodies)
        height = np.array([[0.0, 0.0, body.height] for body in bodies.values()])
        position, axes = sections.position + rotate(sections.axes, height), sections.axes.copy()
        for name, carriers in self.carriers.items():
            if not carriers:
                continue
            i, below = names.index(name), [names.index(c) for c in carriers]
            x = axes[below, :, 0].mean(axis=0) if len(below) < 2 else position[below[-1]] - position[below[0]]
            axes[i] = axes_along(x, axes[below, :, 2].mean(axis=0))
            nominal = np.array([[bodies[c].x, 0.0, bodies[c].height] for c in carriers]).mean(axis=0)
            offset = np.array([bodies[name].x, 0.0, bodies[name].height]) - nominal
            position[i] = position[below].mean(axis=0) + axes[i] @ offset
        return BodyPoses(position, axes)

    def poses(self, distance: float, coordinates: Array) -> BodyPoses:
        """Poses with magnified displacements, in the axes of the track at a distance.

        Parameters:
            distance: of the reference motion along the track, m.
            coordinates: (n, 6) of the bodies, m and rad.
        """
        from scipy.spatial.transform import Rotation

        nominal = np.array([[b.x, b.height, b.wheelset] for b in self.vehicle.bodies.values()])
        sections = self.sections.at(distance + nominal[:, 0] + coordinates[:, 0], distance)
        roll, pitch, yaw = coordinates[:, 3], np.where(nominal[:, 2] > 0, 0.0, coordinates[:, 4]), coordinates[:, 5]
        offset = np.stack([np.zeros(len(nominal)), coordinates[:, 1], nominal[:, 1] + coordinates[:, 2]], axis=1)
        position = sections.position + rotate(sections.axes, offset)
        axes = sections.axes @ body_rotation(roll, pitch, yaw)
        at_rest = self.undeflected(sections)
        back = np.swapaxes(at_rest.axes, 1, 2)
        displacement = rotate(back, position - at_rest.position)
        turn = Rotation.from_matrix(back @ axes).as_rotvec()
        drawn = at_rest.position + rotate(at_rest.axes, self.scale * displacement)
        return BodyPoses(drawn, at_rest.axes @ matrices(self.scale * turn))


def rotate(matrices: Array, vectors: Array) -> Array:
    """Products (n, 3) of matrices and vectors."""
    return np.asarray(np.einsum("nij,nj->ni", matrices, vectors))


def body_rotation(roll: Array | float, pitch: Array | float, yaw: Array | float) -> Array:
    """Rz(yaw) Rx(roll) Ry(pitch) (..., 3, 3) of angles (...) rad."""
    from scipy.spatial.transform import Rotation

    return np.asarray(Rotation.from_euler("ZXY", np.stack([yaw, roll, pitch], axis=-1)).as_matrix())


def axes_along(x: Array, z: Array) -> Array:
    """Right-handed axes (3, 3), columns, the first along x (3,), the last next to z (3,)."""
    x = x / np.linalg.norm(x)
    y = np.cross(z, x)
    y = y / np.linalg.norm(y)
    return np.stack([x, y, np.cross(x, y)], axis=1)


def matrices(vectors: Array) -> Array:
    """Rotations (n, 3, 3) of rotation vectors (n, 3) rad, of any size."""
    from scipy.spatial.transform import Rotation

    return np.asarray(Rotation.from_rotvec(vectors).as_matrix())


def equal_box(body: VehicleBody) -> tuple[float, float, float]:
    """Length, width and height m of the homogeneous box with the mass and moments of inertia of a body.

    Moments that no body of finite height has give a side of 0.2 m.
    """
    x, y, z = body.inertia
    squares = (6.0 / body.mass * value for value in (y + z - x, x + z - y, x + y - z))
    length, width, height = (float(np.sqrt(max(square, 0.04))) for square in squares)
    return length, width, height
