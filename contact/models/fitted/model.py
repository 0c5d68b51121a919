"""Contact on cells fitted to the patch, between bodies invariant along x or in angle: exact normal law, few points.

The normal problem without friction finds the patch: its tips across, the ends of strips along the rolling direction.
Pressure and traction are then solved on the cells of the strips. What is left is an error that falls smoothly with the
number of cells, so that a solution on half as many tells how large it is.
"""

from __future__ import annotations

import logging
from dataclasses import dataclass, field, replace
from functools import cached_property
from time import perf_counter
from typing import Literal

import numpy as np

from wheelrail.contact.kinematics.contact_points import OutsideSurface, SurfacePoints
from wheelrail.contact.kinematics.creepage import NotRolling, creepage, shift
from wheelrail.contact.kinematics.frames import Pose, RigidMotion
from wheelrail.contact.laws.parameters import ContactLaws
from wheelrail.contact.models.fitted.cell_compliance import CellCompliance, FittedState
from wheelrail.contact.models.fitted.free_boundary import FittedPressure, fit, follow
from wheelrail.contact.models.fitted.friction_penetration import FrictionPenetration, added, settling
from wheelrail.contact.models.fitted.initial_layout import initial_layout, mean_overlap
from wheelrail.contact.models.fitted.layout import StripLayout, connected, marks
from wheelrail.contact.models.fitted.operators import StripOperators
from wheelrail.contact.models.fitted.patch_layout import patches, recounted, single
from wheelrail.contact.models.fitted.patch_moments import sharpened
from wheelrail.contact.models.fitted.resolution import Resolution
from wheelrail.contact.models.fitted.surfaces import PenetrationProfile
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

FOLLOWED = 5.0  # times the tolerance, for cells that follow the contact as a whole
BEYOND = "the wheel overlaps the rail beyond the part of its surface that carries contact points"
ROUNDS = 6  # of the fixed-point iteration between layout and tractions
RAISED = 1e-2  # of the approach: its convergence tolerance of the penetration due to friction
ASIDE = 0.1  # of the approach: largest unconverged remainder that warm solves start from
FADING = 0.99  # of that remainder, left by every warm solve
LINES = 241  # where the overlap of two profiles is looked for: 0.4 mm apart


class PhaseTimer:
    """Seconds by phase: each lasts from the end of the one before."""

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

    tolerance: RMS of the last movement of the strips' ends over their length. tangential as for `CondensedContact`.
    estimate: every result carries an estimate of its error, for about a third more time. warm: solves start from the
    guess, for a fraction of the time; what they give then depends on it within the tolerance. Raises ValueError for a
    penalty, whose pressure has no such ends, and for friction that a shift cannot have.
    """

    operators: StripOperators
    laws: ContactLaws
    fineness: Resolution = field(default_factory=Resolution)
    tolerance: float = 1e-3
    options: NewtonOptions = field(default_factory=NewtonOptions)
    tangential: Literal["rolling", "shift"] = "rolling"
    estimate: bool = False
    warm: bool = False

    def __post_init__(self) -> None:
        if self.laws.normal_compliance > 0:
            raise ValueError(f"fitted cells need the exact normal law, got {self.laws}")
        if self.tangential == "shift" and (self.laws.regularisation > 0 or self.laws.falling is not None):
            raise ValueError(f"a shift has no slip velocity for friction to depend on, got {self.laws}")

    def __call__(self, pose: Pose, motion: RigidMotion, guess: ContactResult | None = None) -> ContactResult:
        """The guess is only used by a warm model: else the same pose and motion always give the same result."""
        result = self._solved(pose, motion, guess if self.warm else None)
        if not (self.estimate and result.patches):
            return result
        rough = replace(self, fineness=self.fineness.halved(), estimate=False)(pose, motion)
        return replace(result, error_estimate=difference(result, rough) if rough.ok else ErrorEstimate.unknown())

    def _solved(self, pose: Pose, motion: RigidMotion, guess: ContactResult | None) -> ContactResult:
        clock, count = PhaseTimer(), IterationCount()
        ridge = self.operators.surfaces.ridge(pose, self._lines)
        approach = float(ridge.overlap.max())
        if approach <= 0:
            return ContactResult.separated(approach)
        if ridge.overlap[0] > 0 or ridge.overlap[-1] > 0:
            return ContactResult.failed(BEYOND, approach)
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
        """The result of an iteration. Raises NotConverged, OutsideGrid, NotRolling."""
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
        """Where the overlap is looked for, m: more finely than the lines of the compliance."""
        arc = self.operators.upper.arc
        return np.asarray(np.linspace(arc[0], arc[-1], max(2 * len(arc), LINES)))

    def _result(
        self,
        around: TangentProblem,
        cells: FittedState,
        approach: float,
        statistics: Statistics,
    ) -> ContactResult:
        """What was found, in the frame of the rail."""
        places, found, layout = around.places, around.found, cells.layout
        scale = cells.scale
        p, q, n = found.pressure, found.tangential, len(places.area)
        moved = np.zeros((n, 3))
        if around.rigid is None:
            moved[:, 2] = -scale * (cells.gathered.normal.compliance @ p)
        else:
            moved[:] = scale * (cells.gathered.displacement @ np.concatenate([*q.T, -p])).reshape(3, n).T
        bound = self.laws.friction_at(np.hypot(*found.slip.T), around.speed)[0] * p
        strip = connected(layout, p.reshape(len(layout.sides), -1))
        result = assemble_result(
            FrictionalWork.below(bound, places, q, around.motion, around.speed),
            node=np.arange(n),
            patch=np.where(p > 0, np.repeat(strip, self.fineness.cells), -1),
            pressure=p,
            slip=found.slip,
            displacement=moved,
            approach=approach,
            statistics=statistics,
        )
        return replace(sharpened(result, layout, bound), force_tangent=tangent_of(around), warm_start=cells)


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
        self.count, self.clock, self.approach = count, clock, float(ridge.overlap.max())
        # penetration due to friction: as assumed for the layout, and the remainder that earlier solves left unconverged
        self.penetration = None if start is None else start.raised
        self.remainder = None if start is None else start.aside
        self.traction = None if start is None else start.traction  # (2 n,) Pa, initial guess
        self.previous: tuple[FrictionPenetration | None, FrictionPenetration] | None = (
            None  # penetration assumed, and caused then
        )
        self.rounds: list[
            tuple[float, FittedState, TangentProblem]
        ] = []  # the first one m: residual of the penetration

    def run(self) -> bool:
        """Iterates to convergence, or through all rounds; False without contact.

        Raises NotConverged, OutsideGrid, NotRolling.
        """
        cells = self.start
        for _ in range(ROUNDS):
            if not self.fit(cells):
                return False
            self.solve()
            if self.solution.rigid is None or self.update():
                return True
            cells = self.cells
        self.stop()
        return True

    def fit(self, start: FittedState | None) -> bool:
        """Fits the layout to the penetration, from cells to start from, if any; False without contact.

        Raises NotConverged when an earlier solve's cells do not serve.
        """
        fitted = self._fitted(start)
        if fitted is None:
            if self.start is not None:
                raise NotConverged("cells that were fitted before lose all their pressure")
            return False
        self.cells, self.pressure, self.settled = fitted
        if self.start is not None and not self.settled:
            raise NotConverged("cells that were fitted before do not settle")
        self.clock.ends("fit")
        return True

    def solve(self) -> None:
        """Solves for the tractions on the cells. Raises NotConverged, NotRolling."""
        model, cells, scale = self.model, self.cells, self.cells.scale
        surfaces = model.operators.surfaces
        overlap = mean_overlap(surfaces, self.pose, cells.layout).ravel()
        places = replace(surfaces.places(self.pose, cells.layout), overlap=overlap)
        speed, rigid = self._rigid(places)
        body = self._compliance(rigid is not None)
        self.clock.ends("compliance")
        n = len(places.area)
        if self.traction is None or len(self.traction) != 2 * n:
            self.traction = np.zeros(2 * n)
        tractions = solve_tractions(
            body,
            overlap / scale,  # displacements grow with the scale: the solution is that of an overlap divided by it
            rigid,
            laws=model.laws,
            speed=speed,
            guess=(np.maximum(self.pressure.ravel(), 0.0), self.traction),
            options=model.options,
            count=self.count,
        )
        self.clock.ends("solve")
        self.cells = replace(cells, raised=self.penetration, traction=tractions.tangential.T.ravel())
        self.solution = TangentProblem(
            places,
            self.pose.origin,
            self.motion,
            body,
            rigid,
            speed,
            model.laws,
            tractions,
            model.fineness.cells,
            scale,
        )

    def update(self) -> bool:
        """Compares the penetration that friction causes with the one assumed: True if they agree; if not, a better one
        is assumed for the next round.
        """
        cells, layout, n = self.cells, self.cells.layout, len(self.cells.traction) // 2
        # friction presses the bodies together or apart, where one patch pushes another one sideways, too
        caused = cells.scale * (cells.gathered.displacement[2 * n :, : 2 * n] @ cells.traction)
        caused = caused.reshape(len(layout.sides), -1)
        remainder = self.remainder
        target = FrictionPenetration.by(
            layout, caused if remainder is None else caused - self.approach * remainder.at(layout)
        )
        assumed = added(self.penetration, layout)
        residual = float(np.abs(target.at(layout) - assumed).max())
        log.debug("friction changes the overlap by %.1e of the approach", residual / self.approach)
        if residual <= RAISED * self.approach:
            if remainder is not None:
                self.cells = replace(cells, aside=remainder.times(FADING).between(layout, RAISED, ASIDE))
                self.settled = False
            return True
        unconverged = FrictionPenetration.by(layout, (caused - assumed) / self.approach).between(layout, RAISED, ASIDE)
        self.rounds.append((residual, replace(cells, aside=unconverged), self.solution))
        now = self.penetration, target
        self.penetration = target if self.previous is None else settling(layout, self.previous, now)
        self.previous, self.traction = now, cells.traction
        return False

    def stop(self) -> None:
        """Ends an iteration that does not converge."""
        self.settled = False
        if self.start is None:
            self.cells = replace(self.cells, raised=self.penetration)
        else:  # the iteration alternates between two layouts: keep the one with the smaller residual
            _, self.cells, self.solution = min(self.rounds, key=lambda entry: entry[0])

    def _rigid(self, places: SurfacePoints) -> tuple[float, Array | None]:
        """Rolling speed [m/s] and rigid creepage, or the shift [m]; none without friction."""
        if not self.model.laws.friction:
            return 0.0, None
        shifts = self.model.tangential == "shift"
        return (0.0, shift(places, self.motion)) if shifts else creepage(places, self.motion)

    def _compliance(self, tangential: bool) -> ContactCompliance:
        """Compliance for the tractions, and what earlier solves made of it."""
        gathered = self.cells.gathered
        if not tangential:
            return gathered.frictionless
        return gathered.shifting if self.model.tangential == "shift" else gathered.rolling

    def _fitted(self, start: FittedState | None) -> tuple[FittedState, Array, bool] | None:
        """Cells, their pressures (S, M) Pa without friction, and whether their ends converged; None without contact.

        From cells to start from, moved and scaled as a whole if that suffices, or from the initial layout.
        """
        model = self.model
        if start is not None and model.warm:
            tolerance = FOLLOWED * model.tolerance
            start, pressures = follow(self._overlap, start, self._gathered, tolerance=tolerance, count=self.count)
            if pressures is not None:
                return start, pressures, True
        rolls = model.laws.friction > 0 and model.tangential == "rolling"
        full = marks(model.fineness.cells, rolling=rolls)
        fitted = self._fit_initial(full) if start is None else self._fit(start.layout, full, model.tolerance)
        if fitted is None:
            return None
        gathered = CellCompliance(model.operators, self.pose, fitted.layout, model.laws, fitted.normal)
        return FittedState(fitted.layout, self.penetration, gathered, 1.0, np.zeros(0)), fitted.pressure, fitted.settled

    def _fit_initial(self, full: Array) -> FittedPressure | None:
        """From the rigid surfaces where they suggest one patch, else from pressures on the initial layout."""
        fineness, tolerance = self.model.fineness, self.model.tolerance
        # equal cells find the ends from afar; those that shrink towards the leading end only from near
        few = marks(max(fineness.cells // 2, 4), rolling=False)
        fitted = self._fit(single(self.ridge, fineness, few), few, 5 * tolerance)
        if fitted is not None:
            fitted = self._fit(recounted(fitted.layout, fineness), full, tolerance)
        if fitted is None or not fitted.settled or fitted.divided:
            initial = initial_layout(self.ridge, self._overlap, self._normal, self.count)
            fitted = self._fit(patches(*initial, fineness, few), few, 5 * tolerance)
            fitted = None if fitted is None else self._fit(fitted.layout, full, tolerance)
        return fitted

    def _fit(self, layout: StripLayout | None, cell_marks: Array, tolerance: float) -> FittedPressure | None:
        if layout is None:
            return None
        start, fineness = replace(layout, marks=cell_marks), self.model.fineness
        return fit(self._overlap, self._normal, start, fineness, tolerance=tolerance, count=self.count)

    def _overlap(self, layout: StripLayout) -> Array:
        """Undeformed overlap (S, M) m of the cells, with what friction adds."""
        free = mean_overlap(self.model.operators.surfaces, self.pose, layout)
        return free if self.penetration is None else free + self.penetration.at(layout)

    def _normal(self, layout: StripLayout) -> CachedFactors:
        return CachedFactors(self.model.operators.normal(self.pose, layout))

    def _gathered(self, layout: StripLayout) -> CellCompliance:
        return CellCompliance(self.model.operators, self.pose, layout, self.model.laws)
