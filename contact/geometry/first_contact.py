"""Where a rigid wheelset just touches its rigid rails: height and roll, and the contact point of each wheel."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from wheelrail.contact.geometry.rigid_search import humps, scan
from wheelrail.contact.geometry.rigid_surfaces import RigidWheelRail
from wheelrail.contact.kinematics.frames import SIDES, Pose, Side
from wheelrail.contact.kinematics.wheelset_state import Mounting, WheelsetState
from wheelrail.support.arrays import Array

TOUCH = 1e-9  # m of overlap: a point of contact has some
SETTLED = 1e-11  # m
NUDGE = 1e-6  # m of overlap, in which the search finds the place of bodies that stay apart
MOST = 40  # steps of Newton's method
STEP = 2.5e-4  # m, from one lateral position to the next on the way to one that is asked for
LEAN = 1e-3  # cosine: a contact plane as steep as this carries nothing


@dataclass(frozen=True)
class FirstContact:
    """Contact point of one wheel: arc lengths m on the profiles of wheel and rail, x m along the rail from the axle;
    point (3,) m and normal (3,) out of the rail, in the frame of the left pair's rail; overlap m.
    """

    wheel_s: float
    rail_s: float
    x: float
    point: Array
    normal: Array
    overlap: float


def touch(pair: RigidWheelRail, mounting: Mounting, state: WheelsetState) -> FirstContact:
    """Point of the largest overlap of the left pair. Raises ValueError where the wheel is beside the rail.

    Bodies that stay apart are moved together along the normal meanwhile: the search refines what overlaps.
    """
    pose, _ = mounting.left_pair(state)
    found = _nearest(pair, pose)
    if found.overlap > 0.0:
        return found
    apart = NUDGE - found.overlap
    closer = _nearest(pair, Pose(pose.origin - apart * found.normal, pose.rotation))
    return replace(closer, point=closer.point + apart * found.normal, overlap=closer.overlap - apart)


def _nearest(pair: RigidWheelRail, pose: Pose) -> FirstContact:
    """The highest hump, or the line that comes nearest without any."""
    rotation = np.ascontiguousarray(pose.rotation)
    wheel, rail, lines = pair.wheel.shape, pair.rail.shape, pair.lines
    seen = scan(rail, lines, pair.radius, pose.origin, rotation)
    top, _, _, _ = humps(wheel, rail, pair.radius, pose.origin, rotation, lines.s, seen)
    if len(top):
        s, depth, x = top[top[:, 1].argmax()]
    else:
        i = int(seen.depth.argmax())
        s, depth, x = lines.s[i], seen.depth[i], seen.x[i]
        if i in (0, len(lines.s) - 1):
            raise ValueError("the wheel leaves the rail")
    (point,), _ = pair.at(pose, np.array([s]), np.array([x]))
    foot = float(pair.rail.closest(point[None, 1:]).s[0])
    return FirstContact(float(s), foot, float(x), point, np.array([0.0, *pair.rail.normal(foot)]), float(depth))


def seated(
    pair: RigidWheelRail, mounting: Mounting, state: WheelsetState
) -> tuple[WheelsetState, dict[Side, FirstContact]]:
    """The state with height and roll at which both wheels just touch, from those of the state, by Newton's method.

    Contact points of the right pair are those of its mirror image. Raises ValueError where there is no such place.
    """
    for _ in range(MOST):
        seen = {"left": state, "right": state.mirrored()}
        try:
            touches: dict[Side, FirstContact] = {side: touch(pair, mounting, seen[side]) for side in SIDES}
        except ValueError as error:
            raise ValueError(f"y = {state.y:.6g} m: {error}") from None
        excess = np.array([touches[side].overlap - TOUCH for side in SIDES])
        if np.abs(excess).max() < SETTLED:
            return state, touches
        slope = np.array([_slope(mounting, seen[side], touches[side]) for side in SIDES])
        slope[1, 1] *= -1.0  # a mirror image rolls the other way
        if np.abs(slope[:, 0]).min() < LEAN:
            break
        move = np.linalg.solve(slope, -excess)
        move *= min(1.0, 5e-4 / max(abs(move[0]), mounting.wheel_y * abs(move[1])))
        state = replace(state, z=state.z + float(move[0]), roll=state.roll + float(move[1]))
    raise ValueError(f"y = {state.y:.6g} m: there is no height and roll at which both wheels touch")


def _slope(mounting: Mounting, state: WheelsetState, found: FirstContact) -> tuple[float, float]:
    """Change of a left pair's overlap by height [1] and roll [m/rad]: of two maxima, the place does not matter."""
    centre = mounting.centre(state) - np.array([0.0, mounting.rail_y, 0.0])
    axis = np.array([np.cos(state.yaw), np.sin(state.yaw), 0.0])
    turned = np.cross(axis, found.point - centre)
    return -float(found.normal[2]), -float(found.normal @ turned)


def seats(
    pair: RigidWheelRail, mounting: Mounting, y: Array, yaw: float = 0.0
) -> list[tuple[WheelsetState, dict[Side, FirstContact]]]:
    """`seated` at every lateral position y (n,) m, each reached in small steps from the middle of the track.

    Raises ValueError naming the first position, from the middle, that cannot be reached.
    """
    found: dict[int, tuple[WheelsetState, dict[Side, FirstContact]]] = {}
    middle = seated(pair, mounting, WheelsetState(yaw=yaw))
    for hand in (1.0, -1.0):
        state = middle[0]
        own = np.flatnonzero((y >= 0.0) if hand > 0.0 else (y < 0.0))
        for i in own[np.argsort(np.abs(y[own]), kind="stable")].tolist():
            way = np.linspace(state.y, y[i], int(np.ceil(abs(y[i] - state.y) / STEP)) + 1)[1:]
            last = middle if state is middle[0] else None
            for place in way.tolist():
                last = seated(pair, mounting, replace(state, y=place))
                state = last[0]
            found[i] = last or seated(pair, mounting, state)
    return [found[i] for i in range(len(y))]
