"""Compliance of a body invariant along x or in angle, from its spectrum; same interface as `SurfaceCompliance`."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, field
from functools import cached_property
from typing import TYPE_CHECKING

import numpy as np

from wheelrail.contact.elasticity.compliance import block_diagonal
from wheelrail.contact.elasticity.solid_compliance import ALL
from wheelrail.contact.elasticity.waveguide.spectrum import ComplianceSpectrum, pair_indices
from wheelrail.support.arrays import Array, Mask, Nodes

if TYPE_CHECKING:
    import scipy.sparse as sp

TILE = 16  # lines transformed together; a patch covers a few tiles


@dataclass
class WaveguideCompliance:
    """Compliance of an (nx, ns) grid of cells by inverse transform of a spectrum, computed on demand.

    Parameters:
        spectrum: returns the samples, called at the first use.
        shape: (nx, ns).
        step: m, length of the cells along x.
        radius: m, of the circle on which x is measured on a body of revolution about y; None: prismatic.
        scale: factor from the spectrum to m/N; a block of unit size and modulus serves all sizes: 1 / (E h).
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
        """The spectrum. Raises ValueError for a different number of lines."""
        spectrum = self.spectrum()
        if spectrum.lines != self.shape[1]:
            raise ValueError(f"the spectrum has {spectrum.lines} lines, the grid {self.shape[1]}: they must be equal")
        return spectrum

    @cached_property
    def _weights(self) -> tuple[Array, Array]:
        even, odd = self.samples.weights(np.arange(self.shape[0], dtype=np.float64) * self.step, self.step)
        return even * self.scale, odd * self.scale

    @cached_property
    def _table(self) -> Array:
        # by line of the displacement, line of the load, rows between; untouched pages occupy no memory
        nx, ns = self.shape
        return np.empty((ns, ns, nx, 3, 3))

    @cached_property
    def _pair(self) -> Nodes:
        """Index of the pairs s <= t of lines in the spectrum."""
        return pair_indices(self.shape[1])

    def block(self, nodes: Nodes, directions: Sequence[int] = ALL) -> Array:
        """Symmetric compliance (d n, d n) [m/N], see `Compliance.turned`."""
        turn, matrix = self.turned(nodes, directions)
        return np.asarray(turn @ (turn @ matrix).T)

    def turned(self, nodes: Nodes, directions: Sequence[int] = ALL) -> tuple[sp.csr_array, Array]:
        """Compliance in the axes of the section at each node, see `Compliance.turned`."""
        nx, ns = self.shape
        row, line = np.divmod(nodes, ns)
        self._fill(np.unique(line // TILE))
        between = row[:, None] - row
        index = (line[:, None] * ns + line) * nx + np.abs(between)
        blocks = self._table.reshape(-1, 9).take(index.ravel(), axis=0).reshape(len(nodes), len(nodes), 3, 3)
        own = directions if self.radius is None else ALL
        if 0 in own:
            # coupling of x with the other directions is odd in x
            blocks[:, :, 0, 1:] *= np.sign(between)[..., None]
            blocks[:, :, 1:, 0] *= np.sign(between)[..., None]
        if len(own) < 3:
            blocks = blocks[:, :, own][..., own]
        matrix = np.asarray(blocks.transpose(0, 2, 1, 3).reshape(len(own) * len(nodes), -1))
        turns = np.tile(np.eye(3), (len(nodes), 1, 1))
        if self.radius is not None:  # (x, y, z), the contact at the bottom, of (along the circle, y, outward)
            c, s = np.cos(self._angle(row)), np.sin(self._angle(row))
            turns[:, 0, 0], turns[:, 0, 2], turns[:, 2, 0], turns[:, 2, 2] = c, s, s, -c
        return block_diagonal(turns[:, directions][..., own]), matrix

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
        """Fill the table between two ranges of lines, the first not after the second."""
        pair = self._pair[first, second]
        values = self.samples.values[:, pair]  # (nk, s, t, 3, 3)
        if first == second:
            low = np.tril_indices(len(pair), -1)
            values[:, low[0], low[1]] = values[:, low[1], low[0]].swapaxes(-1, -2)
        even, odd = self._weights
        cosine = np.einsum("xk,kstab->stxab", even, values, optimize=True)
        # u_x = -i U_x: a lateral load displaces x by +sin, a load along x displaces the others by -sin
        sine = np.einsum(
            "xk,kstc->stxc", odd, np.concatenate([values[..., 0, 1:], values[..., 1:, 0]], -1), optimize=True
        )
        cosine[..., 0, 1:], cosine[..., 1:, 0] = sine[..., :2], -sine[..., 2:]
        self._table[first, second] = cosine
        if first != second:
            reciprocal = cosine.transpose(1, 0, 2, 4, 3).copy()
            reciprocal[..., 0, 1:] *= -1
            reciprocal[..., 1:, 0] *= -1
            self._table[second, first] = reciprocal
