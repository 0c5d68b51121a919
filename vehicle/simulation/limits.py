"""Limits of a run: overturning and derailment."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from math import cos, sin
from typing import NoReturn

from wheelrail.contact.kinematics.wheelset_state import NO_SHIFT, WheelsetState
from wheelrail.support.arrays import Array
from wheelrail.vehicle.multibody.coordinates import ROLL
from wheelrail.vehicle.multibody.equations import VehicleDynamics


class OutOfBounds(RuntimeError):
    """The vehicle has overturned or derailed: the model is no longer valid."""


SLOWEST = 0.1  # m/s: at 1 m/s2 a vehicle stops within 5 mm, the length of a contact patch; rolling is no longer steady


@dataclass(frozen=True)
class Limits:
    """Bounds beyond which a run ends; infinity is no limit.

    Parameters:
        roll: rad, of a body relative to the track, in roll and yaw; the default exceeds what springs allow with both
            wheels on the rails.
        shift, lift: m, lateral and vertical displacement of the lower wheel relative to its rail; a flange, about
            30 mm thick and 28 mm high, does not guide the wheel beyond the defaults.

    The lift of the other wheel is limited by the roll only. Raises ValueError unless positive.
    """

    roll: float = 0.3
    shift: float = 0.04
    lift: float = 0.03

    def __post_init__(self) -> None:
        for name in ("roll", "shift", "lift"):
            if not getattr(self, name) > 0.0:
                raise ValueError(f"limits: {name} = {getattr(self, name)}: must be positive")

    def check(
        self, dynamics: VehicleDynamics, time: float, state: Array, states: Mapping[str, WheelsetState] | None = None
    ) -> None:
        """Raises OutOfBounds with kind, time and place of the event.

        Parameters:
            dynamics: the equations of motion.
            time: s.
            state: (2 c + m + k,).
            states: of its wheelsets; None: computed.
        """
        distance, _ = dynamics.progress(time, state)
        position = dynamics.coordinates.split(state).position
        for name, (_, _, _, roll, _, yaw) in zip(dynamics.vehicle.names, position.tolist(), strict=True):
            if abs(roll) > self.roll:
                _end(f"the {_words(name)} overturns to the {_hand(-roll)}: roll {abs(roll):.3f} rad", time, distance)
            if abs(yaw) > self.roll:
                _end(f"the {_words(name)} has turned off the track: yaw {yaw:.3f} rad", time, distance)
        for name, of_wheelset in wheels(dynamics, states or dynamics.wheelset_states(time, state)).items():
            shift, lift = min(of_wheelset, key=lambda wheel: wheel[1])
            gone = f"the {_words(name)} has left the rails"
            if abs(shift) > self.shift:
                _end(f"{gone} to the {_hand(shift)}: lateral shift {1e3 * abs(shift):.0f} mm", time, distance)
            if lift > self.lift:
                _end(f"{gone}: both wheels are at least {1e3 * lift:.0f} mm above the rails", time, distance)


def _end(event: str, time: float, distance: float) -> NoReturn:
    """Raises OutOfBounds."""
    raise OutOfBounds(f"{event} at t = {time:.4g} s, {distance:.4g} m")


LIMITS = Limits()


def wheels(dynamics: VehicleDynamics, states: Mapping[str, WheelsetState]) -> dict[str, list[tuple[float, float]]]:
    """Lateral shift (to the left) and lift, m, of the lowest points of each wheelset's rolling circles, relative to
    nominal.
    """
    half_base, radius = 0.5 * dynamics.track.base, dynamics.vehicle.radius
    result = {}
    for name, wheelset in states.items():
        c, s = cos(wheelset.roll), sin(wheelset.roll)
        result[name] = [
            (
                wheelset.y - sign * half_base * (1.0 - c) + radius * s - rail_y,
                wheelset.z + sign * half_base * s + radius * (1.0 - c) - rail_z,
            )
            for sign, (rail_y, rail_z) in zip((1.0, -1.0), wheelset.rail_shift or NO_SHIFT, strict=True)
        ]
    return result


def describe_position(dynamics: VehicleDynamics, time: float, state: Array) -> str:
    """Positions of the wheelsets and roll of the upper bodies in words, for the status of a run with a failed contact
    solve.

    Parameters:
        dynamics: the equations of motion.
        time: s.
        state: (2 c + m + k,).
    """
    texts, several = [], len(dynamics.vehicle.wheelsets) > 1
    for name, ((shift, left), (_, right)) in wheels(dynamics, dynamics.wheelset_states(time, state)).items():
        texts.append(
            f"{_words(name) + ': ' if several else ''}the left wheel is {1e3 * abs(shift):.1f} mm to the "
            f"{_hand(shift)}, {1e3 * left:.1f} mm above its rail, the right wheel {1e3 * right:.1f} mm above its rail"
        )
    position = dynamics.coordinates.split(state).position
    for name, q in zip(dynamics.vehicle.names, position.tolist(), strict=True):
        if not dynamics.vehicle.bodies[name].wheelset:
            texts.append(f"{_words(name)} roll {q[ROLL]:.3f} rad")
    return ", ".join(texts)


def _words(name: str) -> str:
    return name.replace("_", " ")


def _hand(y: float) -> str:
    return "left" if y > 0.0 else "right"
