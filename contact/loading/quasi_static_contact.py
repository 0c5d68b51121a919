"""Contact of a wheelset with elastic axle on rails on pads, whose motions follow the loads at once."""

from __future__ import annotations

from dataclasses import dataclass, field, replace

import numpy as np

from wheelrail.contact.kinematics.frames import SIDES, Side
from wheelrail.contact.kinematics.wheelset_state import WheelsetState
from wheelrail.contact.loading.flexible_wheelset import (
    MIRRORED_HUB,
    MIRRORED_RAIL,
    FlexibleEquilibrium,
    FlexibleWheelset,
    Loads,
)
from wheelrail.contact.loading.load_search import LoadError
from wheelrail.contact.results.result import ContactResult
from wheelrail.contact.results.vehicle_contact import VehicleContact
from wheelrail.support.arrays import Array


@dataclass(frozen=True)
class StructureStart:
    """Start of a solve of both sides.

    Parameters:
        motions: (18,) of hubs and rails, see `FlexibleEquilibrium.motions`.
        warm_starts: of the left and the right contact.
    """

    motions: tuple[float, ...]
    warm_starts: tuple[object, object]


@dataclass
class QuasiStaticContact(VehicleContact):
    """Contact of one side in equilibrium of axle and rails at a given state of the wheelset.

    Both sides are solved together; the solution of the first one asked for also serves the other.
    Parameters:
        wheelset: with its track.
    """

    wheelset: FlexibleWheelset
    _latest: tuple[WheelsetState, object, FlexibleEquilibrium, StructureStart] | None = field(default=None, init=False)

    @property
    def concurrent(self) -> bool:
        return False

    def __call__(self, state: WheelsetState, side: Side, guess: ContactResult | None = None) -> ContactResult:
        start = None if guess is None else guess.warm_start
        try:
            equilibrium, following = self._solved(state, start)
        except LoadError as error:
            return ContactResult.failed(str(error))
        return replace(equilibrium.results[side], warm_start=following)

    def tangent(self, state: WheelsetState, side: Side, result: ContactResult) -> Array:
        """Derivatives (6, n) of force N and moment N m by the coordinates of the state, with hubs and rails that follow
        the loads.

        Parameters:
            state, side: for which the result was computed.
            result: point of linearisation.
        """
        latest = self._latest
        if latest is None or latest[0] != state or latest[3] is not result.warm_start:
            equilibrium, _ = self._solved(state, result.warm_start)
        else:
            equilibrium = latest[2]
        return np.array(equilibrium.tangent[SIDES.index(side), :, : len(state.coordinates)])

    def motions(self, result: ContactResult, side: Side) -> tuple[Array, Array]:
        """Motion (6,) of the hub and (3,) of the rail of one side of a result, m and rad."""
        start = result.warm_start
        assert isinstance(start, StructureStart)
        hubs, rails = np.array(start.motions[:12]).reshape(2, 6), np.array(start.motions[12:]).reshape(2, 3)
        return (hubs[0], rails[0]) if side == "left" else (MIRRORED_HUB * hubs[1], MIRRORED_RAIL * rails[1])

    def _solved(self, state: WheelsetState, start: object) -> tuple[FlexibleEquilibrium, StructureStart]:
        """Equilibrium of both sides and the start of the next one; raises LoadError."""
        latest = self._latest
        if latest is not None and latest[0] == state and latest[1] is start:
            return latest[2], latest[3]
        self._latest = None
        motions, guess = self.wheelset.flexibility.unloaded, None
        if isinstance(start, StructureStart):
            motions = np.array(start.motions)
            warm_starts = zip(SIDES, start.warm_starts, strict=True)
            guess = {side: ContactResult.guess(warm_start) for side, warm_start in warm_starts}
        equilibrium = self.wheelset.equilibrium(state, Loads(), guess, motions)
        left, right = (equilibrium.results[side].warm_start for side in SIDES)
        following = StructureStart(tuple(equilibrium.motions.tolist()), (left, right))
        self._latest = state, start, equilibrium, following
        return equilibrium, following
