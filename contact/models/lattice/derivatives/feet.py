"""Compiled: derivatives of slips and moments of the gap where strips move on the lower body.

Each strip moves by itself. At every distance between boundaries of two strips this takes two polynomials, one for each
that moves. Few principal motions of all strips take one each, two as a rule, and leave out the others; the multipliers
of force and moment, applied first, six.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from wheelrail.contact.models.lattice.influence.basis import MOMENTS
from wheelrail.contact.models.lattice.influence.body_correction import (
    START,
    PairMeans,
    add_pair_mean,
    share_slopes,
)
from wheelrail.contact.models.lattice.influence.operator import (
    BIAS,
    BLOCK,
    SHIFT,
    VECTOR,
    StripGrid,
    add_antiderivative,
    store_slips,
)
from wheelrail.contact.models.lattice.influence.pair_grid import COMPONENTS, DEGREE
from wheelrail.contact.models.lattice.influence.vectors import bits, double, polynomials
from wheelrail.contact.models.lattice.system.equations import EquationData, force_jumps, strip_grid
from wheelrail.support.arrays import Array
from wheelrail.support.compiled import borrowing, compiled


class _WorkSpace(NamedTuple):
    """Work space.

    Parameters:
        table: (cells, DEGREE + 1, COMPONENTS) coefficients of a pair.
        G: (R, R, 8) their values.
        sums: (3, 8), see `add_antiderivative`.
        part: (R, 3) antiderivative on one strip by another one.
        own: (S, R, 3) that by all others, where the strip itself moves.
    """

    table: Array
    G: Array
    sums: Array
    part: Array
    own: Array


@compiled
def foot_derivatives(values: Array, data: EquationData, arc: Array, feet: Array, change: Array) -> tuple[Array, Array]:
    """Derivatives (6, S, 2, M) of slips and (6, S, MOMENTS) m of moments by the pose, by which the strips move on the
    lower body.

    Parameters:
        values: (S, block), of the state.
        data: of the equations.
        arc: (ns,) m, lines of the lower body; none where the compliance does not depend on places there.
        feet: (S,) m, arc length of the strips' middles on the lower body.
        change: (S, 6), their derivative.
    """
    places, basis, smooth = data.places, data.basis, data.tables.smooth
    S, M = len(values), len(basis.marks) - 1
    slips, moments = np.zeros((6, S, 2, M)), np.zeros((6, S, MOMENTS))
    if not len(arc):
        return slips, moments
    grid, n = strip_grid(values, places, basis), smooth.share.shape[1]
    jumps, R = force_jumps(values, places, basis, data.motion.speed > 0.0), grid.x.shape[1]
    share, V = smooth.share[data.tables.place[places.strip]], np.zeros((6, S, R, 3))
    slope = share_slopes(arc[smooth.first : smooth.first + n], feet, places.width)
    table = np.empty((smooth.lines.shape[2], DEGREE + 1, COMPONENTS))
    work = _WorkSpace(table, np.empty((R, R, 8)), np.empty((3, 8)), np.empty((R, 3)), np.zeros((S, R, 3)))
    _store_antiderivatives(smooth, grid, jumps, share, slope, change, work, V)
    for k in range(6):
        store_slips(V[k], grid, basis, slips[k], moments[k])
    return slips, moments


@borrowing
def _store_antiderivatives(
    smooth: PairMeans,
    grid: StripGrid,
    jumps: Array,
    share: Array,
    slope: Array,
    change: Array,
    work: _WorkSpace,
    V: Array,
) -> None:
    """Fill the derivative V (6, S, R, 3), which is zero, of `antiderivatives` by strips that move by change (S, 6).

    Parameters:
        share, slope: (S, n) weights of the lines in the strips, and their derivatives.
    """
    S, part = len(grid.x), work.part
    for i in range(S):
        for j in range(i, S):
            rows, columns = grid.x[i], grid.x[j]
            farthest = max(abs(rows[0] - columns[-1]), abs(rows[-1] - columns[0]))
            table = work.table[: (bits(farthest / START + 1.0) >> SHIFT) - BIAS + 1]
            table[:] = 0.0
            add_pair_mean(smooth.lines, smooth.first, slope[i], share[j], table)
            if i == j:
                add_pair_mean(smooth.lines, smooth.first, share[i], slope[i], table)
            _tabulated(table, rows, columns, work.G)
            add_antiderivative(work.G, jumps[j], 1.0, 1.0, work.sums, work.own[i])
            if i == j:
                continue
            part[:] = 0.0
            add_antiderivative(work.G, jumps[i], -1.0, 1.0, work.sums, part)
            _add_moved(part, change[i], V[:, j])
            table[:] = 0.0
            add_pair_mean(smooth.lines, smooth.first, share[i], slope[j], table)
            _tabulated(table, rows, columns, work.G)
            add_antiderivative(work.G, jumps[i], -1.0, 1.0, work.sums, work.own[j])
            part[:] = 0.0
            add_antiderivative(work.G, jumps[j], 1.0, 1.0, work.sums, part)
            _add_moved(part, change[j], V[:, i])
    for i in range(S):
        _add_moved(work.own[i], change[i], V[:, i])


@borrowing
def _tabulated(table: Array, rows: Array, columns: Array, G: Array) -> None:
    """Write G (R, C, 8) at the distances of boundaries rows (R,) and columns (C,), from coefficients up to there."""
    start, to, wide = table.ctypes.data, G.ctypes.data, G.shape[1]
    for r in range(len(rows)):
        for c in range(len(columns)):
            x = rows[r] - columns[c]
            z = abs(x) * (1.0 / START) + 1.0
            top = bits(z) >> SHIFT
            cell = start + BLOCK * (top - BIAS), z - double(top << SHIFT), 1.0 / START
            polynomials((cell,), np.copysign(1.0, x), to + VECTOR * (r * wide + c), None)


@borrowing
def _add_moved(part: Array, change: Array, V: Array) -> None:
    """Add to V (6, R, 3) an antiderivative (R, 3) per motion times the motions (6,)."""
    for k in range(6):
        for r in range(len(part)):
            for c in range(3):
                V[k, r, c] += change[k] * part[r, c]
