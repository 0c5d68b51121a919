"""Contact on cells fitted to the patch, between bodies invariant along x or in angle: exact normal law, few points.

The frictionless normal problem gives the patch: its lateral ends and the ends of strips along the rolling direction.
Pressure and traction are then solved on the cells of the strips. The discretisation error decreases smoothly with the
number of cells, so that a solution on half as many strips and cells gives an estimate of it.
"""

from __future__ import annotations

import logging
from dataclasses import dataclass, field, replace
from functools import cached_property
from time import perf_counter
from typing import Literal

import numpy as np

from wheelrail.contact.geometry.strip_layout import StripLayout, connected, marks
from wheelrail.contact.geometry.strip_surfaces import PenetrationProfile
from wheelrail.contact.kinematics.contact_points import OutsideSurface, SurfacePoints
from wheelrail.contact.kinematics.creepage import NotRolling, creepage, shift
from wheelrail.contact.kinematics.frames import Pose, RigidMotion
from wheelrail.contact.laws.parameters import ContactLaws
from wheelrail.contact.models.fitted.cell_compliance import CellCompliance, FittedState
from wheelrail.contact.models.fitted.free_boundary import FittedPressure, fit, follow
from wheelrail.contact.models.fitted.friction_penetration import FrictionPenetration, anderson_step, on_cells
from wheelrail.contact.models.fitted.initial_layout import initial_layout, mean_overlap
from wheelrail.contact.models.fitted.patch_layout import patches, recounted, single
from wheelrail.contact.models.fitted.resolution import Resolution
from wheelrail.contact.models.lattice.influence.strip_operators import StripOperators
from wheelrail.contact.models.lattice.patch_moments import sharpened
from wheelrail.contact.results.error_estimate import ErrorEstimate
from wheelrail.contact.results.extrapolation import difference
from wheelrail.contact.results.result import ContactResult, Statistics
from wheelrail.contact.results.resultants import FrictionalWork, assemble_result
from wheelrail.contact.solvers.active_set import CachedFactors
from wheelrail.contact.solvers.options import IterationCount, NewtonOptions, NotConverged
from wheelrail.contact.solvers.tangent import TangentProblem, tangent_of
from wheelrail.contact.solvers.tractions import ContactCompliance, solve_tractions
from wheelrail.support.arrays import Array

log = logging.getLogger(__name__)

WARM_FACTOR = 5.0  # times the tolerance, for cells translated and scaled as a whole
OUTSIDE = "the wheel penetrates the rail beyond the part of its surface that carries contact points"
ITERATIONS = 6  # of the fixed-point iteration between layout and tractions
PENETRATION_TOLERANCE = 1e-2  # of the approach: its convergence tolerance of the penetration due to friction
LARGEST_REMAINDER = 0.1  # of the approach: largest unconverged remainder that warm solves start from
REMAINDER_DECAY = 0.99  # factor on that remainder in every warm solve
LINES = 241  # least number of lines at which the penetration is evaluated: 0.4 mm apart


class PhaseTimer:
    """Time s spent in each phase, counted from the end of the previous one."""

    def __init__(self) -> None:
        self.spent = {"fit": 0.0, "compliance": 0.0, "solve": 0.0}
        self._last = perf_counter()

    def ends(self, phase: str) -> None:
        now = perf_counter()
        self.spent[phase] += now - self._last
        self._last = now


@dataclass(frozen=True)
class FittedContact:
    """Contact model on strips of cells that end where the contact ends: pose and velocities in, `ContactResult` out.

    Parameters:
        operators: compliance and surfaces of both bodies.
        laws: of the interface.
        resolution: strips over a patch's width, cells along a strip.
        tolerance: RMS of the last step of the strips' ends over their length.
        options: of the Newton method.
        tangential: as for `CondensedContact`.
        estimate: results carry an error estimate, for about a third more time.
        warm: solves start from the guess, for a fraction of the time; results then depend on it within the tolerance.

    Raises ValueError for a penalty, whose pressure has no sharp ends, and for a friction law that depends on the slip
    velocity together with tangential = "shift".
    """

    operators: StripOperators
    laws: ContactLaws
    resolution: Resolution = field(default_factory=Resolution)
    tolerance: float = 1e-3
    options: NewtonOptions = field(default_factory=NewtonOptions)
    tangential: Literal["rolling", "shift"] = "rolling"
    estimate: bool = False
    warm: bool = False

    def __post_init__(self) -> None:
        if not self.laws.exact_normal:
            raise ValueError(f"fitted cells need the exact normal law, got {self.laws}")
        if self.tangential == "shift" and self.laws.depend_on_slip:
            raise ValueError(f"a shift has no slip velocity for friction to depend on, got {self.laws}")

    def __call__(self, pose: Pose, motion: RigidMotion, guess: ContactResult | None = None) -> ContactResult:
        """Result of a pose and motion; the guess is only used if warm, otherwise results do not depend on it."""
        result = self._solved(pose, motion, guess if self.warm else None)
        if not (self.estimate and result.patches):
            return result
        rough = replace(self, resolution=self.resolution.coarsened(), estimate=False)(pose, motion)
        return replace(result, error_estimate=difference(result, rough) if rough.ok else ErrorEstimate.unknown())

    def _solved(self, pose: Pose, motion: RigidMotion, guess: ContactResult | None) -> ContactResult:
        clock, count = PhaseTimer(), IterationCount()
        ridge = self.operators.surfaces.penetration_profile(pose, self._lines)
        approach = float(ridge.penetration.max())
        if approach <= 0:
            return ContactResult.separated(approach)
        if ridge.penetration[0] > 0 or ridge.penetration[-1] > 0:
            return ContactResult.failed(OUTSIDE, approach)
        earlier = None if guess is None or self.tangential == "shift" else guess.warm_start
        starts = (earlier, None) if isinstance(earlier, FittedState) and earlier.covers(ridge) else (None,)
        reason = ""
        for start in starts:
            try:
                return self._iterated(LayoutIteration(self, pose, motion, ridge, start, count, clock))
            except (OutsideSurface, NotRolling, NotConverged, np.linalg.LinAlgError) as error:
                reason = str(error)
        return ContactResult.failed(reason, approach)

    def _iterated(self, iteration: LayoutIteration) -> ContactResult:
        """Result of an iteration. Raises NotConverged, OutsideSurface, NotRolling."""
        if not iteration.run():
            return ContactResult.separated(iteration.approach)
        solution, count = iteration.solution, iteration.count
        statistics = Statistics(
            newton=count.newton,
            linear=count.linear,
            points=len(solution.places.area),
            residual=count.residual,
            settled=iteration.settled,
            seconds=iteration.clock.spent,
        )
        return self._result(solution, iteration.cells, iteration.approach, statistics)

    @cached_property
    def _lines(self) -> Array:
        """Arc length m of the lines of the penetration profile: finer than those of the compliance."""
        arc = self.operators.upper.arc
        return np.asarray(np.linspace(arc[0], arc[-1], max(2 * len(arc), LINES)))

    def _result(
        self,
        solution: TangentProblem,
        cells: FittedState,
        approach: float,
        statistics: Statistics,
    ) -> ContactResult:
        """Result in the frame of the rail."""
        places, tractions, layout = solution.places, solution.found, cells.layout
        scale = cells.scale
        p, q, n = tractions.pressure, tractions.tangential, len(places.area)
        displacement = np.zeros((n, 3))
        if solution.rigid is None:
            displacement[:, 2] = -scale * (cells.gathered.normal.compliance @ p)
        else:
            displacement[:] = scale * (cells.gathered.displacement @ np.concatenate([*q.T, -p])).reshape(3, n).T
        bound = self.laws.friction_bound(p, np.hypot(*tractions.slip.T), solution.speed)
        strip = connected(layout, p.reshape(len(layout.sides), -1))
        result = assemble_result(
            FrictionalWork.below(bound, places, q, solution.motion, solution.speed),
            node=np.arange(n),
            patch=np.where(p > 0, np.repeat(strip, self.resolution.cells), -1),
            pressure=p,
            slip=tractions.slip,
            displacement=displacement,
            approach=approach,
            statistics=statistics,
        )
        return replace(sharpened(result, layout, bound), force_tangent=tangent_of(solution), warm_start=cells)


class LayoutIteration:
    """Fixed-point iteration between the layout of cells and the tractions on them: friction changes the penetration to
    which the layout is fitted.

    start: cells of an earlier solve to start from, if any. After `run`: cells, the solution on them, and whether the
    iteration converged (settled).
    """

    cells: FittedState
    pressure: Array  # (S, M) Pa on the cells, without friction
    solution: TangentProblem
    settled: bool

    def __init__(
        self,
        model: FittedContact,
        pose: Pose,
        motion: RigidMotion,
        ridge: PenetrationProfile,
        start: FittedState | None,
        count: IterationCount,
        clock: PhaseTimer,
    ) -> None:
        self.model, self.pose, self.motion, self.ridge, self.start = model, pose, motion, ridge, start
        self.count, self.clock, self.approach = count, clock, float(ridge.penetration.max())
        # penetration due to friction: as assumed for the layout, and the remainder that earlier solves left unconverged
        self.penetration = None if start is None else start.penetration
        self.remainder = None if start is None else start.remainder
        self.traction = None if start is None else start.traction  # (2 n,) Pa, initial guess
        self.previous: tuple[FrictionPenetration | None, FrictionPenetration] | None = (
            None  # penetration assumed, and caused then
        )
        self.iterates: list[
            tuple[float, FittedState, TangentProblem]
        ] = []  # residual of the penetration m, cells, solution

    def run(self) -> bool:
        """Iterate to convergence or to the largest number of iterations; False without contact.

        Raises NotConverged, OutsideSurface, NotRolling.
        """
        cells = self.start
        for _ in range(ITERATIONS):
            if not self.fit(cells):
                return False
            self.solve()
            if self.solution.rigid is None or self.update():
                return True
            cells = self.cells
        self.stop()
        return True

    def fit(self, start: FittedState | None) -> bool:
        """Fit the layout to the penetration, starting from given cells, if any; False without contact.

        Raises NotConverged when the iteration from an earlier solve's cells fails.
        """
        fitted = self._fitted(start)
        if fitted is None:
            if self.start is not None:
                raise NotConverged("the cells of the initial guess lose all their pressure")
            return False
        self.cells, self.pressure, self.settled = fitted
        if self.start is not None and not self.settled:
            raise NotConverged("the patch-edge iteration from the cells of the initial guess does not converge")
        self.clock.ends("fit")
        return True

    def solve(self) -> None:
        """Solve for the tractions on the cells. Raises NotConverged, NotRolling."""
        model, cells, scale = self.model, self.cells, self.cells.scale
        surfaces = model.operators.surfaces
        overlap = mean_overlap(surfaces, self.pose, cells.layout).ravel()
        places = replace(surfaces.places(self.pose, cells.layout), penetration=overlap)
        speed, rigid = self._rigid(places)
        body = self._compliance(rigid is not None)
        self.clock.ends("compliance")
        n = len(places.area)
        if self.traction is None or len(self.traction) != 2 * n:
            self.traction = np.zeros(2 * n)
        tractions = solve_tractions(
            body,
            overlap / scale,  # displacements are proportional to the scale
            rigid,
            laws=model.laws,
            speed=speed,
            guess=(np.maximum(self.pressure.ravel(), 0.0), self.traction),
            options=model.options,
            count=self.count,
        )
        self.clock.ends("solve")
        self.cells = replace(cells, penetration=self.penetration, traction=tractions.tangential.T.ravel())
        self.solution = TangentProblem(
            places,
            self.pose.origin,
            self.motion,
            body,
            rigid,
            speed,
            model.laws,
            tractions,
            model.resolution.cells,
            scale,
        )

    def update(self) -> bool:
        """Compare the penetration caused by friction with the one assumed: True if they agree within the tolerance;
        else the assumed one is updated for the next iteration.
        """
        cells, layout, n = self.cells, self.cells.layout, len(self.cells.traction) // 2
        # normal displacement by tangential tractions, also by those of other patches
        caused = cells.scale * (cells.gathered.displacement[2 * n :, : 2 * n] @ cells.traction)
        caused = caused.reshape(len(layout.sides), -1)
        remainder = self.remainder
        target = FrictionPenetration.by(
            layout, caused if remainder is None else caused - self.approach * remainder.at(layout)
        )
        assumed = on_cells(self.penetration, layout)
        residual = float(np.abs(target.at(layout) - assumed).max())
        log.debug("residual of the penetration due to friction: %.1e of the approach", residual / self.approach)
        if residual <= PENETRATION_TOLERANCE * self.approach:
            if remainder is not None:
                self.cells = replace(
                    cells,
                    remainder=remainder.times(REMAINDER_DECAY).between(
                        layout, PENETRATION_TOLERANCE, LARGEST_REMAINDER
                    ),
                )
                self.settled = False
            return True
        unconverged = FrictionPenetration.by(layout, (caused - assumed) / self.approach).between(
            layout, PENETRATION_TOLERANCE, LARGEST_REMAINDER
        )
        self.iterates.append((residual, replace(cells, remainder=unconverged), self.solution))
        now = self.penetration, target
        self.penetration = target if self.previous is None else anderson_step(layout, self.previous, now)
        self.previous, self.traction = now, cells.traction
        return False

    def stop(self) -> None:
        """Choose the state of an iteration that did not converge."""
        self.settled = False
        if self.start is None:
            self.cells = replace(self.cells, penetration=self.penetration)
        else:  # the iteration alternates between two layouts: keep the one with the smaller residual
            _, self.cells, self.solution = min(self.iterates, key=lambda entry: entry[0])

    def _rigid(self, places: SurfacePoints) -> tuple[float, Array | None]:
        """Rolling speed m/s and rigid creepage, or the tangential displacement m; None without friction."""
        if not self.model.laws.frictional:
            return 0.0, None
        shifts = self.model.tangential == "shift"
        return (0.0, shift(places, self.motion)) if shifts else creepage(places, self.motion)

    def _compliance(self, tangential: bool) -> ContactCompliance:
        """Compliance for the tractions, with the solvers' cache."""
        gathered = self.cells.gathered
        if not tangential:
            return gathered.frictionless
        return gathered.shifting if self.model.tangential == "shift" else gathered.rolling

    def _fitted(self, start: FittedState | None) -> tuple[FittedState, Array, bool] | None:
        """Cells, their pressures (S, M) Pa without friction, and whether their ends converged; None without contact.

        The iteration starts from given cells, translated and scaled as a whole if that suffices, or from the initial
        layout.
        """
        model = self.model
        if start is not None and model.warm:
            tolerance = WARM_FACTOR * model.tolerance
            start, pressures = follow(self._overlap, start, self._gathered, tolerance=tolerance, count=self.count)
            if pressures is not None:
                return start, pressures, True
        rolls = model.laws.frictional and model.tangential == "rolling"
        full = marks(model.resolution.cells, rolling=rolls)
        fitted = self._fit_initial(full) if start is None else self._fit(start.layout, full, model.tolerance)
        if fitted is None:
            return None
        gathered = CellCompliance(model.operators, self.pose, fitted.layout, model.laws, fitted.normal)
        return FittedState(fitted.layout, self.penetration, gathered, 1.0, np.zeros(0)), fitted.pressure, fitted.settled

    def _fit_initial(self, full: Array) -> FittedPressure | None:
        """Fit from the rigid surfaces where they indicate one patch, else from pressures on the initial layout."""
        resolution, tolerance = self.model.resolution, self.model.tolerance
        # the iteration converges from farther away on uniform cells than on graded ones
        few = marks(max(resolution.cells // 2, 4), rolling=False)
        fitted = self._fit(single(self.ridge, resolution, few), few, 5 * tolerance)
        if fitted is not None:
            fitted = self._fit(recounted(fitted.layout, resolution), full, tolerance)
        if fitted is None or not fitted.settled or fitted.divided:
            initial = initial_layout(self.ridge, self._overlap, self._normal, self.count)
            fitted = self._fit(patches(*initial, resolution, few), few, 5 * tolerance)
            fitted = None if fitted is None else self._fit(fitted.layout, full, tolerance)
        return fitted

    def _fit(self, layout: StripLayout | None, cell_marks: Array, tolerance: float) -> FittedPressure | None:
        if layout is None:
            return None
        start, resolution = replace(layout, marks=cell_marks), self.model.resolution
        return fit(self._overlap, self._normal, start, resolution, tolerance=tolerance, count=self.count)

    def _overlap(self, layout: StripLayout) -> Array:
        """Undeformed penetration (S, M) m of the cells, plus that due to friction."""
        free = mean_overlap(self.model.operators.surfaces, self.pose, layout)
        return free if self.penetration is None else free + self.penetration.at(layout)

    def _normal(self, layout: StripLayout) -> CachedFactors:
        return CachedFactors(self.model.operators.normal(self.pose, layout))

    def _gathered(self, layout: StripLayout) -> CellCompliance:
        return CellCompliance(self.model.operators, self.pose, layout, self.model.laws)
