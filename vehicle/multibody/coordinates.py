"""State of a vehicle: free coordinates of its bodies, their rates, internal variables of its elements."""

from __future__ import annotations

from collections.abc import Callable, Iterable
from dataclasses import dataclass
from functools import cached_property
from math import inf
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from wheelrail.support.arrays import Array
from wheelrail.vehicle.multibody.elements import SuspensionElement
from wheelrail.vehicle.multibody.vehicle import COORDINATES, Vehicle

X, Y, Z, ROLL, PITCH, YAW = range(6)
RATE_SCALE = 100.0  # 1/s, tolerance of a rate over that of its coordinate


class VehicleState(NamedTuple):
    """Parts of a state of n bodies; held coordinates are zero.

    Parameters:
        position: (..., n, 6) m and rad: x from the body's place in the reference motion along the track, y and z from
            its nominal position in the track frame at its own distance, roll, pitch and yaw. The pitch of a wheelset
            counts from nominal rolling of the reference motion.
        rate: (..., n, 6) their rates.
        series: (..., m) m, internal variables of elements, see `Coordinates.internal`.
    """

    position: Array
    rate: Array
    series: Array


@dataclass(frozen=True)
class Coordinates:
    """Order of the state (2 c + m,) of a vehicle of n bodies: c coordinates, their rates, m components for the internal
    variables of elements. Coordinates are the free ones of 6 n, then the twists of wheelsets with independent wheels.

    Parameters:
        vehicle: the bodies and elements.

    Internal variables of elements that are mirror images of each other have the mean and half the difference of their
    values as components: a mirrored motion changes signs only, and linear systems are eliminated in the same order.
    """

    vehicle: Vehicle

    @cached_property
    def names(self) -> tuple[str, ...]:
        """Names (c,) such as "front_bogie_yaw"."""
        names = [f"{body}_{coordinate}" for body in self.vehicle.names for coordinate in COORDINATES]
        twists = (f"{wheelset}_twist" for wheelset in self.vehicle.independent)
        return (*(names[i] for i in self.free.tolist()), *twists)

    @cached_property
    def held(self) -> NDArray[np.int64]:
        """(n, 6) 1 for held coordinates, otherwise 0."""
        rows = [[int(name in body.held) for name in COORDINATES] for body in self.vehicle.bodies.values()]
        return np.array(rows, dtype=np.int64)

    @cached_property
    def places(self) -> Array:
        """(n,) m, of the bodies along the vehicle."""
        return np.array([body.x for body in self.vehicle.bodies.values()])

    @cached_property
    def free(self) -> NDArray[np.int64]:
        """Indices of the free ones among the 6 n coordinates, body by body."""
        return np.flatnonzero(self.held == 0)

    @cached_property
    def count(self) -> int:
        return len(self.free) + len(self.vehicle.independent)

    @property
    def twists(self) -> slice:
        """Places in the state of the twists: half the angle of the left wheel less that of the right one."""
        return slice(len(self.free), self.count)

    @property
    def twist_rates(self) -> slice:
        """Places in the state of their rates."""
        return slice(self.count + len(self.free), 2 * self.count)

    @cached_property
    def maxwell(self) -> tuple[tuple[int, int], ...]:
        """Element and direction of each Maxwell element."""
        return self._where(lambda part, j: part.series_stiffness[j] < inf)

    @cached_property
    def sliders(self) -> tuple[tuple[int, int], ...]:
        """Element and direction of each slider."""
        return self._where(lambda part, j: part.has_friction(j))

    @cached_property
    def flows(self) -> tuple[tuple[int, int], ...]:
        """Element and direction of each Maxwell element with a mass."""
        return self._where(lambda part, j: part.surge_mass[j] > 0.0)

    def _where(self, has: Callable[[SuspensionElement, int], bool]) -> tuple[tuple[int, int], ...]:
        elements = self.vehicle.elements.values()
        return tuple((e, j) for e, part in enumerate(elements) for j in range(3) if has(part, j))

    @cached_property
    def internal(self) -> dict[tuple[str, int, int], int]:
        """Number among the internal variables by kind, element and direction.

        Kinds are "series", spring deflections m of Maxwell elements; "flow", velocities m/s of masses between their
        springs and dampers; "slider", deflections m at which springs of sliders are unloaded.
        """
        kinds = (("series", self.maxwell), ("flow", self.flows), ("slider", self.sliders))
        return {(kind, *at): m for m, (kind, at) in enumerate((k, p) for k, places in kinds for p in places)}

    @cached_property
    def slider_components(self) -> NDArray[np.int64]:
        """Indices in the state of the components for sliders, which move at the ends of steps only."""
        return self._components("slider")

    @cached_property
    def _flow_components(self) -> NDArray[np.int64]:
        return self._components("flow")

    def _components(self, of: str) -> NDArray[np.int64]:
        numbers = [m for (kind, *_), m in self.internal.items() if kind == of]
        return 2 * self.count + np.array(numbers, dtype=np.int64)

    @cached_property
    def series(self) -> Array:
        """(m, m) internal variables by their components in the state."""
        result = np.eye(len(self.internal))
        for first, second in self.vehicle.mirror_pairs:
            for (kind, e, j), m in self.internal.items():
                if second >= 0 and e == first:
                    pair = [m, self.internal[kind, second, j]]
                    result[np.ix_(pair, pair)] = [[1.0, 1.0], [1.0, -1.0]]
        return result

    @cached_property
    def from_series(self) -> Array:
        """(m, m) inverse of `series`: without round-off."""
        return np.asarray(self.series.T / np.abs(self.series).sum(axis=0)[:, None])

    @cached_property
    def size(self) -> int:
        return 2 * self.count + len(self.internal)

    @cached_property
    def within_all(self) -> NDArray[np.int64]:
        """Indices of the parts of a state but its twists among 6 n coordinates, their rates, and internal variables."""
        total = self.held.size
        return np.concatenate([self.free, total + self.free, 2 * total + np.arange(len(self.internal))])

    @cached_property
    def of_bodies(self) -> NDArray[np.int64]:
        """Indices in the state of its parts but twists and their rates."""
        return np.delete(np.arange(self.size), np.r_[self.twists, self.twist_rates])

    def index(self, body: str, coordinate: int) -> int:
        """Index of a free coordinate in the state; that of its rate is larger by `count`. Raises KeyError."""
        return self._indices[6 * self.vehicle.names.index(body) + coordinate]

    def free_indices(self, body: str, coordinates: Iterable[int]) -> dict[int, int]:
        """Indices in the state of the free ones of some coordinates of a body."""
        first = 6 * self.vehicle.names.index(body)
        return {k: self._indices[first + k] for k in coordinates if first + k in self._indices}

    @cached_property
    def _indices(self) -> dict[int, int]:
        """Index in the state by index among all coordinates."""
        return {full: i for i, full in enumerate(self.free.tolist())}

    @cached_property
    def wheelset_bodies(self) -> NDArray[np.int64]:
        """Indices of the wheelsets among the bodies."""
        return np.array([self.vehicle.names.index(name) for name in self.vehicle.wheelsets])

    @cached_property
    def rolling_angles(self) -> NDArray[np.int64]:
        """Indices in the state of the wheelsets' free pitch, on which no force depends."""
        return np.flatnonzero(np.isin(self.free, 6 * self.wheelset_bodies + PITCH))

    @cached_property
    def forceless(self) -> NDArray[np.int64]:
        """Indices in the state of the angles on which no force depends: of rolling, and twists without a spring."""
        bodies, first = self.vehicle.bodies, self.twists.start
        twists = [first + i for i, name in enumerate(self.vehicle.independent) if bodies[name].torsion[0] == 0.0]
        return np.array([*self.rolling_angles, *twists], dtype=np.int64)

    def of_body(self, index: int) -> NDArray[np.int64]:
        """Indices in the state of the free coordinates of a body."""
        return np.flatnonzero(self.free // 6 == index)

    @cached_property
    def inertia(self) -> Array:
        """(c,) mass kg or moment of inertia kg m2 of each coordinate."""
        rows = [(b.mass, b.mass, b.mass, *b.inertia) for b in self.vehicle.bodies.values()]
        twists = [self.vehicle.bodies[name].inertia[1] for name in self.vehicle.independent]
        return np.concatenate([np.ravel(rows)[self.free], twists])

    def split(self, state: Array) -> VehicleState:
        """Parts of states (..., 2 c + m), to which further components may be appended."""
        shape, total = (*state.shape[:-1], len(self.vehicle.names), 6), self.held.size
        full = self.expanded(state)
        return VehicleState(
            full[..., :total].reshape(shape), full[..., total : 2 * total].reshape(shape), full[..., 2 * total :]
        )

    def expanded(self, state: Array) -> Array:
        """Coordinates, held ones included, their rates, and internal variables of elements, (..., 12 n + m), of states
        (..., 2 c + m); further components are left out.
        """
        full = np.zeros((*state.shape[:-1], 2 * self.held.size + len(self.internal)), state.dtype)
        full[..., self.within_all] = state[..., self.of_bodies]
        if self.internal:
            full[..., 2 * self.held.size :] = state[..., 2 * self.count : self.size] @ self.series.T
        return full

    def tolerances(self, atol: float) -> Array:
        """Absolute tolerances (2 c + m,) for implicit steps: atol in m and rad, 100 atol in m/s and rad/s.

        Angles on which no force depends, as those of rolling, have no tolerance of their own.
        """
        result = np.full(self.size, float(atol))
        result[self.count : 2 * self.count] *= RATE_SCALE
        result[self._flow_components] *= RATE_SCALE
        result[self.forceless] = 1e6
        return result
