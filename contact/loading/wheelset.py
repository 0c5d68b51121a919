"""Static equilibrium of a wheelset on its rails: height, and roll, at which it carries given loads."""

from __future__ import annotations

from collections.abc import Callable
from contextlib import suppress
from dataclasses import dataclass, replace
from typing import Protocol, runtime_checkable

import numpy as np

from wheelrail.contact.geometry.grid_points import SurfacePair
from wheelrail.contact.kinematics.contact_points import OutsideSurface
from wheelrail.contact.kinematics.frames import SIDES, Pose, RigidMotion, Side
from wheelrail.contact.kinematics.wheelset_state import WheelsetState
from wheelrail.contact.loading.load_search import (
    NOISE,
    RTOL,
    LoadError,
    LoadSolution,
    Results,
    compliant,
    find_depth_for_load,
)
from wheelrail.contact.loading.two_wheels import at_depths, find_depths_for_loads
from wheelrail.contact.models.wheelset import ContactModel, WheelsetContact
from wheelrail.contact.results.result import ContactResult
from wheelrail.support.arrays import Array

DEEPEST = 0.05  # m below the nominal height, limit of the search
FRICTIONLESS = 1e-3  # tolerance of the load without friction, for a first depth
DEEP = 3.0  # times the expected approach: too large a penetration to start from
SHALLOW = 1e-3  # times that: 0.8 nm of a cylinder on a plane, as long as wide, took 7 GB on the finest strips
TOO_FAR = 50.0  # times the expected approach, with which no wheel carries its load: steep flanges take 35 times at most
HELD = 2e-4  # m, as under usual loads: friction may hold a wheel down on a steep flange to this under any load
STEPS, FLATTEST = 12, 0.1  # to a start without a solve; smallest change of the penetration by the height that they use


@runtime_checkable
class HasGrid(Protocol):
    """A model whose contact points are the penetrating points of a grid."""

    @property
    def geometry(self) -> SurfacePair: ...


@runtime_checkable
class HasFrictionless(Protocol):
    """A model with one without friction on the same points."""

    @property
    def frictionless(self) -> ContactModel: ...


@runtime_checkable
class HasProblem(Protocol):
    """A model whose undeformed penetration is known before a solve."""

    def problem(self, pose: Pose, motion: RigidMotion) -> HasApproach: ...


class HasApproach(Protocol):
    """Equations of a contact at a pose."""

    @property
    def approach(self) -> float: ...


@dataclass(frozen=True)
class WheelsetEquilibrium:
    """Static equilibrium of a wheelset.

    Parameters:
        state: of the wheelset.
        results: contact by side.
        solves: number of contact solves.
    """

    state: WheelsetState
    results: dict[Side, ContactResult]
    solves: int


def wheelset_at_state(
    contact: WheelsetContact, state: WheelsetState, sides: tuple[Side, ...] = SIDES
) -> WheelsetEquilibrium:
    """Contact of a wheelset at a given state.

    Parameters:
        contact: of the wheelset.
        state: of the wheelset.
        sides: that are solved.
    """
    return WheelsetEquilibrium(state, {side: contact(state, side) for side in sides}, len(sides))


def wheel_under_load(
    contact: WheelsetContact,
    state: WheelsetState,
    side: Side,
    load: float,
    *,
    expected: float,
    rtol: float = RTOL,
    near: tuple[WheelsetState, ContactResult] | None = None,
) -> WheelsetEquilibrium:
    """Height z at which one wheel carries a load.

    Parameters:
        contact: of the wheelset.
        state: initial height, and the other coordinates and velocities.
        side: "left" or "right".
        load: N.
        expected: m, estimate of the approach.
        rtol: of the load.
        near: a similar state and its converged result, to begin with: a third of the time, to `NOISE` of the load.

    Raises LoadError.
    """
    solution = _find_depth(contact, state, (side,), load, expected, rtol, near)
    return WheelsetEquilibrium(replace(state, z=-solution.depth), {side: solution.results[0]}, solution.trials)


def axle_under_load(
    contact: WheelsetContact, state: WheelsetState, load: float, *, expected: float, rtol: float = RTOL
) -> WheelsetEquilibrium:
    """Height z at which both wheels together carry a load, at the roll of the state.

    Parameters as for `wheel_under_load`. Raises LoadError.
    """
    solution = _find_depth(contact, state, SIDES, load, expected, rtol)
    return WheelsetEquilibrium(
        replace(state, z=-solution.depth), dict(zip(SIDES, solution.results, strict=True)), 2 * solution.trials
    )


def wheels_under_load(
    contact: WheelsetContact, state: WheelsetState, load: float, *, expected: float, rtol: float = RTOL
) -> WheelsetEquilibrium:
    """Height z and roll at which each wheel carries a load, starting from the state's roll.

    Parameters as for `wheel_under_load`. Raises LoadError.
    """
    base = contact.mounting.wheel_y
    starts = [_find_depth(contact, state, (side,), load, expected, 0.02) for side in SIDES]

    def wheel(lowered: WheelsetState, side: Side, guess: ContactResult | None) -> ContactResult:
        own = contact.of(side)
        penetration = _penetration(own, lowered, side) if isinstance(own.model, HasProblem) else np.nan
        if penetration > max(TOO_FAR * expected, HELD):
            return ContactResult.failed(f"{1e3 * penetration:.3g} mm deep, far beyond its load", penetration)
        return contact(lowered, side, guess)

    def wheels(depths: Array, guess: Results | None) -> Results:
        lowered = at_depths(state, depths, base)
        return tuple(wheel(lowered, side, guess[i] if guess else None) for i, side in enumerate(SIDES))

    def known(depths: Array) -> Array:
        lowered = at_depths(state, depths, base)
        return np.array([_penetration(contact.of(side), lowered, side) for side in SIDES])

    approach = np.array([start.results[0].approach for start in starts])
    depths, results, trials = find_depths_for_loads(
        wheels,
        np.full(2, load),
        start=lifted(np.array([start.depth for start in starts]), approach, expected, known),
        slopes=np.array([start.slope for start in starts]),
        guess=tuple(start.results[0] for start in starts),
        rtol=rtol,
    )
    solves = sum(start.trials for start in starts) + 2 * trials
    return WheelsetEquilibrium(at_depths(state, depths, base), dict(zip(SIDES, results, strict=True)), solves)


def lifted(depths: Array, approach: Array, expected: float, penetration: Callable[[Array], Array]) -> Array:
    """Depths (n,) m from which wheels are solved: those far deeper than under their loads, as on a flange by
    millimetres, are lifted to their approach.

    Parameters:
        depths: (n,) m, of each wheel or of both together.
        approach: (n,) m, under the loads.
        expected: m, by which the penetration may exceed it.
        penetration: of the undeformed surfaces (n,) m at depths; NaN where only a solve tells it.
    """
    before = np.zeros((2, len(depths)))
    for step in range(STEPS):
        known = penetration(depths)
        deep = known > approach + expected
        if not deep.any():
            break
        way = depths - before[0]
        change = (known - before[1]) / np.where(way != 0.0, way, np.inf) if step else np.ones(len(depths))
        before = np.array([depths, known])
        depths = depths - np.where(deep, (known - approach) / np.clip(change, FLATTEST, 1.0), 0.0)
    return depths


def _find_depth(
    contact: WheelsetContact,
    state: WheelsetState,
    sides: tuple[Side, ...],
    load: float,
    expected: float,
    rtol: float,
    near: tuple[WheelsetState, ContactResult] | None = None,
) -> LoadSolution:
    def wheels(depth: float, guess: Results | None) -> Results:
        lowered = replace(state, z=-depth)
        return tuple(contact(lowered, side, guess[i] if guess else None) for i, side in enumerate(sides))

    if near:
        first: LoadSolution | None = _by_tangent(contact, state, sides[0], load, *near)
        rtol = max(rtol, NOISE)
    else:
        first = _without_friction(contact, state, sides, load, expected)
    start = first.depth if first else min(_initial_depth(contact, state, side, expected) for side in sides)
    guess, slope = (first.results, first.slope) if first else (None, None)
    try:
        found = find_depth_for_load(
            wheels, load, expected=expected, start=start, rtol=rtol, deepest=DEEPEST, guess=guess, known_slope=slope
        )
        return replace(found, trials=found.trials + (first.trials if first else 0))
    except LoadError as error:
        raise LoadError(f"{' and '.join(sides)} wheel: {error}") from None


def _by_tangent(
    contact: WheelsetContact, state: WheelsetState, side: Side, load: float, near: WheelsetState, result: ContactResult
) -> LoadSolution:
    """Depth and slope of a wheel under a load by the tangent at a similar state; at its height without one."""
    depth, slope = -near.z, compliant(load) / result.approach
    with suppress(ValueError, RuntimeError):
        by = contact.tangent(near, side, result)[2]
        change = np.array([getattr(state, name) - getattr(near, name) for name in WheelsetState.coordinates])
        z = WheelsetState.coordinates.index("z")
        change[z] = 0.0
        lowered = (load - result.force[2] - by @ change) / -by[z]
        if by[z] < 0.0 and abs(lowered) < result.approach:
            depth, slope = depth + lowered, -2.0 / 3.0 * by[z] / np.cbrt(load)
    return LoadSolution(float(depth), (result,), np.inf, 0, float(slope))


def _without_friction(
    contact: WheelsetContact, state: WheelsetState, sides: tuple[Side, ...], load: float, expected: float
) -> LoadSolution | None:
    """Solution of a quicker frictionless model, from which that with friction starts; None without one."""
    frictionless = contact.changed(lambda own: own.frictionless if isinstance(own, HasFrictionless) else own)
    if any(frictionless.of(side).model is not contact.of(side).model for side in sides):
        with suppress(LoadError):
            return _find_depth(frictionless, state, sides, load, expected, FRICTIONLESS)
    return None


def _initial_depth(contact: WheelsetContact, state: WheelsetState, side: Side, expected: float) -> float:
    """Initial depth m: beyond a gap; on strips of the expected approach, on a grid where there are not many more
    candidate points than under the load.

    0.7 mm on the flange root at a grid of 1 mm are 1600 points, whose compliance takes a gigabyte; under the load they
    are 770. On strips a solve at six times the load takes ten times as long as one under the load.
    """
    own, depth, before = contact.of(side), -state.z, (0.0, 0.0)
    largest = expected if isinstance(own.model, HasProblem) else DEEP * expected
    for step in range(STEPS):
        penetration = _penetration(own, replace(state, z=-depth), side)
        if not (penetration < SHALLOW * expected or penetration > largest):
            break
        # on a flange face the distance of both surfaces changes by a part of the height
        change = (penetration - before[1]) / (depth - before[0]) if step > 0 and depth != before[0] else 1.0
        before = depth, penetration
        depth -= (penetration - expected) / min(max(change, FLATTEST if penetration > 0.0 else 1.0), 1.0)
    return depth


def _penetration(contact: WheelsetContact, state: WheelsetState, side: Side) -> float:
    """Largest penetration m of the undeformed surfaces of a wheel; NaN of models that tell it by a solve alone."""
    return penetration_of(contact.model, *contact.mounting.left_pair(state if side == "left" else state.mirrored()))


def penetration_of(model: ContactModel, pose: Pose, motion: RigidMotion) -> float:
    """Largest penetration m of the undeformed surfaces at a pose; NaN of models that tell it by a solve alone.

    Parameters:
        model: of the contact.
        pose: of the wheel.
        motion: of both bodies.
    """
    if isinstance(model, HasProblem):
        return model.problem(pose, motion).approach
    if isinstance(model, HasGrid):
        with suppress(OutsideSurface):  # the search recovers from a failed solve
            return float(model.geometry.contact_points(pose, 0)[1])
    return np.nan
