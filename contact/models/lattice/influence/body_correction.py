"""Deviation of finite bodies from half-spaces: tables between lines of the surface, and their means over strips.

The deviation is smooth over the surface and along x, so that tables on coarse cells and linear interpolation between
the lines suffice. The mean over a strip of a function that is linear between lines is a continuously differentiable
function of the strip's place.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from itertools import combinations_with_replacement
from typing import NamedTuple

import numpy as np

from wheelrail.contact.elasticity.half_space import cutoff_correction
from wheelrail.contact.elasticity.waveguide.influence import ElementInfluence
from wheelrail.contact.elasticity.waveguide.spectrum import antiderivative_weights
from wheelrail.contact.models.lattice.influence.bulk import TILE, BulkCompliance, bulk_compliance, hat_integral
from wheelrail.contact.models.lattice.influence.pair_grid import CELLS, CHANGES, COMPONENTS, DEGREE, REACH, PairGrid
from wheelrail.contact.models.lattice.influence.vectors import BYTES, add_multiple
from wheelrail.support.arrays import Array, Mask, Nodes, aligned
from wheelrail.support.cache import cached, digest
from wheelrail.support.compiled import borrowing, compiled

START = 0.04  # m: cells of 5 mm up to this distance; of 2.5 mm, forces change by 1e-6
RECIPROCAL = np.array([1, 1, 1, 1, -1, -1, 1, 1])  # signs of the components of the pair in the other order
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

    @cached_property
    def grid(self) -> PairGrid:
        """Cells along x."""
        return PairGrid.over(START)

    @cached_property
    def weights(self) -> tuple[Array, Array]:
        """Even and odd weights (cells (DEGREE + 1), nk) of the samples of the spectrum in the coefficients of G."""
        even, odd = antiderivative_weights(self.grid.x / self.body.unit, self.body.samples)
        return (
            self.grid.coefficients(even, even=True).reshape(even.shape),
            self.grid.coefficients(odd, even=False).reshape(odd.shape),
        )

    @cached_property
    def _coefficients(self) -> Array:
        """Coefficients (ns, ns, cells, DEGREE + 1, COMPONENTS) between all lines, filled by tiles."""
        lines = len(self.body.arc)
        return aligned((lines, lines, len(self.grid.lower), DEGREE + 1, COMPONENTS))

    @cached_property
    def bulk(self) -> Array:
        """`bulk_compliance` (ns, ns, 2) m/N between all lines, filled like the coefficients."""
        lines = len(self.body.arc)
        return np.zeros((lines, lines, 2))

    @cached_property
    def _filled(self) -> Mask:
        """Pairs of tiles (T, T) between which there are coefficients."""
        tiles = -(-len(self.body.arc) // TILE)
        return np.zeros((tiles, tiles), dtype=bool)

    def bulk_compliance(self, moves: bool) -> BulkCompliance:
        """The same, as far as it is filled; moves: whether strips move on the body."""
        return BulkCompliance(self.body.arc, self.bulk, self._filled, moves, self._ends)

    @cached_property
    def _ends(self) -> Array:
        """Ends (2,) m of the lines."""
        return np.array([self.body.bounds[0], self.body.bounds[-1]])

    def between_lines(self, low: float, high: float) -> tuple[slice, Array]:
        """Lines that cover an interval of arc length m, and coefficients (ns, ns, cells, DEGREE + 1, COMPONENTS) of all
        lines, valid between these. Raises OutsideSurface beyond the lines.
        """
        first, last = self.body.window(low, high)
        first, last = max(first - 2, 0), min(last + 2, len(self.body.arc))
        tiles = slice(first // TILE, -(-last // TILE))
        if not self._filled[tiles, tiles].all():
            for i, j in combinations_with_replacement(range(tiles.start, tiles.stop), 2):
                if not self._filled[i, j]:
                    self._fill(i, j)
        return slice(first, last), self._coefficients

    def _fill(self, i: int, j: int) -> None:
        """Fill the coefficients between two tiles."""
        rows, columns = (slice(TILE * k, min(TILE * (k + 1), len(self.body.arc))) for k in (i, j))
        between = self._between(rows, columns)
        for place, values in (
            ((rows, columns), between),
            ((columns, rows), RECIPROCAL * between.swapaxes(0, 1)),
        ):
            self._coefficients[place] = values
            self.bulk[place] = bulk_compliance(values[:, :, 0], 1 / CELLS, START / CELLS)
        self._filled[i, j] = self._filled[j, i] = True

    def _between(self, rows: slice, columns: slice) -> Array:
        """Coefficients (R, C, cells, DEGREE + 1, COMPONENTS) of the displacement of lines by loads on others, with
        those of unit modulus from the disk cache: reading them takes a tenth of the time.
        """
        name = f"deviation/{self._key}-{rows.start}-{columns.start}"
        values = cached(name, lambda: {"values": self._of_unit_modulus(rows, columns)}, ("values",))["values"]
        return np.asarray(self.body.scale * self.body.unit**2 * values)

    @cached_property
    def _key(self) -> str:
        """Hash of all that the coefficients of unit modulus depend on."""
        body, samples = self.body, self.body.samples
        spectrum = {"k": samples.k, "values": samples.values, "shift": samples.shift, "round": samples.round}
        surface = {"points": body.points, "arc": body.arc, "nu": body.nu, "radius": body.radius, "unit": body.unit}
        cells = START, CELLS, DEGREE, COMPONENTS, REACH, TILE
        return digest(spectrum=spectrum, surface=surface, outward=self.outward, cells=cells, joins=CHANGES)

    def _of_unit_modulus(self, rows: slice, columns: slice) -> Array:
        """Coefficients of a body whose scale and unit are 1."""
        lines = self.body.correction(rows, columns)
        row, column = self._axes(rows)[:, None], self._axes(columns)[None]
        even, odd = (np.moveaxis(part, -1, 2) for part in in_strip_axes(lines.even, lines.odd, row, column))
        values = np.concatenate([self.weights[0] @ even, self.weights[1] @ odd], axis=-1)
        far = self.grid.coefficients(
            cutoff_correction(self.grid.x / self.body.unit, self.body._cutoff, self.body.nu), even=True
        ).reshape(-1, 3)
        stretch = self.body._stretch(self.body.arc)
        mean_stretch = 0.5 * (stretch[rows, None] + stretch[columns])
        values -= far_in_strip_axes(far, row, column) / mean_stretch[..., None, None]
        cells = len(self.grid.lower), DEGREE + 1, COMPONENTS
        return np.asarray(values.reshape(*values.shape[:2], *cells))

    def _axes(self, lines: slice) -> Array:
        """Tangent and normal (n, 2, 2) of lines."""
        tangent = self.body._tangents(self.body.arc[lines])
        return np.stack([tangent, self.outward * np.stack([-tangent[:, 1], tangent[:, 0]], axis=1)], axis=1)

    def shares(self, lines: slice, middle: Array, width: Array) -> Array:
        """Weights (S, lines) of lines in the means over strips with middles and widths (S,) m."""
        return strip_shares(self.body.arc[lines], np.ascontiguousarray(middle), np.ascontiguousarray(width))

    def means(self, middle: Array, width: Array, part: tuple[float, float], cells: int) -> PairMeans:
        """`pair_means` of strips with middles and widths (C,) m, which cover a part of the body between ends m."""
        lines, between = self.between_lines(*part)
        return pair_means(between, lines.start, self.shares(lines, middle, width), cells)

    def share_slopes(self, lines: slice, middle: Array, width: Array) -> Array:
        """Derivatives (S, lines) 1/m of `shares` by the middles."""
        return share_slopes(self.body.arc[lines], np.ascontiguousarray(middle), np.ascontiguousarray(width))


def in_strip_axes(even: Array, odd: Array, row: Array, column: Array) -> tuple[Array, Array]:
    """Components even (.., 5, nk) and odd (.., 3, nk) in x, from those (.., 5, nk) and (.., 4, nk) in a body's axes.

    row, column: (.., 2, 2) tangent and normal of the displaced and of the loaded lines.
    """
    xx, yy, yz, zy, zz = np.moveaxis(even, -2, 0)
    xy, xz, yx, zx = np.moveaxis(odd, -2, 0)
    (ry, rz), (ny, nz) = (np.moveaxis(row[..., k, :, None], -2, 0) for k in range(2))
    (cy, cz), (my, mz) = (np.moveaxis(column[..., k, :, None], -2, 0) for k in range(2))
    by_tangent, by_normal = ((yy * y + yz * z, zy * y + zz * z) for y, z in ((cy, cz), (my, mz)))
    tn, nt = ry * by_normal[0] + rz * by_normal[1], ny * by_tangent[0] + nz * by_tangent[1]
    tt, nn = ry * by_tangent[0] + rz * by_tangent[1], ny * by_normal[0] + nz * by_normal[1]
    xt, xn = xy * cy + xz * cz, xy * my + xz * mz
    tx, nx = -(yx * ry + zx * rz), -(yx * ny + zx * nz)
    return (
        np.stack([xx, tt, nn, 0.5 * (tn + nt), 0.5 * (tn - nt)], axis=-2),
        np.stack([0.5 * (xt + tx), np.zeros_like(xx), 0.5 * (xn - nx)], axis=-2),
    )


def far_in_strip_axes(far: Array, row: Array, column: Array) -> Array:
    """Components (.., n, COMPONENTS) of the far-field correction (n, 3), equal across and along the normal."""
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
def hats(arc: Array, s: Array) -> Array:
    """Values (S, n) at s (S,) m of the functions linear between lines (n,) m, 1 at one and 0 at the others."""
    values = np.zeros((len(s), len(arc)))
    for i in range(len(s)):
        right = min(max(np.searchsorted(arc, s[i]), 1), len(arc) - 1)
        share = min(max((s[i] - arc[right - 1]) / (arc[right] - arc[right - 1]), 0.0), 1.0)
        values[i, right - 1], values[i, right] = 1.0 - share, share
    return values


@compiled
def share_slopes(arc: Array, middle: Array, width: Array) -> Array:
    """Derivatives (S, n) 1/m of `strip_shares` by the middles."""
    low, high = hats(arc, middle - 0.5 * width), hats(arc, middle + 0.5 * width)
    return (high - low) / width.reshape(-1, 1)


@compiled
def strip_shares(arc: Array, middle: Array, width: Array) -> Array:
    """Weights (S, n) of lines (n,) m in the means over strips of functions linear between the lines."""
    share = np.zeros((len(middle), len(arc)))
    for i in range(len(middle)):
        low, high = middle[i] - 0.5 * width[i], middle[i] + 0.5 * width[i]
        for k in range(max(np.searchsorted(arc, low) - 1, 0), min(np.searchsorted(arc, high) + 1, len(arc))):
            share[i, k] = (hat_integral(arc, k, high) - hat_integral(arc, k, low)) / width[i]
    return share


@borrowing
def add_pair_mean(lines: Array, first: int, row: Array, column: Array, to: Array, start: int = 0) -> None:
    """Add the coefficients (cells, DEGREE + 1, COMPONENTS) of a pair of strips from those of lines (ns, ns, ..).

    row, column: (n,) weights of the lines from the first in both strips; start: the first cell.
    """
    count, wide, cells = len(to) * (DEGREE + 1), lines.shape[1], lines.shape[2]
    at, total = lines.ctypes.data, to.ctypes.data
    for k in range(len(row)):
        if row[k] == 0.0:
            continue
        for m in range(len(column)):
            weight = row[k] * column[m]
            if weight != 0.0:
                cell = ((first + k) * wide + first + m) * cells + start
                add_multiple(at + BYTES * (DEGREE + 1) * cell, weight, count, total)


class PairMeans(NamedTuple):
    """Coefficients of the pairs i <= j of C strips, the means over them, computed as far as a pair is looked up.

    Parameters:
        lines: (ns, ns, cells, DEGREE + 1, COMPONENTS) coefficients of pairs of lines.
        first: line from which on the weights count.
        share: (C, n) weights of the lines in the strips.
        values: (C (C + 1) / 2, cells, DEGREE + 1, COMPONENTS), those of a pair in row j (j + 1) / 2 + i.
        known: (C (C + 1) / 2,) number of cells that are computed.
    """

    lines: Array
    first: int
    share: Array
    values: Array
    known: Nodes


NO_MEANS = PairMeans(
    np.zeros((0, 0, 0, DEGREE + 1, COMPONENTS)),
    0,
    np.zeros((0, 0)),
    np.zeros((0, 0, DEGREE + 1, COMPONENTS)),
    np.zeros(0, dtype=np.int64),
)


def pair_means(lines: Array, first: int, share: Array, cells: int) -> PairMeans:
    """Means over strips with weights (C, n), of the first cells."""
    pairs = len(share) * (len(share) + 1) // 2
    values = aligned((pairs, cells, *lines.shape[3:]))
    return PairMeans(lines, first, share, values, np.zeros(pairs, dtype=np.int64))


@borrowing
def pair_row(means: PairMeans, i: int, j: int, cells: int) -> int:
    """Row of the values of a pair i <= j, valid in some first cells."""
    row = j * (j + 1) // 2 + i
    values = means.values[row]
    known, cells = means.known[row], min(cells, len(values))
    if known < cells:
        values[known:cells] = 0.0
        add_pair_mean(means.lines, means.first, means.share[i], means.share[j], values[known:cells], known)
        means.known[row] = cells
    return row


@compiled
def complete_means(means: PairMeans) -> None:
    """Compute the coefficients of all pairs in all cells."""
    for j in range(len(means.share)):
        for i in range(j + 1):
            pair_row(means, i, j, means.values.shape[1])
