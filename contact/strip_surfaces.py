"""Where the surfaces of two bodies overlap, strip by strip along the rolling direction."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Protocol

import numpy as np

from contact.points import Places
from contact.pose import Array, Pose
from contact.quadrics import UPSIDE_DOWN, curvature
from contact.strips import Layout
from meshes.profiles import Profile


@dataclass(frozen=True)
class Ridge:
    """Along every line s (ns,) m of the upper body: deepest overlap (ns,) m (negative: distance), its place x (ns,) m,
    and how fast it falls to both sides, bend (ns,) 1/m: overlap - bend x^2 / 2.
    """

    s: Array
    overlap: Array
    x: Array
    bend: Array


class StripSurfaces(Protocol):
    """Surfaces of a pair of bodies for strips: s m across and x m along the rolling circle of the upper body."""

    def ridge(self, pose: Pose, s: Array) -> Ridge: ...

    def overlap(self, pose: Pose, s: Array, x: Array) -> Array:
        """Undeformed overlap m at s and x of one shape."""

    def places(self, pose: Pose, layout: Layout) -> Places:
        """The cells' middles, strip by strip from the trailing end."""

    def lower_sides(self, pose: Pose, layout: Layout) -> Array:
        """Sides (S, 2) m of the strips on the lower body."""

    def along(self, s: Array) -> Array:
        """Length on the surface at s over length on the rolling circle."""


@dataclass(frozen=True)
class ProfileStrips:
    """A wheel of nominal radius m, its profile revolved about y, on a rail, its profile extruded."""

    wheel: Profile
    rail: Profile
    radius: float

    def _wheel(self, pose: Pose, s: Array, x: Array) -> tuple[Array, Array, Array]:
        """Points (..., 3) m, outward normals and forward directions in the rail's frame."""
        (y, z), (ny, nr) = np.moveaxis(self.wheel.point(s), -1, 0), np.moveaxis(self.wheel.normal(s), -1, 0)
        r, sine, cosine = z + self.radius, np.sin(x / self.radius), np.cos(x / self.radius)
        point = pose.origin + np.stack([r * sine, y, -r * cosine], axis=-1) @ pose.rotation.T
        normal = np.stack([nr * sine, ny, -nr * cosine], axis=-1) @ pose.rotation.T
        forward = np.stack([cosine, np.zeros_like(y), sine], axis=-1) @ pose.rotation.T
        return point, normal, forward

    def _overlap(self, pose: Pose, s: Array, x: Array) -> tuple[Array, Array, Array]:
        """Overlap m, arc length m of the foot on the rail, and the wheel's points."""
        point, normal, _ = self._wheel(pose, s, x)
        foot = self.rail.closest(point[..., 1:].reshape(-1, 2))
        on_rail = foot.s.reshape(s.shape)
        depth = np.einsum("...c,...c->...", point[..., 1:] - self.rail.point(on_rail), normal[..., 1:])
        return np.where(foot.inside.reshape(s.shape), depth, -np.inf), on_rail, point

    def ridge(self, pose: Pose, s: Array) -> Ridge:
        """The wheel's circle is nearest to the rail where it runs along it: its forward direction has no part in the
        rail's normal.
        """
        x = np.zeros_like(s)
        for _ in range(2 if pose.rotation[1, 0] != 0 else 0):
            _, foot, _ = self._overlap(pose, s, x)
            across = np.column_stack([np.zeros_like(s), self.rail.normal(foot)]) @ pose.rotation
            x = -self.radius * np.arctan(across[:, 0] / across[:, 2])
        depth = self._overlap(pose, s, x)[0]
        r, nr = self.wheel.point(s)[:, 1] + self.radius, self.wheel.normal(s)[:, 1]
        return Ridge(s, depth, x, np.maximum(r * nr, 0.05 * r) / self.radius**2)

    def overlap(self, pose: Pose, s: Array, x: Array) -> Array:
        return self._overlap(pose, s, x)[0]

    def along(self, s: Array) -> Array:
        return np.asarray(1 + self.wheel.point(s)[..., 1] / self.radius)

    def lower_sides(self, pose: Pose, layout: Layout) -> Array:
        x = np.repeat(layout.ends.mean(axis=1), 2).reshape(-1, 2)
        return self._overlap(pose, layout.sides, x)[1]

    def places(self, pose: Pose, layout: Layout) -> Places:
        edges = layout.edges
        x = 0.5 * (edges[:, 1:] + edges[:, :-1])
        s = np.broadcast_to(layout.middle[:, None], x.shape)
        overlap, on_rail, point = self._overlap(pose, s, x)
        _, normal, forward = self._wheel(pose, s, x)
        length = np.diff(edges) * self.along(layout.middle)[:, None]
        lateral = np.cross(forward, normal)
        return Places(
            point=point.reshape(-1, 3),
            axes=np.stack([forward, lateral, normal], axis=-2).reshape(-1, 3, 3),
            area=(length * layout.width[:, None]).ravel(),
            overlap=overlap.ravel(),
            wheel_rotation=pose.rotation,
            step=length.ravel(),
            wheel_place=np.stack([s.ravel(), self.wheel.point(s.ravel())[:, 0]], axis=1),
            rail_place=np.stack([on_rail.ravel(), self.rail.point(on_rail.ravel())[:, 0]], axis=1),
        )


@dataclass(frozen=True)
class QuadricStrips:
    """Two bodies with principal radii [m] in x and y on large blocks, see `contact.quadrics`."""

    upper: tuple[float, float]
    lower: tuple[float, float]

    def ridge(self, pose: Pose, s: Array) -> Ridge:
        (ax, _), (bx, _) = curvature(self.upper), curvature(self.lower)
        x = np.full_like(s, pose.origin[0] * ax / (ax + bx))
        return Ridge(s, self.overlap(pose, s, x), x, np.full_like(s, 2 * (ax + bx)))

    def overlap(self, pose: Pose, s: Array, x: Array) -> Array:
        (ax, ay), (bx, by) = curvature(self.upper), curvature(self.lower)
        X, Y, Z = pose.origin
        return np.asarray(-Z - ax * (x - X) ** 2 - ay * (s - Y) ** 2 - bx * x * x - by * s * s)

    def along(self, s: Array) -> Array:
        return np.ones_like(s)

    def lower_sides(self, pose: Pose, layout: Layout) -> Array:
        return layout.sides

    def places(self, pose: Pose, layout: Layout) -> Places:
        edges = layout.edges
        x = (0.5 * (edges[:, 1:] + edges[:, :-1])).ravel()
        s = np.repeat(layout.middle, edges.shape[1] - 1)
        length = np.diff(edges)
        across = np.column_stack([s, s])
        return Places(
            point=np.column_stack([x, s, np.zeros_like(x)]),
            axes=np.broadcast_to(np.diag([1.0, 1.0, -1.0]), (len(x), 3, 3)),
            area=(length * layout.width[:, None]).ravel(),
            overlap=self.overlap(pose, s, x),
            wheel_rotation=UPSIDE_DOWN,
            step=length.ravel(),
            wheel_place=across,
            rail_place=across,
        )
