"""Patch resultants as an array: a seventh of the memory of objects, for the many rows of a run."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, fields
from typing import Any, overload

import numpy as np

from wheelrail.contact.results.result import Patch
from wheelrail.support.arrays import Array

# Numbers of each field of a patch in the order of its values; others are single.
LENGTHS = {"force": 3, "tangential_force": 2, "semi_axes": 2, "wheel_band": 2, "rail_band": 2, "creepage": 3}
_ENDS = np.cumsum([0, *(LENGTHS.get(part.name, 1) for part in fields(Patch))]).tolist()
COLUMNS = {part.name: slice(a, b) for part, a, b in zip(fields(Patch), _ENDS[:-1], _ENDS[1:], strict=True)}
WIDTH: int = _ENDS[-1]


@dataclass(frozen=True, slots=True, eq=False)
class PackedPatches(Sequence[Patch]):
    """Patches of a contact, made at each access.

    Parameters:
        values: (n, WIDTH), numbers of the fields one after another.
    """

    values: Array

    @classmethod
    def of(cls, patches: Sequence[Patch]) -> PackedPatches:
        """The same patches, packed."""
        if isinstance(patches, cls):
            return patches
        numbers = list[float]()
        for patch in patches:
            for name in COLUMNS:
                value = getattr(patch, name)
                numbers.extend(value if name in LENGTHS else (value,))
        return cls(np.array(numbers, dtype=float).reshape(-1, WIDTH))

    def column(self, name: str) -> Array:
        """Values (n,) or (n, length) of a field."""
        values = self.values[:, COLUMNS[name]]
        return values if name in LENGTHS else values[:, 0]

    @overload
    def __getitem__(self, index: int) -> Patch: ...
    @overload
    def __getitem__(self, index: slice) -> tuple[Patch, ...]: ...
    def __getitem__(self, index: int | slice) -> Patch | tuple[Patch, ...]:
        if isinstance(index, slice):
            return tuple(self[i] for i in range(len(self))[index])
        row = self.values[index]
        numbers = {name: row[part].tolist() for name, part in COLUMNS.items()}
        plain: dict[str, Any] = {
            name: tuple(numbers[name]) if name in LENGTHS else numbers[name][0] for name in COLUMNS
        }
        return Patch(**plain | {"force": row[COLUMNS["force"]].copy(), "strips": int(plain["strips"])})

    def __len__(self) -> int:
        return len(self.values)
