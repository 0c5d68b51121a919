"""Deviation of finite bodies from half-spaces: tables between lines of the surface, and their means over strips.

The deviation is smooth over the surface and along x, so that tables on coarse cells and linear interpolation between
the lines suffice. The mean over a strip of a function that is linear between lines is a continuously differentiable
function of the strip's place.
"""

from __future__ import annotations

from dataclasses import dataclass, field
from functools import cached_property
from itertools import product

import numpy as np

from wheelrail.contact.elasticity.half_space import cutoff_correction
from wheelrail.contact.elasticity.waveguide.influence import ElementInfluence
from wheelrail.contact.elasticity.waveguide.spectrum import antiderivative_weights
from wheelrail.contact.models.lattice.influence.pair_grid import COMPONENTS, DEGREE, PairGrid
from wheelrail.support.arrays import Array
from wheelrail.support.compiled import compiled

START = 0.02  # m: cells of 2.5 mm up to this distance
TILE = 16  # lines: granularity of the parts of the surface whose correction is assembled
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
    _filled: set[tuple[int, int]] = field(init=False, default_factory=set, repr=False)

    @cached_property
    def grid(self) -> PairGrid:
        """Cells along x."""
        return PairGrid.over(START)

    @cached_property
    def weights(self) -> tuple[Array, Array]:
        """Even and odd weights (nodes, nk) of the samples of the spectrum in G at the nodes of the grid."""
        return antiderivative_weights(self.grid.x / self.body.unit, self.body.samples)

    @cached_property
    def _coefficients(self) -> Array:
        """Coefficients (ns, ns, cells, DEGREE + 1, COMPONENTS) between all lines, filled by tiles."""
        lines = len(self.body.arc)
        return np.zeros((lines, lines, len(self.grid.lower), DEGREE + 1, COMPONENTS))

    def between_lines(self, low: float, high: float) -> tuple[slice, Array]:
        """Lines that cover an interval of arc length m, and coefficients (ns, ns, cells, DEGREE + 1, COMPONENTS) between
        all lines, valid for these. Raises OutsideSurface beyond the lines.
        """
        first, last = self.body.window(low, high)
        first, last = max(first - 2, 0), min(last + 2, len(self.body.arc))
        tiles = range(first // TILE, -(-last // TILE))
        for tile in product(tiles, tiles):
            if tile not in self._filled:
                rows, columns = (slice(TILE * k, min(TILE * (k + 1), len(self.body.arc))) for k in tile)
                self._coefficients[rows, columns] = self._between(rows, columns)
                self._filled.add(tile)
        return slice(first, last), self._coefficients

    def _between(self, rows: slice, columns: slice) -> Array:
        """Coefficients (R, C, cells, DEGREE + 1, COMPONENTS) of the displacement of lines by loads on others."""
        lines = self.body.correction(rows, columns)
        even, odd = (part @ weight.T for part, weight in zip((lines.even, lines.odd), self.weights, strict=True))
        far = cutoff_correction(self.grid.x / self.body.unit, self.body._cutoff, self.body.nu)
        row, column = self._axes(rows)[:, None], self._axes(columns)[None]
        stretch = self.body._stretch(self.body.arc)
        samples = in_strip_axes(even, odd, row, column)
        samples -= (
            far_in_strip_axes(far, row, column) / (0.5 * (stretch[rows, None] + stretch[columns]))[..., None, None]
        )
        return self.body.scale * self.body.unit**2 * self.grid.coefficients(samples)

    def _axes(self, lines: slice) -> Array:
        """Tangent and normal (n, 2, 2) of lines."""
        tangent = self.body._tangents(self.body.arc[lines])
        return np.stack([tangent, self.outward * np.stack([-tangent[:, 1], tangent[:, 0]], axis=1)], axis=1)

    def shares(self, lines: slice, middle: Array, width: Array) -> Array:
        """Weights (S, lines) of lines in the means over strips with middles and widths (S,) m."""
        return strip_shares(self.body.arc[lines], np.ascontiguousarray(middle), np.ascontiguousarray(width))


def in_strip_axes(even: Array, odd: Array, row: Array, column: Array) -> Array:
    """Components (.., nodes, COMPONENTS) from even (.., 5, nodes) and odd (.., 4, nodes) ones in the axes of a body.

    row, column: (.., 2, 2) tangent and normal of the displaced and of the loaded lines.
    """
    xx, yy, yz, zy, zz = np.moveaxis(even, -2, 0)
    xy, xz, yx, zx = np.moveaxis(odd, -2, 0)
    plane = np.stack([np.stack([yy, yz], axis=-1), np.stack([zy, zz], axis=-1)], axis=-2)  # (.., nodes, 2, 2)
    block = row[..., None, :, :] @ plane @ np.swapaxes(column, -1, -2)[..., None, :, :]
    by_column = np.stack([xy, xz], axis=-1) @ np.swapaxes(column, -1, -2)
    by_row = -np.stack([yx, zx], axis=-1) @ np.swapaxes(row, -1, -2)
    tn, nt = block[..., 0, 1], block[..., 1, 0]
    return np.stack(
        [
            xx,
            block[..., 0, 0],
            block[..., 1, 1],
            0.5 * (tn + nt),
            0.5 * (tn - nt),
            0.5 * (by_column[..., 0] + by_row[..., 0]),
            np.zeros_like(xx),
            0.5 * (by_column[..., 1] - by_row[..., 1]),
        ],
        axis=-1,
    )


def far_in_strip_axes(far: Array, row: Array, column: Array) -> Array:
    """Components (.., nodes, COMPONENTS) of the far-field correction (nodes, 3), equal across and along the normal."""
    turned = (row @ np.swapaxes(column, -1, -2))[..., None, :, :]
    zero = np.zeros(np.broadcast_shapes(turned.shape[:-2], far.shape[:1]))
    tn, nt = turned[..., 0, 1], turned[..., 1, 0]
    return np.stack(
        [
            zero + far[:, 0],
            turned[..., 0, 0] * far[:, 1],
            turned[..., 1, 1] * far[:, 2],
            0.5 * (tn + nt) * far[:, 1],
            0.5 * (tn - nt) * far[:, 1],
            zero,
            zero,
            zero,
        ],
        axis=-1,
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
def pair_means(lines: Array, first: int, share: Array, cells: int) -> Array:
    """Coefficients (S, S, cells, DEGREE + 1, COMPONENTS) of pairs i <= j of strips from those of lines (ns, ns, ..).

    share (S, n): weights in the strips of the lines from the first.
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
                        values = lines[first + k, first + m, :cells].ravel()
                        for c in range(len(to)):
                            to[c] += weight * values[c]
    return tables
