"""Deviation of finite bodies from half-spaces: tables between lines of the surface.

The deviation is smooth over the surface and along x, so that tables on coarse cells and linear interpolation between
the lines suffice. The mean over a strip of a function that is linear between lines is a continuously differentiable
function of the strip's place.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np

from wheelrail.bindings._contact import (
    CELLS,
    COMPONENTS,
    DEGREE,
    NN,
    REACH,
    START,
    TILE,
    TN,
    TN_TURN,
    BulkCompliance,
    FiniteBody,
)
from wheelrail.contact.elasticity.half_space import cutoff_correction
from wheelrail.contact.elasticity.waveguide.influence import ElementInfluence
from wheelrail.contact.elasticity.waveguide.spectrum import antiderivative_weights
from wheelrail.contact.models.lattice.influence.pair_grid import CHANGES, PairGrid
from wheelrail.support.arrays import Array, Mask, aligned
from wheelrail.support.cache import cached, digest

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
    def coefficients(self) -> Array:
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

    def finite_body(self, moves: bool) -> FiniteBody:
        """The same for the core, which fills it when needed; moves: whether strips move on the body."""
        ends = np.array([self.body.bounds[0], self.body.bounds[-1]])
        bulk = BulkCompliance(self.body.arc, self.bulk, self._filled, moves, ends)
        return FiniteBody(bulk, self.coefficients, self.fill)

    def fill(self, i: int, j: int) -> None:
        """Fill the coefficients between two tiles."""
        rows, columns = (slice(TILE * k, min(TILE * (k + 1), len(self.body.arc))) for k in (i, j))
        between = self._between(rows, columns)
        for place, values in (
            ((rows, columns), between),
            ((columns, rows), RECIPROCAL * between.swapaxes(0, 1)),
        ):
            self.coefficients[place] = values
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


def bulk_compliance(coefficients: Array, width: float, length: float) -> Array:
    """Normal displacement (.., 2) m/N, apart from each other, by lateral loads and by pressure, from coefficients
    (.., DEGREE + 1, COMPONENTS) of the first cell: it varies little along a contact, and is the mean over 5 mm with
    weights that fall linearly with the distance, 2 (G(l) - G(0)) / l^2 of G'' = C.

    Parameters:
        width: of the cell, in its variable.
        length: m, of the cell.
    """
    rise = np.tensordot(coefficients[..., 1:, :], width ** np.arange(1, DEGREE + 1), axes=(-2, 0))
    mean = 2.0 * rise / length**2
    return np.stack([mean[..., TN_TURN] - mean[..., TN], mean[..., NN]], axis=-1)
