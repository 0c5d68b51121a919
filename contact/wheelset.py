"""Both wheels of a wheelset through one contact model of the left pair."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

from contact.pose import Motion, Mounting, Pose, Side, WheelsetState
from contact.result import ContactResult

ContactModel = Callable[[Pose, Motion, ContactResult | None], ContactResult]


@dataclass(frozen=True)
class WheelsetContact:
    """Contact of one side: state of the wheelset in, `ContactResult` in the track's axes out.

    The moment is about the wheelset's centre. `guess` is an earlier result of the same side.
    """

    model: ContactModel
    mounting: Mounting

    def __call__(self, state: WheelsetState, side: Side, guess: ContactResult | None = None) -> ContactResult:
        seen = state if side == "left" else state.mirrored()
        pose, motion = self.mounting.left_pair(seen)
        result = self.model(pose, motion, guess).about(motion.wheel.reference)
        return result if side == "left" else result.mirrored()
