"""Tables of the compliance between pairs of strips of a lattice, both bodies together, in the strips' own axes.

With G'' = C the compliance along x, the mean displacement of cells by forces on cells is a second difference of G. Near
its load a body is a half-space, whose part of G depends on the strips' widths and distances on the upper body alone and
is tabulated once for all poses; the deviation of finite bodies from half-spaces is smooth.

Cells of the tables: z = 1 + |x| / start, `CELLS` equal ones in every octave of z, polynomials of degree `DEGREE` in
each; means over contact cells err by 1e-7. Axes are longitudinal x, lateral t and outward normal n of the upper body on
either strip. Displacement by force is symmetric up to TURN components, which change their sign when the pair is taken in
the other order: C_xt = XT + XT_TURN, C_tx = XT - XT_TURN, C_tn = TN + TN_TURN, C_nt = TN - TN_TURN, C_xn = -C_nx = XN.
The first five components are even functions of x, the others odd.
"""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import NamedTuple

import numpy as np

from wheelrail.contact.elasticity.half_space import strip_antiderivative
from wheelrail.contact.models.fitted.influence import HalfSpaceInfluence
from wheelrail.contact.models.fitted.operators import StripOperators
from wheelrail.support.arrays import Array, Nodes

CELLS = 8  # an octave
DEGREE = 5
COMPONENTS = 8
XX, TT, NN, TN, TN_TURN, XT, XT_TURN, XN = range(COMPONENTS)
START = 0.004, 0.03, 0.5  # of the width, on the strip itself and next to it; of the distance, beyond
REACH = 0.08  # m, longest distance along x
GROWTH = 1.5  # of the storage


class PairTables(NamedTuple):
    """Tables of the pairs i <= j of S strips, row by row.

    Parameters:
        values: (cells, DEGREE + 1, COMPONENTS) m/N times m2, coefficients of powers of z minus the cell's lower bound.
        first: (pairs,) first cell of a pair.
        count: (pairs,) its number of cells.
        inverse: (pairs,) 1/m, 1 / start.
    """

    values: Array
    first: Nodes
    count: Nodes
    inverse: Array


def lobatto(count: int) -> Array:
    """Chebyshev-Lobatto points (count,) from 0 to 1."""
    return np.asarray(0.5 - 0.5 * np.cos(np.pi * np.arange(count) / (count - 1)))


@dataclass(frozen=True)
class PairGrid:
    """Distances along x at which a pair is sampled: cells (n,) from z = lower with given widths, start m."""

    start: float
    lower: Array
    width: Array

    @classmethod
    def over(cls, start: float) -> PairGrid:
        """Cells from 0 to `REACH`."""
        octaves = int(np.ceil(np.log2(1 + REACH / start)))
        octave, k = np.divmod(np.arange(octaves * CELLS), CELLS)
        return cls(start, 2.0**octave * (1 + k / CELLS), 2.0**octave / CELLS)

    @property
    def x(self) -> Array:
        """Distances (n (DEGREE + 1),) m."""
        z = self.lower[:, None] + self.width[:, None] * lobatto(DEGREE + 1)
        return np.asarray(((z - 1) * self.start).ravel())

    def coefficients(self, samples: Array) -> Array:
        """Coefficients (n, DEGREE + 1, COMPONENTS) from samples (n (DEGREE + 1), COMPONENTS) at `x`."""
        inverse = np.linalg.inv(np.vander(lobatto(DEGREE + 1), increasing=True))
        powers = inverse @ samples.reshape(len(self.lower), DEGREE + 1, -1)
        return np.asarray(powers / self.width[:, None, None] ** np.arange(DEGREE + 1)[:, None])


@dataclass
class LatticeTables:
    """Tables of half-spaces under the strips of a lattice, computed when a pair is first needed.

    Parameters:
        operators: bodies and surfaces.
        sides: (K + 1,) m, lateral bounds of the strips on the upper body.
    """

    operators: StripOperators
    sides: Array
    _place: dict[tuple[int, int], tuple[int, int, float]] = field(init=False, default_factory=dict, repr=False)
    _values: Array = field(init=False, repr=False)
    _used: int = field(init=False, default=0)

    def __post_init__(self) -> None:
        self._values = np.zeros((4096, DEGREE + 1, COMPONENTS))
        middle = 0.5 * (self.sides[1:] + self.sides[:-1])
        tangent = self.operators.upper._tangents(middle)
        self._angle = np.unwrap(np.arctan2(tangent[:, 1], tangent[:, 0]))

    def of(self, strips: Nodes) -> PairTables:
        """Tables of the pairs of some strips (S,), in ascending order."""
        i, j = np.triu_indices(len(strips))
        return self._of_pairs(strips[i], strips[j])

    def between(self, rows: Nodes, columns: Nodes) -> PairTables:
        """Tables of the pairs of rows (n,) and columns (m,), row by row, the lower number of each pair first."""
        i, j = (index.ravel() for index in np.meshgrid(rows, columns, indexing="ij"))
        return self._of_pairs(np.minimum(i, j), np.maximum(i, j))

    def _of_pairs(self, i: Nodes, j: Nodes) -> PairTables:
        pairs = list(zip(i.tolist(), j.tolist(), strict=True))
        for pair in pairs:
            if pair not in self._place:
                self._add(*pair)
        first, count, inverse = zip(*(self._place[pair] for pair in pairs), strict=True)
        return PairTables(self._values, np.array(first), np.array(count), np.array(inverse))

    def _add(self, i: int, j: int) -> None:
        sides = np.array([[self.sides[k], self.sides[k + 1]] for k in ((i,) if i == j else (i, j))])
        width, distance = float(np.diff(sides).min()), float(sides[-1].mean() - sides[0].mean())
        start = START[0] * width if i == j else max(START[1] * width, START[2] * (distance - width))
        grid = PairGrid.over(start)
        samples = np.zeros((len(grid.x), COMPONENTS))
        tilt = 0.5 * (self._angle[j] - self._angle[i])
        for body in (self.operators.upper, self.operators.lower):
            near = strip_antiderivative(grid.x, sides, body.nu)[min(j - i, 1)]
            samples += half_space_scale(body) * rotated(near, -tilt, tilt)
        coefficients = grid.coefficients(samples)
        count = len(coefficients)
        while self._used + count > len(self._values):
            larger = np.zeros((int(GROWTH * len(self._values)), DEGREE + 1, COMPONENTS))
            larger[: self._used] = self._values[: self._used]
            self._values = larger
        self._values[self._used : self._used + count] = coefficients
        self._place[i, j] = self._used, count, 1 / start
        self._used += count


def half_space_scale(body: HalfSpaceInfluence) -> float:
    """Compliance 1/N m of the body's tables over that of unit modulus with lengths in m."""
    return body.scale * body.unit


def rotated(near: Array, row: float, column: float) -> Array:
    """Components (n, COMPONENTS) from those along, across, normal and along by across (n, 4) in the mean axes of two
    strips that are inclined to them by angles rad, positive from the lateral towards the upper body's outward normal.
    """
    along, across, normal, mixed = near.T
    ci, si, cj, sj = np.cos(row), np.sin(row), np.cos(column), np.sin(column)
    tn, nt = -ci * sj * across + si * cj * normal, -si * cj * across + ci * sj * normal
    xt, tx = mixed * cj, mixed * ci
    return np.stack(
        [
            along,
            ci * cj * across + si * sj * normal,
            si * sj * across + ci * cj * normal,
            0.5 * (tn + nt),
            0.5 * (tn - nt),
            0.5 * (xt + tx),
            0.5 * (xt - tx),
            0.5 * mixed * (si - sj),
        ],
        axis=1,
    )
