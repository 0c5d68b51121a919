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
    total = weight.sum(axis=1, keepdims=True)
    means = weight / np.where(total > 0, total, 1.0)
    feet = problem.lines.foot if problem.tables.moves else None
    deviation = np.zeros((2, *relative.shape))
    for body in (0, 1):
        tables = problem.tables.deviation_of(body, state.strips, feet, problem.reach)
        if tables is not None:
            _, V = antiderivatives(tables, grid, jumps)
            deviation[body] = (np.diff(V, axis=1) / np.diff(grid.x)[..., None])[:, : weight.shape[1]]
    upper, lower = problem.tables.operators.upper, problem.tables.operators.lower
    compliance = np.array([(1 + body.nu) * half_space_scale(body) for body in (upper, lower)])
    half_spaces = relative - deviation.sum(axis=0)
    wheel, minus_rail = deviation + (compliance / compliance.sum())[:, None, None, None] * half_spaces
    return BodyDisplacements(
        (means * wheel[..., 1]).sum(axis=1),
        -(means * minus_rail[..., 1]).sum(axis=1),
        (means * deviation[0, ..., 2]).sum(axis=1),
    )
