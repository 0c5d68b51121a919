"""A mass on one suspension element above a wheelset that is held, for closed forms of elements."""

from __future__ import annotations

from typing import Any

import numpy as np
from linear_creep import LinearCreep

from wheelrail.support.arrays import Array
from wheelrail.vehicle.loads import AppliedLoads, BodyForce
from wheelrail.vehicle.multibody.elements import SuspensionElement
from wheelrail.vehicle.multibody.equations import VehicleDynamics
from wheelrail.vehicle.multibody.vehicle import Vehicle, VehicleBody
from wheelrail.vehicle.track.track import Track

ALL = ("x", "y", "z", "roll", "pitch", "yaw")
MASS = 1000.0  # kg


def on_a_slider(
    force: Any = 0.0, *, direction: int = 1, mass: float = MASS, axle: tuple[str, ...] = ALL, **element: Any
) -> VehicleDynamics:
    """A mass that moves in one direction only, on an element above a wheelset that is held; force N on the mass."""
    held = tuple(name for name in ALL if name != ALL[direction])
    bodies = {
        "mass": VehicleBody(mass, (500.0, 500.0, 500.0), 0.0, 1.0, held=held),
        "axle": VehicleBody(1500.0, (900.0, 100.0, 900.0), 0.0, 0.46, wheelset=True, held=axle),
    }
    others = {"series_stiffness": np.inf, "surge_exponent": 1.0}
    values: dict[str, Any] = {
        key: tuple(value if j == direction else others.get(key, 0.0) for j in range(3))
        for key, value in element.items()
    }
    part = SuspensionElement("mass", "axle", (0.0, 0.0, 1.0), **values)
    loads = AppliedLoads(
        (), (BodyForce("mass", (0.0, 0.0, 1.0), *(force if j == direction else 0.0 for j in range(3))),)
    )
    return VehicleDynamics(Vehicle({**bodies}, {"slider": part}, {}), Track(), LinearCreep(), 20.0, loads=loads)


def matrix_of(dynamics: VehicleDynamics, state: Array) -> Array:
    """Derivatives of the rate (n, n) without contacts."""
    c, size = dynamics.coordinates.count, dynamics.size
    found = np.zeros((size, size))
    found[:c, c : 2 * c] = np.eye(c)
    wrenches = np.zeros((len(dynamics.vehicle.wheelsets), 6))
    found[c:] = dynamics.bodies.derivatives(dynamics.speed_profile(0.0), 0.0, state, wrenches).by_state
    return found
