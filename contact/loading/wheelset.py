"""Static equilibrium of a wheelset on its rails: height, and roll, at which it carries given loads."""

from __future__ import annotations

from contextlib import suppress
from dataclasses import dataclass, replace
from functools import partial
from typing import Protocol, runtime_checkable

import numpy as np

from wheelrail.bindings._contact import RTOL, LoweredWheelset, compliant
from wheelrail.contact.geometry.grid_points import SurfacePair
from wheelrail.contact.kinematics.contact_points import OutsideSurface
from wheelrail.contact.kinematics.frames import SIDES, Pose, RigidMotion, Side
from wheelrail.contact.kinematics.wheelset_state import WheelsetState
from wheelrail.contact.models.wheelset import ContactModel, WheelsetContact
from wheelrail.contact.results.result import ContactResult
from wheelrail.support.interrupts import check_interrupt


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
        near: a similar state and its converged result, to begin with: a third of the time, to 1e-6 of the load.

    Raises LoadError.
    """
    start = _by_tangent(contact, state, side, load, *near) if near else None
    found = _lowered(contact, state).under_load([SIDES.index(side)], load, expected, rtol, start)
    return _equilibrium(state, (side,), *found)


def axle_under_load(
    contact: WheelsetContact, state: WheelsetState, load: float, *, expected: float, rtol: float = RTOL
) -> WheelsetEquilibrium:
    """Height z at which both wheels together carry a load, at the roll of the state.

    Parameters as for `wheel_under_load`. Raises LoadError.
    """
    return _equilibrium(state, SIDES, *_lowered(contact, state).under_load([0, 1], load, expected, rtol))


def wheels_under_load(
    contact: WheelsetContact, state: WheelsetState, load: float, *, expected: float, rtol: float = RTOL
) -> WheelsetEquilibrium:
    """Height z and roll at which each wheel carries a load, starting from the state's roll.

    Parameters as for `wheel_under_load`. Raises LoadError.
    """
    return _equilibrium(state, SIDES, *_lowered(contact, state).each_under_load(load, expected, rtol))


def _equilibrium(
    state: WheelsetState,
    sides: tuple[Side, ...],
    z: float,
    roll: float,
    results: tuple[ContactResult, ...],
    solves: int,
) -> WheelsetEquilibrium:
    return WheelsetEquilibrium(replace(state, z=z, roll=roll), dict(zip(sides, results, strict=True)), solves)


def _lowered(contact: WheelsetContact, state: WheelsetState) -> LoweredWheelset:
    """Wheels of a state but for its height and roll, for the core's searches."""
    frictionless = contact.changed(lambda own: own.frictionless if isinstance(own, HasFrictionless) else own)
    models = [contact.of(side).model for side in SIDES]
    return LoweredWheelset(
        state.z,
        state.roll,
        contact.mounting.wheel_y,
        partial(_solve, contact, state),
        partial(_penetration, contact, state),
        [isinstance(model, HasProblem) for model in models],
        partial(_solve, frictionless, state),
        [frictionless.of(side).model is not model for side, model in zip(SIDES, models, strict=True)],
    )


def _solve(
    contact: WheelsetContact, state: WheelsetState, side: int, z: float, roll: float, guess: ContactResult | None
) -> ContactResult:
    check_interrupt()
    return contact(replace(state, z=z, roll=roll), SIDES[side], guess)


def _penetration(contact: WheelsetContact, state: WheelsetState, side: int, z: float, roll: float) -> float:
    """Largest penetration m of the undeformed surfaces of a wheel; NaN of models that tell it by a solve alone."""
    own, placed = contact.of(SIDES[side]), replace(state, z=z, roll=roll)
    return penetration_of(own.model, *own.mounting.left_pair(placed.mirrored() if side else placed))


def _by_tangent(
    contact: WheelsetContact, state: WheelsetState, side: Side, load: float, near: WheelsetState, result: ContactResult
) -> tuple[float, tuple[ContactResult], float]:
    """Depth, result and slope of a wheel under a load by the tangent at a similar state; at its height without one."""
    depth, slope = -near.z, compliant(load) / result.approach
    with suppress(ValueError, RuntimeError):
        by = contact.tangent(near, side, result)[2]
        change = np.array([getattr(state, name) - getattr(near, name) for name in WheelsetState.coordinates])
        z = WheelsetState.coordinates.index("z")
        change[z] = 0.0
        lowered = (load - result.force[2] - by @ change) / -by[z]
        if by[z] < 0.0 and abs(lowered) < result.approach:
            depth, slope = depth + lowered, -2.0 / 3.0 * by[z] / np.cbrt(load)
    return float(depth), (result,), float(slope)


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
