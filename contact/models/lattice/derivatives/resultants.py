"""Compiled: derivatives of the resultants by the unknowns, and sums and products of vectors."""

from __future__ import annotations

import numpy as np

from wheelrail.contact.geometry.wheel_surface import Place
from wheelrail.contact.models.lattice.system.equations import EquationData, cell_frames, strip_grid
from wheelrail.contact.models.lattice.system.surface import SurfaceFrames
from wheelrail.support.arrays import Array
from wheelrail.support.compiled import borrowing, compiled

CHANGES = 12  # of pose and motion: those of `wheelrail.contact.kinematics.sensitivity`


@borrowing
def vector(a: Array) -> Place:
    """Components of a vector (3,)."""
    return a[0], a[1], a[2]


@borrowing
def away(a: Place, b: Place) -> Place:
    """Difference a - b."""
    return a[0] - b[0], a[1] - b[1], a[2] - b[2]


@borrowing
def cross(a: Place, b: Place) -> Place:
    """Cross product."""
    return a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]


@borrowing
def dot(a: Place, b: Place) -> float:
    """Scalar product."""
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]


@compiled
def resultant_slopes(values: Array, data: EquationData) -> tuple[Array, Array]:
    """Force N and moment N m about the origin (6,) on the upper body, and their derivative (6, S block) by the
    unknowns.
    """
    places, basis = data.places, data.basis
    at = cell_frames(values, places, basis, data.surface, data.motion)
    length = strip_grid(values, places, basis).length
    total, slopes = np.zeros(6), np.zeros((6, values.size))
    _store_resultants(values, data, at, length, total, slopes)
    return total, slopes


@borrowing
def _store_resultants(
    values: Array, data: EquationData, at: SurfaceFrames, length: Array, total: Array, slopes: Array
) -> None:
    """Fill `resultant_slopes`, which are zero, from cells and lengths (S,) m."""
    basis, (S, block), rolls, turn = data.basis, values.shape, data.motion.speed > 0.0, vector(at.turn)
    M, modes = len(basis.marks) - 1, basis.mean.shape[1]
    first = 2 * M if rolls else 0
    for i in range(S):
        column = i * block
        low, high = column + block - 2, column + block - 1
        over = 1.0 / (values[i, block - 1] - values[i, block - 2])
        for r in range(M):
            cell, mark = i * M + r, basis.marks[r + 1] - basis.marks[r]
            middle = 0.5 * (basis.marks[r] + basis.marks[r + 1])
            area, place = length[i] * mark * data.places.width[i], vector(at.point[cell])
            along, across, normal = vector(at.axes[cell, 0]), vector(at.axes[cell, 1]), vector(at.axes[cell, 2])
            along_arm, across_arm, normal_arm = cross(place, along), cross(place, across), cross(place, normal)
            p, x, y = 0.0, 0.0, 0.0
            for m in range(modes):
                p -= area * values[i, first + m] * basis.mean[r, m]
            if rolls:
                x, y = area * values[i, r], area * values[i, M + r]
            force = (
                x * along[0] + y * across[0] + p * normal[0],
                x * along[1] + y * across[1] + p * normal[1],
                x * along[2] + y * across[2] + p * normal[2],
            )
            moment, turned, moved = cross(place, force), cross(turn, force), cross(vector(at.forward[cell]), force)
            turned_arm = cross(place, turned)
            for c in range(3):
                if rolls:
                    slopes[c, column + r], slopes[3 + c, column + r] = area * along[c], area * along_arm[c]
                    slopes[c, column + M + r] = area * across[c]
                    slopes[3 + c, column + M + r] = area * across_arm[c]
                for m in range(modes):
                    slopes[c, column + first + m] -= basis.mean[r, m] * area * normal[c]
                    slopes[3 + c, column + first + m] -= basis.mean[r, m] * area * normal_arm[c]
                # the cell moves along x: its axes turn, and its point moves forward
                by_force, by_moment = turned[c], turned_arm[c] + moved[c]
                slopes[c, low] += (1.0 - middle) * by_force - over * force[c]
                slopes[c, high] += middle * by_force + over * force[c]
                slopes[3 + c, low] += (1.0 - middle) * by_moment - over * moment[c]
                slopes[3 + c, high] += middle * by_moment + over * moment[c]
                total[c] += force[c]
                total[3 + c] += moment[c]
