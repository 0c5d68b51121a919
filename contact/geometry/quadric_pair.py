"""Hertz pairs: two quadratic surfaces on large blocks; the gap follows from the radii."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from wheelrail.contact.geometry.grid_points import GridPoints, Interpolation
from wheelrail.contact.geometry.surface_grid import ContactGrid
from wheelrail.contact.kinematics.contact_points import OutsideSurface
from wheelrail.contact.kinematics.frames import Pose
from wheelrail.contact.kinematics.sensitivity import QuadricSensitivity
from wheelrail.support.arrays import Array

UPSIDE_DOWN = np.diag([1.0, 1.0, -1.0])  # the upper block is the lower one's reflection


@dataclass(frozen=True)
class QuadricPair:
    """Two quadratic surfaces on one flat grid of contact points.

    Parameters:
        grid: contact grid of both blocks.
        upper, lower: principal radii in x and y, m; inf is straight, negative is hollow.

    The pose's origin is the position of the upper body's apex relative to the lower one's: (x, y, -approach).
    """

    grid: ContactGrid
    upper: tuple[float, float]
    lower: tuple[float, float]

    def contact_points(self, pose: Pose, steps: int) -> tuple[GridPoints | None, float]:
        """Candidates by the undeformed penetration -(z_upper - z_lower) of paraboloids; see `SurfacePair`."""
        position = self.grid.position.reshape(-1, 3)[:, :2]
        penetration = (
            -pose.origin[2]
            - (position - pose.origin[:2]) ** 2 @ curvature(self.upper)
            - position**2 @ curvature(self.lower)
        )
        along = position[:, 0]
        slope = -2.0 * ((along - pose.origin[0]) * curvature(self.upper)[0] + along * curvature(self.lower)[0])
        inside = penetration > 0
        if not inside.any():
            return None, min(vertical_approach(self.upper, self.lower, pose), 0.0)
        mask = inside.reshape(self.grid.shape)
        if mask[0].any() or mask[:, 0].any() or mask[:, -1].any() or mask[-1 - steps * self.grid.stride :].any():
            raise OutsideSurface(
                "the region of penetration exceeds the meshed strip: the approach is larger than the mesh allows"
            )
        node = np.flatnonzero(inside & (self.grid.weight.ravel() > 0))
        n, (_, ns) = len(node), self.grid.shape
        upstream = node + np.arange(steps + 1)[:, None] * self.grid.stride * ns
        point = np.column_stack([position[node], np.zeros(n)])
        axes = np.broadcast_to(np.diag([1.0, 1.0, -1.0]), (n, 3, 3))
        spacing = self.grid.position[self.grid.stride, 0, 0] - self.grid.position[0, 0, 0]
        across = np.repeat(position[node, 1:], 2, axis=1)
        return (
            GridPoints(
                node=node,
                point=point,
                axes=axes,
                area=self.grid.weight.ravel()[node],
                penetration=penetration[node],
                wheel_rotation=UPSIDE_DOWN,
                upstream=upstream,
                rail=Interpolation(upstream.reshape(-1, 1), np.ones((upstream.size, 1))),
                circle_curvature=np.zeros((2, n)),
                slope=slope[node],
                step=np.full(n, spacing),
                wheel_place=across,
                rail_place=across,
                sensitivity=QuadricSensitivity(self.upper),
            ),
            float(-pose.origin[2]),
        )


def curvature(radii: tuple[float, float]) -> Array:
    """Coefficients 1 / (2 R) of the parabola, 1/m."""
    return 0.5 / np.asarray(radii, dtype=float)


def vertical_approach(upper: tuple[float, float], lower: tuple[float, float], pose: Pose) -> float:
    """Largest penetration m along z; negative is the gap.

    Parameters:
        upper, lower: principal radii in x and y, m, as of a `QuadricPair`.
        pose: of the upper body's apex.
    """
    above, below = curvature(upper), curvature(lower)
    return float(-pose.origin[2] - (pose.origin[:2] ** 2 * above * below / (above + below)).sum())
