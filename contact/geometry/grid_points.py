"""Contact points of one pose: the candidates, their local axes, and where the rail meets them, eq. (1)."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Protocol

from wheelrail.contact.kinematics.contact_points import SurfacePoints
from wheelrail.contact.kinematics.frames import Pose
from wheelrail.support.arrays import Array, Nodes


@dataclass(frozen=True)
class Interpolation:
    """Values at m places from values on the nodes of a grid: nodes (m, k) and weights (m, k) that sum to one."""

    nodes: Nodes
    weights: Array


@dataclass(frozen=True)
class GridPoints(SurfacePoints):
    """The n points of the wheel's grid that overlap the rail, and the places upstream that their slip looks at.

    node (n,) on the wheel's grid; upstream (k, n) nodes of the wheel's grid at 0, 1, .. steps upstream; rail the
    interpolation at their projections, row by row of upstream.
    """

    node: Nodes
    upstream: Nodes
    rail: Interpolation


class SurfacePair(Protocol):
    """Surfaces of a pair of bodies."""

    def contact_points(self, pose: Pose, steps: int) -> tuple[GridPoints | None, float]:
        """Candidates with so many steps upstream (None without overlap), and the largest overlap [m] (negative:
        distance).

        Raises OutsideGrid when the overlap leaves the meshed strip.
        """
