"""Energy of a vehicle in its cross-section: bodies that shift, lift and roll on springs above given wheelsets."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from functools import cache

import numpy as np

from wheelrail.support.arrays import Array
from wheelrail.vehicle.multibody.vehicle import Vehicle

Place = Sequence[float]  # y m, z m, roll rad


@dataclass(frozen=True)
class PlanarVehicle:
    """Vehicle whose halves before and behind its middle do the same.

    Parameters:
        vehicle: of the package; only its data are used.
        static: N, load of each vertical spring, by name.
        wheelsets: y m, z m, roll rad, by name.
        cant: rad, of the track, that raises the right rail.
        forces: name of the body, point (y, height above top of rail) m, force (2,) N along y and z.
    """

    vehicle: Vehicle
    static: Mapping[str, float]
    wheelsets: Mapping[str, Place]
    cant: float = 0.0
    forces: Sequence[tuple[str, tuple[float, float], Array]] = ()

    @property
    def free(self) -> list[str]:
        return [name for name in self.vehicle.names if name not in self.wheelsets]

    def energy(self, q: Array) -> float:
        """J, of positions (3 b,) of the free bodies: y, z, roll of each."""
        v = self.vehicle
        at = {**dict(zip(self.free, q.reshape(-1, 3), strict=True)), **self.wheelsets}

        def point(name: str, y: float, height: float) -> Array:
            (py, pz, roll), arm = at[name], np.array([y, height - v.bodies[name].height])
            return np.array([py, pz + v.bodies[name].height]) + turned(roll) @ arm

        total = 0.0
        for name in self.free:
            y, z, _ = at[name]
            total += v.bodies[name].mass * v.gravity * (z * np.cos(self.cant) - y * np.sin(self.cant))
        for name, e in v.elements.items():
            roll = (1.0 - e.turn) * at[e.lower][2] + e.turn * at[e.upper][2]
            gap = turned(roll).T @ (point(e.upper, *e.point[1:]) - point(e.lower, *e.point[1:]))
            for law, x in zip(e.stiffness[1:], gap, strict=True):
                total += 0.5 * law * x**2 if isinstance(law, float) else work(law, x)
            total -= self.static[name] * gap[1]
        for spring in v.rotational_springs.values():
            total += 0.5 * spring.stiffness[0] * (at[spring.upper][2] - at[spring.lower][2]) ** 2
        return float(total - sum(force @ point(name, *where) for name, where, force in self.forces))

    def rest(self) -> dict[str, Array]:
        """y, z, roll of the free bodies in equilibrium, by Newton's method on differences of the energy."""
        count = 3 * len(self.free)
        steps, q = 1e-4 * np.eye(count), np.zeros(count)
        for _ in range(30):
            middle = self.energy(q)
            ahead, behind = (np.array([self.energy(q + sign * own) for own in steps]) for sign in (1.0, -1.0))
            both = np.array([[self.energy(q + own + other) for other in steps] for own in steps])
            slope = 0.5 * (ahead - behind)
            curvature = 0.5 * (both + both.T) - ahead[:, None] - ahead + middle
            np.fill_diagonal(curvature, ahead + behind - 2.0 * middle)
            change = -1e-4 * np.linalg.solve(curvature, slope)
            q += change
            if np.abs(change).max() < 1e-8:
                return dict(zip(self.free, q.reshape(-1, 3), strict=True))
        raise AssertionError("no equilibrium")


def turned(roll: float) -> Array:
    return np.array([[np.cos(roll), -np.sin(roll)], [np.sin(roll), np.cos(roll)]])


STEP = 1e-3  # m: laws have their kinks at multiples


@cache
def _works(law: Callable[[float], float]) -> Array:
    """J, to multiples of the step."""
    forces = np.array([law(STEP * k) for k in range(200)])
    return np.append(0.0, np.cumsum(0.5 * STEP * (forces[1:] + forces[:-1])))


def work(law: Callable[[float], float], x: float) -> float:
    """J, of an odd force law to a deflection."""
    k = int(abs(x) / STEP)
    return float(_works(law)[k] + 0.5 * (law(STEP * k) + law(abs(x))) * (abs(x) - STEP * k))
