"""Coordinates along a waveguide and in its cross-section."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from wheelrail.support.arrays import Array

if TYPE_CHECKING:
    from wheelrail.contact.elasticity.waveguide.section import WaveguideSection


@dataclass(frozen=True)
class WaveguideCoordinates:
    """Coordinates of m points of a waveguide.

    Parameters:
        along: (m,) m, along the body.
        section: (m, 2) m, in its cross-section.
        angle: (m,) rad, about the axle; None for a prismatic body.
    """

    along: Array
    section: Array
    angle: Array | None

    @classmethod
    def of(cls, body: WaveguideSection, points: Array) -> WaveguideCoordinates:
        """Coordinates of points (m, 3) m in body axes."""
        x, y, z = np.asarray(points, dtype=float).T
        if body.radius is None:
            return cls(x, np.column_stack([y, z]), None)
        angle = np.arctan2(x, -z)
        return cls(angle * body.radius, np.column_stack([y, np.hypot(x, z)]), angle)

    @classmethod
    def over(cls, body: WaveguideSection, stations: Array, spots: Array) -> WaveguideCoordinates:
        """Points (n, 2) m of the section at stations (m,) m along the body, station by station."""
        along = np.repeat(stations, len(spots))
        return cls(along, np.tile(spots, (len(stations), 1)), None if body.radius is None else along / body.radius)

    @property
    def points(self) -> Array:
        """Points (m, 3) m in body axes."""
        y, r = self.section.T
        if self.angle is None:
            return np.column_stack([self.along, y, r])
        return np.column_stack([r * np.sin(self.angle), y, -r * np.cos(self.angle)])

    def rotated(self, tensor: Array) -> Array:
        """Vectors (m, 3) or tensors (m, 3, 3), rotated from axes (along, y, up or outward) to body axes."""
        if self.angle is None:
            return tensor
        T = axes(self.angle)
        if tensor.ndim == 2:
            return np.asarray(np.einsum("mab,mb->ma", T, tensor))
        return np.asarray(T @ tensor @ T.swapaxes(-1, -2))


def axes(angle: Array) -> Array:
    """Components (m, 3, 3) in body axes of the directions (along the circle, y, outward), a column each.

    Parameters:
        angle: (m,) rad, about the axle.
    """
    c, s, zero = np.cos(angle), np.sin(angle), np.zeros_like(angle)
    return np.asarray(np.stack([c, zero, s, zero, zero + 1, zero, s, zero, -c], axis=-1).reshape(-1, 3, 3))
