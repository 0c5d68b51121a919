"""Whether springs and rails hold all bodies of a vehicle in place."""

from __future__ import annotations

import numpy as np

from wheelrail.support.arrays import Array
from wheelrail.vehicle.multibody.coordinates import PITCH, ROLL, YAW, Coordinates, X, Z
from wheelrail.vehicle.multibody.elements import InvalidVehicle
from wheelrail.vehicle.multibody.vehicle import COORDINATES, Vehicle
from wheelrail.vehicle.wagon.force_law import ForceLaw, Law

SLACK = 1e-12  # stiffness of a free motion, over the largest one: round-off
DIRECTIONS = dict(
    zip(COORDINATES, ("along the track", "laterally", "vertically", "in roll", "in pitch", "in yaw"), strict=True)
)


def require_held(vehicle: Vehicle) -> None:
    """Raise InvalidVehicle for a body free to move, naming the body and a direction.

    Parameters:
        vehicle: of which rails hold the wheelsets but for x, and a speed hold the heaviest body along the track.

    A body is free where the stiffness matrix of springs, loads aside, is singular. Springs in series with dampers hold
    nothing at rest; force laws count with their steepest piece, friction sticks.
    """
    coordinates = Coordinates(vehicle)
    unknown = [i for i in coordinates.free.tolist() if i % 6 == X or i // 6 not in coordinates.wheelset_bodies]
    stiffness = _stiffness(vehicle)
    values, shapes = np.linalg.eigh(stiffness[np.ix_(unknown, unknown)])
    if len(values) and values[0] <= SLACK * values[-1]:
        index = unknown[int(np.argmax(np.abs(shapes[:, 0])))]
        name, coordinate = vehicle.names[index // 6], COORDINATES[index % 6]
        raise InvalidVehicle(
            f"bodies.{name}", f"must be held {DIRECTIONS[coordinate]} by a spring, or {coordinate} be one of held"
        )


def _stiffness(vehicle: Vehicle) -> Array:
    """Matrix (6 n, 6 n) N/m, N and N m of the springs, by the coordinates of n bodies."""
    names, bodies = vehicle.names, vehicle.bodies
    result = np.zeros((6 * len(names), 6 * len(names)))
    heaviest = max(bodies, key=lambda name: bodies[name].mass)
    along = 6 * names.index(vehicle.speed_hold.body if vehicle.speed_hold else heaviest) + X
    result[along, along] = 1e6
    for element in vehicle.elements.values():
        moved = np.zeros((3, 6 * len(names)))
        lower = element.point if element.lower_point is None else element.lower_point
        for name, sign, point in ((element.upper, 1.0, element.point), (element.lower, -1.0, lower)):
            body, first = bodies[name], 6 * names.index(name)
            arm = np.array(point) - (body.x, 0.0, body.height)
            moved[:, first + X : first + Z + 1] += sign * np.eye(3)
            for axis, rotation in enumerate((ROLL, PITCH, YAW)):
                moved[:, first + rotation] += sign * np.cross(np.eye(3)[axis], arm)
        if element.lower_point is not None:
            moved[:1] = (np.array(element.point) - lower) / element.length @ moved
        stiffness = np.array([_steepest(law) for law in element.stiffness]) + element.friction_stiffness
        result += moved.T @ (stiffness[:, None] * moved)
    for spring in vehicle.rotational_springs.values():
        turned = np.zeros((3, 6 * len(names)))
        for name, sign in ((spring.upper, 1.0), (spring.lower, -1.0)):
            turned[:, 6 * names.index(name) + ROLL : 6 * names.index(name) + YAW + 1] += sign * np.eye(3)
        result += turned.T @ (np.array(spring.stiffness)[:, None] * turned)
    return result


def _steepest(law: Law) -> float:
    """Largest stiffness N/m."""
    return float(law.slopes.max()) if isinstance(law, ForceLaw) else law
