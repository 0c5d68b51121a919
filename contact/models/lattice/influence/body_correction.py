"""Deviation of finite bodies from half-spaces: tables between lines of the surface.

The deviation is smooth over the surface and along x, so that tables on coarse cells and linear interpolation between
the lines suffice. The mean over a strip of a function that is linear between lines is a continuously differentiable
function of the strip's place.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np

from wheelrail.bindings._contact import START, TILE, BodyData, DeviationWeights, FiniteBody
from wheelrail.contact.elasticity.half_space import cutoff_correction
from wheelrail.contact.elasticity.waveguide.influence import ElementInfluence
from wheelrail.contact.elasticity.waveguide.spectrum import antiderivative_weights
from wheelrail.contact.models.lattice.influence.pair_grid import PairGrid
from wheelrail.support.arrays import Array
from wheelrail.support.cache import cached, digest

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
    def weights(self) -> DeviationWeights:
        """How the core finds coefficients of G: sums over `spectra`."""
        body = self.body
        even, odd = antiderivative_weights(self.grid.x / body.unit, body.samples)
        far = cutoff_correction(self.grid.x / body.unit, body._cutoff, body.nu)
        even, odd = np.hstack([even, -far]), np.hstack([odd, np.zeros_like(far)])
        factor, ends = body.scale * body.unit**2, np.array([body.bounds[0], body.bounds[-1]])
        return DeviationWeights(
            np.ascontiguousarray(body.arc),
            ends,
            factor * self.grid.coefficients(even, even=True).reshape(even.shape),
            factor * self.grid.coefficients(odd, even=False).reshape(odd.shape),
        )

    def finite_body(self, moves: bool) -> FiniteBody:
        """Deviation from a half-space for the core, evaluated on demand; moves: whether strips move on the body."""
        return FiniteBody(self.weights, moves, self.spectra)

    def data(self) -> BodyData:
        """Weights and all spectra, for the native library."""
        tiles = range(-(-len(self.body.arc) // TILE))
        return BodyData(self.weights, np.concatenate([self.spectra(i, j).ravel() for i in tiles for j in tiles[i:]]))

    def spectra(self, i: int, j: int) -> Array:
        """Spectra (R, C, SPECTRA, nk + 3) of the displacement of the lines of a tile by loads on another tile. Spectra
        of unit modulus come from the disk cache: reading takes a tenth of the time. The last three are factors of the
        correction in the far field.
        """
        rows, columns = (slice(TILE * k, min(TILE * (k + 1), len(self.body.arc))) for k in (i, j))
        name = f"deviation/{self._key}-{i}-{j}"
        values = cached(name, lambda: {"values": self._spectra(rows, columns)}, ("values",))["values"]
        return np.asarray(values)

    @cached_property
    def _key(self) -> str:
        """Hash of all that the spectra of unit modulus depend on."""
        body, samples = self.body, self.body.samples
        spectrum = {"k": samples.k, "values": samples.values, "shift": samples.shift, "round": samples.round}
        surface = {"points": body.points, "arc": body.arc, "nu": body.nu, "radius": body.radius, "unit": body.unit}
        return digest(spectrum=spectrum, surface=surface, outward=self.outward, tile=TILE)

    def _spectra(self, rows: slice, columns: slice) -> Array:
        """Spectra of a body whose scale and unit are 1."""
        lines = self.body.correction(rows, columns)
        row, column = self._axes(rows)[:, None], self._axes(columns)[None]
        even, odd = in_strip_axes(lines.even, lines.odd, row, column)
        stretch = self.body._stretch(self.body.arc)
        far = far_in_strip_axes(row, column) / (0.5 * (stretch[rows, None] + stretch[columns]))[..., None, None]
        far = np.concatenate([far, np.zeros((*far.shape[:2], odd.shape[2], 3))], axis=2)
        return np.ascontiguousarray(np.concatenate([np.concatenate([even, odd], axis=2), far], axis=3))

    def _axes(self, lines: slice) -> Array:
        """Tangent and normal (n, 2, 2) of lines."""
        tangent = self.body._tangents(self.body.arc[lines])
        return np.stack([tangent, self.outward * np.stack([-tangent[:, 1], tangent[:, 0]], axis=1)], axis=1)


def in_strip_axes(even: Array, odd: Array, row: Array, column: Array) -> tuple[Array, Array]:
    """Components even (.., 5, nk) and odd (.., 2, nk) in x, from components (.., 5, nk), (.., 4, nk) in body axes.

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
        np.stack([0.5 * (xt + tx), 0.5 * (xn - nx)], axis=-2),
    )


def far_in_strip_axes(row: Array, column: Array) -> Array:
    """Factors (.., 5, 3) of the correction in the far field, (3,) along x, across and along the normal, in the even
    components; that along the normal is equal across and along it.
    """
    turned = row @ np.swapaxes(column, -1, -2)
    factors = np.zeros((*turned.shape[:-2], 5, 3))
    tn, nt = turned[..., 0, 1], turned[..., 1, 0]
    factors[..., 0, 0], factors[..., 1, 1], factors[..., 2, 2] = 1.0, turned[..., 0, 0], turned[..., 1, 1]
    factors[..., 3, 1], factors[..., 4, 1] = 0.5 * (tn + nt), 0.5 * (tn - nt)
    return factors
