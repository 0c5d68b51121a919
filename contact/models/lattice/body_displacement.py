"""Displacement of each body in a contact on a lattice, for the material that touches.

The relative displacement of the solution is the sum of that of half-spaces, which divides by their compliance, and of
the deviations of finite bodies, which are evaluated body by body. The contraction of half-spaces by pressure is left
out: it is opposite on both sides of a patch, and 2 um by another patch of 40 kN at 10 mm. So is their displacement
along the normal: by reciprocity a half-space under pressure is not inclined in the mean.
"""

from __future__ import annotations

import numpy as np

from wheelrail.contact.models.lattice.influence.operator import antiderivatives
from wheelrail.contact.models.lattice.influence.pair_tables import half_space_scale
from wheelrail.contact.models.lattice.system.equations import force_jumps, strip_grid
from wheelrail.contact.models.lattice.system.problem import LatticeProblem
from wheelrail.contact.models.lattice.system.state import LatticeState
from wheelrail.contact.results.touching_material import BodyDisplacements
from wheelrail.support.arrays import Array

PARTS = 3  # of a strip, over which deviations from half-spaces vary little


def body_displacements(
    problem: LatticeProblem, state: LatticeState, relative: Array, weight: Array
) -> BodyDisplacements:
    """Displacements of both bodies in a solution.

    Parameters:
        problem: equations.
        state: their solution.
        relative: (S, M, 3) m, displacement of the upper relative to the lower body, means over the cells.
        weight: (S, M) N, loads of the cells.
    """
    data = problem.of(state.strips)
    grid = strip_grid(state.values, data.places, problem.basis)
    jumps = force_jumps(state.values, data.places, problem.basis, problem.rolls)
    M = weight.shape[1]
    bounds = np.linspace(0, M, PARTS + 1).round().astype(int)
    ends, parts = np.ascontiguousarray(grid.x[:, bounds]), np.add.reduceat(weight, bounds[:-1], axis=1)
    forces = np.cumsum(jumps, axis=1)[:, :-1] * np.diff(grid.x[:, : M + 1])[..., None]
    loads = np.add.reduceat(forces, bounds[:-1], axis=1) / np.diff(ends)[..., None]
    jumps, deviation = np.diff(loads, axis=1, prepend=0.0, append=0.0), np.zeros((2, len(weight), 3))
    for body in (0, 1):
        tables = problem.tables.deviation_of(body, state.strips, problem.lines.foot, problem.reach)
        if tables is not None:
            _, V = antiderivatives(tables, grid._replace(x=ends), jumps)
            deviation[body] = _means(np.diff(V, axis=1) / np.diff(ends)[..., None], parts)
    upper, lower = problem.tables.operators.upper, problem.tables.operators.lower
    compliance = np.array([(1 + body.nu) * half_space_scale(body) for body in (upper, lower)])
    half_spaces = _means(relative, weight) - deviation.sum(axis=0)
    wheel, minus_rail = deviation + (compliance / compliance.sum())[:, None, None] * half_spaces
    return BodyDisplacements(wheel[:, 1], -minus_rail[:, 1], deviation[0, :, 2])


def _means(values: Array, weight: Array) -> Array:
    """Means (S, 3) of values (S, M, 3) by weights (S, M); zero where these are."""
    total = weight.sum(axis=1, keepdims=True)
    return np.asarray(np.einsum("sm,smk->sk", weight / np.where(total > 0, total, 1.0), values))
