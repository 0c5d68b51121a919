"""First contact of a rigid wheelset with rigid rails: height, roll, and the contact point of each wheel."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from wheelrail.bindings._contact import lines_to_scan, local_maxima, scan
from wheelrail.contact.geometry.rigid_surfaces import RigidWheelRail
from wheelrail.contact.kinematics.frames import SIDES, Pose, Side
from wheelrail.contact.kinematics.wheelset_state import Mounting, WheelsetState
from wheelrail.support.arrays import Array

TOUCH = 1e-9  # m, penetration at first contact
TOLERANCE = 1e-11  # m
NUDGE = 1e-6  # m, penetration at which separated bodies are searched
ITERATIONS = 40  # of Newton's method
END = 1e-8  # m, from an end of the wheel's profile: closer places are the end
STEP = 2.5e-4  # m, lateral continuation step
LEAN = 1e-3  # cosine: a steeper contact plane cannot carry the wheel


@dataclass(frozen=True)
class FirstContact:
    """Contact point of one wheel, in the frame of the left pair's rail.

    Parameters:
        wheel_s, rail_s: m, arc lengths on the profiles.
        x: m, along the rail from the axle.
        point: (3,) m.
        normal: (3,), outward from the rail.
        penetration: m.
    """

    wheel_s: float
    rail_s: float
    x: float
    point: Array
    normal: Array
    penetration: float


@dataclass(frozen=True)
class RigidWheelset:
    """Rigid left-hand pair of profiles and its mounting; the right-hand one where it differs, as a left-hand pair.

    Parameters:
        pair: rigid surfaces.
        mounting: of wheels and rails.
        right: surfaces and mounting of the right-hand side; None where both sides are alike.
    """

    pair: RigidWheelRail
    mounting: Mounting
    right: RigidWheelset | None = None

    def on(self, side: Side) -> RigidWheelset:
        """The pair of one side, as a left-hand one."""
        return self.right if side == "right" and self.right is not None else self


def contact_point(pair: RigidWheelRail, mounting: Mounting, state: WheelsetState) -> FirstContact:
    """Point of the largest penetration of the left pair.

    Parameters:
        pair: rigid surfaces.
        mounting: of wheels and rails.
        state: of the wheelset.

    The search refines penetrating surfaces only: separated bodies are moved together along the normal by `NUDGE`.
    Raises ValueError where the wheel is beside the rail.
    """
    pose, _ = mounting.left_pair(state)
    contact = _largest_penetration(pair, pose)
    if contact.penetration > 0.0:
        return contact
    distance = NUDGE - contact.penetration
    closer = _largest_penetration(pair, replace(pose, origin=pose.origin - distance * contact.normal))
    return replace(closer, point=closer.point + distance * contact.normal, penetration=closer.penetration - distance)


def _largest_penetration(pair: RigidWheelRail, pose: Pose) -> FirstContact:
    """The largest local maximum of the penetration, or else the place of the smallest distance.

    Raises ValueError where it is an end of a profile.
    """
    wheel, rail, lines = pair.wheel.shape, pair.rail.shape, pair.lines
    samples = scan(rail, lines, pair.radius, *pose.arrays, lines_to_scan(lines, pair.radius, *pose.arrays))
    maxima, _, _, _ = local_maxima(wheel, rail, pair.radius, *pose.arrays, lines.s, samples)
    if len(maxima):
        s, depth, x = maxima[maxima[:, 1].argmax()]
    else:
        s, depth, x = pair.nearest(pose)
    (point,), _ = pair.at(pose, np.array([s]), np.array([x]))
    closest = pair.rail.closest(point[None, 1:])
    foot = float(closest.s[0])
    if not closest.inside[0] or not pair.wheel.s_range[0] + END < s < pair.wheel.s_range[1] - END:
        raise ValueError("the wheel is beside the rail: they are nearest at an end of a profile")
    return FirstContact(float(s), foot, float(x), point, np.array([0.0, *pair.rail.normal(foot)]), float(depth))


def first_contacts(wheelset: RigidWheelset, state: WheelsetState) -> tuple[WheelsetState, dict[Side, FirstContact]]:
    """State with the height and roll at which both wheels just touch, by Newton's method, and the contact points.

    Parameters:
        wheelset: rigid surfaces of both sides.
        state: lateral position and yaw, initial guess of height and roll.

    Contact points of the right pair are those of its mirror image. Raises ValueError without solution.
    """
    for _ in range(ITERATIONS):
        states = {"left": state, "right": state.mirrored()}
        try:
            contacts: dict[Side, FirstContact] = {
                side: contact_point(wheelset.on(side).pair, wheelset.on(side).mounting, states[side]) for side in SIDES
            }
        except ValueError as error:
            raise ValueError(f"y = {state.y:.6g} m: {error}") from None
        residual = np.array([contacts[side].penetration - TOUCH for side in SIDES])
        if np.abs(residual).max() < TOLERANCE:
            return state, contacts
        slope = np.array([_gradient(wheelset.on(side).mounting, states[side], contacts[side]) for side in SIDES])
        slope[1, 1] *= -1.0  # roll changes sign in the mirror image
        if np.abs(slope[:, 0]).min() < LEAN:
            break
        step = np.linalg.solve(slope, -residual)
        step *= min(1.0, 5e-4 / max(abs(step[0]), wheelset.mounting.wheel_y * abs(step[1])))
        state = replace(state, z=state.z + float(step[0]), roll=state.roll + float(step[1]))
    raise ValueError(f"y = {state.y:.6g} m: no height and roll found at which both wheels touch the rails")


def contact_without_roll(wheelset: RigidWheelset, y: float, z: float = 0.0) -> tuple[float, FirstContact]:
    """Height m and contact point of the left wheel, lowered alone to first contact, without roll and yaw.

    Parameters:
        wheelset: rigid surfaces and mounting of the left-hand pair.
        y: lateral position of the wheelset, m.
        z: first height, m.

    Raises ValueError without solution.
    """
    state = WheelsetState(y=y, z=z)
    for _ in range(ITERATIONS):
        contact = contact_point(wheelset.pair, wheelset.mounting, state)
        if abs(contact.penetration - TOUCH) < TOLERANCE:
            return state.z, contact
        if contact.normal[2] < LEAN:
            break
        state = replace(state, z=state.z + (contact.penetration - TOUCH) / float(contact.normal[2]))
    raise ValueError(f"y = {y:.6g} m: no height found at which the wheel touches the rail")


def _gradient(mounting: Mounting, state: WheelsetState, contact: FirstContact) -> tuple[float, float]:
    """Derivative of a left pair's penetration by height [1] and roll [m/rad] at the fixed contact point."""
    centre = mounting.centre(state) - np.array([0.0, mounting.rail_y, 0.0])
    axis = np.array([np.cos(state.yaw), np.sin(state.yaw), 0.0])
    displacement = np.cross(axis, contact.point - centre)
    return -float(contact.normal[2]), -float(contact.normal @ displacement)


def first_contacts_over(
    wheelset: RigidWheelset, y: Array, yaw: float = 0.0
) -> list[tuple[WheelsetState, dict[Side, FirstContact]]]:
    """Height, roll and contact points at every lateral position, as `first_contacts`.

    Parameters:
        wheelset: rigid surfaces of both sides.
        y: (n,) m, reached in steps of `STEP` from the middle of the track.
        yaw: rad.

    Raises ValueError naming the first position, from the middle, that cannot be reached.
    """
    solutions: dict[int, tuple[WheelsetState, dict[Side, FirstContact]]] = {}
    middle = first_contacts(wheelset, WheelsetState(yaw=yaw))
    for sign in (1.0, -1.0):
        state = middle[0]
        indices = np.flatnonzero((y >= 0.0) if sign > 0.0 else (y < 0.0))
        for i in indices[np.argsort(np.abs(y[indices]), kind="stable")].tolist():
            positions = np.linspace(state.y, y[i], int(np.ceil(abs(y[i] - state.y) / STEP)) + 1)[1:]
            solution = middle if state is middle[0] else None
            for position in positions.tolist():
                solution = first_contacts(wheelset, replace(state, y=position))
                state = solution[0]
            solutions[i] = solution or first_contacts(wheelset, state)
    return [solutions[i] for i in range(len(y))]
