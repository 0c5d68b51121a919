"""A contact on a lattice for libraries without Python."""

from __future__ import annotations

import numpy as np

from wheelrail.bindings._contact import LEVELS, BodyData, DeviationWeights, FamilyBases, LatticeData, LevelData
from wheelrail.contact.geometry.strip_lattice import cells_along
from wheelrail.contact.geometry.strip_surfaces import ProfileStrips
from wheelrail.contact.models.lattice.influence.basis import Tangential, equal_cells, strip_basis
from wheelrail.contact.models.lattice.influence.pair_grid import RULE
from wheelrail.contact.models.lattice.model import FINER, PROBES, START_CELLS, LatticeContact, margin, rail_outline

NONE = np.zeros(0)
HALF_SPACE = BodyData(DeviationWeights(NONE, NONE, NONE[:, None], NONE[:, None]), NONE)


def lattice_data(model: LatticeContact) -> LatticeData:
    """Data of a contact on profiles for the native library."""
    operators, laws = model.operators, model.laws
    assert isinstance(operators.surfaces, ProfileStrips)
    levels = [operators.strips(model.sides(level)) for level in range(LEVELS)]
    return LatticeData(
        model.surface,
        operators.surfaces.rigid.lines,
        rail_outline(operators.surfaces),
        tuple(LevelData(strips, slender) for strips, slender, _ in levels),
        levels[0][2],
        RULE,
        operators.moves,
        tuple(HALF_SPACE if body is None else body.data() for body in operators.corrections),
        equal_cells(PROBES[0]),
        equal_cells(PROBES[1]),
        (_bases(model, "rolling"), _bases(model, "none")),
        len(model.finer_cells),
        model.resolution.strips,
        tuple(margin(level) for level in range(LEVELS)),
        tuple(model.apart(level) for level in range(LEVELS)),
        model.tolerance,
        laws.regularisation,
        laws.pointwise_friction.parameters if laws.frictional else np.zeros(0),
    )


def _bases(model: LatticeContact, tangential: Tangential) -> FamilyBases:
    surfaces, cells = model.operators.surfaces, model.resolution.cells
    own, *finer = (strip_basis(cells_along(surfaces, n * cells), tangential) for n in (1, *model.finer_cells))
    finer += [own] * (len(FINER) - len(finer))
    return FamilyBases(own, tuple(finer), tuple(equal_cells(n, tangential) for n in START_CELLS))
