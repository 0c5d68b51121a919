"""How far a run may go: where a wagon on its track becomes one that overturns, or lies beside the rails."""

from __future__ import annotations

from dataclasses import dataclass
from math import cos, sin

import numpy as np
from numpy.typing import NDArray

from contact.pose import RailShift
from vehicle.dynamics import Dynamics
from vehicle.state import ROLL, Y, Z

Array = NDArray[np.float64]

CAR_BODY_ROLL = 2
SMOOTH: RailShift = ((0.0, 0.0), (0.0, 0.0))


class OutOfBounds(RuntimeError):
    """The wagon has left what the model describes."""


@dataclass(frozen=True)
class Limits:
    """roll rad of the car body against the track, beyond what springs allow with both wheels down; shift
    and lift m of the lower wheel against its rail: a flange is about 30 mm thick and 28 mm high, so that a rail guides
    no wheel beyond.

    The other wheel may lift as far as the roll permits: it can come down again. Raises ValueError unless positive;
    infinity is no limit.
    """

    roll: float = 0.3
    shift: float = 0.04
    lift: float = 0.03

    def __post_init__(self) -> None:
        for name in ("roll", "shift", "lift"):
            if not getattr(self, name) > 0.0:
                raise ValueError(f"limits: {name} = {getattr(self, name)}: must be positive")

    def check(self, dynamics: Dynamics, time: float, state: Array) -> None:
        """Raises OutOfBounds, which says what has happened, when and where."""
        roll = float(state[CAR_BODY_ROLL])
        shift, lift = lower_wheel(dynamics, time, state)
        if abs(roll) > self.roll:
            side = "left" if roll < 0.0 else "right"
            what = f"the wagon overturns to the {side}: its car body rolls by {abs(roll):.3f} rad"
        elif abs(shift) > self.shift:
            side = "left" if shift > 0.0 else "right"
            what = f"the wheelset has left the rails to the {side}: {1e3 * abs(shift):.0f} mm aside"
        elif lift > self.lift:
            what = f"the wheelset has left the rails: both wheels are {1e3 * lift:.0f} mm above them or more"
        else:
            return
        raise OutOfBounds(f"{what} at t = {time:.4g} s, {dynamics.drive(time).distance:.4g} m")


LIMITS = Limits()


def lower_wheel(dynamics: Dynamics, time: float, state: Array) -> tuple[float, float]:
    """Where the lowest point of the lower wheel's rolling circle is, against the same at rest on its rail: shift to the
    left and lift m.
    """
    half_base, radius = 0.5 * dynamics.track.base, dynamics.wagon.radius
    y, z, roll = float(state[Y]), float(state[Z]), float(state[ROLL])
    c, s = cos(roll), sin(roll)
    rails = dynamics.frame(time).rails or SMOOTH
    below = [
        (z + sign * half_base * s + radius * (1.0 - c) - rail_z, y - sign * half_base * (1.0 - c) + radius * s - rail_y)
        for sign, (rail_y, rail_z) in zip((1.0, -1.0), rails, strict=True)
    ]
    lift, shift = min(below)
    return shift, lift
