"""Where force elements join the bodies: how far they are strained in a position, and what their forces do there."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from wheelrail.support.arrays import Array


class Strain(NamedTuple):
    """deflection, velocity (..., n, 2) of elements in their own axes; cosine, sine (..., n) of how far these lean; arms
    (..., 2, n) m from the centres of both bodies to where the force acts.
    """

    deflection: Array
    velocity: Array
    cosine: Array
    sine: Array
    arm_y: Array
    arm_z: Array


@dataclass(frozen=True)
class Attachments:
    """Points of n elements in the two bodies that they join, which coincide in the nominal position; rolls are finite.

    Forces act along axes that turn with the lower body (turn = 0), the upper (1) or in between, at a point that divides
    the distance of both in the same ratio: so an element has a potential, and force and moment on its two bodies cancel
    in every position. Elements: four of the left side, four of the right side, one in the middle.

    ends (2, n) indices of upper and lower body; across, above (2, n) position of the points in their bodies, m; turn
    (n,).
    """

    ends: NDArray[np.int64]
    across: Array
    above: Array
    turn: Array

    @cached_property
    def reach(self) -> Array:
        """(2, n): from the element's end on each body to where its force acts, as a share of the gap."""
        return np.stack([-self.turn, 1.0 - self.turn])

    @cached_property
    def incidence(self) -> tuple[Array, Array]:
        """Two of (3, 5): which body is the upper, less which is the lower one, of a pair of elements or the stop."""
        pairs = self.ends[:, [0, 1, 2, 3, 8]]
        upper, lower = (np.arange(3)[:, None] == pairs[:, None, :]).astype(float)
        return upper, -lower

    def strain(self, position: Array, rate: Array) -> Strain:
        """At position (..., 3, 3), y m, z m from the nominal height, roll rad of each body, and its rate."""
        where, moving = position[..., self.ends, :], rate[..., self.ends, :]
        # NumPy's sine of an array with gaps depends, in the last bit, on where in memory it lies.
        y, z, roll = where[..., 0], where[..., 1], np.ascontiguousarray(where[..., 2])
        vy, vz, spin = moving[..., 0], moving[..., 1], moving[..., 2]
        c, s = np.cos(roll), np.sin(roll)
        arm_y, arm_z = self.across * c - self.above * s, self.across * s + self.above * c
        gap_y, gap_z = _upper_minus_lower(y + arm_y), _upper_minus_lower(z + arm_z - self.above)
        slide_y, slide_z = _upper_minus_lower(vy - spin * arm_z), _upper_minus_lower(vz + spin * arm_y)

        upper = self.turn
        lean = upper * roll[..., 0, :] + (1.0 - upper) * roll[..., 1, :]
        lean_rate = upper * spin[..., 0, :] + (1.0 - upper) * spin[..., 1, :]
        c, s = np.cos(lean), np.sin(lean)
        slide_y, slide_z = slide_y + lean_rate * gap_z, slide_z - lean_rate * gap_y
        deflection = np.stack([c * gap_y + s * gap_z, c * gap_z - s * gap_y], axis=-1)
        velocity = np.stack([c * slide_y + s * slide_z, c * slide_z - s * slide_y], axis=-1)
        arm_y += self.reach * gap_y[..., None, :]
        arm_z += self.reach * gap_z[..., None, :]
        return Strain(deflection, velocity, c, s, arm_y, arm_z)

    def on_bodies(self, force: Array, strain: Strain) -> Array:
        """Lateral and vertical force N, roll moment N m about the centre of each body (..., 3, 3) under forces of the
        elements (..., n, 2) N in their own axes, on the upper body.
        """
        c, s = strain.cosine, strain.sine
        fy = c * force[..., 0] - s * force[..., 1]
        fz = s * force[..., 0] + c * force[..., 1]
        total = np.zeros((*force.shape[:-2], 3, 3))
        for i, incidence in enumerate(self.incidence):
            each = np.stack([fy, fz, strain.arm_y[..., i, :] * fz - strain.arm_z[..., i, :] * fy], axis=-1)
            # Left and right first: the mirror image of a state then has the mirrored forces to the last bit.
            total += incidence @ np.concatenate([each[..., :4, :] + each[..., 4:8, :], each[..., 8:, :]], axis=-2)
        return total


def _upper_minus_lower(pair: Array) -> Array:
    return np.asarray(pair[..., 0, :] - pair[..., 1, :])
