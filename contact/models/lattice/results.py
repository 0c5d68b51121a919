"""Result of a contact on a lattice in the frame of the rail, on the cells of its strips."""

from __future__ import annotations

from functools import partial

import numpy as np

from wheelrail.bindings._contact import patch_rows, resultants, strip_cells
from wheelrail.contact.kinematics.contact_points import OutsideSurface
from wheelrail.contact.models.lattice.derivatives.tangent import LatticeTangent
from wheelrail.contact.models.lattice.influence.strip_operators import TOO_LONG
from wheelrail.contact.models.lattice.solver.newton import LatticeSolution
from wheelrail.contact.models.lattice.system.problem import LatticeProblem
from wheelrail.contact.models.lattice.system.state import LatticeState
from wheelrail.contact.results.patch_sums import patches_of
from wheelrail.contact.results.result import ContactResult, Fields, LazyFields, LazyPatches, Patch, Statistics
from wheelrail.contact.solvers.tangent import ContactTangent


def contact_result(problem: LatticeProblem, solution: LatticeSolution, statistics: Statistics) -> ContactResult:
    """Forces, patches, fields and tangent of a solution; all but the forces are computed when first needed."""
    state = solution.state
    load = resultants(state.values, problem.of(state.strips))
    return ContactResult(
        force=load[:3],
        moment=load[3:],
        patches=LazyPatches(partial(_patches, problem, state)),
        fields=LazyFields(partial(_fields, problem, state)),
        approach=problem.approach,
        status="converged",
        statistics=statistics,
        force_tangent=ContactTangent(LatticeTangent(problem, solution)),
        warm_start=solution,
    )


def _patches(problem: LatticeProblem, state: LatticeState) -> tuple[Patch, ...]:
    """Patches of a state, by decreasing load. Raises OutsideSurface."""
    bodies, modulus = problem.bodies(state.strips), problem.tables.modulus
    patches = patch_rows(state.values, problem.of(state.strips), bodies, modulus)
    if not patches.inside:
        raise OutsideSurface(TOO_LONG)
    return patches_of(patches.rows)


def _fields(problem: LatticeProblem, state: LatticeState) -> Fields:
    """Fields at the cells of a state. Raises OutsideSurface."""
    cells = strip_cells(state.values, problem.of(state.strips))
    if not cells.inside:
        raise OutsideSurface(TOO_LONG)
    points = cells.points
    return Fields(
        node=np.arange(len(points.area)),
        patch=np.repeat(cells.patch, problem.cells),
        point=points.point,
        axes=points.axes,
        area=points.area,
        step=points.step,
        penetration=cells.penetration,
        pressure=points.pressure,
        traction=points.traction,
        slip=cells.slip,
        displacement=cells.displacement,
    )
