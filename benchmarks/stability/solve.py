"""Solution of the cases of a stress test, and their outcomes."""

from __future__ import annotations

from dataclasses import asdict, dataclass, field, replace
from functools import lru_cache
from time import perf_counter
from typing import Any

import numpy as np

from benchmarks.stability.depth_estimate import NoDepth, depth_for
from benchmarks.stability.invariants import broken, findings
from benchmarks.stability.sample import RADIUS, SIZES, SampledCase
from wheelrail.contact.laws.material import Material
from wheelrail.contact.laws.parameters import ContactLaws
from wheelrail.contact.models.builders import wheel_rail_pair
from wheelrail.contact.models.discretisation import Discretisation
from wheelrail.contact.models.lattice.resolution import LatticeResolution
from wheelrail.contact.models.wheelset import ContactModel
from wheelrail.contact.results.result import ContactResult
from wheelrail.meshes.profiles.named import named_profile

TWIN_FINENESS = LatticeResolution(32, 20)
LEAVES = "beyond the part of its surface"  # status of models when the contact leaves the meshed surface
LONG = "longer than what fitted cells"
BETWEEN = "separated: the contact lies between the grid's points"


@dataclass(frozen=True)
class SolveOutcome:
    """Outcome of a case: kind "converged", "no answer" (with the reason) or "failed"; seconds of the solve; settled:
    convergence of the patch-edge iteration; load N, the vertical part of the pressure; values of `stability_check` and
    those beyond their limits; status of its twin, if any, and relative differences of force and area from it.
    """

    case: SampledCase
    kind: str
    reason: str = ""
    depth: float = np.nan
    seconds: float = np.nan
    newton: int = 0
    settled: bool = True
    load: float = np.nan
    figures: dict[str, float] = field(default_factory=dict)
    broken: tuple[str, ...] = ()
    twin: str = ""
    force_differs: float = np.nan
    area_differs: float = np.nan

    @property
    def fitted(self) -> bool:
        return not np.isfinite(self.case.stiffness_per_area)

    def data(self) -> dict[str, Any]:
        return asdict(self)


def solve(case: SampledCase, *, twin: bool = False) -> SolveOutcome:
    """Solves one case and, if requested or if the patch-edge iteration did not converge, an independent twin: finer
    cells on finer lines, or half the size.
    """
    try:
        depth = depth_for(case)
    except NoDepth as error:
        return SolveOutcome(case, "no answer", str(error))
    model = model_of(case)
    pose, motion = case.at(depth)
    start = perf_counter()
    result = model(pose, motion, None)
    seconds = perf_counter() - start
    statistics = result.statistics
    settled = bool(getattr(statistics, "settled", True))
    outcome = SolveOutcome(case, "failed", result.status, depth, seconds, statistics.newton, settled)
    if result.status == "separated":
        return outcome if outcome.fitted else replace(outcome, kind="no answer", reason=BETWEEN)
    if not result.ok:
        return replace(outcome, kind="no answer") if legitimate(result.status) else outcome
    values = findings(case, pose, result)
    outcome = replace(
        outcome, kind="converged", load=vertical_load(result), figures=values, broken=tuple(broken(values))
    )
    if (settled and not twin) or (not outcome.fitted and case.size == SIZES[0]):
        return outcome
    twin_result = twin_of(case)(pose, motion, None)
    if not twin_result.patches or not result.patches:
        return replace(outcome, twin=twin_result.status)
    force = float(np.linalg.norm(result.force - twin_result.force)) / float(np.linalg.norm(twin_result.force))
    return replace(
        outcome,
        twin=twin_result.status,
        force_differs=force,
        area_differs=abs(area(result) / max(area(twin_result), 1e-300) - 1),
    )


def legitimate(status: str) -> bool:
    """Whether a status means that the contact is beyond the range of the model, not a failed solve."""
    return LEAVES in status or LONG in status


def vertical_load(result: ContactResult) -> float:
    """Vertical part N of the pressure; on a steep flange friction may carry the remainder."""
    fields = result.fields
    if fields is None:
        return 0.0
    return float(-(fields.pressure * fields.area) @ fields.axes[:, 2, 2])


def area(result: ContactResult) -> float:
    """Total area of all patches, m2."""
    return float(sum(patch.area for patch in result.patches))


def model_of(case: SampledCase) -> ContactModel:
    model: ContactModel = replace(_pair(case.rail, case.size, np.isfinite(case.stiffness_per_area)), laws=case.laws)
    return model


def twin_of(case: SampledCase) -> ContactModel:
    if np.isfinite(case.stiffness_per_area):
        grid: ContactModel = replace(_pair(case.rail, max(case.size / 2, SIZES[0]), True), laws=case.laws)
        return grid
    model: ContactModel = replace(_pair(case.rail, SIZES[0], False), laws=case.laws, resolution=TWIN_FINENESS)
    return model


@lru_cache(maxsize=4)
def _pair(rail: str, size: float, grid: bool) -> Any:
    """Frictionless model, whose laws are replaced for each case."""
    laws = ContactLaws(1e15 if grid else np.inf, 0.0, 0.0)
    profiles = named_profile("S1002"), named_profile(rail)
    return wheel_rail_pair(profiles, RADIUS, (Material(), Material()), laws, Discretisation(size, bodies="waveguide"))
