"""Surfaces of a wheel on a rail: candidate points, contact map and gap on the exact profiles, eq. (1).

The rail is an extruded profile, the wheel a revolved one, so the normal projection of a wheel point on the rail is the
closest point of a plane curve; no search tree is needed.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np

from wheelrail.bindings._contact import UNSOLVED, overlap_text
from wheelrail.contact.geometry.grid_points import GridPoints, Interpolation
from wheelrail.contact.geometry.rigid_surfaces import RigidWheelRail
from wheelrail.contact.geometry.surface_grid import ContactGrid
from wheelrail.contact.kinematics.contact_points import OutsideSurface
from wheelrail.contact.kinematics.frames import Pose
from wheelrail.contact.kinematics.sensitivity import WheelPointSensitivity
from wheelrail.meshes.bodies.solids import Strip
from wheelrail.meshes.profiles.profile import Profile
from wheelrail.support.arrays import Array, Nodes

MISSED = 5e-4  # m, largest overlap between grid points, which are at most 4 mm apart
CHORD = 1e-6  # m, largest distance of a line of the rail from its chords of 0.1 mm: 0.1 um at 13 mm, 1 um at 1.3 mm


@dataclass(frozen=True)
class ProfilePair:
    """Surfaces of a left-hand wheel-rail pair.

    Parameters:
        wheel, rail: profiles.
        radius: nominal rolling radius, m.
        wheel_strip, rail_strip: parts of the profiles that carry contact points.
        wheel_grid, rail_grid: contact grids on the strips.
        degree: of the displacements, 1 or 2; a grid of degree 2 is twice as fine as its strip.
    """

    wheel: Profile
    rail: Profile
    radius: float
    wheel_strip: Strip
    rail_strip: Strip
    wheel_grid: ContactGrid
    rail_grid: ContactGrid
    degree: int = 1

    @cached_property
    def arc(self) -> Array:
        """Arc length (ns,) of the wheel grid's lines on the profile, m."""
        strip = self.wheel_strip
        return np.asarray(strip.start + np.arange(self.wheel_grid.shape[1]) * strip.size / self.degree)

    @cached_property
    def lines(self) -> tuple[Array, Array]:
        """Lateral position and radius (ns, 2), and outward normal (ns, 2), of the wheel grid's lines."""
        return self.wheel.point(self.arc) + np.array([0.0, self.radius]), self.wheel.normal(self.arc)

    @cached_property
    def angle(self) -> Array:
        """Angle (nx,) of the wheel grid's rows about the axle, forward from straight below, rad."""
        count = self.wheel_grid.shape[0]
        return np.asarray((np.arange(count) - count // 2) * self.wheel_strip.size / self.degree / self.radius)

    @cached_property
    def surface(self) -> tuple[Array, Array]:
        """Exact points (nx ns, 3) m and local axes (nx ns, 3, 3), rows longitudinal, lateral, outward, in the wheel's
        frame.
        """
        (y, r), (ny, nr) = self.lines[0].T, self.lines[1].T
        s, c = np.sin(self.angle)[:, None], np.cos(self.angle)[:, None]
        shape = self.wheel_grid.shape

        def stack(*parts: Array) -> Array:
            return np.stack([np.broadcast_to(p, shape) for p in parts], axis=-1).reshape(-1, 3)

        point, normal = stack(r * s, y, -r * c), stack(nr * s, ny, -nr * c)
        forward = stack(c, np.zeros(1), s)
        return point, np.stack([forward, np.cross(forward, normal), normal], axis=1)

    @cached_property
    def _sensitivity(self) -> WheelPointSensitivity:
        return WheelPointSensitivity.of(self.rail)

    @cached_property
    def skyline(self) -> tuple[Array, Array]:
        """Lateral position and height (n,) m of the rail's top line, for a fast preselection of points."""
        points = self.rail.point(self.rail.samples(1e-4))
        y, z = points.T
        rising = np.concatenate([[True], y[1:] > np.maximum.accumulate(y)[:-1]])
        return y[rising], z[rising]

    def contact_points(self, pose: Pose, steps: int) -> tuple[GridPoints | None, float]:
        """Candidates: wheel points inside the undeformed rail; see `SurfacePair`."""
        if unsolved := self.rigid.unsolved(pose, self.arc[0], self.arc[-1]):
            raise OutsideSurface(unsolved)
        point = pose.origin + self.surface[0] @ pose.rotation.T
        seen = point[:, 1:]  # in the section of a rail that is curved in plan
        if pose.plan:
            seen = seen - np.stack([0.5 * pose.plan * point[:, 0] ** 2, np.zeros(len(point))], axis=1)
        # Points below the rail's top line are inside the rail; outside its lateral range there is no contact.
        depth = np.interp(seen[:, 0], *self.skyline, left=-np.inf, right=-np.inf) - seen[:, 1]
        near = depth > -CHORD
        if not near.any():
            return None, self._separated(pose)
        nx, ns = self.wheel_grid.shape
        stride = self.wheel_grid.stride
        mask = (depth > 0).reshape(nx, ns)
        last_row = nx - 1 - steps * stride  # beyond, upstream points for the slip are missing
        if mask[0].any() or mask[last_row:].any():
            raise self._beyond(pose, _ALONG.format(1e3 * self.radius * self.angle[last_row]))
        if mask[:, 0].any() or mask[:, -1].any():
            end = "flange's tip" if mask[:, 0].any() else "end of the tread"
            raise self._beyond(pose, f"it passes the last line towards the {end}")
        near[last_row * ns :] = False  # none of them is inside
        node = np.flatnonzero(near & (self.wheel_grid.weight.ravel() > 0))
        if not len(node):
            return None, self._separated(pose)
        upstream = node + np.arange(steps + 1)[:, None] * stride * ns
        nodes, inverse = np.unique(upstream, return_inverse=True)
        projection = self.rail.closest(seen[nodes])
        first = inverse.reshape(upstream.shape)[0]
        rail_s = projection.s[first]
        projected = self.rail.point(rail_s)
        axes = self.surface[1][node] @ pose.rotation.T
        penetration = np.einsum("nc,nc->n", seen[node] - projected, axes[:, 2, 1:])
        positive = penetration > 0  # at the edge of the region the two normals may differ
        if not positive.all():
            node, upstream, axes, penetration = (
                node[positive],
                upstream[:, positive],
                axes[positive],
                penetration[positive],
            )
            rail_s, projected = rail_s[positive], projected[positive]
            inverse = inverse.reshape(steps + 1, -1)[:, positive].ravel()
        if not len(node):
            return None, self._separated(pose)
        reach = self.rail_strip.size / self.degree * (self.rail_grid.shape[0] // 2)
        along = point[nodes, 0] - self.rail_x(pose)
        if np.abs(along).max() > reach:
            upstream_length = steps * stride * self.wheel_strip.size / self.degree
            raise self._beyond(pose, _ALONG.format(1e3 * (reach - upstream_length)))
        if (beyond := self._beyond_rail(rail_s, penetration)) >= 0:
            place = self.wheel.point(self.arc[node[beyond] % ns])
            raise OutsideSurface(overlap_text(penetration[beyond], place, UNSOLVED))
        interpolation = self._rail_interpolation(along, projection.s)
        inverse = inverse.ravel()
        line, normal = node % ns, self.rail.normal(rail_s)
        slope = np.einsum("nc,nc->n", axes[:, 0, 1:], normal) * np.einsum("nc,nc->n", axes[:, 2, 1:], normal)
        return (
            GridPoints(
                node=node,
                point=point[node],
                axes=axes,
                area=self.wheel_grid.weight.ravel()[node],
                penetration=penetration,
                wheel_rotation=pose.rotation,
                upstream=upstream,
                rail=Interpolation(interpolation.nodes[inverse], interpolation.weights[inverse]),
                circle_curvature=self.lines[1][line].T / self.lines[0][line, 1],
                slope=slope,
                step=self.lines[0][line, 1] * (self.angle[stride] - self.angle[0]),
                wheel_place=np.stack([self.arc[line], self.lines[0][line, 0]], axis=1),
                rail_place=np.stack([rail_s, projected[:, 0]], axis=1),
                sensitivity=replace(self._sensitivity, plan=pose.plan) if pose.plan else self._sensitivity,
            ),
            float(penetration.max()),
        )

    def rail_x(self, pose: Pose) -> float:
        """Place m along the rail of its grid's middle, near the wheel's: after whole cells the rail is the same."""
        return float(self.rail_strip.size * np.round(pose.origin[0] / self.rail_strip.size))

    @cached_property
    def rigid(self) -> RigidWheelRail:
        """Rigid surfaces of the same profiles."""
        return RigidWheelRail(self.wheel, self.rail, self.radius)

    def _separated(self, pose: Pose) -> float:
        """Approach m of a pose without candidates: minus the gap. Raises OutsideSurface for bodies that overlap."""
        place, depth, _ = self.rigid.nearest(pose)
        if depth > MISSED:
            raise OutsideSurface(overlap_text(depth, self.wheel.point(place), UNSOLVED))
        return min(depth, 0.0)

    def _beyond(self, pose: Pose, reason: str) -> OutsideSurface:
        """Error of a pose whose overlap reaches beyond the points, with the largest depth and its place."""
        place, depth, _ = self.rigid.nearest(pose)
        return OutsideSurface(overlap_text(depth, self.wheel.point(place), f"{UNSOLVED}: {reason}"))

    def _beyond_rail(self, s: Array, penetration: Array) -> int:
        """Number of the deepest of the points at s (n,) m beyond the rail's lines, with penetration (n,) m; -1 without
        any.
        """
        first, spacing = self.rail_strip.start, self.rail_strip.size / self.degree
        beyond = (s < first) | (s > first + (self.rail_grid.shape[1] - 1) * spacing)
        return int(np.where(beyond, penetration, -np.inf).argmax()) if beyond.any() else -1

    def _rail_interpolation(self, x: Array, s: Array) -> Interpolation:
        """Interpolation on the rail's grid at x, s (m,) m by tensor products of linear or quadratic shape functions."""
        (rows, lines), degree, spacing = self.rail_grid.shape, self.degree, self.rail_strip.size / self.degree
        i, wx = _cells(x / spacing + rows // 2, rows, degree)
        j, ws = _cells((s - self.rail_strip.start) / spacing, lines, degree)
        offset = np.arange(degree + 1)
        nodes = (i[:, None, None] + offset[:, None]) * lines + j[:, None, None] + offset
        return Interpolation(nodes.reshape(len(x), -1), (wx[:, :, None] * ws[:, None, :]).reshape(len(x), -1))


_ALONG = "it passes {:.3g} mm along the rail, where grids of solids end before those of waveguides"


def _cells(coordinate: Array, count: int, degree: int) -> tuple[Nodes, Array]:
    """First node of the cells at coordinates (m,) counted in nodes, and their shape functions (m, degree + 1)."""
    if coordinate.min() < 0 or coordinate.max() > count - 1:
        raise OutsideSurface("the wheel touches the rail beyond the part of its surface that carries contact points")
    first = np.minimum((coordinate // degree).astype(np.int64) * degree, count - 1 - degree)
    return first, _shape(coordinate - first, degree)


def _shape(t: Array, degree: int) -> Array:
    """Lagrange shape functions (m, degree + 1) at t in 0 .. degree."""
    if degree == 1:
        return np.stack([1 - t, t], axis=1)
    return np.stack([(t - 1) * (t - 2) / 2, t * (2 - t), t * (t - 1) / 2], axis=1)
