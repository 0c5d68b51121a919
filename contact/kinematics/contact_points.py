"""Contact points of one pose, and their sensitivity to the pose of the wheel."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Protocol

from wheelrail.support.arrays import Array


class PointSensitivity(Protocol):
    """Sensitivity of contact points to the wheel's frame, see `wheelrail.contact.kinematics.sensitivity`."""

    @property
    def moves_with_wheel(self) -> bool:
        """Whether the points move with the wheel."""

    def penetration(self, points: SurfacePoints, origin: Array, /) -> Array:
        """Derivative (6, n) of the penetration by translation of the frame and rotation about its origin.

        Parameters:
            points: n points.
            origin: (3,) m of the wheel's frame.
        """


@dataclass(frozen=True)
class SurfacePoints:
    """Contact points of a pose, in the rail frame.

    Parameters:
        point: (n, 3) m.
        axes: (n, 3, 3), rows longitudinal, lateral, normal outward from the wheel.
        area: (n,) m2.
        penetration: (n,) m, undeformed penetration.
        wheel_rotation: (3, 3), from wheel axes to rail axes.
        step: (n,) m, length of the point's cell along the rolling direction.
        wheel_place, rail_place: (n, 2) m, arc length and lateral position on the profiles.
        sensitivity: sensitivity to the wheel's frame; None: the force has no tangent.
    """

    point: Array
    axes: Array
    area: Array
    penetration: Array
    wheel_rotation: Array
    step: Array
    wheel_place: Array
    rail_place: Array
    sensitivity: PointSensitivity | None = field(default=None, kw_only=True)


class OutsideSurface(ValueError):
    """The region of penetration exceeds the part of the surface that carries contact points."""
