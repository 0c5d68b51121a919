"""State of a vehicle: coordinates of its bodies, their rates, spring deflections of Maxwell elements."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from math import inf
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from wheelrail.support.arrays import Array
from wheelrail.vehicle.multibody.vehicle import Vehicle

COORDINATES = ("x", "y", "z", "roll", "pitch", "yaw")  # of a body in the track frame at its own distance
X, Y, Z, ROLL, PITCH, YAW = range(6)
RATE_SCALE = 100.0  # 1/s, tolerance of a rate over that of its coordinate


class VehicleState(NamedTuple):
    """Parts of a state of n bodies.

    Parameters:
        position: (..., n, 6) m and rad: x from the body's place in the reference motion along the track, y and z from
            its nominal position in the track frame at its own distance, roll, pitch and yaw. The pitch of a wheelset
            counts from nominal rolling of the reference motion.
        rate: (..., n, 6) their rates.
        series: (..., m) m, spring deflections of Maxwell elements.
    """

    position: Array
    rate: Array
    series: Array


@dataclass(frozen=True)
class Coordinates:
    """Order of the state (2 c + m,) of a vehicle: c = 6 n coordinates, their rates, m Maxwell elements.

    Parameters:
        vehicle: the bodies and elements.
    """

    vehicle: Vehicle

    @cached_property
    def names(self) -> tuple[str, ...]:
        """Names (c,) such as "front_bogie_yaw"."""
        return tuple(f"{body}_{coordinate}" for body in self.vehicle.names for coordinate in COORDINATES)

    @property
    def count(self) -> int:
        return 6 * len(self.vehicle.names)

    @cached_property
    def maxwell(self) -> tuple[tuple[int, int], ...]:
        """Element and direction of each Maxwell element."""
        elements = self.vehicle.elements.values()
        return tuple((e, j) for e, part in enumerate(elements) for j in range(3) if part.series_stiffness[j] < inf)

    @property
    def size(self) -> int:
        return 2 * self.count + len(self.maxwell)

    def index(self, body: str, coordinate: int) -> int:
        """Index of a coordinate in the state; that of its rate is larger by `count`."""
        return 6 * self.vehicle.names.index(body) + coordinate

    @cached_property
    def wheelset_bodies(self) -> NDArray[np.int64]:
        """Indices of the wheelsets among the bodies."""
        return np.array([self.vehicle.names.index(name) for name in self.vehicle.wheelsets])

    @cached_property
    def rolling_angles(self) -> NDArray[np.int64]:
        """Indices of the wheelsets' pitch, on which no force depends."""
        return np.asarray(6 * self.wheelset_bodies + PITCH)

    def split(self, state: Array) -> VehicleState:
        """Parts of states (..., 2 c + m)."""
        c, shape = self.count, (*state.shape[:-1], len(self.vehicle.names), 6)
        return VehicleState(state[..., :c].reshape(shape), state[..., c : 2 * c].reshape(shape), state[..., 2 * c :])

    def tolerances(self, atol: float) -> Array:
        """Absolute tolerances (2 c + m,) for implicit steps: atol in m and rad, 100 atol in m/s and rad/s.

        The angles of rolling, on which no force depends, have no tolerance of their own.
        """
        result = np.full(self.size, float(atol))
        result[self.count : 2 * self.count] *= RATE_SCALE
        result[self.rolling_angles] = 1e6
        return result
