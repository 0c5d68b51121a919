"""Static loads of the vertical springs on straight level track."""

from __future__ import annotations

import numpy as np

from wheelrail.support.arrays import Array
from wheelrail.vehicle.multibody.elements import InvalidVehicle
from wheelrail.vehicle.multibody.vehicle import Vehicle
from wheelrail.vehicle.wagon.force_law import ForceLaw

BALANCED = ("z", "roll", "pitch")
UNBALANCED = 1e-9  # of the weight, or of the weight times 1 m


def static_loads(vehicle: Vehicle) -> Array:
    """Vertical forces (e,) N on the upper bodies that carry all bodies but the wheelsets in the nominal position.

    Parameters:
        vehicle: of e suspension elements.

    Of all distributions that balance vertical forces, roll moments and pitch moments where these coordinates are free,
    that of springs on fixed wheelsets: it minimises the sum of F^2 / k. Raises InvalidVehicle for a body that vertical
    springs cannot carry in its nominal position. Parts of a train without elements between them are as if alone.
    """
    loads, elements = np.zeros(len(vehicle.elements)), list(vehicle.elements.values())
    for part in _parts(vehicle):
        own = [e for e, element in enumerate(elements) if element.upper in part]
        loads[own] = _of_part(vehicle, part, own)
    return loads


def _parts(vehicle: Vehicle) -> list[set[str]]:
    """Names of bodies that elements join, of each part."""
    parts = [{name} for name in vehicle.names]
    for element in vehicle.elements.values():
        joined = [part for part in parts if element.upper in part or element.lower in part]
        parts = [part for part in parts if part not in joined] + [set[str]().union(*joined)]
    return parts


def _of_part(vehicle: Vehicle, part: set[str], own: list[int]) -> Array:
    """Loads N of the elements of one part, by their numbers."""
    elements = [list(vehicle.elements.values())[e] for e in own]
    carried = [name for name in vehicle.names if name in part and not vehicle.bodies[name].wheelset]
    rows = {name: 3 * i for i, name in enumerate(carried)}
    balance, weights = np.zeros((3 * len(carried), len(elements))), np.zeros(3 * len(carried))
    for name, row in rows.items():
        weights[row] = vehicle.gravity * vehicle.bodies[name].mass
    stiffness = np.array([_vertical_stiffness(e.stiffness[2]) for e in elements])
    for column, element in enumerate(elements):
        for name, sign in ((element.upper, 1.0), (element.lower, -1.0)):
            if name in rows:
                x, y = element.point[0] - vehicle.bodies[name].x, element.point[1]
                balance[rows[name] : rows[name] + 3, column] = sign, sign * y, -sign * x
    for name, row in rows.items():
        constrained = [coordinate in vehicle.bodies[name].held for coordinate in BALANCED]
        balance[row : row + 3][constrained], weights[row : row + 3][constrained] = 0.0, 0.0
    compliance_root = np.sqrt(stiffness)
    loads = compliance_root * np.linalg.lstsq(balance * compliance_root, weights, rcond=1e-12)[0]
    places = {e: i for i, e in enumerate(own)} | {-1: -1}
    pairs = [(places[left], places[right]) for left, right in vehicle.mirror_pairs if left in places]
    if all(right >= 0 or elements[left].point[1] == 0.0 for left, right in pairs):
        for pair in pairs:  # of a symmetric vehicle equal but for round-off
            if pair[1] >= 0:
                loads[list(pair)] = loads[list(pair)].mean()
    for name, row in rows.items():
        if np.abs((balance @ loads - weights)[row : row + 3]).max() > UNBALANCED * vehicle.weight:
            raise InvalidVehicle(f"bodies.{name}", "must be carried by vertical springs in its nominal position")
    return np.asarray(loads)


def _vertical_stiffness(law: float | ForceLaw) -> float:
    """Stiffness at zero deflection, N/m."""
    if not isinstance(law, ForceLaw):
        return law
    return float(law.slopes[int(np.searchsorted(law.abscissae[1:-1], 0.0, side="right"))])
