"""Judgement of a situation: right, explained failure, unexplained failure or wrong, each with its reason."""

from __future__ import annotations

import re
from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field, replace
from time import process_time
from typing import Literal

import numpy as np

from benchmarks.population.checks import LOAD, TOUCH, broken, names_overlap
from benchmarks.population.draw import Situation, with_profiles
from benchmarks.population.explanations import explanation
from benchmarks.population.oracle import RigidSide
from benchmarks.population.results import SideResult, side_result, solved
from wheelrail.contact.kinematics.frames import SIDES, Side

Kind = Literal["right", "explained failure", "unexplained failure", "wrong"]
KINDS: tuple[Kind, ...] = ("right", "explained failure", "unexplained failure", "wrong")

MIRROR = 1e-9  # of the load, of mirror images at a given height or under the load of each wheel
UNLIKE = 1e-2  # of the load, where wheels differ on an axle: both hubs are those of the left-hand one
WARM = 2e-5  # of the load, from another start: a last step of 1e-5 of the tractions
STEP = {"y": 3e-5, "z": 1e-5}  # m, to the start of the warm solve
# The standard contact against elastic half-spaces: its approach under a load is that of Kik and Piotrowski's virtual
# penetration, 5 to 8 % larger on ellipses and more where patches are not; its tangential force is within a third of
# mu N of the complete theory at every creepage.
BAND_APPROACH, BAND_FORCE = 0.5, 0.4
BAND_NORMAL = 0.25  # of the wider range of normals of both patches, in which both resultants lie; 0.08 on gauge corners
NO_RIM = re.compile(r"wheel disc_\w+ is \S+ m wide, the rim \S+ m$")
NARROW, STRIPS_ONLY = "the width of the wheelset over its flanges", "error_estimate = true: allowed only with points"
REFUSED = re.compile(r"(wheel_load|axle_load) = \S+: must be a number from (\S+) to (\S+)")


@dataclass(frozen=True)
class Verdict:
    """Judgement of a situation.

    Parameters:
        seed, line: of the situation, and the line of Python.
        kind, reason: the judgement.
        seconds: of processor time, of the solve and with its judgement.
        model: in short.
        sides: status and figures by side.
    """

    seed: int
    line: str
    kind: Kind
    reason: str
    seconds: tuple[float, float] = (0.0, 0.0)
    model: str = ""
    sides: Mapping[Side, str] = field(default_factory=dict)


def model_of(situation: Situation) -> str:
    """Contact model in short."""
    own = situation.wheelset
    if own.get("model") == "standard":
        return "standard"
    return f"{own.get('model', 'condensed')} {own['bodies']} {own.get('points', 'lattice')}"


def judged(situation: Situation) -> Verdict:
    """Solve a situation and judge its result."""
    began = process_time()

    def verdict(kind: Kind, reason: str, sides: Mapping[Side, str] | None = None) -> Verdict:
        seconds = (spent, process_time() - began)
        return Verdict(situation.seed, str(situation), kind, reason, seconds, model_of(situation), sides or {})

    try:
        solution = solved(situation)
    except Exception as error:
        spent = process_time() - began
        return verdict(*of_exception(situation, error))
    spent = process_time() - began
    results = {side: side_result(solution.data, side) for side in situation.sides}
    failures = {side: result for side, result in results.items() if result.status.startswith("failed")}
    sides = {side: _figures(result) for side, result in results.items()}
    try:
        texts = [*faults(situation, results)]
        if not texts and len(failures) < len(results):
            texts = [*compared(situation, results)]
    except Exception as error:
        texts = [f"its judgement raises {type(error).__name__}: {error}"]
    if texts:
        return verdict("wrong", "; ".join(texts), sides)
    if not failures and any(names_overlap(result) for result in results.values()):
        return verdict("explained failure", "names an overlap that virtual penetration leaves", sides)
    if not failures:
        return verdict("right", "", sides)
    reasons = {side: explanation(situation, side, result) for side, result in failures.items()}
    if len({result.status for result in failures.values()}) == 1:  # one failure of both, for either's reason
        reasons = dict.fromkeys(failures, next(filter(None, reasons.values()), ""))
    if all(reasons.values()):
        return verdict("explained failure", "; ".join(dict.fromkeys(reasons.values())), sides)
    unexplained = [failures[side].status for side, reason in reasons.items() if not reason]
    return verdict("unexplained failure", "; ".join(dict.fromkeys(unexplained)), sides)


def _figures(result: SideResult) -> str:
    peak = 1e-6 * float(result.peak.max(initial=0.0))
    force = " ".join(f"{value:.6g}" for value in result.force)
    return (
        f"{result.status}; ({force}) N, {peak:.0f} MPa, {len(result.peak)} patches, "
        f"approach {1e6 * result.approach:.3f} um, z {1e3 * result.z:.6f} mm, roll {1e3 * result.roll:.6f} mrad"
    )


def of_exception(situation: Situation, error: Exception) -> tuple[Kind, str]:
    """Judgement of an exception: refused values that are out of the documented range are explained."""
    from wheelrail.scenes.schema.errors import SceneError

    text = f"{type(error).__name__}: {error}"
    refused = REFUSED.search(str(error))
    if isinstance(error, SceneError) and refused:
        low, high = float(refused[2]), float(refused[3])
        if not low <= situation.solve[refused[1]] <= high:
            return "explained failure", f"refused: {refused[1]} out of range"
    if NARROW in str(error) and sum(rigid.flange_y for rigid in situation.rigid.values()) > situation.wheelset["gauge"]:
        return "explained failure", "refused: flanges wider apart than the rails"
    strips = situation.wheelset.get("points", "lattice") == "lattice" and situation.wheelset.get("model") != "full"
    if STRIPS_ONLY in str(error) and not strips:
        return "explained failure", "refused: errors are estimated on strips only"
    meshed = "axle" in situation.wheelset or situation.wheelset.get("bodies") in ("waveguide", "solid")
    if meshed and NO_RIM.search(str(error)):
        return "explained failure", "refused: a disc is no wheel whose rim, web and hub are elastic"
    clear = isinstance(error, SceneError | ValueError) and "\n" not in str(error)
    return ("unexplained failure" if clear else "wrong"), text


def faults(situation: Situation, results: Mapping[Side, SideResult]) -> Iterator[str]:
    """Laws that results break, by side and together."""
    for side, result in results.items():
        if not result.status.startswith("failed"):
            yield from (f"{side}: {text}" for text in broken(situation, side, result))
    if any(result.status.startswith("failed") for result in results.values()):
        return
    total, asked = sum(result.force[2] for result in results.values()), situation.solve.get("axle_load")
    if asked is not None and abs(total - asked) > LOAD * asked:
        yield f"vertical forces of {total:.6g} N where {asked:g} N are asked for"
    if "wheel_load" in situation.solve and any(result.status != "converged" for result in results.values()):
        yield "separated under a load"
    if len(results) == 2 and situation.solve.get("roll") == "solve":
        (left, right) = (results[side] for side in SIDES)
        if left.z != right.z or left.roll != -right.roll:
            yield "sides of one wheelset at different heights or rolls"


def compared(situation: Situation, results: Mapping[Side, SideResult]) -> Iterator[str]:
    """Differences to the mirror image, to other starts, and to the other model."""
    yield from mirrored(situation, results)
    if {"axle", "pads"} & situation.wheelset.keys():
        return
    yield from started_elsewhere(situation, results)
    if situation.wheelset.get("bodies") == "half-space":
        yield from against_standard(situation, results)


def mirrored(situation: Situation, results: Mapping[Side, SideResult]) -> Iterator[str]:
    """Differences to the mirror image in y = 0."""
    image = situation.mirrored()
    try:
        data = solved(image).data
    except Exception as error:
        yield f"its mirror image raises {type(error).__name__}: {error}"
        return
    unlike = "axle" in situation.wheelset and bool({*SIDES} & situation.wheelset.keys())
    together = "axle_load" in situation.solve or situation.solve.get("roll") == "solve"
    for side, result in results.items():
        other = side_result(data, "right" if side == "left" else "left")
        if other.status.split(":")[0] != result.status.split(":")[0]:
            yield f"{side}: {result.status}, its mirror image {other.status}"
        elif result.status == "converged":
            off = float(np.abs(other.force - result.force).max()) / result.load
            if off > (UNLIKE if unlike else 2.0 * LOAD if together else MIRROR):
                yield f"{side}: the force differs by {off:.1e} from that of its mirror image"


def started_elsewhere(situation: Situation, results: Mapping[Side, SideResult]) -> Iterator[str]:
    """Differences between solves of an element from none and from another result."""
    import wheelrail as wr

    contact = wr.Wheelset(**with_profiles(situation.wheelset)).element().contact
    for side, result in results.items():
        if result.status != "converged":
            continue
        # the pressure at a corner is not bounded: ends of strips beside it have several places, or none from none
        corner = on_corner(situation.rigid[side], result)
        allowed = LOAD if corner else WARM
        state = replace(situation.state, z=result.z, roll=result.roll if side == "left" else -result.roll)
        aside = replace(state, y=state.y + STEP["y"], z=state.z + STEP["z"])
        (cold,) = contact.solve_side([state], side, [None])
        if not cold.ok and corner:
            continue
        if not cold.ok:
            yield f"{side}: solved from none: {cold.status}"
            continue
        (near,) = contact.solve_side([aside], side, [None])
        if not near.ok:
            yield f"{side}: solved 30 um aside: {near.status}"
            continue
        (warm,) = contact.solve_side([state], side, [near])
        for name, again in (("from none", cold), ("from another start", warm)):
            if again.status != "converged":
                yield f"{side}: solved {name}: {again.status}"
                continue
            force = again.force * (1.0, -1.0 if side == "right" else 1.0, 1.0)
            off = float(np.abs(force - result.force).max()) / result.load
            if off > allowed:
                yield f"{side}: solved {name} the force differs by {off:.1e}"


def against_standard(situation: Situation, results: Mapping[Side, SideResult]) -> Iterator[str]:
    """Results outside the band around the standard contact at the same load."""
    other = situation.with_model(model="standard")
    try:
        data = solved(other).data
    except Exception as error:
        yield f"the standard contact raises {type(error).__name__}: {error}"
        return
    deepest = max(result.approach for result in results.values())
    up = {
        side: abs(float(np.average(result.axes[:, 2, 2], weights=result.pressure)))
        for side, result in results.items()
        if result.status == "converged"
    }
    for side, result in results.items():
        standard, mu = side_result(data, side), situation.on(side)["friction"]
        if "failed" in result.status + standard.status:
            continue
        if "z" in situation.solve:
            near = abs(result.approach) < TOUCH
            if standard.status != result.status and not near:
                yield f"{side}: {result.status}, the standard contact {standard.status}"
            continue
        along = up.get(side, min(up.values(), default=1.0))  # a wheel in the air is as high as the other one
        band = BAND_APPROACH * max(deepest, standard.approach) / along + TOUCH  # of heights: approaches are normal
        if abs(result.z - standard.z) > band and situation.solve.get("roll") != "solve":
            above = 1e6 * (result.z - standard.z)
            yield f"{side}: {above:.1f} um above the standard contact, approach {1e6 * deepest:.1f} um"
        if "separated" in (result.status, standard.status):
            continue
        # over the own load: of 114 kN on an axle one wheel carries 9.4 kN on strips and 7.6 kN by the standard contact
        off = np.abs(result.force / result.load - standard.force / standard.load)[:2].max()
        if (
            off > BAND_FORCE * max(mu, 1e-3) + BAND_NORMAL * max(spread(result), spread(standard))
            and len(result.peak) == len(standard.peak) == 1
            and not on_corner(situation.rigid[side], result)
        ):
            yield f"{side}: force {off:.2f} of the load off the standard contact's at friction {mu:g}"


def spread(result: SideResult) -> float:
    """Largest angle rad between the normal of a loaded point and their mean."""
    normals = result.axes[result.pressure > 0.0, 2]
    mean = normals.mean(axis=0)
    return float(np.linalg.norm(normals - mean / np.linalg.norm(mean), axis=1).max())


def on_corner(rigid: RigidSide, result: SideResult) -> bool:
    """Whether a patch has a corner of the wheel, where resultants lie anywhere between the normals beside it: at the
    chamfer of a rim, of 0.78 rad, by 0.07 on strips and 0.19 rad by the standard contact.
    """
    y = rigid.wheel_points[rigid.corners, 0]
    return any(((y >= low) & (y <= high)).any() for low, high in result.bands)
