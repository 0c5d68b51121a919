"""How far a run may go: where a wagon on its track becomes one that overturns, or lies beside the rails."""

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
        shift, lift = min(wheels(dynamics, time, state), key=lambda wheel: wheel[1])
        if abs(roll) > self.roll:
            what = f"the wagon overturns to the {_hand(-roll)}: its car body rolls by {abs(roll):.3f} rad"
        elif abs(shift) > self.shift:
            what = f"the wheelset has left the rails to the {_hand(shift)}: {1e3 * abs(shift):.0f} mm aside"
        elif lift > self.lift:
            what = f"the wheelset has left the rails: both wheels are {1e3 * lift:.0f} mm above them or more"
        else:
            return
        raise OutOfBounds(f"{what} at t = {time:.4g} s, {dynamics.drive(time).distance:.4g} m")


LIMITS = Limits()


def wheels(dynamics: Dynamics, time: float, state: Array) -> list[tuple[float, float]]:
    """Where the lowest points of the left and the right rolling circle are, against the same at rest on their rails:
    shift to the left and lift m.
    """
    half_base, radius = 0.5 * dynamics.track.base, dynamics.wagon.radius
    y, z, roll = float(state[Y]), float(state[Z]), float(state[ROLL])
    c, s = cos(roll), sin(roll)
    rails = dynamics.frame(time).rails or SMOOTH
    return [
        (y - sign * half_base * (1.0 - c) + radius * s - rail_y, z + sign * half_base * s + radius * (1.0 - c) - rail_z)
        for sign, (rail_y, rail_z) in zip((1.0, -1.0), rails, strict=True)
    ]


def whereabouts(dynamics: Dynamics, time: float, state: Array) -> str:
    """Where wheelset and car body are, in words, for whom a contact has no answer there."""
    (shift, left), (_, right) = wheels(dynamics, time, state)
    return (
        f"the left wheel is {1e3 * abs(shift):.1f} mm to the {_hand(shift)}, {1e3 * left:.1f} mm above its rail, "
        f"the right one {1e3 * right:.1f} mm, and the car body rolls by {float(state[CAR_BODY_ROLL]):.3f} rad"
    )


def _hand(y: float) -> str:
    return "left" if y > 0.0 else "right"
