"""Solves the cases of a stress test, each on its own, and keeps what came of it."""

from __future__ import annotations

from dataclasses import asdict, dataclass, field, replace
from functools import lru_cache
from time import perf_counter
from typing import Any

import numpy as np

from benchmarks.stability_check import broken, findings
from benchmarks.stability_depth import NoDepth, depth_for
from benchmarks.stability_sample import RADIUS, SIZES, Case
from contact.fitting import Fineness
from contact.laws import Laws, Steel
from contact.pairs import wheel_rail_pair
from contact.result import ContactResult
from contact.wheelset import ContactModel
from meshes.profiles import named_profile

TWIN_FINENESS = Fineness(16, 24)
LEAVES = "beyond the part of its surface"  # said by models when the contact leaves what is meshed
LONG = "longer than what fitted cells"


@dataclass(frozen=True)
class Outcome:
    """A case and what came of it: kind "converged", "no answer" (with the reason) or "failed"; seconds of the solve;
    figures of `stability_check`; broken limits; against its twin: differences of force and area over their size.
    """

    case: Case
    kind: str
    reason: str = ""
    depth: float = np.nan
    seconds: float = np.nan
    newton: int = 0
    load: float = np.nan
    figures: dict[str, float] = field(default_factory=dict)
    broken: tuple[str, ...] = ()
    force_differs: float = np.nan
    area_differs: float = np.nan

    @property
    def fitted(self) -> bool:
        return not np.isfinite(self.case.stiffness_per_area)

    def data(self) -> dict[str, Any]:
        return asdict(self)


def solve(case: Case, *, twin: bool = False) -> Outcome:
    """One case, and if asked an independent solution of the same: finer cells on finer lines, or half the size."""
    try:
        depth = depth_for(case)
    except NoDepth as error:
        return Outcome(case, "no answer", str(error))
    model = model_of(case)
    pose, motion = case.at(depth)
    start = perf_counter()
    result = model(pose, motion, None)
    seconds = perf_counter() - start
    newton = result.statistics.newton
    if not result.ok:
        legitimate = LEAVES in result.status or (LONG in result.status)
        return Outcome(case, "no answer" if legitimate else "failed", result.status, depth, seconds, newton)
    found = findings(case, pose, result)
    outcome = Outcome(
        case,
        "converged",
        result.status,
        depth,
        seconds,
        newton,
        float(result.force[2]),
        found,
        tuple(broken(found)),
    )
    if not twin or (not outcome.fitted and case.size == SIZES[0]):
        return outcome
    other = twin_of(case)(pose, motion, None)
    if not other.ok or not result.patches:
        return outcome
    force = float(np.linalg.norm(result.force - other.force)) / max(float(np.linalg.norm(other.force)), 1e-300)
    return replace(outcome, force_differs=force, area_differs=abs(area(result) / max(area(other), 1e-300) - 1))


def area(result: ContactResult) -> float:
    """Of all patches, m2."""
    return float(sum(patch.area for patch in result.patches))


def model_of(case: Case) -> ContactModel:
    model: ContactModel = replace(_pair(case.rail, case.size, np.isfinite(case.stiffness_per_area)), laws=case.laws)
    return model


def twin_of(case: Case) -> ContactModel:
    if np.isfinite(case.stiffness_per_area):
        grid: ContactModel = replace(_pair(case.rail, max(case.size / 2, SIZES[0]), True), laws=case.laws)
        return grid
    model: ContactModel = replace(_pair(case.rail, SIZES[0], False), laws=case.laws, fineness=TWIN_FINENESS)
    return model


@lru_cache(maxsize=4)
def _pair(rail: str, size: float, grid: bool) -> Any:
    """Model without friction, whose laws are replaced case by case."""
    return wheel_rail_pair(
        named_profile("S1002"),
        named_profile(rail),
        radius=RADIUS,
        wheel_steel=Steel(),
        rail_steel=Steel(),
        surface_size=size,
        laws=Laws(1e15 if grid else np.inf, 0.0, 0.0),
        bodies="waveguide",
    )
