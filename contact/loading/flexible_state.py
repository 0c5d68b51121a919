"""State of a wheelset with the motions of its hubs and rails."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import ClassVar, cast

from wheelrail.contact.kinematics.wheelset_state import WheelsetState

HUB_MOTIONS, RAIL_MOTIONS = ("x", "y", "z", "roll", "pitch", "yaw"), ("y", "z", "roll")
MOTIONS = (
    *(f"{side}_hub_{name}" for side in ("left", "right") for name in HUB_MOTIONS),
    *(f"{side}_rail_{name}" for side in ("left", "right") for name in RAIL_MOTIONS),
)
SIDES_OF_MOTIONS = slice(0, 6), slice(6, 12), slice(12, 15), slice(15, 18)


@dataclass(frozen=True)
class FlexibleState(WheelsetState):
    """Position and velocity of a wheelset, and the motions of its hubs and rails.

    Parameters:
        motions: (18,) m and rad of the left and the right hub, x, y, z and rotation vector in the axes of the wheelset,
            then y, z and roll of the left and the right rail about its foot; those of the right side mirrored.
    """

    coordinates: ClassVar[tuple[str, ...]] = (*WheelsetState.coordinates, *MOTIONS)

    motions: tuple[float, ...] = (0.0,) * len(MOTIONS)

    def mirrored(self) -> FlexibleState:
        """The state in the mirror y = 0."""
        left, right, left_rail, right_rail = (self.motions[at] for at in SIDES_OF_MOTIONS)
        return replace(cast(FlexibleState, super().mirrored()), motions=(*right, *left, *right_rail, *left_rail))
