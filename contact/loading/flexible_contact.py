"""Contact of a wheelset with given motions of hubs and rails, for time integrations with such states."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np

from wheelrail.bindings._contact import MovedStates, moved_load_slopes, moved_loads
from wheelrail.contact.kinematics.frames import SIDES, Side
from wheelrail.contact.kinematics.wheelset_state import Mounting, WheelsetState
from wheelrail.contact.loading.flexible_state import MOTIONS, FlexibleState, by_parts
from wheelrail.contact.loading.flexible_wheelset import Flexibility, by_unknowns
from wheelrail.contact.loading.moved_pair import COORDINATES, MovedPair
from wheelrail.contact.loading.moved_wheels import MovedWheels, moved_together
from wheelrail.contact.models.wheelset import ContactModel, WheelsetContact
from wheelrail.contact.results.result import ContactResult
from wheelrail.contact.results.vehicle_contact import VehicleContact
from wheelrail.contact.solvers.tangent import MIRRORED
from wheelrail.contact.structure.hubs import about_hubs_line
from wheelrail.support.arrays import Array

REST = (0.0,) * len(MOTIONS)  # motions of hubs and rails that do not move
BOTH = slice(0, 6), slice(6, 12)  # motions of the left and of the right hub
HUBS = slice(COORDINATES, COORDINATES + 12)  # columns of derivatives by the coordinates of a `FlexibleState`


@dataclass(frozen=True)
class FlexiblePairs:
    """Pairs of both sides of a wheelset whose hubs and rails move.

    The hubs' motions are relative to the line through the journals; the frame of the wheelset is that of the line
    through its hubs, which carry nearly all of its mass.
    Parameters:
        mountings: of the left and the right side.
        flexibility: of axle and rails.
    """

    mountings: tuple[Mounting, Mounting]
    flexibility: Flexibility

    def pair(self, state: WheelsetState, side: Side) -> MovedPair:
        """Pair of one side as a left-hand one; hubs and rails of a state without motions are at rest."""
        index = int(side == "right")
        mounting = self.mountings[index]
        moves = self._moves([state], index)[0]
        own = state.mirrored() if index else state
        return MovedPair(mounting, own, moves[:6], moves[6:], self.flexibility.foot(index))

    def states(self, states: Sequence[WheelsetState], side: Side) -> MovedStates:
        """States of one side of several wheelsets, see `pair`."""
        index = int(side == "right")
        mounting, (y, z) = self.mountings[index], self.flexibility.foot(index).tolist()
        moves = self._moves(states, index)
        return MovedStates(np.array([s.values for s in states]), moves, mounting.dimensions, (y, z), index == 1)

    def _moves(self, states: Sequence[WheelsetState], index: int) -> Array:
        """Motions (n, 9) of hub and rail of a side; the hub moves relative to the line through both hubs.

        Sums and differences of both sides, and no others, keep mirror images to the last bit.
        """
        motions = np.array([s.motions if isinstance(s, FlexibleState) else REST for s in states])
        even, odd = 0.5 * (motions[:, :6] + motions[:, 6:12]), 0.5 * (motions[:, :6] - motions[:, 6:12])
        by_even, by_odd = self._lines_of_parts[index]
        # A product for each state: rounding must not depend on the others that are solved together.
        even, odd = (even[:, None] @ by_even)[:, 0], (odd[:, None] @ by_odd)[:, 0]
        rails = motions[:, 12 + 3 * index : 15 + 3 * index]
        return np.concatenate([even - odd if index else even + odd, rails], axis=1)

    @cached_property
    def _lines(self) -> tuple[Array, Array]:
        """Transformations (12, 12) of both sides, see `about_hubs_line`."""
        left, right = (about_hubs_line(mounting.wheel_y) for mounting in self.mountings)
        return left, right

    @cached_property
    def _lines_of_parts(self) -> list[tuple[Array, Array]]:
        """Transposed transformations (6, 6) of even and odd parts into the motions of a side's hub."""
        halves = [
            (lines[own, own], lines[own, other])
            for lines, own, other in zip(self._lines, BOTH, BOTH[::-1], strict=True)
        ]
        return [((own + other).T, (own - other).T) for own, other in halves]

    def loads(self, states: Sequence[WheelsetState], wrenches: Array) -> Array:
        """Loads (n, 18) N and N m on even and odd parts of the motions of hubs, then of rails.

        Parameters:
            states: of n wheelsets with their motions.
            wrenches: (n, 2, 6), force N on the left and the right wheel, and moment N m about the wheelset's centre.
        """
        result = np.zeros((len(states), 18))
        for index, side in enumerate(SIDES):
            own = wrenches[:, index] * (MIRRORED if index else 1.0)
            result += on_parts(moved_loads(self.states(states, side)) @ own[..., None], index)[..., 0]
        return result

    def load_slopes(self, states: Sequence[WheelsetState], wrenches: Array, tangents: Array) -> Array:
        """Derivatives (n, 2, 18, c) of the loads: parts of the left and the right contact.

        Parameters:
            states, wrenches: as for `loads`.
            tangents: (n, 2, 6, c), derivatives of the wrenches by the wheelset's coordinates, even and odd parts of the
                motions, and what leaves them as they are.
        """
        slopes = np.empty((len(states), 2, 18, tangents.shape[-1]))
        for index, side in enumerate(SIDES):
            sign, moved = MIRRORED if index else np.ones(6), self.states(states, side)
            own = moved_loads(moved) @ (sign[:, None] * tangents[:, index])
            change = by_parts(self.by_coordinates(moved_load_slopes(moved, sign * wrenches[:, index]), side))
            own[..., : change.shape[-1]] += change
            slopes[:, index] = on_parts(own, index)
        return slopes

    def by_coordinates(self, slopes: Array, side: Side) -> Array:
        """Derivatives (..., 27) by `FlexibleState.coordinates`.

        Parameters:
            slopes: (..., 18) of the left-hand pair of a side, columns as of `MovedPair.wrench_slopes`.
            side: its name.
        """
        index = int(side == "right")
        out = by_unknowns(slopes, index)
        out[..., HUBS] = out[..., HUBS] @ self._lines[index]
        return out


def on_parts(loads: Array, index: int) -> Array:
    """Loads (n, 18, ...) on even and odd parts of hubs and rails, by loads (n, 9, ...) on one side."""
    odd = -loads if index else loads
    return np.concatenate([loads[:, :6], odd[:, :6], loads[:, 6:], odd[:, 6:]], axis=1)


@dataclass(frozen=True)
class FlexibleContact(VehicleContact):
    """Contact of one side of a wheelset at given motions of its hub and rail.

    Parameters:
        contact: of both sides.
        flexibility: of axle and rails.
    """

    contact: WheelsetContact
    flexibility: Flexibility

    @cached_property
    def pairs(self) -> FlexiblePairs:
        """Pairs of both sides."""
        left, right = (self.contact.of(side).mounting for side in SIDES)
        return FlexiblePairs((left, right), self.flexibility)

    @property
    def model(self) -> ContactModel:
        """Contact model of the left-hand pair."""
        return self.contact.model

    def changed(self, change: Callable[[ContactModel], ContactModel]) -> FlexibleContact:
        """The contact with the models of both sides changed by a function."""
        return replace(self, contact=self.contact.changed(change))

    def rubbing(self, factor: float) -> FlexibleContact:
        """The contact with its coefficients of friction times a factor, as of `WheelsetContact`."""
        return replace(self, contact=self.contact.rubbing(factor))

    @property
    def concurrent(self) -> bool:
        return self.contact.concurrent

    @property
    def together(self) -> bool:
        return self.contact.together

    def solve_side(
        self, states: Sequence[WheelsetState], side: Side, guesses: Sequence[ContactResult | None]
    ) -> list[ContactResult]:
        model = self.contact.batched(side)
        if model is None or model.together is None:
            return super().solve_side(states, side, guesses)
        return model.results(MovedWheels.at(model.together, self.pairs.states(states, side)))

    def side_tangents(self, states: Sequence[WheelsetState], side: Side, results: Sequence[ContactResult]) -> Array:
        if (wheels := moved_together(results)) is None:
            return super().side_tangents(states, side, results)
        solved, indices = wheels
        slopes = solved.by_moves(indices, self.pairs.states(states, side)).reshape(len(states), 6, -1)
        out = self.pairs.by_coordinates(slopes, side)
        return out if side == "left" else MIRRORED[:, None] * out

    def __call__(self, state: WheelsetState, side: Side, guess: ContactResult | None = None) -> ContactResult:
        if self.contact.batched(side) is not None:
            return self.solve_side([state], side, [guess])[0]
        pair = self.pairs.pair(state, side)
        result = pair.in_track(self.contact.of(side).model(pair.pose, pair.motion, guess))
        return result if side == "left" else result.mirrored()

    def tangent(self, state: WheelsetState, side: Side, result: ContactResult) -> Array:
        """Derivatives (6, 27) of force N and moment N m by `FlexibleState.coordinates`.

        Parameters and errors as for `WheelsetContact.tangent`.
        """
        own = result if side == "left" else result.mirrored()
        slopes = self.pairs.by_coordinates(self.pairs.pair(state, side).wrench_slopes(own), side)
        return slopes if side == "left" else MIRRORED[:, None] * slopes
