"""Wheel unloading on twisted track at walking pace, by continuation of the equilibrium over the twist.

Test twists and the limit of EN 14363 are from memory and not confirmed.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace

import numpy as np

from wheelrail.contact.kinematics.frames import SIDES
from wheelrail.support.arrays import Array
from wheelrail.vehicle.integration.problem import StepFailure
from wheelrail.vehicle.multibody.coordinates import ROLL
from wheelrail.vehicle.multibody.equations import VehicleDynamics, WheelContacts
from wheelrail.vehicle.multibody.vehicle import Vehicle
from wheelrail.vehicle.steady.equilibrium import EquilibriumError, equilibrium, equilibrium_near
from wheelrail.vehicle.track.irregularity import Irregularities
from wheelrail.vehicle.track.track import Track

LIMIT = 0.6  # of the unloading
SPEED = 1.0  # m/s
PLATEAU = 0.3  # m, ahead of and behind each wheelset, of constant cross level
FADE = 80.0  # m, over which the cross level falls to zero beyond the vehicle
LARGEST, SMALLEST = 2e-3, 0.05  # m of cross level in a step of the continuation, and share that is tried at least


@dataclass(frozen=True)
class Twisted:
    """Vehicle on twisted track.

    Parameters:
        cross_level: (w,) m, of the right rail above the left at the wheelsets.
        load: (w, 2) N, Q of the left and right wheels.
        level_load: (w, 2) N, on level track.
    """

    cross_level: Array
    load: Array
    level_load: Array

    @property
    def unloading(self) -> Array:
        """Lost share (w, 2) of each wheel load; negative where a wheel gains."""
        return np.asarray(1.0 - self.load / self.level_load)


def bogies(vehicle: Vehicle) -> list[list[str]]:
    """Wheelsets in groups from the front, each below one frame that carries no wheelset of another group."""
    above = {name: {own.upper for own in vehicle.elements.values() if own.lower == name} for name in vehicle.wheelsets}
    groups: dict[str, list[str]] = {}
    for name in sorted(vehicle.wheelsets, key=lambda name: -vehicle.bodies[name].x):
        carrier = min(above[name], default=name)
        is_frame = any(own.lower == carrier for own in vehicle.elements.values())
        groups.setdefault(carrier if is_frame else name, []).append(name)
    return list(groups.values())


def en_14363_twists(vehicle: Vehicle) -> tuple[float, float]:
    """Twist of the body over the distance of the first and last bogie, and twist of a bogie over its wheelbase."""
    groups = [[vehicle.bodies[name].x for name in group] for group in bogies(vehicle)]
    distance = float(np.mean(groups[0]) - np.mean(groups[-1]))
    base = max(max(group) - min(group) for group in groups)
    body = (15.0 / distance + 2.0) * 1e-3 if distance > 0.0 else 0.0
    return body, (7.0 - 5.0 / base) * 1e-3 if base > 5.0 / 7.0 else 0.0


def cross_levels(vehicle: Vehicle, body: float, bogie: float) -> Array:
    """Cross levels (w,) m at the wheelsets: the body twisted between its first and last bogie, the first bogie twisted
    in the same sense.
    """
    groups = bogies(vehicle)
    middles = [float(np.mean([vehicle.bodies[name].x for name in group])) for group in groups]
    centre, levels = 0.5 * (middles[0] + middles[-1]), dict[str, float]()
    for k, (group, middle) in enumerate(zip(groups, middles, strict=True)):
        for name in group:
            own = bogie * (vehicle.bodies[name].x - middle) if k == 0 else 0.0
            levels[name] = body * (middle - centre) + own
    return np.array([levels[name] for name in vehicle.wheelsets])


def twisted(dynamics: VehicleDynamics, levels: Array) -> Twisted:
    """Equilibrium on straight track with cross levels (w,) m at the wheelsets, from level track in small steps.

    Parameters:
        dynamics: equations of motion; its track and speed are not used.
        levels: m, of the right rail above the left.

    Bodies first turn with their rails. Raises EquilibriumError and StepFailure where a step of the continuation fails.
    """
    vehicle = dynamics.vehicle
    d = replace(dynamics, track=Track(), speed=SPEED)
    start = equilibrium(d)
    place = FADE + float(max(body.x for body in vehicle.bodies.values())) + 10.0
    turns = _turns(vehicle, dict(zip(vehicle.wheelsets, levels.tolist(), strict=True)))
    step = largest = 1.0 / max(int(np.ceil(np.abs(levels).max() / LARGEST)), 1)
    share, state, contacts = 0.0, start.state, start.contacts
    while share < 1.0 - 1e-9:
        step = min(step, 1.0 - share)
        guess = state.copy()
        for name, level in turns.items():
            if not d.coordinates.held[vehicle.names.index(name), ROLL]:
                guess[d.coordinates.index(name, ROLL)] -= step * level / (2.0 * vehicle.wheel_y)
        irregular = _irregularities(vehicle, (share + step) * levels, place)
        try:
            at = equilibrium_near(replace(d, track=Track(irregularities=irregular)), place / SPEED, guess, contacts)
        except (EquilibriumError, StepFailure):
            if step < SMALLEST * largest:
                raise
            step *= 0.5
            continue
        share, state, contacts = share + step, at.state, at.contacts
        step = min(2.0 * step, largest)
    return Twisted(levels, _loads(vehicle, contacts), _loads(vehicle, start.contacts))


def _turns(vehicle: Vehicle, levels: Mapping[str, float]) -> dict[str, float]:
    """Mean cross level m of the wheelsets below each body."""
    below = {name: {own.lower for own in vehicle.elements.values() if own.upper == name} for name in vehicle.names}
    turns = dict(levels)
    for _ in vehicle.names:  # from the wheelsets upwards
        for name, carriers in below.items():
            known = [turns[own] for own in carriers if own in turns]
            if name not in levels and known:
                turns[name] = float(np.mean(known))
    return turns


def _irregularities(vehicle: Vehicle, levels: Array, place: float) -> Irregularities:
    order = np.argsort([vehicle.bodies[name].x for name in vehicle.wheelsets])
    x = np.array([vehicle.bodies[vehicle.wheelsets[k]].x for k in order.tolist()])
    knots = np.stack([x - PLATEAU, x + PLATEAU], axis=1).ravel()
    values = np.repeat(levels[order], 2)
    knots, values = np.append(knots, knots[-1] + FADE), np.append(values, 0.0)
    knots, values = np.append(knots[0] - FADE, knots), np.append(0.0, values)
    s = np.arange(knots[0], knots[-1], 0.05)
    rows = np.zeros((len(s), 4))
    rows[:, 2] = np.interp(s, knots, values)
    rows[[0, -1]] = 0.0
    return Irregularities(place + s, rows)


def _loads(vehicle: Vehicle, contacts: WheelContacts) -> Array:
    return np.array([[contacts[name][side].force[2] for side in SIDES] for name in vehicle.wheelsets])
