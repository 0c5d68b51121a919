"""Contact of a Hertz pair as an element of a time integration."""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING

from wheelrail.api.elements.checks import checked_numbers
from wheelrail.contact.element.contact_element import ContactElement
from wheelrail.contact.element.element_solution import ElementSolution
from wheelrail.contact.kinematics.hertz_state import HertzState

if TYPE_CHECKING:
    from wheelrail.contact.models.hertz import HertzContact, HertzSide


class HertzElement(ContactElement[HertzState, "HertzSide"]):
    """Contact of a Hertz pair as an element of a time integration, from `wheelrail.Hertz.element`; side "contact".

    Parameters:
        contact: model of the pair.
        speed: by default, m/s.

    SI units; forces act on the upper body, moments are about its lowest point in the plane of first contact.
    """

    def __init__(self, contact: HertzContact, speed: float) -> None:
        super().__init__(contact, ("contact",))
        self._default = HertzState(speed=speed)

    def solve(
        self,
        *,
        x: float | None = None,
        y: float | None = None,
        z: float | None = None,
        x_rate: float | None = None,
        y_rate: float | None = None,
        yaw_rate: float | None = None,
        speed: float | None = None,
    ) -> ElementSolution[HertzState, HertzSide]:
        """Solve the contact of a trial state, starting from the last accepted one.

        Parameters:
            x, y, z: position of the upper body from first contact, m; z is the negative approach; 0 by default.
            x_rate, y_rate: velocity of the upper body's material relative to the lower body's, m/s; 0 by default.
            yaw_rate: relative spin about z, rad/s; 0 by default.
            speed: at which the lower body's material flows backwards through the contact, m/s. The rolling speed, to
                which creepages refer, is speed - x_rate / 2.

        A contact that cannot be solved gives status "failed: ..." and no exception. Raises SceneError for values that
        are not numbers in range, naming argument and value.
        """
        numbers = {
            "x": x,
            "y": y,
            "z": z,
            "x_rate": x_rate,
            "y_rate": y_rate,
            "yaw_rate": yaw_rate,
            "speed": speed,
        }
        return self.solve_state(replace(self._default, **checked_numbers(numbers)))
