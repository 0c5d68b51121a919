"""Rigid motions of a rail's section."""

from __future__ import annotations

import numpy as np

from wheelrail.support.arrays import Array


def section_modes(points: Array) -> Array:
    """Displacements (k, 2, 3) in y and z of points (k, 2) m of a section by its motion (y, z, roll) at the origin."""
    y, z = points.T
    zero, unit = np.zeros_like(y), np.ones_like(y)
    return np.stack([np.stack([unit, zero, -z], axis=1), np.stack([zero, unit, y], axis=1)], axis=1)
