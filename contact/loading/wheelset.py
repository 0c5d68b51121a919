"""A wheelset seated on its rails under a load: height, and roll, solved for."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import Protocol, runtime_checkable

import numpy as np

from wheelrail.contact.geometry.grid_points import SurfacePair
from wheelrail.contact.kinematics.contact_points import OutsideSurface
from wheelrail.contact.kinematics.frames import SIDES, Side
from wheelrail.contact.kinematics.wheelset_state import WheelsetState
from wheelrail.contact.loading.load_search import RTOL, LoadError, LoadSolution, Results, find_depth_for_load
from wheelrail.contact.loading.two_wheels import find_depths_for_loads
from wheelrail.contact.models.wheelset import WheelsetContact
from wheelrail.contact.results.result import ContactResult
from wheelrail.support.arrays import Array

DEEPEST = 0.05  # m: farther than this from its nominal height a wheelset has left the track
DEEP = 3.0  # times the approach that a load should need: no overlap to start from


@runtime_checkable
class HasGrid(Protocol):
    """A model whose points are those of a grid that overlap."""

    @property
    def geometry(self) -> SurfacePair: ...


@dataclass(frozen=True)
class WheelsetEquilibrium:
    """State of the wheelset, contact by side, and the number of contact solves that it took."""

    state: WheelsetState
    results: dict[Side, ContactResult]
    solves: int


def placed(contact: WheelsetContact, state: WheelsetState, sides: tuple[Side, ...] = SIDES) -> WheelsetEquilibrium:
    """The contact of each side where the wheelset stands."""
    return WheelsetEquilibrium(state, {side: contact(state, side) for side in sides}, len(sides))


def wheel_under_load(
    contact: WheelsetContact, state: WheelsetState, side: Side, load: float, *, expected: float, rtol: float = RTOL
) -> WheelsetEquilibrium:
    """Height z at which one wheel carries the load N, everything else given; expected m is the approach to look for."""
    found = _lowered(contact, state, (side,), load, expected, rtol)
    return WheelsetEquilibrium(replace(state, z=-found.depth), {side: found.results[0]}, found.trials)


def axle_under_load(
    contact: WheelsetContact, state: WheelsetState, load: float, *, expected: float, rtol: float = RTOL
) -> WheelsetEquilibrium:
    """Height z at which both wheels together carry the load N, roll given."""
    found = _lowered(contact, state, SIDES, load, expected, rtol)
    return WheelsetEquilibrium(
        replace(state, z=-found.depth), dict(zip(SIDES, found.results, strict=True)), 2 * found.trials
    )


def wheels_under_load(
    contact: WheelsetContact, state: WheelsetState, load: float, *, expected: float, rtol: float = RTOL
) -> WheelsetEquilibrium:
    """Height z and roll at which each wheel carries the load N, starting from the state's roll."""
    base = contact.mounting.wheel_y
    rough = [_lowered(contact, state, (side,), load, expected, 0.02) for side in SIDES]

    def at(depths: Array) -> WheelsetState:
        left, right = depths  # of the wheels: z + base roll = -left, z - base roll = -right
        return replace(state, z=-0.5 * (left + right), roll=state.roll + 0.5 * (right - left) / base)

    def wheels(depths: Array, guess: Results | None) -> Results:
        moved = at(depths)
        return tuple(contact(moved, side, guess[i] if guess else None) for i, side in enumerate(SIDES))

    depths, results, trials = find_depths_for_loads(
        wheels,
        np.full(2, load),
        start=np.array([found.depth for found in rough]),
        slopes=np.array([found.slope for found in rough]),
        guess=tuple(found.results[0] for found in rough),
        rtol=rtol,
    )
    solves = sum(found.trials for found in rough) + 2 * trials
    return WheelsetEquilibrium(at(depths), dict(zip(SIDES, results, strict=True)), solves)


def _lowered(
    contact: WheelsetContact, state: WheelsetState, sides: tuple[Side, ...], load: float, expected: float, rtol: float
) -> LoadSolution:
    def wheels(depth: float, guess: Results | None) -> Results:
        moved = replace(state, z=-depth)
        return tuple(contact(moved, side, guess[i] if guess else None) for i, side in enumerate(sides))

    start = min(-state.z, *(_shallow(contact, state, side, expected) for side in sides))
    try:
        return find_depth_for_load(wheels, load, expected=expected, start=start, rtol=rtol, deepest=DEEPEST)
    except LoadError as error:
        raise LoadError(f"{' and '.join(sides)} wheel: {error}") from None


def _shallow(contact: WheelsetContact, state: WheelsetState, side: Side, expected: float) -> float:
    """Depth m to start from, where a grid's candidates are not many times those of the load.

    0.7 mm on the flange root at 1 mm are 1600 points, whose compliance takes a gigabyte; under the load they are 770.
    """
    if not isinstance(contact.model, HasGrid):
        return -state.z
    pose, _ = contact.mounting.left_pair(state if side == "left" else state.mirrored())
    try:
        _, overlap = contact.model.geometry.contact_points(pose, 0)
    except OutsideSurface:  # the search finds its way up from a failed solve
        return -state.z
    return -state.z - (overlap - expected if overlap > DEEP * expected else 0.0)
