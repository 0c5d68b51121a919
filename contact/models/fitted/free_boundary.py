"""Free-boundary iteration: quasi-Newton steps of the strips' ends and the patches' tips until cells and contact end
together, on the pressures of the frictionless contact.
"""

from __future__ import annotations

import logging
from collections.abc import Callable
from dataclasses import dataclass, replace

import numpy as np
import scipy.linalg as la

from wheelrail.contact.geometry.strip_layout import StripLayout
from wheelrail.contact.models.fitted.cell_compliance import CellCompliance, FittedState
from wheelrail.contact.models.fitted.edge_rules import edge_rules, tip
from wheelrail.contact.models.fitted.initial_layout import NormalOperator, Overlap
from wheelrail.contact.models.fitted.patch_layout import PatchSpan, assembled
from wheelrail.contact.models.fitted.resolution import Resolution
from wheelrail.contact.solvers.active_set import CachedFactors
from wheelrail.contact.solvers.options import IterationCount, NotConverged
from wheelrail.support.arrays import Array, Mask, Nodes

log = logging.getLogger(__name__)

STEPS = 40
COPIES = 3  # translated and scaled layouts that are tried before the free-boundary iteration
FARTHEST = 0.12  # of the strip's length: largest step of an end, before relaxation
STRETCH = 1.6  # relaxation factor of the first step: between 1, of a line contact, and 2, of a point contact


@dataclass(frozen=True)
class FittedPressure:
    """Cells, the frictionless pressures (S, M) Pa on them, their compliance along the normals, whether their ends
    converged, and the number of steps.
    """

    layout: StripLayout
    pressure: Array
    normal: CachedFactors
    settled: bool
    steps: int

    @property
    def divided(self) -> bool:
        """Whether the load across the patch has a local minimum."""
        steps = np.diff((self.pressure * np.diff(self.layout.edges)).sum(axis=1))
        return bool(((steps[1:] > 0) & (steps[:-1] < 0)).any())


def fit(
    overlap: Overlap,
    operator: NormalOperator,
    start: StripLayout,
    resolution: Resolution,
    *,
    tolerance: float,
    count: IterationCount,
) -> FittedPressure | None:
    """Solve for ends and tips: iterate until their steps, over the strips' length and width, are below the tolerance.

    Parameters:
        overlap: undeformed penetration (S, M) m of the cells of a layout.
        operator: relative normal compliance m/Pa of the cells of a layout.
        start: initial layout of S strips of M cells.
        resolution: numbers of strips and cells.
        tolerance: RMS of the ends' steps over the strips' length; a tenth of the largest step of a tip over the width.
        count: iteration counts, increased.

    Strips in tension inside a patch are released until their penetration is positive again. Returns the layout with
    the smallest residual when the iteration does not converge; None when no pressure is left.
    """
    layout, stretch = start, STRETCH
    previous: Array | None = None
    best: tuple[float, StripLayout, Array, CachedFactors] | None = None  # with the smallest residual
    held = np.ones(len(start.sides), dtype=bool)
    last: Array = np.zeros((0, 2))
    damping: Array = np.ones((0, 2))
    for step in range(1, STEPS + 1):
        factors = operator(layout)
        pressure, touches = _pressed(factors, overlap(layout), held, count)
        load = (pressure * np.diff(layout.edges)).sum(axis=1)
        moves = np.clip(np.nan_to_num(_beyond(layout, pressure)), -FARTHEST, FARTHEST) * held[:, None]
        tips = _tips(layout, load)
        damping, last = _damped(tips, last, damping), tips
        error = float(np.sqrt((moves[held] ** 2).mean()))
        log.debug(
            "step %d: ends move by %.1e, tips by %s widths, %d of %d strips",
            step,
            error,
            tips.round(4).tolist(),
            held.sum(),
            len(load),
        )
        slip = float(np.abs(damping * tips).max())
        holds = touches & ((load > 0) | _outermost(layout) | ~held)
        distance = max(error / tolerance, slip / (10 * tolerance), 1.0 if (holds == held).all() else 10.0)
        if distance <= 1.0:
            return FittedPressure(layout, pressure, factors, True, step)
        if best is None or distance < best[0]:
            best = distance, layout, pressure, factors
        stretch, previous = _relaxation(stretch, previous, moves), moves
        ends = layout.ends + stretch * moves * np.diff(layout.ends) * [-1.0, 1.0]
        moved = _retipped(replace(layout, ends=ends), load, damping * tips, resolution)
        if moved is None:
            return None
        held = holds if len(moved.sides) == len(held) else np.ones(len(moved.sides), dtype=bool)
        if not held.any():
            return None
        layout = moved
    assert best is not None
    return FittedPressure(*best[1:], False, STEPS)


def _damped(tips: Array, before: Array, damping: Array) -> Array:
    """Damping factors (parts, 2) of the tips' steps, from the previous steps and factors: halved where the step changes
    its sign, else raised by half up to 1.
    """
    if tips.shape != before.shape:
        return np.ones(tips.shape)
    return np.asarray(np.where(tips * before < 0, 0.5 * damping, np.minimum(1.0, 1.5 * damping)))


def _relaxation(factor: float, before: Array | None, moves: Array) -> float:
    """Relaxation factor of the ends by a secant through the last two steps (S, 2), from the factor before."""
    if before is None or before.shape != moves.shape:
        return factor
    change = moves - before
    bottom = float((change**2).sum())
    return float(np.clip(-factor * (before * change).sum() / bottom, 0.7, 2.2)) if bottom > 0 else factor


def follow(
    overlap: Overlap,
    cells: FittedState,
    gather: Callable[[StripLayout], CellCompliance],
    *,
    tolerance: float,
    count: IterationCount,
) -> tuple[FittedState, Array | None]:
    """Cells translated and scaled as a whole, and their pressures (S, M) Pa if their ends converge that way, else None.

    Parameters:
        overlap: as for `fit`.
        cells: state of an earlier solve.
        gather: assembles the compliance of a layout, called where the cells differ too much from the assembled ones.
        tolerance: as for `fit`, of the remaining steps.
        count: iteration counts, increased.
    """
    for step in range(COPIES):
        layout = cells.layout
        held = np.ones(len(layout.sides), dtype=bool)
        pressure, _ = _pressed(cells.gathered.normal, overlap(layout) / cells.scale, held, count)
        load = (pressure * np.diff(layout.edges)).sum(axis=1)
        if not (load > 0).all():
            break
        moves, tips = _beyond(layout, pressure), _tips(layout, load)
        error = max(np.sqrt((moves**2).mean()), np.abs(tips).max() / 2)
        if error <= tolerance:
            return cells, pressure
        if step == COPIES - 1 or not error < FARTHEST:
            break
        cells = cells.copied(STRETCH * moves, tips)
        if cells.far:
            cells = replace(cells, gathered=gather(cells.layout), scale=1.0)
    return cells, None


def _pressed(factors: CachedFactors, overlap: Array, held: Mask, count: IterationCount) -> tuple[Array, Mask]:
    """Signed pressures (S, M) Pa of the strips in contact (held), and which strips (S,) touch: these, and others with
    positive penetration.

    Raises NotConverged when the compliance is singular.
    """
    depth = overlap.ravel()
    own = np.repeat(held, overlap.shape[1])
    pressure = np.zeros(own.size)
    pressure[own] = la.lu_solve(factors.of(own, count), depth[own], check_finite=False)
    if not np.isfinite(pressure).all():
        raise NotConverged("the normal compliance of the fitted cells is singular")
    touches = held
    if not held.all():
        left = (depth - factors.compliance @ pressure).reshape(overlap.shape)
        touches = held | (left.max(axis=1) > 0)
    return pressure.reshape(overlap.shape), touches


def _beyond(layout: StripLayout, pressure: Array) -> Array:
    """Distances by which the contact extends beyond the trailing and leading end of every strip (S, 2), over its
    length.
    """
    trailing, leading = edge_rules(tuple(layout.marks.tolist()))
    return np.column_stack(
        [trailing.beyond(pressure[:, 0], pressure[:, 1]), leading.beyond(pressure[:, -1], pressure[:, -2])]
    )


def _outermost(layout: StripLayout) -> Mask:
    """First and last strips of the patches, which the tips' steps move."""
    outermost = np.zeros(len(layout.patch), dtype=bool)
    outermost[np.concatenate(_bounds(layout))] = True
    return outermost


def _tips(layout: StripLayout, load: Array) -> Array:
    """Distances by which the contact extends beyond the first and last strip of each part (parts, 2), in widths; zero
    where two loaded parts share a side.
    """
    first, last = _bounds(layout)
    tips = np.array([(tip(load[i : j + 1]), tip(load[i : j + 1][::-1])) for i, j in zip(first, last, strict=True)])
    for k in range(len(first) - 1):
        i, j = last[k], first[k + 1]
        if layout.sides[i, 1] == layout.sides[j, 0] and load[i] > 0 and load[j] > 0:
            tips[k, 1] = tips[k + 1, 0] = 0.0
    return tips


def _bounds(layout: StripLayout) -> tuple[Nodes, Nodes]:
    """First and last strip of every part."""
    new = np.flatnonzero(np.diff(layout.patch)) + 1
    return np.concatenate([[0], new]), np.concatenate([new - 1, [len(layout.patch) - 1]])


def _retipped(layout: StripLayout, load: Array, tips: Array, resolution: Resolution) -> StripLayout | None:
    """Strips between the moved tips; parts without load are removed, those that meet share a side."""
    parts = []
    for i, j, (before, after) in zip(*_bounds(layout), tips, strict=True):
        own = slice(i, j + 1)
        width = layout.width[i]
        low, high = layout.sides[i, 0] - before * width, layout.sides[j, 1] + after * width
        middle = layout.middle[own]
        if (load[own] > 0).any() and ((middle > low) & (middle < high)).any():
            parts.append(PatchSpan(float(low), float(high), middle, layout.ends[own], j + 1 - i))
    return assembled(parts, resolution, layout.marks)
