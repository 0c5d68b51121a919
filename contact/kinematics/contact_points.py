"""Contact points of one pose, and how they move with the wheel's frame."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Protocol

from wheelrail.support.arrays import Array


class PointSensitivity(Protocol):
    """How points follow the wheel's frame, see `wheelrail.contact.kinematics.sensitivity`: riding on it or at rest."""

    @property
    def rides(self) -> bool: ...

    def overlap(self, places: SurfacePoints, origin: Array, /) -> Array:
        """Change (6, n) of the overlap by translation of the frame and by rotation about its origin (3,) m."""


@dataclass(frozen=True)
class SurfacePoints:
    """Where n contact points of a pose are.

    point (n, 3) m and axes (n, 3, 3) in the rail frame, rows longitudinal, lateral, normal outward from the wheel; area
    (n,) m2; overlap (n,) m, undeformed; wheel_rotation (3, 3) from wheel axes to rail axes; step (n,) m, the length
    along the rolling direction that a point stands for; wheel_place and rail_place (n, 2) m, arc length and lateral
    position on the profiles; follows, how they follow the wheel's frame (None: not known, and no tangent of the force).
    """

    point: Array
    axes: Array
    area: Array
    overlap: Array
    wheel_rotation: Array
    step: Array
    wheel_place: Array
    rail_place: Array
    follows: PointSensitivity | None = field(default=None, kw_only=True)


class OutsideSurface(ValueError):
    """The bodies overlap where no contact points were meshed."""
