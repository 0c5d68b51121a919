"""Start from the solution without friction, where Newton's method does not converge from the first cells."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from wheelrail.contact.laws.parameters import ContactLaws
from wheelrail.contact.models.lattice.cold_start import OPTIONS, cold_start
from wheelrail.contact.models.lattice.equations import linearise
from wheelrail.contact.models.lattice.influence.basis import strip_basis
from wheelrail.contact.models.lattice.newton import LatticeNewton
from wheelrail.contact.models.lattice.problem import LatticeProblem
from wheelrail.contact.models.lattice.state import LatticeState
from wheelrail.contact.solvers.active_set import PrescribedPressure
from wheelrail.contact.solvers.options import IterationCount
from wheelrail.contact.solvers.semismooth_newton import tangential_contact
from wheelrail.contact.solvers.tangential import FrictionProblem

TOLERANCE = 1e-3  # of the solution without friction, which is a start only


def frictionless_start(problem: LatticeProblem, laws: ContactLaws, count: IterationCount) -> LatticeState | None:
    """Strips, ends and pressure without friction, and the tractions of friction at this pressure; None without contact.

    Raises NotConverged, OutsideSurface.
    """
    normal = replace(problem, basis=strip_basis(problem.cells, "none"), law=None)
    state = cold_start(normal, laws, IterationCount())
    solution = None if state is None else LatticeNewton(normal, TOLERANCE, count).solve(state)
    return None if solution is None else _with_tractions(problem, laws, solution.state)


def _with_tractions(problem: LatticeProblem, laws: ContactLaws, normal: LatticeState) -> LatticeState:
    """A state without tractions with those of friction at its pressure. Raises NotConverged."""
    S, M = len(normal.strips), problem.cells
    values = np.hstack([np.zeros((S, 2 * M)), normal.values])
    evaluation, operator, _ = linearise(values, problem.of(normal.strips))
    cells = np.arange(values.size).reshape(values.shape)[:, : 2 * M].reshape(S, 2, M)
    rows = cells.transpose(1, 0, 2).ravel()
    rigid = evaluation.slip.transpose(1, 0, 2).ravel()  # with the part of the pressure
    pressure = PrescribedPressure(np.maximum(evaluation.pressure, 0.0).ravel())
    friction = FrictionProblem(operator[np.ix_(rows, rows)], rigid, None, pressure, laws, problem.speed)
    loaded = evaluation.pressure.ravel() > 0
    tractions = tangential_contact(friction, np.zeros((2, S * M)), loaded, OPTIONS, IterationCount()).q
    values[:, : 2 * M] = tractions.reshape(2, S, M).transpose(1, 0, 2).reshape(S, 2 * M)
    return LatticeState(normal.strips, values)
