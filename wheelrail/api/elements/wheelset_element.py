"""Contact of both wheels of a wheelset as an element of a time integration."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from typing import TYPE_CHECKING, Any

import numpy as np

from wheelrail.api.elements.checks import checked_motions, checked_numbers, checked_rates, checked_shifts
from wheelrail.contact.element.contact_element import ContactElement
from wheelrail.contact.element.element_solution import ElementSolution
from wheelrail.contact.kinematics.frames import SIDES, Side
from wheelrail.contact.kinematics.wheelset_state import WheelsetState
from wheelrail.scenes.schema.errors import SceneError

if TYPE_CHECKING:
    from wheelrail.contact.results.vehicle_contact import VehicleContact
    from wheelrail.support.arrays import Array


class WheelsetElement(ContactElement[WheelsetState, Side]):
    """Contact of both wheels of a wheelset as an element of a time integration, from `wheelrail.Wheelset.element`.

    Parameters:
        contact: model of both contacts.
        radius: nominal rolling radius, m.
        default: values of arguments that a solve does not give.
        curvature: of the track, 1/m.

    SI units; x forward, y to the left, z up; forces act on the wheels, moments are about the wheelset's centre. With
    an elastic axle or pads every solve finds the motions of hubs and rails under its loads, and the tangent has them
    follow; the wheelset's centre is the middle of the line through its hubs.
    """

    def __init__(self, contact: VehicleContact, radius: float, default: WheelsetState, curvature: float) -> None:
        super().__init__(contact, SIDES)
        self._default, self._radius, self._curvature = default, radius, curvature

    def solve(
        self,
        *,
        y: float | None = None,
        z: float | None = None,
        roll: float | None = None,
        yaw: float | None = None,
        y_rate: float | None = None,
        z_rate: float | None = None,
        roll_rate: float | None = None,
        yaw_rate: float | None = None,
        pitch_rate: float | None = None,
        speed: float | None = None,
        frame_rate: Sequence[float] | None = None,
        rail_shift: Sequence[Sequence[float]] | None = None,
        wheel_motion: Sequence[Sequence[float]] | None = None,
        rail_motion: Sequence[Sequence[float]] | None = None,
    ) -> ElementSolution[WheelsetState, Side]:
        """Solve both contacts of a trial state, starting from the last accepted one.

        Parameters:
            y, z: position of the wheelset's centre, m, z above the nominal height.
            roll, yaw: rad.
            y_rate, z_rate: m/s.
            roll_rate, yaw_rate: time derivatives of roll and yaw, rad/s.
            pitch_rate: spin about the axle, rad/s, positive when rolling forward; pure rolling by default.
            speed: of the track frame along the track, m/s.
            frame_rate: (3,) angular velocity of the track frame, rad/s; that of the wheelset's curvature by default.
            rail_shift: ((y, z), (y, z)), displacement of the left and the right rail by irregularities, m.
            wheel_motion: of the left and the right wheel about its centre, x, y, z, then about x, y, z in the axes of
                the wheelset; rail_motion: of the left and the right rail, y, z, then roll about the middle of its foot;
                m and rad, 0 by default. Only of an element for a program that knows them, see `Wheelset.element`.

        Other defaults are those of the `Wheelset`. A contact that cannot be solved gives status "failed: ..." and no
        exception. Raises SceneError for values that are not numbers in range, naming argument and value.
        """
        numbers = {
            "y": y,
            "z": z,
            "roll": roll,
            "yaw": yaw,
            "y_rate": y_rate,
            "z_rate": z_rate,
            "roll_rate": roll_rate,
            "yaw_rate": yaw_rate,
            "pitch_rate": pitch_rate,
            "speed": speed,
        }
        given: dict[str, Any] = checked_numbers(numbers)
        if speed is not None:
            given.setdefault("pitch_rate", given["speed"] / self._radius)
            given["frame_rate"] = (0.0, 0.0, given["speed"] * self._curvature)
        if frame_rate is not None:
            given["frame_rate"] = checked_rates("frame_rate", frame_rate)
        if rail_shift is not None:
            given["rail_shift"] = checked_shifts("rail_shift", rail_shift)
        if wheel_motion is not None or rail_motion is not None:
            given["motions"] = self._given_motions(wheel_motion, rail_motion)
        return self.solve_state(replace(self._default, **given))

    def _given_motions(self, wheels: object, rails: object) -> tuple[float, ...]:
        """Motions (18,) of a `FlexibleState`. Raises SceneError, also where the program does not know them."""
        from wheelrail.contact.loading.flexible_state import FlexibleState
        from wheelrail.contact.loading.flexible_wheelset import MIRRORED_HUB, MIRRORED_RAIL

        if not isinstance(self._default, FlexibleState):
            raise SceneError('solve: wheel_motion, rail_motion: allowed only with element(host=["wheels", "rails"])')
        left, right = checked_motions("wheel_motion", np.zeros((2, 6)) if wheels is None else wheels, 3, 3)
        left_rail, right_rail = checked_motions("rail_motion", np.zeros((2, 3)) if rails is None else rails, 2, 1)
        return (*left, *(MIRRORED_HUB * right).tolist(), *left_rail, *(MIRRORED_RAIL * right_rail).tolist())

    def motions(self) -> dict[Side, tuple[Array, Array]]:
        """Motions of the hub (6,) relative to the line through the journals, x, y, z, then about x, y, z, and of the
        rail (3,), y, z, then roll about its foot, m and rad, at the last solved state.

        Raises ValueError when it failed, or there is none, and for rigid axle and clamped rails.
        """
        from wheelrail.contact.loading.quasi_static_contact import QuasiStaticContact

        results = self._solved("motions").results
        if not isinstance(self.contact, QuasiStaticContact):
            raise ValueError("motions: the axle is rigid, and the rails are clamped")
        return {side: self.contact.motions(results[side], side) for side in SIDES}
