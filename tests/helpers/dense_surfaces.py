"""Distance and overlap of a wheel and a rail by dense sampling of both undeformed surfaces in space: an oracle for
searches, made of points of the profiles alone.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np
from matplotlib.path import Path
from scipy.optimize import minimize
from scipy.spatial import KDTree

from wheelrail.contact.kinematics.frames import Pose
from wheelrail.meshes.profiles.profile import Profile
from wheelrail.support.arrays import Array

FINE = 1e-5  # m, of the rail's polygon


@dataclass(frozen=True)
class DenseSurfaces:
    """A wheel's profile revolved about its axle, and a rail's profile extruded.

    Parameters:
        wheel, rail: profiles.
        radius: nominal rolling radius, m.
        reach: m along the rolling circle, up to which the wheel is sampled.
    """

    wheel: Profile
    rail: Profile
    radius: float
    reach: float = 0.06

    @cached_property
    def _rail(self) -> tuple[Array, KDTree]:
        points = self.rail.point(np.linspace(*self.rail.s_range, int(np.ptp(self.rail.breaks) / FINE)))
        return points, KDTree(points)

    def places(self, pose: Pose, s: Array, x: Array) -> Array:
        """Points (n, 2) m across the track, of s, x (n,) m on the wheel."""
        y, z = self.wheel.point(np.clip(s, *self.wheel.s_range)).T
        r, angle = self.radius + z, x / self.radius
        own = np.column_stack([r * np.sin(angle), y, -r * np.cos(angle)])
        return np.asarray((own @ pose.rotation.T + pose.origin)[:, 1:])

    def distances(self, points: Array) -> Array:
        """Distances (n,) m of points (n, 2) m from the rail's polygon."""
        corners, tree = self._rail
        nearest = tree.query(points)[1]
        best = np.full(len(points), np.inf)
        for start in (np.maximum(nearest - 1, 0), np.minimum(nearest, len(corners) - 2)):
            a, d = corners[start], corners[start + 1] - corners[start]
            t = np.clip(((points - a) * d).sum(axis=1) / (d * d).sum(axis=1), 0.0, 1.0)
            best = np.minimum(best, np.hypot(*(points - a - t[:, None] * d).T))
        return best

    @cached_property
    def _outline(self) -> Path:
        """A polygon with a corner every 0.2 mm, 0.5 um off at most, which extends downwards from its ends."""
        corners = np.concatenate([self._rail[0][:-1:20], self._rail[0][-1:]])
        below = corners[:, 1].min() - 1.0
        return Path(np.concatenate([corners, [[corners[-1, 0], below], [corners[0, 0], below]]]))

    def _inside(self, points: Array) -> Array:
        """Points (m, 2) inside the rail out of points (n, 2); a box leaves few for the polygon of many corners."""
        low, high = self._rail[0].min(axis=0), self._rail[0].max(axis=0)
        near = points[(points[:, 0] >= low[0]) & (points <= high).all(axis=1)]
        return np.asarray(near[self._outline.contains_points(near)])

    def overlaps(self, pose: Pose) -> tuple[Array, Array]:
        """Lateral positions (n,) m on the wheel's profile and depths m of the overlap at its lowest points; no yaw."""
        s = np.linspace(*self.wheel.s_range, 2000)
        points = self.places(pose, s, np.zeros_like(s))
        inside = self._outline.contains_points(points)
        return self.wheel.point(s[inside])[:, 0], self.distances(points[inside])

    def deepest(self, pose: Pose) -> float:
        """Largest depth m of the overlap; 0 without."""
        s, x = np.linspace(*self.wheel.s_range, 800), np.linspace(-0.15, 0.15, 400)
        points = self.places(pose, *(part.ravel() for part in np.meshgrid(s, x, indexing="ij")))
        return float(self.distances(self._inside(points)).max(initial=0.0))

    def gap(self, pose: Pose) -> float:
        """Smallest distance m of separated surfaces."""
        s = np.linspace(*self.wheel.s_range, int(np.ptp(self.wheel.breaks) / 5e-4))
        x = np.linspace(-self.reach, self.reach, 31)
        grid = np.column_stack([part.ravel() for part in np.meshgrid(s, x, indexing="ij")])
        near = self._rail[1].query(self.places(pose, *grid.T))[0].reshape(len(s), -1).min(axis=1)
        lines = np.flatnonzero((near <= np.append(near[1:], np.inf)) & (near <= np.append(np.inf, near[:-1])))
        lines = lines[near[lines] < near.min() + 2e-4]
        found = []
        for line in lines:
            distances = self.distances(self.places(pose, np.full_like(x, s[line]), x))
            start = np.array([s[line], x[distances.argmin()]]) * 1e3
            simplex = start + np.array([[0.0, 0.0], [0.5, 0.0], [0.0, 4.0]])
            options = {"initial_simplex": simplex, "xatol": 1e-5, "fatol": 1e-11, "maxiter": 200}
            best = minimize(
                lambda at: float(self.distances(self.places(pose, at[:1] * 1e-3, at[1:] * 1e-3))[0]),
                start,
                method="Nelder-Mead",
                options=options,
            )
            found.append(best.fun)
        return float(min(found))
