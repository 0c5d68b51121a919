"""Candidate contact points of one pose on a grid, their local axes and projections on the rail, eq. (1)."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Protocol

from wheelrail.contact.kinematics.contact_points import SurfacePoints
from wheelrail.contact.kinematics.frames import Pose
from wheelrail.support.arrays import Array, Nodes


@dataclass(frozen=True)
class Interpolation:
    """Interpolation from grid nodes to m points: nodes (m, k) and weights (m, k) that sum to one."""

    nodes: Nodes
    weights: Array


@dataclass(frozen=True)
class GridPoints(SurfacePoints):
    """The n points of the wheel's grid that penetrate the rail, and the upstream points for their slip.

    Parameters:
        node: (n,) on the wheel's grid.
        upstream: (k, n), nodes of the wheel's grid 0, 1, .. steps upstream.
        rail: interpolation on the rail's grid at their projections, row by row of upstream.
        circle_curvature: (2, n) 1/m, of the wheel's circles: rotation of the longitudinal axis towards the lateral one,
            and of the outward normal towards the longitudinal axis, per length.
        slope: (n,) of the penetration along the rolling direction.
    """

    node: Nodes
    upstream: Nodes
    rail: Interpolation
    circle_curvature: Array
    slope: Array


class SurfacePair(Protocol):
    """Undeformed surfaces of a pair of bodies."""

    def contact_points(self, pose: Pose, steps: int) -> tuple[GridPoints | None, float]:
        """Candidate points (None without penetration), and the largest penetration m (negative: distance).

        Parameters:
            pose: of the wheel's frame in the rail's frame.
            steps: number of upstream points for the slip.

        Raises OutsideSurface when the region of penetration exceeds the meshed strip.
        """
