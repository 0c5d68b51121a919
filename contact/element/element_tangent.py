"""Derivatives of the forces of a contact element, with names of rows and columns."""

from __future__ import annotations

from dataclasses import dataclass
from typing import ClassVar

import numpy as np

from wheelrail.contact.element.element_solution import ArrayBySide
from wheelrail.support.arrays import Array


@dataclass(frozen=True, eq=False)
class ElementTangent:
    """Derivatives of force and moment of all sides by position and velocity.

    Parameters:
        values: (sides, 6, n) in N and N m per m, rad, m/s and rad/s.
        sides: names along the first axis.
        columns: names of the n coordinates along the last axis.
    """

    rows: ClassVar[tuple[str, ...]] = ("Fx", "Fy", "Fz", "Mx", "My", "Mz")

    values: Array
    sides: tuple[str, ...]
    columns: tuple[str, ...]

    @property
    def force(self) -> ArrayBySide:
        """Derivative (3, n) of the force of each side."""
        return dict(zip(self.sides, self.values[:, :3], strict=True))

    @property
    def moment(self) -> ArrayBySide:
        """Derivative (3, n) of the moment of each side."""
        return dict(zip(self.sides, self.values[:, 3:], strict=True))

    def by(self, *names: str) -> Array:
        """Derivatives (sides, 6, len(names)) by some coordinates. Raises ValueError for an unknown name."""
        unknown = [name for name in names if name not in self.columns]
        if unknown:
            raise ValueError(f"tangent by {unknown[0]!r}: must be one of {', '.join(self.columns)}")
        return np.asarray(self.values[:, :, [self.columns.index(name) for name in names]])

    @property
    def coords(self) -> list[tuple[str, tuple[str, ...]]]:
        """Names along each axis: `xarray.DataArray(tangent.values, tangent.coords)` is the labelled array."""
        return [("side", self.sides), ("row", self.rows), ("column", self.columns)]
