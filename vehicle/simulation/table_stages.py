"""Inner stages of steps on a table of contact forces, corrected to value and slope of the contact at their start."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from typing import NamedTuple

import numpy as np

from wheelrail.contact.element.contact_element import ContactElement
from wheelrail.contact.kinematics.copies import changed
from wheelrail.contact.kinematics.frames import SIDES, Side
from wheelrail.contact.kinematics.wheelset_state import NO_SHIFT, WheelsetState
from wheelrail.contact.results.result import ContactResult
from wheelrail.contact.results.vehicle_contact import FrictionAlong, IndependentWheels, VehicleContact, WrappedContact
from wheelrail.support.arrays import Array
from wheelrail.vehicle.integration.problem import HasDerivatives, RightHandSide
from wheelrail.vehicle.multibody.equations import VehicleDynamics, VehicleEvaluation
from wheelrail.vehicle.multibody.jacobian import VehicleLinearisation, by_speed


class Correction(NamedTuple):
    """Difference of the contact from the table, linear around the state of a wheel at the start of a step.

    Parameters:
        result: of the contact there.
        at: (n + 1,) values of the state, see `values_on_rail`.
        offset: (6,) N and N m.
        slope: (6, n + 1).
    """

    result: ContactResult
    at: Array
    offset: Array
    slope: Array


def values_on_rail(state: WheelsetState, side: Side, radius: float) -> Array:
    """Values (n + 1,) of a state by which forces of a side vary: its coordinates relative to the rail, and the speed.

    Parameters:
        state: of the wheelset.
        side: of the wheel.
        radius: height m of the wheelset's centre over the origin of the track frame.

    The motion of the track frame is that of all bodies against the rail: to first order in yaw and roll its rotation is
    added to the rates and the speed.
    """
    values = np.array([*(getattr(state, name) for name in WheelsetState.coordinates), *_motions(state), state.speed])
    (wx, wy, wz), y, z = state.frame_rate, state.y, radius + state.z
    shift = (state.rail_shift or NO_SHIFT)[SIDES.index(side)]
    values[:2] -= shift
    values[4:9] += -wx * z, wx * y, wx, wz, wy
    values[-1] += wy * z - wz * y
    return values


def _motions(state: WheelsetState) -> tuple[float, ...]:
    return getattr(state, "motions", ())


class CorrectedTable(WrappedContact):
    """Contact of the inner stages of a step.

    Parameters:
        contact: solved where the table or its correction is not known.
        table: of forces.
        corrections: by wheelset and side.
        radius: see `values_on_rail`.

    F(x) = T(x) + [F(x_n) - T(x_n)] + [F'(x_n) - T'(x_n)] (x - x_n), T the table's force. Results have the warm start of
    the contact at x_n.
    """

    def __init__(
        self,
        contact: VehicleContact,
        table: VehicleContact,
        corrections: Mapping[tuple[str, Side], Correction],
        radius: float,
    ) -> None:
        super().__init__(contact)
        self.table, self.corrections, self.radius = table, corrections, radius

    def solve_side(
        self, states: Sequence[WheelsetState], side: Side, guesses: Sequence[ContactResult | None]
    ) -> list[ContactResult]:
        looked_up = self.table.solve_side(states, side, [None] * len(states))
        results = [self._corrected(*pair, side) for pair in zip(states, looked_up, strict=True)]
        missing = [i for i, result in enumerate(results) if result is None]
        found = dict[int, ContactResult]()
        if missing:
            solved = self.contact.solve_side([states[i] for i in missing], side, [guesses[i] for i in missing])
            found |= zip(missing, solved, strict=True)
        return [found[i] if result is None else result for i, result in enumerate(results)]

    def _corrected(self, state: WheelsetState, there: ContactResult, side: Side) -> ContactResult | None:
        """Result of a state and the table's one; None where one of both is not known."""
        own = self.corrections.get((state.wheelset, side))
        if own is None or there.status != "converged":
            return None
        change = own.offset + (own.slope * (values_on_rail(state, side, self.radius) - own.at)).sum(axis=1)
        return changed(own.result, force=there.force + change[:3], moment=there.moment + change[3:])


@dataclass
class TableStages:
    """Right-hand sides of the inner stages of steps, by their starts.

    Parameters:
        dynamics: equations of motion.
        table: contact of all wheels by tables of forces.

    Offsets and slopes belong to the evaluation at the start of a step; a step that is repeated has the same.
    """

    dynamics: VehicleDynamics
    table: VehicleContact
    _latest: tuple[VehicleEvaluation, RightHandSide[VehicleEvaluation]] | None = field(init=False, default=None)

    def __call__(self, start: VehicleEvaluation, linear: HasDerivatives) -> RightHandSide[VehicleEvaluation]:
        if self._latest is None or self._latest[0] is not start:
            self._latest = start, self._of(start, linear)
        return self._latest[1]

    def _of(self, start: VehicleEvaluation, linear: HasDerivatives) -> RightHandSide[VehicleEvaluation]:
        dynamics = self.dynamics
        if not (isinstance(linear, VehicleLinearisation) and linear.exact and start.states is not None):
            return dynamics
        assert linear.tangents is not None
        table = IndependentWheels(self.table) if dynamics.twists else self.table
        corrections = dict[tuple[str, Side], Correction]()
        radius = dynamics.vehicle.radius
        for k, side in enumerate(SIDES):
            states, own = list(start.states.values()), [start.contacts[name][side] for name in start.states]
            for i, there in enumerate(table.solve_side(states, side, [None] * len(states))):
                if there.status == own[i].status == "converged":
                    turning = states[i].turning_as(side)
                    slope = linear.tangents[i, k] - table.side_tangents([states[i]], side, [there])[0]
                    slope = np.concatenate([slope, by_speed(slope[None, None], [turning])[0, 0]], axis=1)
                    offset = np.concatenate([own[i].force - there.force, own[i].moment - there.moment])
                    at = values_on_rail(turning, side, radius)
                    corrections[turning.wheelset, side] = Correction(own[i], at, offset, slope)
        solved = FrictionAlong(dynamics.contact) if dynamics.track.rubs else dynamics.contact
        contact = CorrectedTable(solved, self.table, corrections, radius)
        element = ContactElement(IndependentWheels(contact) if dynamics.twists else contact, SIDES)
        return lambda time, state, previous: dynamics.evaluated(
            time, state, None if previous is None else previous.contacts, element
        )
