"""State of a wheelset with the motions of its hubs and rails."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import ClassVar, cast

import numpy as np

from wheelrail.contact.kinematics.wheelset_state import WheelsetState
from wheelrail.support.arrays import Array

HUB_MOTIONS, RAIL_MOTIONS = ("x", "y", "z", "roll", "pitch", "yaw"), ("y", "z", "roll")
MOTIONS = (
    *(f"{side}_hub_{name}" for side in ("left", "right") for name in HUB_MOTIONS),
    *(f"{side}_rail_{name}" for side in ("left", "right") for name in RAIL_MOTIONS),
)
SIDES_OF_MOTIONS = slice(0, 6), slice(6, 12), slice(12, 15), slice(15, 18)


def sums_and_differences(*sizes: int) -> Array:
    """Matrix that turns even and odd parts into motions of the left and the right side, as left-hand ones.

    In the mirror y = 0 even parts (l + r) / 2 stay and odd ones (l - r) / 2 change their sign, whatever the rounding,
    while those of the sides change places. The matrix also turns loads of the sides into those on even and odd parts.

    Parameters:
        sizes: numbers of motions of one side, of which even ones are first.
    """
    result, first = np.zeros((2 * sum(sizes), 2 * sum(sizes))), 0
    for size in sizes:
        own = slice(first, first + 2 * size)
        result[own, own] = np.kron([[1.0, 1.0], [1.0, -1.0]], np.eye(size))
        first += 2 * size
    return result


OF_SIDES = sums_and_differences(len(HUB_MOTIONS), len(RAIL_MOTIONS))


def of_parts(compliance: Array) -> Array:
    """Compliance (18, 18) of even and odd parts, of that of the sides; sides that are alike couple no parts."""
    return np.asarray(0.25 * (OF_SIDES @ (compliance @ OF_SIDES)))


def by_parts(tangents: Array) -> Array:
    """Derivatives (..., 27) by the wheelset's coordinates and parts, of derivatives by the motions of sides."""
    rigid = len(WheelsetState.coordinates)
    return np.concatenate([tangents[..., :rigid], tangents[..., rigid:] @ OF_SIDES], axis=-1)


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
