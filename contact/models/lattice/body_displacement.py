"""Compiled: displacement of each body in a contact on a lattice, for the material that touches.

The relative displacement of the solution is the sum of that of half-spaces, which divides by their compliance, and of
the deviations of finite bodies, which are evaluated body by body. The contraction of half-spaces by pressure is left
out: it is opposite on both sides of a patch, and 2 um by another patch of 40 kN at 10 mm. So is their displacement
along the normal: by reciprocity a half-space under pressure is not inclined in the mean.
"""

from __future__ import annotations

import numpy as np

from wheelrail.contact.models.lattice.influence.operator import StripGrid, antiderivatives
from wheelrail.contact.models.lattice.influence.pair_tables import BodyTables, PairTables
from wheelrail.contact.models.lattice.system.cells import StripCells
from wheelrail.contact.models.lattice.system.equations import EquationData, force_jumps, strip_grid
from wheelrail.contact.results.touching_material import BodyDisplacements
from wheelrail.support.arrays import Array
from wheelrail.support.compiled import borrowing, compiled

PARTS = 3  # of a strip, over which deviations from half-spaces vary little


@compiled
def body_displacements(values: Array, data: EquationData, cells: StripCells, bodies: BodyTables) -> BodyDisplacements:
    """Displacements of both bodies on the strips of a solution.

    Parameters:
        values: (S, block), its state.
        data: of the equations.
        cells: of the state.
        bodies: tables of each body.
    """
    S, M = len(values), len(data.basis.marks) - 1
    grid = strip_grid(values, data.places, data.basis)
    forces = force_jumps(values, data.places, data.basis, data.motion.speed > 0.0)
    weight, ends = np.zeros((S, PARTS)), np.empty((S, PARTS + 1))
    jumps, relative = np.zeros((S, PARTS + 1, 3)), np.zeros((S, 3))
    for i in range(S):
        ends[i, 0] = grid.x[i, 0]
        for part in range(PARTS):
            first, last = _mark(part, M), _mark(part + 1, M)
            ends[i, part + 1] = grid.x[i, last]
            for r in range(first, last):
                load = cells.points.pressure[i * M + r] * cells.points.area[i * M + r]
                weight[i, part] += load
                for k in range(3):
                    relative[i, k] += load * cells.displacement[i * M + r, k]
        _store_mean_jumps(forces[i], grid.x[i], jumps[i])
    coarse = StripGrid(ends, grid.length, grid.width, grid.stretch, grid.strip, grid.middle)
    upper, lower = _means(bodies.upper, coarse, jumps, weight), _means(bodies.lower, coarse, jumps, weight)
    wheel, rail, wheel_normal = np.empty(S), np.empty(S), np.empty(S)
    for i in range(S):
        total = weight[i].sum()
        across = relative[i, 1] / total if total > 0.0 else 0.0
        half_spaces = across - upper[i, 1] - lower[i, 1]
        wheel[i], rail[i] = upper[i, 1] + bodies.share[0] * half_spaces, -lower[i, 1] - bodies.share[1] * half_spaces
        wheel_normal[i] = upper[i, 2]
    return BodyDisplacements(wheel, rail, wheel_normal)


@borrowing
def _mark(part: int, M: int) -> int:
    """Cell boundary at which a part of a strip of M cells begins."""
    return (2 * part * M + PARTS) // (2 * PARTS)


@borrowing
def _store_mean_jumps(forces: Array, x: Array, jumps: Array) -> None:
    """Fill the jumps (PARTS + 1, 3) N/m, which are zero, of the mean forces per length on the parts of a strip, from
    jumps (M + 1, 3) N/m at boundaries x m of its cells.
    """
    M = len(forces) - 1
    for k in range(3):
        at = 0.0
        for part in range(PARTS):
            first, last, force = _mark(part, M), _mark(part + 1, M), 0.0
            for r in range(first, last):
                at += forces[r, k]
                force += at * (x[r + 1] - x[r])
            mean = force / (x[last] - x[first])
            jumps[part, k] += mean
            jumps[part + 1, k] -= mean


@compiled
def _means(tables: PairTables, grid: StripGrid, jumps: Array, weight: Array) -> Array:
    """Means (S, 3) m, by weights (S, PARTS), of the displacement by a body's tables; zero for a half-space."""
    S = len(weight)
    means = np.zeros((S, 3))
    if len(tables.smooth.values) == 0:
        return means
    _, V = antiderivatives(tables, grid, jumps)
    for i in range(S):
        total = weight[i].sum()
        for part in range(PARTS):
            share = weight[i, part] / (total * (grid.x[i, part + 1] - grid.x[i, part])) if total > 0.0 else 0.0
            for k in range(3):
                means[i, k] += share * (V[i, part + 1, k] - V[i, part, k])
    return means
