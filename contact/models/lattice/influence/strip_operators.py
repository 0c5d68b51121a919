"""Relative displacement and elastic slip of the cells of a layout by tractions on them."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np

from wheelrail.contact.elasticity.waveguide.influence import HalfSpaceInfluence
from wheelrail.contact.elasticity.waveguide.influence_tables import add_all_means, add_normal_means
from wheelrail.contact.geometry.strip_layout import StripLayout
from wheelrail.contact.geometry.strip_surfaces import StripSurfaces
from wheelrail.contact.kinematics.contact_points import OutsideSurface, SurfacePoints
from wheelrail.contact.kinematics.frames import Pose
from wheelrail.contact.models.lattice.influence.slip_difference import AHEAD, upstream
from wheelrail.support.arrays import Array

TOO_LONG = "the patch is longer than the tables of influence"


@dataclass(frozen=True)
class StripOperators:
    """Two bodies invariant along x or in angle, and their surfaces in contact.

    The lower body is aligned with the rolling direction: a yaw of 30 mrad rotates it by as much, which has no effect on
    a half-space.
    """

    surfaces: StripSurfaces
    upper: HalfSpaceInfluence
    lower: HalfSpaceInfluence

    def area(self, layout: StripLayout) -> Array:
        """Area (n,) m2 of the cells."""
        length = np.diff(layout.edges) * self.surfaces.along(layout.middle)[:, None]
        return np.asarray((length * layout.width[:, None]).ravel())

    def normal(self, pose: Pose, layout: StripLayout) -> Array:
        """Relative normal compliance (n, n) m/Pa: mean displacement of the cells by unit pressures on them."""
        edges, area = layout.edges, self.area(layout)
        total = np.zeros((area.size, area.size))
        for kernel, sides, along in self._bodies(pose, layout):
            x, nodes = edges * along, kernel.nodes
            table = kernel.normal(sides, float(x.max() - x.min()))
            if not add_normal_means(total, table, x / kernel.unit, area, nodes.start, nodes.rate):
                raise OutsideSurface(TOO_LONG)
        return 2 * total if self.alike else total

    @property
    def alike(self) -> bool:
        """Whether both bodies have the same normal compliance: plane surfaces of the same material."""
        return self.lower is self.upper

    def _bodies(self, pose: Pose, layout: StripLayout) -> Iterator[tuple[HalfSpaceInfluence, Array, Array | float]]:
        """The different bodies, sides (S, 2) m of the strips on them, and lengths along them over those on the rolling
        circle.
        """
        yield self.upper, layout.sides, 1.0
        if not self.alike:
            stretch = self.surfaces.along(layout.middle)[:, None]
            yield self.lower, self.surfaces.lower_sides(pose, layout), stretch

    def all(self, pose: Pose, layout: StripLayout, places: SurfacePoints) -> tuple[Array, Array]:
        """Relative displacement (3 n, 3 n) m/Pa and elastic slip over the rolling speed (2 n, 3 n) 1/Pa by unit
        tractions, in the local axes of the cells, component by component.
        """
        S, M = len(layout.sides), len(layout.marks) - 1
        n = S * M
        edges = layout.edges
        lead = edges[:, -1:] - edges[:, -2:-1]
        rows = np.column_stack([edges, *(edges[:, -1:] + (k + 1) * lead for k in range(AHEAD))])
        stretch = self.surfaces.along(layout.middle)[:, None]
        middle = 0.5 * (rows[:, 1:] + rows[:, :-1])
        weight = np.stack(upstream(middle * stretch))
        displacement, slip = np.zeros((3, n, 3, n)), np.zeros((2, n, 3, n))
        bodies = list(self._bodies(pose, layout))
        table: Array = np.empty(0)
        both = (self.upper_axes(places), self.lower_axes(pose, places))
        for (kernel, sides, along), axes in zip([*bodies, *bodies][:2] if self.alike else bodies, both, strict=True):
            x = rows * along
            if not (table.size and self.alike):
                table = kernel.full(sides, float(x.max() - x.min()))
            turn = np.zeros(weight.shape)
            if kernel.radius is not None:
                for k in range(1, AHEAD + 1):
                    turn[k] = (middle[:, k : k + M] - middle[:, :M]) / kernel.radius
            nodes = kernel.nodes
            x, own = x / kernel.unit, np.ascontiguousarray(axes)
            if not add_all_means(displacement, slip, table, x, own, places.area, weight, turn, nodes.start, nodes.rate):
                raise OutsideSurface(TOO_LONG)
        return displacement.reshape(3 * n, 3 * n), slip.reshape(2 * n, 3 * n)

    def upper_axes(self, places: SurfacePoints) -> Array:
        """Local axes (n, 3, 3) in the upper body's own axes: (x, y, z), or (along the circle, y, outward)."""
        own = places.axes @ places.wheel_rotation
        if self.upper.radius is None and not self.upper.flat:
            return np.asarray(own)
        return level(own[:, 2, 1], np.hypot(own[:, 2, 0], own[:, 2, 2]))

    def lower_axes(self, pose: Pose, places: SurfacePoints) -> Array:
        """Local axes (n, 3, 3) along and across the rolling direction, and up."""
        own = places.axes @ self._yawed(pose)
        return level(own[:, 2, 1], -np.hypot(own[:, 2, 0], own[:, 2, 2])) if self.lower.flat else np.asarray(own)

    def _yawed(self, pose: Pose) -> Array:
        """Axes along and across the rolling direction as columns (3, 3)."""
        if self.upper.radius is None:
            return np.eye(3)
        yaw = np.arctan2(pose.rotation[1, 0], pose.rotation[0, 0])
        c, s = np.cos(yaw), np.sin(yaw)
        return np.array([[c, -s, 0.0], [s, c, 0.0], [0.0, 0.0, 1.0]])


def level(across: Array, up: Array) -> Array:
    """Axes (n, 3, 3) of normals (0, across, up): along x, lateral = x times normal, normal."""
    axes = np.zeros((len(up), 3, 3))
    axes[:, 0, 0], axes[:, 2, 1], axes[:, 2, 2] = 1, across, up
    axes[:, 1, 1], axes[:, 1, 2] = np.abs(up), -across * np.sign(up)
    return axes
