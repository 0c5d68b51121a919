"""Invariants of every converged contact: laws, equilibrium, dissipation, each as a value that must be small."""

from __future__ import annotations

import numpy as np

from benchmarks.stability.depth_estimate import penetration_outside
from benchmarks.stability.sample import SampledCase
from wheelrail.bindings._contact import LatticeProblem, opening, penetration
from wheelrail.contact.kinematics.frames import Pose, RigidMotion
from wheelrail.contact.laws.material import Material
from wheelrail.contact.models.lattice.influence.basis import equal_cells
from wheelrail.contact.models.lattice.model import LatticeContact
from wheelrail.contact.models.lattice.states import LatticeState, states_of
from wheelrail.contact.models.wheelset import ContactModel
from wheelrail.contact.results.result import ContactResult, Fields
from wheelrail.support.arrays import Array

LIMITS = {
    "residual": 1e-8,
    "force": 1e-10,
    "moment": 1e-10,
    "patches": 1e-9,
    "pull": 0.0,
    "friction": 3e-8,  # tractions converge to 1e-9 of their norm, which may be that of one cell of a thousand
    "law": 3e-8,
    "work": 1e-8,
    "penetration": 1e-7,
    "missed": 1.0,
    "unloaded": 0.0,
    "undeformed": 1e-7,
}
LATTICE = {  # limits of strips: means over cells deviate from a gap that vanishes in its moments alone
    "penetration": 1e-2,
    "unloaded": 1e-3,
}
TIGHT = 1e-8  # of the last Newton step on strips, relative to the peak pressure
PROBES = equal_cells(60)  # along an unloaded strip
NARROW = 1e-5  # variation of a bound over itself: the mean is the value at the middle
G = Material().E / (2 + 2 * Material().nu)  # Pa


def findings(case: SampledCase, depth: float, result: ContactResult, model: ContactModel) -> dict[str, float]:
    """Values by name, see LIMITS.

    residual of the solve; force and moment (about the wheel's origin) of the result minus the opposite of those of the
    tractions on the rail, over load and load times a metre; the patches' forces minus the result's; pull, the largest
    tension over the peak pressure; friction, traction beyond mu p over mu times the peak; law, the largest q max(|s|,
    eps) + mu p s, and work, the largest q . s > 0, over mu times the peak times the largest slip, or the strain due to
    mu times the peak; on strips law is the residual of the mean law of a cell, over mu times the peak; penetration at
    loaded and open points over the approach; missed, the largest undeformed penetration outside all patches over that
    inside: pressure lowers a surface most where it acts; unloaded, the largest penetration that remains in a strip of a
    lattice without pressure, over the approach; undeformed, the error of the undeformed penetration of the points of a
    lattice, over the approach. All infinite without any pressure: penetrating bodies must carry some.
    """
    pose, motion = case.at(depth)
    fields = result.fields
    if fields is None or not fields.pressure.any():
        return dict.fromkeys(LIMITS, np.inf)
    p, q, s = fields.pressure, fields.traction, fields.slip
    load, peak = float(np.linalg.norm(result.force)), float(np.abs(p).max())
    on_rail = np.einsum("nk,nkc->nc", np.column_stack([-q, p]), fields.axes) * fields.area[:, None]
    # a moment about a point that no model uses, computed by lever arms one by one
    moment = sum((cross(a - pose.origin, f) for a, f in zip(fields.point, on_rail, strict=True)), np.zeros(3))
    about = result.about(pose.origin)
    bound, power = case.friction * p, (q * s).sum(axis=1)
    slip = np.maximum(np.hypot(*s.T), case.regularisation)[:, None]
    astray = np.hypot(*(q * slip + bound[:, None] * s).T)
    most = max(case.friction * peak, 1e-300)
    power_scale = max(most * max(float(np.hypot(*s.T).max()), most / G), 1e-300)
    in_patches = sum((patch.force for patch in result.patches), np.zeros(3))
    beyond, law = np.hypot(*q.T) - bound, astray / power_scale
    undeformed, unloaded, error = fields.penetration, 0.0, 0.0
    if isinstance(model, LatticeContact):
        levels = _levels(pose, motion, result, model)
        undeformed, unloaded, at_middles = _strips(levels)
        error = float(np.abs(at_middles - fields.penetration).max())
        if case.friction > 0:
            beyond, residual = _friction(case, fields, levels)
            law = residual / most
    # deformed penetration minus that of the penalty: zero at loaded points, negative at open ones
    d = undeformed + fields.displacement[:, 2] - p * case.laws.normal_compliance
    apart = np.where(p > 0, np.abs(d), np.maximum(d, 0.0))
    return {
        "residual": result.statistics.residual,
        "force": float(np.linalg.norm(result.force + on_rail.sum(axis=0))) / load,
        "moment": float(np.linalg.norm(about.moment + moment)) / load,
        "patches": float(np.linalg.norm(in_patches - result.force)) / load,
        "pull": float(max(-p.min(), 0.0)) / peak,
        "friction": float(np.maximum(beyond, 0.0).max()) / most,
        "law": float(law.max()),
        "work": float(np.maximum(power, 0.0).max()) / power_scale,
        "penetration": float(apart.max()) / result.approach,
        "missed": penetration_outside(case, pose, [patch.wheel_band for patch in result.patches]),
        "unloaded": unloaded / result.approach,
        "undeformed": error / result.approach,
    }


def _strips(levels: list[tuple[LatticeProblem, LatticeState]]) -> tuple[Array, float, Array]:
    """Undeformed penetration m of cells, the mean over the widths of their strips by Simpson's rule, with the gap left
    on strips that touch on a part of their width, and the largest penetration m that remains at an edge of unloaded
    strips between the ends of their undeformed one; the former at the middles, without the gap.
    """
    depths, unloaded, at_middles = zip(*(_level(*part) for part in levels), strict=True)
    return np.concatenate(depths), max(unloaded), np.concatenate(at_middles)


def _levels(
    pose: Pose, motion: RigidMotion, result: ContactResult, model: LatticeContact
) -> list[tuple[LatticeProblem, LatticeState]]:
    """Equations and their solution on strips of each width."""
    levels = states_of(result.warm_start).items()
    return [(model.on(level).problem(pose, motion), state) for level, state in levels]


def _friction(
    case: SampledCase, fields: Fields, levels: list[tuple[LatticeProblem, LatticeState]]
) -> tuple[Array, Array]:
    """Tractions Pa beyond their largest mean in each cell (n,), and the residual Pa of the law (n,), its mean over a
    pressure that varies linearly in the cell: q - m y / |y| with y = rho q - s, m the mean of the lesser of
    |y| / (rho + eps / b) and mu p, and b the mean of mu p.
    """
    ends = [np.einsum("sm,rkm->ksr", state.modes, problem.basis.ends).reshape(2, -1) for problem, state in levels]
    varied = np.concatenate([part - part.mean(axis=0) for part in ends], axis=1)
    bounds = case.friction * np.maximum(fields.pressure + varied, 0.0)
    rho = np.concatenate([np.tile(problem.rho, len(state.strips)) for problem, state in levels])
    y = rho[:, None] * fields.traction - fields.slip
    size = np.maximum(np.hypot(*y.T), 1e-300)
    mean = _mean_of_lesser(size / (rho + case.regularisation / np.maximum(bounds.mean(axis=0), 1e-300)), bounds)
    residual = np.hypot(*(fields.traction - (mean / size)[:, None] * y).T)
    return np.hypot(*fields.traction.T) - bounds.mean(axis=0), residual


def _mean_of_lesser(t: Array, bounds: Array) -> Array:
    """Means (n,) of the lesser of t (n,) and a bound that varies linearly between two values, (2, n)."""
    low, high = np.sort(bounds, axis=0)
    narrow = high - low <= NARROW * high
    beyond = np.maximum(t - low, 0.0) ** 2 - np.maximum(t - high, 0.0) ** 2
    mean = t - beyond / (2 * np.where(narrow, 1.0, high - low))
    return np.where(narrow, np.minimum(t, 0.5 * (low + high)), mean)


def _level(problem: LatticeProblem, state: LatticeState) -> tuple[Array, float, Array]:
    """Values of `_strips` on strips of one width."""
    marks, places = problem.basis.marks, problem.of(state.strips).places
    x = (state.ends[:, :1] + np.diff(state.ends) * 0.5 * (marks[1:] + marks[:-1])).ravel()
    cells = len(marks) - 1
    middle, width = (np.repeat(values, cells) for values in (places.middle, places.width))

    def undeformed(s: Array) -> Array:
        at = problem.motion
        return penetration(problem.surface, at.origin, at.rotation, at.plan, s, x).depth

    depth = sum(
        (weight / 6 * undeformed(middle + k * width) for k, weight in ((-0.5, 1), (0, 4), (0.5, 1))),
        np.zeros(len(x)),
    )
    gaps = [opening(*strip)[0] for strip in zip(state.load, places.onset, places.whole, strict=True)]
    depth += np.repeat(gaps, cells)
    at_middles = undeformed(middle)
    free = np.setdiff1d(problem.candidates, state.strips)
    if not len(free):
        return depth, 0.0, at_middles
    place, half = problem.lines.x[free], np.sqrt(2 * problem.depth[free] / problem.lines.curvature[free])
    ends = (place - half).tolist(), (place + half).tolist()
    remaining = problem.remaining_penetration(state.strips, state.values, free.tolist(), *ends, PROBES)
    return depth, max(float(remaining.max()), 0.0), at_middles


def cross(a: Array, b: Array) -> Array:
    """a x b, component by component."""
    return np.array([a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]])


def limits(case: SampledCase) -> dict[str, float]:
    """Limits of a case by name."""
    if not case.laws.exact_normal:
        return LIMITS
    # tractions converge to a part of the peak pressure, and these figures are relative to mu times it
    frictional = {name: max(LIMITS[name], TIGHT / max(case.friction, TIGHT)) for name in ("friction", "law")}
    return LIMITS | LATTICE | frictional


def broken(case: SampledCase, values: dict[str, float], rough: bool = False) -> list[str]:
    """Names of the values beyond their limits, but for the remaining penetration where strips are too few."""
    beyond = [name for name, limit in limits(case).items() if not values[name] <= limit]
    return [name for name in beyond if not (rough and name in LATTICE)]
