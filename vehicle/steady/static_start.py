"""Initial guess of an equilibrium: bodies above one another at the height at which the contacts carry the vehicle."""

from __future__ import annotations

import numpy as np

from wheelrail.support.arrays import Array
from wheelrail.vehicle.integration.problem import StepFailure
from wheelrail.vehicle.multibody.coordinates import ROLL, Y, Z
from wheelrail.vehicle.multibody.equations import VehicleDynamics, WheelContacts, side_wrenches
from wheelrail.vehicle.steady.steady_problem import SteadyProblem

MOST_ROLL = 5e-3  # rad: 7 mm difference of the wheels' radii
UNEVEN = 0.8  # difference of the wheels' loads over the weight, above which the wheelsets are rolled
REACH = 0.05  # m from the nominal height


class StaticStart:
    """Static state of upright bodies, axle and rails without load.

    Parameters:
        problem: unbalanced forces.
    """

    def __init__(self, problem: SteadyProblem) -> None:
        self.problem, self.dynamics = problem, problem.dynamics
        coordinates = self.dynamics.coordinates
        kinds = coordinates.free % 6
        self.heights = np.flatnonzero(kinds == Z)
        wheelsets = np.isin(coordinates.free // 6, coordinates.wheelset_bodies)
        self.rolls = np.flatnonzero((kinds == ROLL) & wheelsets)

    def __call__(self) -> Array:
        """State (2 c + m + k,) at the height where the contacts carry the weight within 2 %.

        Where the wheels of one side then carry nearly all, as with wheels of different radii, at the roll of the
        wheelsets at which both sides carry the same load within 5 %. Raises StepFailure.
        """
        roll, low, high = 0.0, -MOST_ROLL, MOST_ROLL
        state, uneven = self._at_roll(roll)
        while abs(uneven) > (UNEVEN if roll == 0.0 else 0.05):
            low, high = (roll, high) if uneven > 0.0 else (low, roll)  # roll lifts the left wheel
            if high - low < 1e-9:
                raise StepFailure("no roll of the wheelset at which both wheels carry the same load")
            roll = 0.5 * (low + high)
            state, uneven = self._at_roll(roll)
        return state

    def _at_roll(self, roll: float) -> tuple[Array, float]:
        """State at the height for the weight, and load of the left less the right wheels over the weight.

        roll: of the wheelsets, rad.
        """
        state, weight = above_one_another(self.dynamics), self.dynamics.vehicle.weight
        state[self.rolls] = roll
        contacts: WheelContacts | None = None

        def load_fraction(z: float) -> float:
            nonlocal contacts
            state[self.heights] = z
            contacts = self.problem.contacts(state, contacts)
            # A Hertzian force grows as depth^(3/2): its power 2/3 is nearly straight.
            return float(np.cbrt(max(_loads(contacts).sum(), 0.0) / weight) ** 2)

        z, stride = 0.0, 5e-5
        fraction = load_fraction(z)
        direction = -1.0 if fraction < 1.0 else 1.0
        other, other_fraction = z, fraction
        while (other_fraction < 1.0) == (fraction < 1.0):
            if abs(other) > REACH:
                raise StepFailure(f"the wheels do not carry the vehicle within {1e3 * REACH:g} mm of its height")
            z, fraction = other, other_fraction
            try:
                other_fraction = load_fraction(z + direction * stride)
            except StepFailure:
                if stride < 1e-7:
                    raise
                stride *= 0.25  # too deep for the contact model
                continue
            other, stride = z + direction * stride, 1.5 * stride
        for _ in range(40):
            middle = z + (1.0 - fraction) * (other - z) / (other_fraction - fraction)
            value = load_fraction(middle)
            if abs(value - 1.0) < 0.013:
                break
            if (value < 1.0) == (fraction < 1.0):
                z, fraction = middle, value
            else:
                other, other_fraction = middle, value
        assert contacts is not None
        left, right = _loads(contacts)
        return state, float((left - right) / weight)


def _loads(contacts: WheelContacts) -> Array:
    """Vertical forces (2,) N of all left and all right wheels."""
    return np.asarray(np.array([side_wrenches(sides)[:, 2] for sides in contacts.values()]).sum(axis=0))


def above_one_another(dynamics: VehicleDynamics) -> Array:
    """State (2 c + m + k,) with bodies at their nominal heights, in a curve centred above their supporting bodies.

    In a curve of curvature k a body that is carried at a distance a before and behind its centre is k a^2 / 2 inwards
    of its own section's centre line.
    """
    vehicle, coordinates = dynamics.vehicle, dynamics.coordinates
    state = np.zeros(dynamics.size)
    curvature = dynamics.track.curvature(0.0)[0]
    offset = dict.fromkeys(vehicle.wheelsets, 0.0)
    while len(offset) < len(vehicle.names):
        carried = {part.upper for part in vehicle.elements.values() if part.lower in offset} - set(offset)
        if not carried:
            break
        for name in carried:
            held = "y" in vehicle.bodies[name].held
            offset[name] = 0.0 if held else _carried_offset(dynamics, name, offset, curvature)
    for name, y in offset.items():
        if y != 0.0:
            state[coordinates.index(name, Y)] = y
    # Independent wheels roll: the inner one more slowly.
    free = np.isin(range(dynamics.size)[coordinates.twists], coordinates.forceless)
    spin = dynamics.speed_profile(0.0).speed / vehicle.radius
    state[coordinates.twist_rates] = np.where(free, -spin * vehicle.wheel_y * curvature, 0.0)
    return state


def _carried_offset(dynamics: VehicleDynamics, name: str, offset: dict[str, float], curvature: float) -> float:
    """Lateral position m of a body centred above its supporting bodies, on average over its elements."""
    bodies = dynamics.vehicle.bodies
    values = []
    for part in dynamics.vehicle.elements.values():
        if part.upper == name and part.lower in offset:
            from_lower, from_upper = part.point[0] - bodies[part.lower].x, part.point[0] - bodies[name].x
            values.append(offset[part.lower] + 0.5 * curvature * (from_upper**2 - from_lower**2))
    return float(np.mean(values))
