"""Contact of wear on the motions of another one: each wheel is lifted to the height at which it carries its load."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from typing import TYPE_CHECKING

from wheelrail.contact.kinematics.frames import Side
from wheelrail.contact.kinematics.wheelset_state import WheelsetState
from wheelrail.contact.loading.load_search import LoadError, LoadSolution, Results, find_depth_for_load
from wheelrail.contact.results.result import ContactResult
from wheelrail.contact.results.vehicle_contact import VehicleContact
from wheelrail.scenes.builders.wheelset import wheel_scale
from wheelrail.scenes.schema.scene import RunScene

if TYPE_CHECKING:
    from wheelrail.vehicle.multibody.equations import WheelContacts

RTOL = 1e-6  # of the load
LEAST = 1.0  # N, below which a wheel is lifted off the rail


@dataclass(frozen=True)
class LiftedContact:
    """Contact for the wheels of motions at their loads.

    Parameters:
        scene: of this contact.
        contacts: models by wheelset.
        shared: the same as one, in threads.
    """

    scene: RunScene
    contacts: Mapping[str, VehicleContact]
    shared: VehicleContact

    def motion(self) -> LiftedMotion:
        """Wheels of a new motion."""
        return LiftedMotion(self)


@dataclass(frozen=True)
class LiftedMotion:
    """Wheels of a motion, each of which starts from its last solution and its height, m, above that of the motion."""

    of: LiftedContact
    found: dict[tuple[str, Side], tuple[LoadSolution, float]] = field(default_factory=dict)

    def results(self, states: Mapping[str, WheelsetState], contacts: WheelContacts) -> WheelContacts:
        """Results by wheelset and side.

        Parameters:
            states: of the wheelsets.
            contacts: of the motion, whose loads count.

        A load that is not found is a failed result.
        """
        tasks = [
            (name, side, states[name].turning_as(side), float(result.force[2]))
            for name, sides in contacts.items()
            for side, result in sides.items()
        ]
        values = iter(self.of.shared.each(self._lifted, tasks))
        return {name: {side: next(values) for side in sides} for name, sides in contacts.items()}

    def _lifted(self, name: str, side: Side, state: WheelsetState, load: float) -> ContactResult:
        if load < LEAST:
            return ContactResult.separated()
        contact, expected = self.of.contacts[name], wheel_scale(self.of.scene, load)
        if state.friction != 1.0:
            contact = contact.rubbing(state.friction)

        def wheel(depth: float, guess: Results | None) -> Results:
            return (contact(replace(state, z=-depth), side, guess[0] if guess else None),)

        near: list[tuple[Results | None, float | None, float]] = [(None, None, 0.0)]  # guess, slope, lift of starts
        if (name, side) in self.found:
            last, lift = self.found[name, side]
            near.insert(0, (last.results, last.slope, lift))
        for guess, slope, lift in near:
            start = -(state.z + lift)
            try:
                solution = find_depth_for_load(
                    wheel, load, expected=expected, start=start, rtol=RTOL, guess=guess, known_slope=slope
                )
                break
            except LoadError as error:
                failure = f"{error}"
        else:
            return ContactResult.failed(failure)
        self.found[name, side] = solution, -solution.depth - state.z
        return solution.results[0]
