"""Result of a contact on a lattice in the frame of the rail, on the cells of its strips."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from functools import partial

import numpy as np

from wheelrail.contact.kinematics.contact_points import SurfacePoints
from wheelrail.contact.models.fitted.layout import StripLayout, connected
from wheelrail.contact.models.fitted.patch_moments import sharpened
from wheelrail.contact.models.lattice.equations import strip_grid
from wheelrail.contact.models.lattice.newton import LatticeSolution
from wheelrail.contact.models.lattice.problem import LatticeProblem
from wheelrail.contact.models.lattice.tangent import LatticeTangent
from wheelrail.contact.results.result import ContactResult, LazyPatches, Patch, Statistics
from wheelrail.contact.results.resultants import FrictionalWork, assemble_result
from wheelrail.contact.solvers.tangent import ContactTangent
from wheelrail.support.arrays import Array, Nodes

SAMPLES = 65  # of the pressure along a strip


def contact_result(problem: LatticeProblem, solution: LatticeSolution, statistics: Statistics) -> ContactResult:
    """Forces, patches, fields and tangent of a solution."""
    state, evaluation = solution.state, solution.evaluation
    S, M = evaluation.pressure.shape
    bounds = problem.tables.sides
    sides = np.column_stack([bounds[state.strips], bounds[state.strips + 1]])
    layout = StripLayout(sides, state.ends, np.zeros(S, dtype=int), problem.basis.marks)
    places = problem.tables.operators.surfaces.places(problem.pose, layout)
    pressure = evaluation.pressure.ravel()
    q, slip = np.zeros((S * M, 2)), np.zeros((S * M, 2))
    bound = np.zeros(S * M)
    if problem.law is not None:
        q = state.tractions.transpose(0, 2, 1).reshape(-1, 2)
        slip = evaluation.slip.transpose(0, 2, 1).reshape(-1, 2)
        bound = problem.law.functions.coefficient(np.hypot(*slip.T) * problem.speed, pressure) * pressure
    grid = strip_grid(state.values, problem.of(state.strips).places, problem.basis)
    strip = connected(layout, np.ones((S, M)))
    result = assemble_result(
        FrictionalWork.below(bound, places, q, problem.motion, problem.speed),
        node=np.arange(S * M),
        patch=np.repeat(strip, M),
        pressure=pressure,
        slip=slip,
        displacement=_displacement(evaluation.V, grid.x),
        approach=problem.approach,
        statistics=statistics,
    )
    result = _with_peaks(sharpened(result, layout, bound), layout, state.modes)
    return replace(result, force_tangent=_tangent(problem, solution, places), warm_start=state)


def _displacement(V: Array, x: Array) -> Array:
    """Relative displacement (n, 3) m, means over the cells, from the antiderivative (S, M + 3, 3)."""
    means = np.diff(V, axis=1) / np.diff(x)[..., None]
    return np.asarray(means[:, :-2].reshape(-1, 3))


def _tangent(problem: LatticeProblem, solution: LatticeSolution, places: SurfacePoints) -> ContactTangent | None:
    return None if places.sensitivity is None else ContactTangent(LatticeTangent(problem, solution, places))


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
    a, b, c = np.polyfit(middle[k - 1 : k + 2] - middle[k], highest[k - 1 : k + 2] ** 2, 2)
    return float(np.sqrt(c - b * b / (4 * a))) if a < 0 else float(highest[k])
