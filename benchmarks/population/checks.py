"""Checks of one solved side by laws that hold for every model: each returns a text where the result breaks one."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace

import numpy as np

from benchmarks.population.bending import bent_rail, bent_wheel
from benchmarks.population.draw import Situation
from benchmarks.population.oracle import Section
from benchmarks.population.results import SideResult
from wheelrail.contact.kinematics.frames import Side
from wheelrail.support.arrays import Array, Mask

TOUCH = 2e-6  # m: files have 1e-9 m, splines follow the points of a worn profile to 1e-6 m
ORIGIN = 3e-5  # m, of the top of a rail, where its slope is 1e-4 on a crown of 0.3 m
SUMS = 1e-6  # of the load: integrals of tractions against forces
LOAD = 3e-4  # of the load: the largest jump that a search accepts is 2e-4
TENSION = 1e-6  # of the peak pressure
BOUND = 1e-2  # of mu times the peak: cells of strips hold means of a bound that varies
FRICTION = 1e-4  # of mu times the normal force, whose axes are those of the undeformed wheel
GEOMETRY = 0.03  # of the approach, along the normal there and to the closest point here
TILT = 1.25  # times the overlap inside of patches: a web that bends by 0.7 mm tilts the tread by 4 mrad over 10 mm
# FASTSIM's bound mu N / V (a^2 - x^2) has the sum of mu p. Its peak over mu p is (3 pi / 8) a int a^2 dy / int a^3 dy,
# 4/3 on an ellipse and pi/2 where the strips shorten linearly.
PARABOLIC = 0.5 * np.pi
PLACES = 11  # of a strip around a point
NAMED = 0.1  # of the approach: overlaps outside the patches that results of the standard contact name
E, NU = 2.1e11, 0.3


def broken(situation: Situation, side: Side, result: SideResult) -> list[str]:
    """Laws that a converged or separated side breaks."""
    section = section_of(situation, side, result)
    if result.status == "separated":
        deepest, at = float(section.depth.max()), _where(section, section.depth)
        resolved = deepest > TOUCH + between_points(situation, section, int(np.argmax(section.depth)))
        return [f"separated with an overlap of {1e6 * deepest:.1f} um{at}"] if resolved else []
    own = situation.wheelset
    fastsim = own.get("model") == "standard" and own.get("tangential") != "polach"
    return [*finite(result)] or [
        *_forces(situation, side, result),
        *laws(result, situation.on(side)["friction"], fastsim, dissipates=own.get("tangential") != "polach"),
        *_pose(situation, side, result),
        *_overlap(situation, side, section, result),
    ]


def flexible(situation: Situation) -> bool:
    """Whether wheels and rails move on the axle and the pads."""
    return bool({"axle", "pads"} & situation.wheelset.keys())


def between_points(situation: Situation, section: Section, at: int) -> float:
    """Fall m of the overlap from a point to a place half a cell beside it, unseen on a grid; 0 on others.

    On a flange's tip of 12 mm on a corner of 13 mm it is 80 um at 2 mm.
    """
    half = 0.5 * situation.wheelset.get("surface_size", 0.0)
    return float(section.depth[at] - np.interp((-half, half), section.arc - section.arc[at], section.depth).min())


def section_of(situation: Situation, side: Side, result: SideResult) -> Section:
    """Overlap at the pose of a result, where axle and rails are rigid at the own one of its height and roll."""
    rigid = situation.rigid[side]
    if flexible(situation):
        # the top of a flat crown, from which the pose counts, lies some um elsewhere here: the gauge faces agree
        head = rigid.rail.profile.inclined(rigid.inclination)
        top = (0.0, head.gauge_offset(rigid.gauge, rigid.gauge_height) - rigid.rail_y, 0.0)
        return rigid.overlap(rigid.silhouette(result.origin + top, result.rotation))
    return rigid.section(replace(situation.given_position(side), z=result.z, roll=result.roll))


def finite(result: SideResult) -> Iterator[str]:
    for name, value in vars(result).items():
        if isinstance(value, np.ndarray) and value.dtype.kind == "f" and not np.isfinite(value).all():
            yield f"{name} is not finite"


def _forces(situation: Situation, side: Side, result: SideResult) -> Iterator[str]:
    """Integrals over points, patches, and the load of one wheel."""
    load = result.load
    yield from sums(result)
    if not load > 0:
        return
    on_wheel = forces_of_points(result)
    if not flexible(situation):
        rigid = situation.rigid[side]
        at = situation.position(side, result.z, 0.0)
        centre = np.array([0.0, at.y - rigid.rail_y, rigid.nominal + at.z])
        moment = np.cross(result.position - centre, on_wheel).sum(axis=0)
        arm = float(np.linalg.norm(result.moment - moment)) / load
        if arm > ORIGIN:
            yield f"the moment differs by {1e3 * arm:.3g} mm times the load from that of its tractions"
    asked = situation.solve.get("wheel_load")
    if asked is not None and abs(result.force[2] - asked) > LOAD * asked:
        yield f"vertical force {result.force[2]:.6g} N where {asked:g} N is asked for"


def forces_of_points(result: SideResult) -> Array:
    """Forces (n, 3) N on the wheel."""
    tractions = np.column_stack([result.traction, -result.pressure])
    return np.asarray(np.einsum("nk,nkc->nc", tractions, result.axes) * result.area[:, None])


def sums(result: SideResult) -> Iterator[str]:
    """Integrals over points and patches against the force."""
    if not result.load > 0:
        yield "converged without a force"
        return
    for name, own in (
        ("the integral of its tractions", forces_of_points(result)),
        ("that of its patches", result.patch_force),
    ):
        off = float(np.linalg.norm(result.force - own.sum(axis=0))) / result.load
        if off > SUMS:
            yield f"the force differs by {off:.1e} from {name}"


def laws(result: SideResult, mu: float, fastsim: bool, *, dissipates: bool = True) -> Iterator[str]:
    """Pressure, friction bound and dissipation.

    Parameters:
        result: of one side.
        mu: largest coefficient of friction.
        fastsim: whether the bound of the tractions is parabolic.
        dissipates: whether friction must not do work: by Polach's lateral force of spin it does, as there is no moment.
    """
    p, q, peak = result.pressure, result.traction, float(result.pressure.max(initial=0.0))
    if p.min(initial=0.0) < -TENSION * peak:
        yield f"tension of {-p.min() / peak:.1e} of the peak pressure"
    most = mu * peak
    beyond = float((np.hypot(*q.T) - (PARABOLIC * most if fastsim else mu * p)).max(initial=0.0))
    if beyond > BOUND * most:
        yield f"traction beyond the bound by {beyond / most if most else np.inf:.1e} of its peak"
    bound = mu * float((p * result.area).sum())
    total = float((np.hypot(*q.T) * result.area).sum())
    if total > (1.0 + FRICTION) * bound + 1e-9 * result.load:
        yield f"sum of the tractions is {total / max(bound, 1e-300):.6g} of the friction bound"
    power = (q * result.slip).sum(axis=1) * result.area
    if dissipates and power.sum() > 1e-3 * np.abs(power).sum() + 1e-9 * result.load:
        yield "friction does work on the wheel and the rail"


def _pose(situation: Situation, side: Side, result: SideResult) -> Iterator[str]:
    """The pose of the wheel against the own one of the same wheelset position."""
    if flexible(situation):
        return
    given, rigid = situation.given_position(side), situation.rigid[side]
    if situation.solve.get("roll") != "solve" and abs(result.roll - given.roll) > 1e-12:
        yield f"roll {result.roll:g} rad where {given.roll:g} is given"
    if "z" in situation.solve and result.z != situation.solve["z"]:
        yield f"height {result.z:g} m where {situation.solve['z']:g} is given"
    own = rigid.outline(replace(given, z=result.z, roll=result.roll))
    off = float(np.abs(own - rigid.silhouette(result.origin, result.rotation)).max())
    if off > ORIGIN:
        yield f"the pose of the wheel is {1e6 * off:.2f} um off"


def _overlap(situation: Situation, side: Side, section: Section, result: SideResult) -> Iterator[str]:
    """Approach, and overlap that remains outside the patches beyond the elastic lowering of the surfaces there."""
    y, depth = section.y, section.depth
    inside = np.zeros(len(y), dtype=bool)
    for (low, high), strips in zip(result.bands, result.strips, strict=True):
        margin = max((high - low) / max(strips, 8), 2e-4)
        inside |= (y >= low - margin) & (y <= high + margin)
    if situation.wheelset.get("normal") == "hertz":  # one ellipse stands for the overlap around a deepest point
        inside |= _connected(depth > 0.0, inside)
    deepest = float(depth.max())
    within = float(depth[inside].max(initial=-np.inf))
    unseen = between_points(situation, section, int(np.argmax(depth)))
    allowed = TOUCH + GEOMETRY * abs(result.approach) + unseen + within_strip(section, result)
    rigid = situation.rigid[side]
    allowed += rigid.rounding if rigid.corners[int(np.argmax(depth))] else 0.0
    if abs(deepest - result.approach) > allowed:
        at = _where(section, depth)
        yield f"approach {1e6 * result.approach:.2f} um where the overlap is {1e6 * deepest:.2f} um{at}"
    excess, where = _remaining(situation, side, section, ~inside, within, unseen, result)
    if excess > 0.0 and not names_overlap(result, excess):
        yield f"overlap of {1e6 * excess:.1f} um remains outside the contacts{where}"


def names_overlap(result: SideResult, excess: float = 0.0) -> bool:
    """Whether a result of the standard contact says that an overlap m, or more, remains outside its patches."""
    return result.unsolved > NAMED * result.approach and result.unsolved > (1.0 - NAMED) * excess


def _remaining(
    situation: Situation, side: Side, section: Section, outside: Mask, within: float, unseen: float, result: SideResult
) -> tuple[float, str]:
    """Overlap m outside the patches beyond the elastic lowering there, and its place; 0 if it is small."""
    outside = outside & (section.depth > TOUCH)
    if not outside.any():
        return 0.0, ""
    lowered = lowering(section.place[outside], result) + parted(situation, side, section, result)[outside]
    excess = float((section.depth[outside] - lowered).max())
    margin = TOUCH + 0.1 * max(within, 0.0) + unseen
    if (
        flexible(situation)
        or situation.wheelset.get("bodies") in ("waveguide", "solid")
        or situation.wheelset.get("model") == "full"
    ):
        margin = max(margin, TILT * within)  # webs, feet, axles and pads give way, too
    where = _where(section, np.where(outside, section.depth, -np.inf))
    return (excess, where) if excess > margin else (0.0, "")


def within_strip(section: Section, result: SideResult) -> float:
    """Largest fall m from the deepest point to the mean over a strip that has it, which is the approach on strips; 0 on
    others.

    Of a parabola on 4 strips it is 1/12 of the depth, and 26 um at the chamfer of a rim, slopes of 0.2 and 0.9 beside
    it, on strips of 0.17 mm.
    """
    deepest, arc = int(np.argmax(section.depth)), section.arc
    for (low, high), strips in zip(result.bands, result.strips, strict=True):
        inside = (section.y >= low) & (section.y <= high)
        if not strips or not inside[deepest]:
            continue
        outside = np.flatnonzero(~inside)  # y returns behind the tip of a flange
        first, last = outside[outside < deepest].max(initial=0), outside[outside > deepest].min(initial=len(arc) - 1)
        width = (arc[last] - arc[first]) / max(strips - 1, 1)  # outer strips touch on a part of their width
        volume = np.concatenate([[0.0], np.cumsum(np.diff(arc) * 0.5 * (section.depth[1:] + section.depth[:-1]))])
        starts = arc[deepest] - width * np.linspace(0.0, 1.0, PLACES)
        mean = (np.interp(starts + width, arc, volume) - np.interp(starts, arc, volume)) / width
        return float(section.depth[deepest] - mean.min())
    return 0.0


def _connected(overlaps: Mask, inside: Mask) -> Mask:
    """Points (n,) of those connected parts of an overlap that have points inside of patches."""
    part = np.cumsum(np.diff(overlaps, prepend=False) & overlaps) * overlaps
    return np.asarray(np.isin(part, np.unique(part[inside & overlaps])) & overlaps)


def lowering(places: Array, result: SideResult) -> Array:
    """Distance m by which the pressure of all points parts two half-spaces at places (n, 3) m (Boussinesq)."""
    loaded = result.pressure > 0
    force = (result.pressure * result.area)[loaded]
    distance = np.linalg.norm(places[:, None, :] - result.position[loaded][None], axis=2)
    near = 0.5 * np.sqrt(result.area[loaded])  # of a cell
    return np.asarray(2.0 * (1.0 - NU**2) / (np.pi * E) * (force / np.maximum(distance, near)).sum(axis=1))


def parted(situation: Situation, side: Side, section: Section, result: SideResult) -> Array:
    """Distance (n,) m by which the load bends a clamped rail and wheel apart, at the points of a section; 0 for bodies
    that do not bend. 51 kN of friction on a tread part a flange by 0.4 mm.
    """
    if situation.wheelset.get("bodies") != "waveguide" or situation.wheelset.get("model") == "full":
        return np.zeros(len(section.y))
    own, places, force = situation.on(side), section.place[:, 1:], result.force[1:]
    at = np.average(result.position[:, 1:], axis=0, weights=result.pressure * result.area)
    wheel, rail = bent_wheel(own["radius"]), bent_rail(own["rail"])
    centre = result.origin[1:]
    apart = wheel.displacement(force, at - centre, places - centre) - rail.displacement(-force, at, places)
    across, up = np.gradient(places, axis=0).T
    return np.asarray(np.maximum((apart[:, 1] * across - apart[:, 0] * up) / np.hypot(across, up), 0.0))


def _where(section: Section, depth: Array) -> str:
    at = int(np.argmax(depth))
    y, z = 1e3 * section.place[at, 1:]
    return f", at y = {1e3 * section.y[at]:.1f} mm of the wheel, ({y:.1f}, {z:.1f}) mm of the rail"
