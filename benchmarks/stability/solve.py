"""Solution of the cases of a stress test, and their outcomes."""

from __future__ import annotations

from dataclasses import asdict, dataclass, field, replace
from functools import lru_cache
from time import perf_counter
from typing import Any

import numpy as np

from benchmarks.stability.depth_estimate import NoDepth, depth_for
from benchmarks.stability.invariants import TIGHT, broken, findings
from benchmarks.stability.sample import RADIUS, SIZES, SampledCase
from wheelrail.bindings._contact import PATCH_TOO_LONG
from wheelrail.contact.laws.material import Material
from wheelrail.contact.laws.parameters import ContactLaws
from wheelrail.contact.models.builders import wheel_rail_pair
from wheelrail.contact.models.discretisation import Discretisation
from wheelrail.contact.models.lattice.resolution import LatticeResolution
from wheelrail.contact.models.wheelset import ContactModel
from wheelrail.contact.results.result import ContactResult
from wheelrail.meshes.profiles.named import named_profile

FINE = LatticeResolution(28, 24)  # twice the default
LEAVES = "beyond the part of its surface"  # status of models when the contact leaves the meshed surface
BETWEEN = "separated: the contact lies between the grid's points"
EARLIER = ((3e-4, 1.0, 1.0), (3e-3, 0.3, -1.0))  # m aside, fraction of the load, of the creepages: warm starts


@dataclass(frozen=True)
class SolveOutcome:
    """Outcome of a case: kind "converged", "no answer" (with the reason) or "failed"; seconds of the solve; load N, the
    vertical part of the pressure; values of `findings` and those beyond their limits; status of its twin, if any, and
    relative differences of force and area from it; rough, whether the result says that it has too few strips; history,
    the largest relative difference of the force by starts from earlier results, inf where one fails.
    """

    case: SampledCase
    kind: str
    reason: str = ""
    depth: float = np.nan
    seconds: float = np.nan
    newton: int = 0
    load: float = np.nan
    figures: dict[str, float] = field(default_factory=dict)
    broken: tuple[str, ...] = ()
    twin: str = ""
    force_differs: float = np.nan
    area_differs: float = np.nan
    rough: bool = False
    history: float = np.nan

    @property
    def strips(self) -> bool:
        """Whether the points are those of strips."""
        return self.case.laws.exact_normal

    def data(self) -> dict[str, Any]:
        return asdict(self)


def solve(case: SampledCase, *, twin: bool = False) -> SolveOutcome:
    """Solves one case; strips again from earlier results, and if requested a twin: strips and cells twice as fine on
    the same bodies, or a grid of half the size.
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
    outcome = SolveOutcome(case, "failed", result.status, depth, seconds, result.statistics.newton)
    if result.status == "separated":
        return outcome if outcome.strips else replace(outcome, kind="no answer", reason=BETWEEN)
    if not result.ok:
        return replace(outcome, kind="no answer") if legitimate(result.status) else outcome
    values = findings(case, depth, result, model)
    outcome = replace(
        outcome,
        kind="converged",
        load=vertical_load(result),
        figures=values,
        rough=any(patch.rough for patch in result.patches),
    )
    outcome = replace(outcome, broken=tuple(broken(case, values, outcome.rough)))
    if outcome.strips:
        outcome = replace(outcome, history=history(case, depth, result, model))
    if not twin or (not outcome.strips and case.size == SIZES[0]):
        return outcome
    twin_result = twin_of(case)(pose, motion, None)
    if not twin_result.patches or not result.patches:
        return replace(outcome, twin=twin_result.status)
    return replace(
        outcome,
        twin=twin_result.status,
        force_differs=_difference(result, twin_result),
        area_differs=abs(area(result) / max(area(twin_result), 1e-300) - 1),
    )


def history(case: SampledCase, depth: float, result: ContactResult, model: ContactModel) -> float:
    """Largest relative difference of the force from starts at other poses; those without a result do not count."""
    largest = 0.0
    for aside, load, creepage in EARLIER:
        other = replace(
            case,
            y=case.y - float(np.copysign(aside, case.y)),
            load=load * case.load,
            longitudinal=creepage * case.longitudinal,
            lateral=creepage * case.lateral,
        )
        try:
            earlier = model(*other.at(depth_for(other)), None)
        except NoDepth:
            continue
        if earlier.ok and earlier.patches:
            again = model(*case.at(depth), earlier)
            largest = max(largest, _difference(again, result) if again.ok else np.inf)
    return largest


def _difference(result: ContactResult, reference: ContactResult) -> float:
    """Of forces, relative to the reference."""
    return float(np.linalg.norm(result.force - reference.force)) / float(np.linalg.norm(reference.force))


def legitimate(status: str) -> bool:
    """Whether a status means that the contact is beyond the range of the model, not a failed solve."""
    return LEAVES in status or PATCH_TOO_LONG in status


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
    """Model of a case, with the last Newton step on strips below `TIGHT`."""
    grid = not case.laws.exact_normal
    options = {} if grid else {"tolerance": TIGHT}
    model: ContactModel = replace(_pair(case.rail, case.size, grid), laws=case.laws, **options)
    return model


def twin_of(case: SampledCase) -> ContactModel:
    """A finer model of a case."""
    if not case.laws.exact_normal:
        grid: ContactModel = replace(_pair(case.rail, max(case.size / 2, SIZES[0]), True), laws=case.laws)
        return grid
    model: ContactModel = replace(_pair(case.rail, case.size, False), laws=case.laws, resolution=FINE)
    return model


@lru_cache(maxsize=4)
def _pair(rail: str, size: float, grid: bool) -> Any:
    """Frictionless model, whose laws are replaced for each case."""
    laws = ContactLaws(1e15 if grid else np.inf, 0.0, 0.0)
    profiles = named_profile("S1002"), named_profile(rail)
    how = Discretisation(size, bodies="waveguide", points="grid" if grid else "lattice")
    return wheel_rail_pair(profiles, RADIUS, (Material(), Material()), laws, how)
