"""Contact solution of one side of a scene."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from math import nan
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from wheelrail.contact.kinematics.frames import Pose
    from wheelrail.contact.results.result import ContactResult
    from wheelrail.contact.stress.subsurface import SubsurfaceStress
    from wheelrail.support.arrays import Array


@dataclass(frozen=True)
class StructuralMotion:
    """Motion of a wheel's hub and of its rail, of a wheelset with elastic axle or rails on pads.

    Parameters:
        hub: (6,) m and rad, along and about x, y, z of the wheelset.
        rail: (3,) m and rad, y, z and roll about the foot.
        axle: places (k,) m from the middle of the axle, and its bending stress (k,) Pa there; None: rigid.
    """

    hub: Array
    rail: Array
    axle: tuple[Array, Array] | None = None


@dataclass(frozen=True)
class SideSolution:
    """Contact solution of one side.

    Parameters:
        result: contact result; its status is the reason where no pose was found.
        pose: of the upper body in the frame of the lower one; None if the load cannot be carried.
        z: height of the wheelset above its nominal height, m.
        roll: of the wheelset, rad.
        solves: number of contact solves.
        seconds: their computing time.
        stress: subsurface stress by body.
        structure: motions of hub and rail and stress of the axle, where they are flexible.
    """

    result: ContactResult
    pose: Pose | None = None
    z: float = nan
    roll: float = nan
    solves: int = 0
    seconds: float = 0.0
    stress: Mapping[str, SubsurfaceStress] = field(default_factory=dict)
    structure: StructuralMotion | None = None

    @classmethod
    def failed(cls, reason: str) -> SideSolution:
        """A load that cannot be carried."""
        from wheelrail.contact.results.result import ContactResult

        return cls(ContactResult.failed(reason))
