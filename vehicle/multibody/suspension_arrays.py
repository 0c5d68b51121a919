"""Suspension elements and rotational springs of a vehicle as arrays."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import NamedTuple

import numpy as np

from wheelrail.support.arrays import Array, Nodes
from wheelrail.vehicle.multibody.coordinates import Coordinates
from wheelrail.vehicle.multibody.static_loads import static_loads


class Ends(NamedTuple):
    """Indices (p,) of the upper and lower bodies of p parts."""

    upper: Nodes
    lower: Nodes

    @classmethod
    def of(cls, names: tuple[str, ...], pairs: Sequence[tuple[str, str]]) -> Ends:
        """Parameters: names of the bodies, and of the upper and lower body of each part."""
        return cls(*np.array([[names.index(name) for name in pair] for pair in pairs], dtype=np.int64).reshape(-1, 2).T)


@dataclass(frozen=True)
class SuspensionArrays:
    """Suspension of a vehicle as arrays.

    Parameters:
        coordinates: of the vehicle.
    """

    coordinates: Coordinates

    @cached_property
    def ends(self) -> Ends:
        pairs = [(part.upper, part.lower) for part in self.coordinates.vehicle.elements.values()]
        return Ends.of(self.coordinates.vehicle.names, pairs)

    @cached_property
    def rotational_ends(self) -> Ends:
        pairs = [(part.upper, part.lower) for part in self.coordinates.vehicle.rotational_springs.values()]
        return Ends.of(self.coordinates.vehicle.names, pairs)

    @cached_property
    def arms(self) -> tuple[Array, Array]:
        """Points (e, 3) m of the elements from the centres of their upper and lower bodies, in the bodies' axes."""
        vehicle = self.coordinates.vehicle
        parts = vehicle.elements.values()
        points = np.array([part.point for part in parts]).reshape(-1, 3)
        lower = np.array([part.point if part.lower_point is None else part.lower_point for part in parts])
        centres = np.array([(body.x, 0.0, body.height) for body in vehicle.bodies.values()])
        return points - centres[self.ends.upper], lower.reshape(-1, 3) - centres[self.ends.lower]

    @cached_property
    def static_loads(self) -> Array:
        return static_loads(self.coordinates.vehicle)
