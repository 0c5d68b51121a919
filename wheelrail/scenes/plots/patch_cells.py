"""Cells of a contact patch in the contact plane."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from wheelrail.scenes.quantity import significant
from wheelrail.support.arrays import Array

if TYPE_CHECKING:
    from xarray import Dataset


@dataclass(frozen=True)
class PatchCells:
    """Loaded cells of one patch in plan view of its contact plane, positive forward and to the left of its resultant.

    Parameters:
        corners: (n, 4, 2), m.
        pressure: (n,), Pa.
        traction: (n, 2), Pa, on the wheel or the upper body.
        slip: (n, 2), over the rolling speed.
        sticks: (n,).
        on: name of the body that tractions act on.
    """

    corners: Array
    pressure: Array
    traction: Array
    slip: Array
    sticks: NDArray[np.bool_]
    on: str

    @property
    def middle(self) -> Array:
        return np.asarray(self.corners.mean(axis=1))

    @property
    def areas(self) -> Array:
        """Area (n,) m2."""
        return np.asarray(np.prod(np.ptp(self.corners, axis=1), axis=-1))

    def spread(self, count: int, only: NDArray[np.bool_] | None = None) -> NDArray[np.int64]:
        """Indices of cells evenly distributed over the patch.

        Parameters:
            count: along the longer side.
            only: (n,) mask of admissible cells.
        """
        box = float(np.ptp(self.middle, axis=0).max()) / count or 1.0
        candidates = np.arange(len(self.pressure)) if only is None else np.flatnonzero(only)
        _, first = np.unique(np.floor(self.middle[candidates] / box), axis=0, return_index=True)
        return np.asarray(candidates[first])

    def stick_edge(self) -> Array:
        """Segments (k, 2, 2), m, of the boundary between sticking and slipping cells."""
        low, high = self.corners.min(axis=1), self.corners.max(axis=1)
        size = high - low
        pieces: list[Array] = []
        for first, second in ((self.sticks, ~self.sticks), (~self.sticks, self.sticks)):
            a, b = np.flatnonzero(first), np.flatnonzero(second)
            for axis in (0, 1):  # common edge normal to this axis
                across = 1 - axis
                distance = np.abs(high[a, None, axis] - low[b, axis])
                start = np.maximum(low[a, None, across], low[b, across])
                stop = np.minimum(high[a, None, across], high[b, across])
                adjacent = distance < 0.2 * np.minimum(size[a, None, axis], size[b, axis])
                least = np.minimum(size[a, None, across], size[b, across])
                i, j = np.nonzero(adjacent & (stop - start > 1e-2 * least))
                side = 0.5 * (high[a[i], axis] + low[b[j], axis])
                ends = np.empty((len(i), 2, 2))
                ends[..., axis] = side[:, None]
                ends[:, 0, across], ends[:, 1, across] = start[i, j], stop[i, j]
                pieces.append(ends)
        return np.concatenate(pieces)

    @classmethod
    def of(cls, data: Dataset, side: str, patch: int) -> PatchCells:
        """Cells of a Dataset of `wheelrail.scenes.datasets.contact`, with true lengths in the contact plane."""
        fields = data.variables  # quicker than by data arrays
        of_patch = (fields["point_side"].values == side) & (fields["point_patch"].values == patch)
        largest = 1.0
        if "share" in data:  # strips of two widths: those with the larger share
            share = np.where(of_patch, fields["share"].values, 0.0)
            largest = share.max()
            of_patch &= share == largest
        point, axes, pressure, area, step = (
            fields[name].values[of_patch] for name in ("position", "axes", "pressure", "area", "step")
        )
        weight = pressure * area
        up = -(weight @ axes[:, 2])
        up /= np.linalg.norm(up)
        forward = np.array([1.0, 0.0, 0.0]) - up[0] * up
        forward /= np.linalg.norm(forward)
        plane = np.column_stack([forward, np.cross(up, forward)])
        half = 0.5 * np.stack([step, area / (step * largest)], axis=1)[..., None] * axes[:, :2]
        signs = np.array([[-1, -1], [1, -1], [1, 1], [-1, 1]])
        middle = point - weight @ point / weight.sum()
        corners = (middle[:, None] + np.einsum("ks,nsc->nkc", signs, half)) @ plane
        traction, slip = (
            np.einsum("ns,nsc->nc", fields[name].values[of_patch], axes[:, :2]) @ plane for name in ("traction", "slip")
        )
        return cls(corners, pressure, traction, slip, fields["sticks"].values[of_patch].astype(bool), upper_body(side))


def upper_body(side: str) -> str:
    """Name of the body that pressure and traction act on."""
    return "upper body" if side == "contact" else "wheel"


def touching(data: Dataset) -> list[tuple[str, int]]:
    """Side and index of every patch of a Dataset of `wheelrail.scenes.datasets.contact`."""
    counts = zip(data.variables["side"].values, data.variables["patches"].values, strict=True)
    return [(str(side), k) for side, count in counts for k in range(int(count))]


def chosen(data: Dataset, side: str | None, patch: int) -> tuple[str, int]:
    """Side and index of a patch; side: by default the first in contact. Raises ValueError naming the available ones."""
    available = touching(data)
    if not available:
        raise ValueError("the bodies are not in contact: no patch to draw")
    key = (available[0][0] if side is None else side, patch)
    if key not in available:
        allowed = ", ".join(f"side = {name!r} with patch = {k}" for name, k in available)
        raise ValueError(f"side = {side!r}, patch = {patch!r}: must be {allowed}")
    return key


def title(data: Dataset, side: str, patch: int) -> str:
    """Title of a patch: side, number if there are several, load."""
    name = "contact" if side == "contact" else f"{side} wheel"
    fields = data.variables
    row = list(fields["side"].values).index(side)
    which = f", patch {patch + 1}" if int(fields["patches"].values[row]) > 1 else ""
    load = 1e-3 * float(fields["patch_normal_force"].values[row, patch])
    return f"{name}{which}: {significant(load)} kN"
