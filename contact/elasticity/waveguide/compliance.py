"""Compliance of a body invariant along x or in angle, from its spectrum: a drop-in for `SurfaceCompliance`."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, field
from functools import cached_property

import numpy as np

from wheelrail.contact.elasticity.solid_compliance import ALL
from wheelrail.contact.elasticity.waveguide.spectrum import ComplianceSpectrum, pair_places
from wheelrail.support.arrays import Array, Mask, Nodes

TILE = 16  # lines transformed together: a patch touches a few tiles


@dataclass
class WaveguideCompliance:
    """Compliance of an (nx, ns) grid of cells of the length step [m] along x, transformed back where it is asked for.

    spectrum fetches the samples when first needed. radius [m] of the circle on which x is counted for a body of
    revolution about y (None: prismatic). scale turns what the spectrum gives into m/N (a block of unit size and modulus
    serves all sizes: 1 / (E h)).
    """

    spectrum: Callable[[], ComplianceSpectrum]
    shape: tuple[int, int]
    step: float
    radius: float | None = None
    scale: float = 1.0
    _filled: Mask = field(init=False, repr=False)

    def __post_init__(self) -> None:
        count = -(-self.shape[1] // TILE)
        self._filled = np.zeros((count, count), dtype=bool)

    @cached_property
    def samples(self) -> ComplianceSpectrum:
        """The spectrum. Raises ValueError when it belongs to another number of lines."""
        found = self.spectrum()
        if found.lines != self.shape[1]:
            raise ValueError(f"a spectrum of {found.lines} lines cannot serve a grid of {self.shape[1]}")
        return found

    @cached_property
    def _weights(self) -> tuple[Array, Array]:
        even, odd = self.samples.weights(np.arange(self.shape[0], dtype=np.float64) * self.step, self.step)
        return even * self.scale, odd * self.scale

    @cached_property
    def _table(self) -> Array:
        # by line of the displacement, line of the load, rows between; memory that is never touched is never taken
        nx, ns = self.shape
        return np.empty((ns, ns, nx, 3, 3))

    @cached_property
    def _pair(self) -> Nodes:
        """Place of the pairs s <= t of lines in the spectrum."""
        return pair_places(self.shape[1])

    def block(self, nodes: Nodes, directions: Sequence[int] = ALL) -> Array:
        """Symmetric compliance (d n, d n) [m/N] between grid nodes (n,) along the given axes, node by node."""
        nx, ns = self.shape
        row, line = np.divmod(nodes, ns)
        self._fill(np.unique(line // TILE))
        between = row[:, None] - row
        place = (line[:, None] * ns + line) * nx + np.abs(between)
        found = self._table.reshape(-1, 9).take(place.ravel(), axis=0).reshape(len(nodes), len(nodes), 3, 3)
        if self.radius is not None or 0 in directions:
            # what couples x with the others is odd in x
            found[:, :, 0, 1:] *= np.sign(between)[..., None]
            found[:, :, 1:, 0] *= np.sign(between)[..., None]
        if self.radius is not None:
            out = found.transpose(0, 2, 1, 3).reshape(3 * len(nodes), -1)
            turned = _turned(_turned(out, self._angle(row)).T, self._angle(row))
            if len(directions) == 3:
                return turned
            return turned.reshape(len(nodes), 3, -1, 3)[:, directions][..., directions].reshape(
                len(directions) * len(nodes), -1
            )
        if len(directions) < 3:
            found = found[:, :, directions][..., directions]
        return np.asarray(found.transpose(0, 2, 1, 3).reshape(len(directions) * len(nodes), -1))

    def _angle(self, row: Nodes) -> Array:
        """Angle of rows about the axle, forward from straight below, rad."""
        return np.asarray((row - self.shape[0] // 2) * self.step / (self.radius or 1.0))

    def _fill(self, tiles: Nodes) -> None:
        for i in tiles:
            for j in tiles[tiles >= i]:
                if not self._filled[i, j]:
                    self._transform(slice(TILE * i, TILE * (i + 1)), slice(TILE * j, TILE * (j + 1)))
                    self._filled[i, j] = self._filled[j, i] = True

    def _transform(self, first: slice, second: slice) -> None:
        """Table between two runs of lines, the first not after the second."""
        pair = self._pair[first, second]
        values = self.samples.values[:, pair]  # (nk, s, t, 3, 3)
        if first == second:
            low = np.tril_indices(len(pair), -1)
            values[:, low[0], low[1]] = values[:, low[1], low[0]].swapaxes(-1, -2)
        even, odd = self._weights
        back = np.einsum("xk,kstab->stxab", even, values, optimize=True)
        # u_x = -i U_x: a lateral load moves x by +sin, a load along x moves the others by -sin
        sine = np.einsum(
            "xk,kstc->stxc", odd, np.concatenate([values[..., 0, 1:], values[..., 1:, 0]], -1), optimize=True
        )
        back[..., 0, 1:], back[..., 1:, 0] = sine[..., :2], -sine[..., 2:]
        self._table[first, second] = back
        if first != second:
            reciprocal = back.transpose(1, 0, 2, 4, 3).copy()
            reciprocal[..., 0, 1:] *= -1
            reciprocal[..., 1:, 0] *= -1
            self._table[second, first] = reciprocal


def _turned(rows: Array, angle: Array) -> Array:
    """Rows (along the circle, y, outward) of every node turned into (x, y, z), the contact at the bottom."""
    c, s = np.cos(angle)[:, None], np.sin(angle)[:, None]
    out = rows.copy(order="C")
    out[0::3] = c * rows[0::3] + s * rows[2::3]
    out[2::3] = s * rows[0::3] - c * rows[2::3]
    return out
