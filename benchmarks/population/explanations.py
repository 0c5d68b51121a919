"""Reasons of failures that the oracle confirms."""

from __future__ import annotations

import re
from dataclasses import replace
from itertools import pairwise

import numpy as np

from benchmarks.population.checks import TOUCH, section_of
from benchmarks.population.draw import Situation
from benchmarks.population.results import SideResult, side_result, solved
from wheelrail.contact.kinematics.frames import SIDES, Side

DEEPEST = 0.05  # m below the nominal height, to which loads are searched for
OVERLAP = 5e-4  # m: heights with more are no contact of elastic bodies
NAMED = re.compile(r"(?:overlaps the rail (\S+) mm deep|touches the rail) at y = (\S+), z = (\S+) mm of its profile")
OVERLOADED = re.compile(r"too deep for half-spaces: \S+ GPa are above")
UNSTEADY = "the force jumps over", "Newton's method did not converge"
BEYOND = "far beyond its load"
PULLED = "the wheel is pulled onto its rail"
LEAST_PULLING = 0.2  # friction whose force at the tread tilts a wheel by more than the load
ALONG = re.compile(r"passes (\S+) mm along the rail")
YIELDING = re.compile(r"do not settle.*would move them by \S+ mm")
NEAR = 5e-3  # m on the profile of a wheel
ORDINARY = (-50e-3, 45e-3)  # m, where a wheel touches a rail between flange tip and rim
FIELD = 36e-3  # m on the profile of a wheel, up to which finite bodies carry contact
STEEPEST = 0.05  # rad, to which a roll is looked for
BESIDE = 5e-4  # m, from an overlap to the next strip, whose face counts, too
CORNER = 1e-3  # m on the profile of a wheel, to the place that touches first
LOWEST, LOWERED = -18e-3, 1e-4  # m: end of a meshed rail's points from its top; steps in which a wheel is lowered
ROUNDED, NORMALS = 0.99, 1.1  # times the depth in a text, along the wheel's normal, up to 25 degrees off the rail's
SINE = 0.7  # of an angle about the axle, beyond which a lowest point is far ahead
TIP = 20e-3  # m, height on a flange above which it touches the rail as it climbs


def explanation(situation: Situation, side: Side, result: SideResult) -> str:
    """Reason of a failure that the oracle confirms; empty otherwise."""
    rigid, at = situation.rigid[side], situation.given_position(side)
    rolls = resting_rolls(situation) if situation.solve.get("roll") == "solve" else [situation.solve.get("roll", 0.0)]
    named = NAMED.search(result.status)
    if named:
        depth, y, z = (1e-3 * float(number or 0.0) for number in named.groups())
        reasons = [
            _named(situation, side, (y, z), roll)
            or _below_points(situation, side, (y, z), depth, roll)
            or _vertical(situation, side, (y, z), depth, roll)
            for roll in (at.roll, *rolls)
        ]
        if reason := next(filter(None, reasons), ""):
            return reason
    overloaded = OVERLOADED.search(result.status)
    unsteady = any(text in result.status for text in UNSTEADY)
    if (overloaded or unsteady) and any(_touches_corner(situation, side, roll) for roll in (at.roll, *rolls)):
        return "carried by a corner of the wheel, where pressures are not bounded"
    if PULLED in result.status and situation.on(side)["friction"] > LEAST_PULLING:
        return "pulled onto its rail by friction as the axle bends, where equilibria turn back"
    if "z" in situation.solve:
        deepest = float(rigid.section(at).depth.max())
        return "pressed into the rail by more than half a millimetre" if deepest > OVERLAP else ""
    along, yielding = ALONG.search(result.status), YIELDING.search(result.status)
    held = overloaded or named or yielding or BEYOND in result.status
    if held and any(_locked(situation, side, roll) for roll in rolls):
        return "held down by friction on its flange to an overlap of half a millimetre"
    if along:
        strips = situation.with_model(bodies="waveguide")
        other = side_result(solved(strips).data, side)
        if other.status.startswith("failed"):
            return explanation(strips, side, other)
        if other.status == "converged" and _extent(strips, side, other) > 1e-3 * float(along[1]):
            return "touches the rail farther along than grids have points"
    if yielding:
        return "pushes a rail aside by more than 5 mm, whose equilibria end"
    if not rolls:
        return "no roll at which both wheels rest on their rails"
    resting = rigid.first_contact(replace(at, z=0.0))
    if not resting > -DEEPEST:
        return "beside the rail"
    return ""


def _named(situation: Situation, side: Side, place: tuple[float, float], roll: float) -> str:
    """Reason of a failure that names an overlap at a place (y, z) m of the wheel's profile: where it overlaps its rail
    when it is lowered OVERLAP from there, and where profiles end or finite bodies do; empty elsewhere.
    """
    rigid, at, (y, z) = situation.rigid[side], situation.position(side, 0.0, roll), place
    low = rigid.section(replace(at, z=rigid.first_contact(at) - OVERLAP))
    over = (np.abs(low.y - y) < NEAR) & (low.depth > 0.0)
    if not over.any():
        return ""
    if situation.wheelset.get("bodies") in ("waveguide", "solid"):
        first = over & (low.depth > low.depth[over].max() - TOUCH)  # what touches first there
        if low.y[first].max() > FIELD or (abs(y - FIELD) < CORNER and low.y[over].max() > FIELD):
            return "touches the rail beyond the part of a finite wheel that carries contact points"
    at_end = (
        bool(np.abs(rigid.wheel_points[[[0], [-1]], 0] - low.y[over]).min() < CORNER)
        or not ORDINARY[0] < y < ORDINARY[1]
    )
    if at_end or z > TIP:
        return f"names an overlap of the {'flange' if y < 0.0 else 'rim'}"
    ends = np.hypot(*(low.place[over, None, 1:] - rigid.rail_points[[0, -1]]).T)
    return "names an overlap of the end of the rail's profile" if ends.min() < CORNER else ""


def _below_points(situation: Situation, side: Side, place: tuple[float, float], depth: float, roll: float) -> str:
    """Reason of a failure that names an overlap m at a place (y, z) m of the wheel's profile, where a wheel that is
    lowered has it only below the lines of a meshed rail; empty elsewhere.
    """
    if situation.wheelset.get("bodies") not in ("waveguide", "solid"):
        return ""
    rigid, at = situation.rigid[side], situation.position(side, 0.0, roll)
    k = int(np.argmin(np.hypot(*(rigid.wheel_points - place).T)))
    for z in np.arange(rigid.first_contact(at), -DEEPEST, -LOWERED):
        low = rigid.section(replace(at, z=z))
        if low.place[k, 2] < LOWEST and ROUNDED * depth < low.depth[k] < NORMALS * depth:
            return "touches the side of the rail farther down than meshed rails have points"
    return ""


def _vertical(situation: Situation, side: Side, place: tuple[float, float], depth: float, roll: float) -> str:
    """Reason of a failure that names an overlap m at a place (y, z) m of the wheel's profile: where a wheel that is
    lowered has it, the overlap reaches a face of the rail so steep that by the yaw a wheel has no lowest point on it;
    empty elsewhere.
    """
    rigid, at = situation.rigid[side], situation.position(side, 0.0, roll)
    k = int(np.argmin(np.hypot(*(rigid.wheel_points - place).T)))
    for z in np.arange(rigid.first_contact(at), -DEEPEST, -LOWERED):
        low = rigid.section(replace(at, z=z))
        if low.depth[k] > ROUNDED * depth:
            break
    else:
        return ""
    over = (low.depth > -BESIDE) & (np.abs(low.y - place[0]) < NEAR)
    across, up = np.gradient(rigid.rail_points, axis=0)[rigid.nearest(low.place[over, 1:])].T
    return "presses against a vertical face of the rail" if (SINE * across < np.abs(up * np.sin(at.yaw))).any() else ""


def _touches_corner(situation: Situation, side: Side, roll: float) -> bool:
    """Whether a wheel that is lowered onto its rail touches it with a corner."""
    rigid, at = situation.rigid[side], situation.position(side, 0.0, roll)
    resting = rigid.section(replace(at, z=rigid.first_contact(at)))
    return bool(rigid.corners[np.abs(resting.y - resting.y[np.argmax(resting.depth)]) < CORNER].any())


def _locked(situation: Situation, side: Side, roll: float) -> bool:
    """Whether a wheel that is lowered until it overlaps its rail by OVERLAP does so only on a face behind its axle,
    whose material moves up and is held down by friction, and too steep for the pressure to lift it.
    """
    rigid, at = situation.rigid[side], situation.position(side, 0.0, roll)
    z = rigid.first_contact(at)
    while (low := rigid.section(replace(at, z=z))).depth.max() < OVERLAP:
        z -= OVERLAP
        if z < -DEEPEST:
            return False
    over = low.depth > 0.0
    steep = np.abs(np.gradient(low.place[:, 2], low.place[:, 1])) * situation.on(side)["friction"] > 1.0
    return bool((steep & (low.place[:, 0] < 0.0))[over].all())


def _extent(own: Situation, side: Side, result: SideResult) -> float:
    """Largest distance m from the axle, along the rail, of the undeformed overlap at the height of a result."""
    section = section_of(own, side, result)
    k = int(np.argmax(section.depth))
    _, across, up = np.gradient(section.place, axis=0)[k]
    radius = (own.rigid[side].radius + own.rigid[side].wheel_points[k, 1]) * np.hypot(1.0, up / across)
    return float(abs(section.place[k, 0] - result.origin[0]) + np.sqrt(2.0 * radius * max(section.depth[k], 0.0)))


def resting_rolls(situation: Situation) -> list[float]:
    """Rolls of at most STEEPEST at which both undeformed wheels touch their rails at one height."""

    def excess(roll: float) -> float:
        left, right = (situation.rigid[side].first_contact(situation.position(side, 0.0, roll)) for side in SIDES)
        return left - right if np.isfinite(left) and np.isfinite(right) else np.nan

    rolls = np.linspace(-STEEPEST, STEEPEST, 41)
    found, before = [], excess(float(rolls[0]))
    for low, high in pairwise(rolls):
        after = excess(float(high))
        if before * after <= 0.0:
            ends = [float(low), float(high)]
            for _ in range(10):
                middle = 0.5 * sum(ends)
                ends[int(excess(middle) * before <= 0.0)] = middle
            found.append(0.5 * sum(ends))
        before = after
    return found
