"""Attachment points of force elements: deflections, velocities, and resultants on the bodies."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from wheelrail.support.arrays import Array


class Strain(NamedTuple):
    """Kinematics of n elements.

    Parameters:
        deflection, velocity: (..., n, 2) m and m/s, lateral and vertical in the axes of the elements.
        cosine, sine: (..., n) of the roll angle of these axes.
        arm_y, arm_z: (..., 2, n) m, lever arms from the centres of the upper and lower body to the point of the force.
    """

    deflection: Array
    velocity: Array
    cosine: Array
    sine: Array
    arm_y: Array
    arm_z: Array


@dataclass(frozen=True)
class Attachments:
    """Attachment points of n elements, for finite rolls; those of an element coincide in the nominal position.

    Parameters:
        ends: (2, n) indices of upper and lower body.
        across, above: (2, n) m, lateral and vertical position of the points in their bodies.
        turn: (n,) fraction of the upper body's roll in the axes of the element; 1 - turn is the lower body's.

    The force acts at a point that divides the distance of both attachment points in the same ratio: an element then has
    a potential, and its forces and moments on the two bodies are in equilibrium in every position. Elements: four of
    the left side, four of the right side, one in the middle.
    """

    ends: NDArray[np.int64]
    across: Array
    above: Array
    turn: Array

    @cached_property
    def lever_fractions(self) -> Array:
        """(2, n): position of the force relative to each attachment point, as a fraction of their distance."""
        return np.stack([-self.turn, 1.0 - self.turn])

    @cached_property
    def incidence(self) -> tuple[Array, Array]:
        """Incidence (3, 5) of bodies and pairs of elements (last: bumpstop): upper bodies 1, and lower bodies -1."""
        pairs = self.ends[:, [0, 1, 2, 3, 8]]
        upper, lower = (np.arange(3)[:, None] == pairs[:, None, :]).astype(float)
        return upper, -lower

    def strain(self, position: Array, rate: Array) -> Strain:
        """Kinematics of the elements.

        Parameters:
            position: (..., 3, 3) y m, z m from the nominal height, roll rad of each body.
            rate: (..., 3, 3) its time derivative.
        """
        positions, rates = position[..., self.ends, :], rate[..., self.ends, :]
        # The last bit of NumPy's sine of a strided array depends on its memory layout.
        y, z, roll = positions[..., 0], positions[..., 1], np.ascontiguousarray(positions[..., 2])
        vy, vz, spin = rates[..., 0], rates[..., 1], rates[..., 2]
        c, s = np.cos(roll), np.sin(roll)
        arm_y, arm_z = self.across * c - self.above * s, self.across * s + self.above * c
        gap_y, gap_z = _upper_minus_lower(y + arm_y), _upper_minus_lower(z + arm_z - self.above)
        velocity_y, velocity_z = _upper_minus_lower(vy - spin * arm_z), _upper_minus_lower(vz + spin * arm_y)

        upper = self.turn
        axis_roll = upper * roll[..., 0, :] + (1.0 - upper) * roll[..., 1, :]
        axis_roll_rate = upper * spin[..., 0, :] + (1.0 - upper) * spin[..., 1, :]
        c, s = np.cos(axis_roll), np.sin(axis_roll)
        velocity_y, velocity_z = velocity_y + axis_roll_rate * gap_z, velocity_z - axis_roll_rate * gap_y
        deflection = np.stack([c * gap_y + s * gap_z, c * gap_z - s * gap_y], axis=-1)
        velocity = np.stack([c * velocity_y + s * velocity_z, c * velocity_z - s * velocity_y], axis=-1)
        arm_y += self.lever_fractions * gap_y[..., None, :]
        arm_z += self.lever_fractions * gap_z[..., None, :]
        return Strain(deflection, velocity, c, s, arm_y, arm_z)

    def on_bodies(self, force: Array, strain: Strain) -> Array:
        """Resultants (..., 3, 3) on the bodies: lateral and vertical force N, roll moment N m about the centre.

        Parameters:
            force: (..., n, 2) N, of the elements on the upper body, in their own axes.
            strain: kinematics of the elements.
        """
        c, s = strain.cosine, strain.sine
        fy = c * force[..., 0] - s * force[..., 1]
        fz = s * force[..., 0] + c * force[..., 1]
        total = np.zeros((*force.shape[:-2], 3, 3))
        for i, incidence in enumerate(self.incidence):
            each = np.stack([fy, fz, strain.arm_y[..., i, :] * fz - strain.arm_z[..., i, :] * fy], axis=-1)
            # Sum left and right first: mirrored states then have mirrored forces, bit for bit.
            total += incidence @ np.concatenate([each[..., :4, :] + each[..., 4:8, :], each[..., 8:, :]], axis=-2)
        return total


def _upper_minus_lower(pair: Array) -> Array:
    return np.asarray(pair[..., 0, :] - pair[..., 1, :])
