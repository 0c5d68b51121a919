"""Deviation of finite bodies from half-spaces: tables between lines of the surface, and their means over strips.

The deviation is smooth over the surface and along x, so that tables on coarse cells and linear interpolation between
the lines suffice. The mean over a strip of a function that is linear between lines is a continuously differentiable
function of the strip's place.
"""

from __future__ import annotations

from dataclasses import dataclass, field
from functools import cached_property

import numpy as np

from wheelrail.contact.elasticity.half_space import cutoff_correction
from wheelrail.contact.elasticity.waveguide.influence import TILE, ElementInfluence
from wheelrail.contact.elasticity.waveguide.spectrum import antiderivative_weights
from wheelrail.contact.models.lattice.influence.pair_grid import COMPONENTS, DEGREE, PairGrid
from wheelrail.support.arrays import Array
from wheelrail.support.compiled import compiled

START = 0.02  # m: cells of 2.5 mm up to this distance
OUTWARD = 1.0, -1.0  # outward normal of the upper body in the axes of the upper and of the lower one


@dataclass
class BodyCorrection:
    """Deviation of one body.

    Parameters:
        body: spectrum and surface.
        outward: 1 where the normal of the tables is the body's outward one, else -1.
    """

    body: ElementInfluence
    outward: float
    _tiles: dict[tuple[int, int], Array] = field(init=False, default_factory=dict, repr=False)

    @cached_property
    def grid(self) -> PairGrid:
        """Cells along x."""
        return PairGrid.over(START)

    @cached_property
    def weights(self) -> tuple[Array, Array]:
        """Even and odd weights (nodes, nk) of the samples of the spectrum in G at the nodes of the grid."""
        return antiderivative_weights(self.grid.x / self.body.unit, self.body.samples)

    def between_lines(self, low: float, high: float) -> tuple[int, Array]:
        """First line, and coefficients (n, n, cells, DEGREE + 1, COMPONENTS) between n lines that cover an interval of
        arc length m. Raises OutsideSurface beyond the lines.
        """
        first, last = self.body.window(low, high)
        first, last = max(first - 2, 0), min(last + 2, len(self.body.arc))
        key = first // TILE, -(-last // TILE)
        if key not in self._tiles:
            self._tiles[key] = self._assembled(TILE * key[0], min(TILE * key[1], len(self.body.arc)))
        return TILE * key[0], self._tiles[key]

    def _assembled(self, low: int, high: int) -> Array:
        lines = self.body._assembled(low, high)
        n = high - low
        even_weights, odd_weights = self.weights
        even = lines.even.reshape(n, n, 5, -1) @ even_weights.T
        odd = lines.odd.reshape(n, n, 4, -1) @ odd_weights.T
        far = cutoff_correction(self.grid.x / self.body.unit, self.body._cutoff, self.body.nu)
        tangent = self.body._tangents(self.body.arc[low:high])
        stretch = self.body._stretch(self.body.arc[low:high])
        normal = self.outward * np.stack([-tangent[:, 1], tangent[:, 0]], axis=1)
        scale = self.body.scale * self.body.unit**2
        coefficients = np.empty((n, n, len(self.grid.lower), DEGREE + 1, COMPONENTS))
        for i in range(n):
            for j in range(n):
                axes = np.stack([tangent[i], normal[i]]), np.stack([tangent[j], normal[j]])
                samples = in_strip_axes(even[i, j], odd[i, j], *axes)
                samples -= far_in_strip_axes(far, *axes) / (0.5 * (stretch[i] + stretch[j]))
                coefficients[i, j] = self.grid.coefficients(scale * samples)
        return coefficients

    def shares(self, first: int, count: int, middle: Array, width: Array) -> Array:
        """Weights (S, count) of lines, from the first, in the means over strips with middles and widths (S,) m."""
        arc = self.body.arc[first : first + count]
        return strip_shares(arc, np.ascontiguousarray(middle), np.ascontiguousarray(width))


def in_strip_axes(even: Array, odd: Array, row: Array, column: Array) -> Array:
    """Components (nodes, COMPONENTS) from even (5, nodes) and odd (4, nodes) ones in the axes of a body.

    row, column: (2, 2) tangent and normal of the displaced and of the loaded line.
    """
    xx, yy, yz, zy, zz = even
    xy, xz, yx, zx = odd[0], odd[1], -odd[2], -odd[3]
    block = np.einsum("ai,ijn,bj->abn", row, np.array([[yy, yz], [zy, zz]]), column)
    by_column, by_row = column @ np.array([xy, xz]), row @ np.array([yx, zx])
    return np.stack(
        [
            xx,
            block[0, 0],
            block[1, 1],
            0.5 * (block[0, 1] + block[1, 0]),
            0.5 * (block[0, 1] - block[1, 0]),
            0.5 * (by_column[0] + by_row[0]),
            np.zeros_like(xx),
            0.5 * (by_column[1] - by_row[1]),
        ],
        axis=1,
    )


def far_in_strip_axes(far: Array, row: Array, column: Array) -> Array:
    """Components (nodes, COMPONENTS) of the far-field correction (nodes, 3), equal across and along the normal."""
    turned = row @ column.T
    zero = np.zeros(len(far))
    return np.stack(
        [
            far[:, 0],
            turned[0, 0] * far[:, 1],
            turned[1, 1] * far[:, 2],
            0.5 * (turned[0, 1] + turned[1, 0]) * far[:, 1],
            0.5 * (turned[0, 1] - turned[1, 0]) * far[:, 1],
            zero,
            zero,
            zero,
        ],
        axis=1,
    )


@compiled
def _integral(arc: Array, k: int, s: float) -> float:
    """Integral up to s m of the function that is 1 at line k and 0 at the others, linear in between."""
    total = 0.0
    if k > 0 and s > arc[k - 1]:
        t = min(s, arc[k]) - arc[k - 1]
        total += 0.5 * t * t / (arc[k] - arc[k - 1])
    if k < len(arc) - 1 and s > arc[k]:
        wide = arc[k + 1] - arc[k]
        t = min(s - arc[k], wide)
        total += t - 0.5 * t * t / wide
    return total


@compiled
def strip_shares(arc: Array, middle: Array, width: Array) -> Array:
    """Weights (S, n) of lines (n,) m in the means over strips of functions linear between the lines."""
    share = np.empty((len(middle), len(arc)))
    for i in range(len(middle)):
        low, high = middle[i] - 0.5 * width[i], middle[i] + 0.5 * width[i]
        for k in range(len(arc)):
            share[i, k] = (_integral(arc, k, high) - _integral(arc, k, low)) / width[i]
    return share


@compiled
def pair_means(lines: Array, share: Array, cells: int) -> Array:
    """Coefficients (S, S, cells, DEGREE + 1, COMPONENTS) of the pairs i <= j of strips, from those of lines (n, n, ..).

    share (S, n): weights of the lines in the strips.
    """
    S, n = share.shape
    tables = np.zeros((S, S, cells, lines.shape[3], lines.shape[4]))
    for i in range(S):
        for j in range(i, S):
            to = tables[i, j].ravel()
            for k in range(n):
                if share[i, k] == 0.0:
                    continue
                for m in range(n):
                    weight = share[i, k] * share[j, m]
                    if weight != 0.0:
                        values = lines[k, m, :cells].ravel()
                        for c in range(len(to)):
                            to[c] += weight * values[c]
    return tables
