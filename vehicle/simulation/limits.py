"""Limits of a run: overturning and derailment."""

from __future__ import annotations

from dataclasses import dataclass
from math import cos, sin

from wheelrail.contact.kinematics.wheelset_state import RailShift
from wheelrail.support.arrays import Array
from wheelrail.vehicle.dynamics.equations import Dynamics
from wheelrail.vehicle.dynamics.state import ROLL, Y, Z

CAR_BODY_ROLL = 2
SMOOTH: RailShift = ((0.0, 0.0), (0.0, 0.0))


class OutOfBounds(RuntimeError):
    """The wagon has overturned or derailed: the model is no longer valid."""


@dataclass(frozen=True)
class Limits:
    """Bounds beyond which a run ends; infinity is no limit.

    Parameters:
        roll: rad, of the car body relative to the track; the default exceeds what springs allow with both wheels on
            the rails.
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

    def check(self, dynamics: Dynamics, time: float, state: Array) -> None:
        """Raises OutOfBounds with kind, time and place of the event.

        Parameters:
            dynamics: the equations of motion.
            time: s.
            state: (20 + m,).
        """
        roll = float(state[CAR_BODY_ROLL])
        shift, lift = min(wheels(dynamics, time, state), key=lambda wheel: wheel[1])
        if abs(roll) > self.roll:
            event = f"the wagon overturns to the {_hand(-roll)}: car body roll {abs(roll):.3f} rad"
        elif abs(shift) > self.shift:
            event = f"the wheelset has left the rails to the {_hand(shift)}: lateral shift {1e3 * abs(shift):.0f} mm"
        elif lift > self.lift:
            event = f"the wheelset has left the rails: both wheels are at least {1e3 * lift:.0f} mm above the rails"
        else:
            return
        raise OutOfBounds(f"{event} at t = {time:.4g} s, {dynamics.speed_profile(time).distance:.4g} m")


LIMITS = Limits()


def wheels(dynamics: Dynamics, time: float, state: Array) -> list[tuple[float, float]]:
    """Shift to the left and lift, m, of the lowest points of the left and the right rolling circle relative to their
    nominal position on the rails.

    Parameters:
        dynamics: the equations of motion.
        time: s.
        state: (20 + m,).
    """
    half_base, radius = 0.5 * dynamics.track.base, dynamics.wagon.radius
    y, z, roll = float(state[Y]), float(state[Z]), float(state[ROLL])
    c, s = cos(roll), sin(roll)
    rails = dynamics.frame(time).rails or SMOOTH
    return [
        (y - sign * half_base * (1.0 - c) + radius * s - rail_y, z + sign * half_base * s + radius * (1.0 - c) - rail_z)
        for sign, (rail_y, rail_z) in zip((1.0, -1.0), rails, strict=True)
    ]


def describe_position(dynamics: Dynamics, time: float, state: Array) -> str:
    """Position of wheelset and car body in words, for the status of a run with a failed contact solve.

    Parameters:
        dynamics: the equations of motion.
        time: s.
        state: (20 + m,).
    """
    (shift, left), (_, right) = wheels(dynamics, time, state)
    return (
        f"the left wheel is {1e3 * abs(shift):.1f} mm to the {_hand(shift)}, {1e3 * left:.1f} mm above its rail, "
        f"the right wheel {1e3 * right:.1f} mm above its rail, car body roll {float(state[CAR_BODY_ROLL]):.3f} rad"
    )


def _hand(y: float) -> str:
    return "left" if y > 0.0 else "right"
