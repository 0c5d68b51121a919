"""Result of a contact on a lattice in the frame of the rail, on the cells of its strips."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import cached_property, partial

import numpy as np

from wheelrail.contact.geometry.strip_layout import StripLayout, connected
from wheelrail.contact.models.lattice.body_displacement import body_displacements
from wheelrail.contact.models.lattice.solver.newton import LatticeSolution
from wheelrail.contact.models.lattice.system.equations import resultants, strip_grid
from wheelrail.contact.models.lattice.system.problem import LatticeProblem
from wheelrail.contact.models.lattice.tangent import LatticeTangent
from wheelrail.contact.results.patch_moments import sharpened
from wheelrail.contact.results.result import ContactResult, Fields, LazyFields, LazyPatches, Patch, Statistics
from wheelrail.contact.results.resultants import FrictionalWork, assemble_result
from wheelrail.contact.results.touching_material import with_material
from wheelrail.contact.solvers.tangent import ContactTangent
from wheelrail.support.arrays import Array, Nodes

SAMPLES = 65  # of the pressure along a strip


def contact_result(problem: LatticeProblem, solution: LatticeSolution, statistics: Statistics) -> ContactResult:
    """Forces, patches, fields and tangent of a solution; all but the forces are computed when first needed."""
    state, details = solution.state, SolutionDetails(problem, solution)
    load = resultants(state.values, problem.of(state.strips))
    return ContactResult(
        force=load[:3],
        moment=load[3:],
        patches=LazyPatches(lambda: tuple(details.result.patches)),
        fields=LazyFields(lambda: details.fields),
        approach=problem.approach,
        status="converged",
        statistics=statistics,
        force_tangent=ContactTangent(LatticeTangent(problem, solution)),
        warm_start=solution,
    )


@dataclass(frozen=True, eq=False)
class SolutionDetails:
    """Fields and patches of a solution.

    Parameters:
        problem: equations.
        solution: their solution.
    """

    problem: LatticeProblem
    solution: LatticeSolution

    @cached_property
    def result(self) -> ContactResult:
        """Result with fields and patches."""
        problem, state = self.problem, self.solution.state
        evaluation = problem.evaluate(state)
        S, M = evaluation.pressure.shape
        layout, places = problem.layout(state), problem.cell_places(state)
        q, slip, margin = np.zeros((S * M, 2)), np.zeros((S * M, 2)), np.zeros(S * M)
        if problem.law is not None:
            q = state.tractions.transpose(0, 2, 1).reshape(-1, 2)
            slip = evaluation.slip.transpose(0, 2, 1).reshape(-1, 2)
            margins = problem.law.margins(
                state.tractions, evaluation.slip, evaluation.pressure, problem.rho, problem.speed
            )
            margin = margins.ravel()
        grid = strip_grid(state.values, problem.of(state.strips).places, problem.basis)
        result = assemble_result(
            FrictionalWork(places, q, margin > 0, problem.motion, 0.0 if problem.shifts else problem.speed),
            node=np.arange(S * M),
            patch=np.repeat(connected(layout, np.ones((S, M))), M),
            pressure=evaluation.pressure.ravel(),
            slip=slip,
            displacement=_displacement(evaluation.V, grid.x),
            approach=problem.approach,
            statistics=Statistics(),
        )
        result = sharpened(result, layout, margin, self._touching())
        return self._with_material(_with_peaks(result, layout, state.modes), layout)

    def _touching(self) -> Array:
        """Squared length, continued where the surfaces have opened, over that of the strips (S,)."""
        problem, state = self.problem, self.solution.state
        depth = problem.tables.stretch[state.strips] * state.load / problem.tables.modulus
        return np.asarray(1 - problem.openings(state) / depth)

    def _with_material(self, result: ContactResult, layout: StripLayout) -> ContactResult:
        """The result with the material of both bodies that touches, and the inclination of their common surface."""
        fields = result.fields
        assert fields is not None
        S = len(layout.sides)
        load = (fields.pressure * fields.area).reshape(S, -1)
        labels = fields.patch.reshape(S, -1).max(axis=1)

        def patches() -> tuple[Patch, ...]:
            relative = fields.displacement.reshape(S, -1, 3)
            displacements = body_displacements(self.problem, self.solution.state, relative, load)
            return tuple(
                with_material(
                    patch, displacements.of(labels == k), layout.middle[labels == k], load[labels == k].sum(1)
                )
                for k, patch in enumerate(result.patches)
            )

        return replace(result, patches=LazyPatches(patches))

    @property
    def fields(self) -> Fields:
        """Fields at the cells."""
        assert self.result.fields is not None
        return self.result.fields


def _displacement(V: Array, x: Array) -> Array:
    """Relative displacement (n, 3) m, means over the cells, from the antiderivative (S, M + 3, 3)."""
    means = np.diff(V, axis=1) / np.diff(x)[..., None]
    return np.asarray(means[:, :-2].reshape(-1, 3))


def _with_peaks(result: ContactResult, layout: StripLayout, modes: Array) -> ContactResult:
    """The result with the largest pressure of every patch by the modes of its strips."""
    assert result.fields is not None
    labels = result.fields.patch.reshape(len(modes), -1)[:, 0]
    return replace(result, patches=LazyPatches(partial(_peaks, result.patches, layout, modes, labels)))


def _peaks(patches: Sequence[Patch], layout: StripLayout, modes: Array, labels: Nodes) -> tuple[Patch, ...]:
    theta = np.linspace(0.0, np.pi, SAMPLES)[1:-1]
    shapes = np.sin((np.arange(modes.shape[1]) + 1)[:, None] * theta)  # sqrt(1 - xi^2) U_m
    highest = (modes @ shapes).max(axis=1)
    return tuple(
        replace(patch, max_pressure=peak_across(highest[labels == k], layout.middle[labels == k]))
        for k, patch in enumerate(patches)
    )


def peak_across(highest: Array, middle: Array) -> float:
    """Largest pressure Pa over adjacent strips: a parabola, as in an ellipse, through the squares of the largest values
    (n,) Pa of the three strips with middles (n,) m at the largest of all.

    Over patches of 3 strips this errs by up to 9 %, of 4 by 2 to 5 %, from 5 on by 0.6 %.
    """
    k = int(np.argmax(highest))
    if not 0 < k < len(highest) - 1:
        return float(highest[k])
    before, after = middle[k] - middle[k - 1], middle[k + 1] - middle[k]
    left, c, right = highest[k - 1 : k + 2] ** 2
    fall, rise = (c - left) / before, (right - c) / after
    a, b = (rise - fall) / (before + after), (fall * after + rise * before) / (before + after)
    return float(np.sqrt(c - b * b / (4 * a))) if a < 0 else float(highest[k])
