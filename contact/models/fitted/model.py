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

from wheelrail.contact.kinematics.contact_points import OutsideGrid, Places
from wheelrail.contact.kinematics.creepage import NotRolling, creepage, shift
from wheelrail.contact.kinematics.frames import Motion, Pose
from wheelrail.contact.laws.parameters import Laws
from wheelrail.contact.models.fitted.cell_compliance import Cells, Gathered
from wheelrail.contact.models.fitted.free_boundary import Fitted, fit, follow
from wheelrail.contact.models.fitted.friction_penetration import Raised, added, settling
from wheelrail.contact.models.fitted.initial_layout import coarse, mean_overlap
from wheelrail.contact.models.fitted.layout import Layout, connected, marks
from wheelrail.contact.models.fitted.operators import StripOperators
from wheelrail.contact.models.fitted.patch_layout import patches, recounted, single
from wheelrail.contact.models.fitted.patch_moments import sharpened
from wheelrail.contact.models.fitted.resolution import Fineness
from wheelrail.contact.models.fitted.surfaces import Ridge
from wheelrail.contact.results.error_estimate import ErrorEstimate
from wheelrail.contact.results.extrapolation import difference
from wheelrail.contact.results.result import ContactResult, Statistics
from wheelrail.contact.results.resultants import outcome
from wheelrail.contact.solvers.active_set import Factors
from wheelrail.contact.solvers.options import Count, NewtonOptions, NotConverged
from wheelrail.contact.solvers.tangent import Linearisation, tangent_of
from wheelrail.contact.solvers.tractions import Elastic, solve_tractions
from wheelrail.support.arrays import Array

log = logging.getLogger(__name__)

FOLLOWED = 5.0  # times the tolerance, for cells that follow the contact as a whole
BEYOND = "the wheel overlaps the rail beyond the part of its surface that carries contact points"
ROUNDS = 6  # of fitting and solving, where friction changes the overlap
RAISED = 1e-2  # of the approach, that friction may still change it by
ASIDE = 0.1  # of the approach, that rounds without rest may be off by for warm solves to go on from them
FADING = 0.99  # of that, left by every warm solve
LINES = 241  # where the overlap of two profiles is looked for: 0.4 mm apart


class Clock:
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

    tolerance: RMS of the last movement of the strips' ends over their length. tangential as for `Condensed`. estimate:
    every result carries an estimate of its error, for about a third more time. warm: solves start from the guess, for a
    fraction of the time; what they give then depends on it within the tolerance. Raises ValueError for a penalty, whose
    pressure has no such ends, and for friction that a shift cannot have.
    """

    operators: StripOperators
    laws: Laws
    fineness: Fineness = field(default_factory=Fineness)
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

    def __call__(self, pose: Pose, motion: Motion, guess: ContactResult | None = None) -> ContactResult:
        """The guess is only used by a warm model: else the same pose and motion always give the same result."""
        result = self._solved(pose, motion, guess if self.warm else None)
        if not (self.estimate and result.patches):
            return result
        rough = replace(self, fineness=self.fineness.halved(), estimate=False)(pose, motion)
        return replace(result, error_estimate=difference(result, rough) if rough.ok else ErrorEstimate.unknown())

    def _solved(self, pose: Pose, motion: Motion, guess: ContactResult | None) -> ContactResult:
        clock, count = Clock(), Count()
        ridge = self.operators.surfaces.ridge(pose, self._lines)
        approach = float(ridge.overlap.max())
        if approach <= 0:
            return ContactResult.separated(approach)
        if ridge.overlap[0] > 0 or ridge.overlap[-1] > 0:
            return ContactResult.failed(BEYOND, approach)
        known = None if guess is None or self.tangential == "shift" else guess.warm_start
        starts = (known, None) if isinstance(known, Cells) and known.covers(ridge) else (None,)
        reason = ""
        for start in starts:
            try:
                return self._found(pose, motion, ridge, start, count, clock)
            except (OutsideGrid, NotRolling, NotConverged, np.linalg.LinAlgError) as error:
                reason = str(error)
        return ContactResult.failed(reason, approach)

    def _found(
        self, pose: Pose, motion: Motion, ridge: Ridge, start: Cells | None, count: Count, clock: Clock
    ) -> ContactResult:
        """The result from cells to start from, if any: cells and tractions in turn until friction moves cells no more.

        Raises NotConverged, OutsideGrid, NotRolling.
        """
        surfaces, approach = self.operators.surfaces, float(ridge.overlap.max())
        known, raised, settled = start, None if start is None else start.raised, True
        q = None if start is None else start.traction
        before: tuple[Raised | None, Raised] | None = None
        aside = None if start is None else start.aside
        rounds: list[tuple[float, Cells, Linearisation]] = []
        for _ in range(ROUNDS):
            fitted = self._fitted(pose, ridge, known, raised, count)
            if fitted is None:
                if start is not None:
                    raise NotConverged("cells that were fitted before lose all their pressure")
                return ContactResult.separated(approach)
            cells, pressure, settled = fitted
            known = cells
            if start is not None and not settled:
                raise NotConverged("cells that were fitted before do not settle")
            clock.ends("fit")
            layout, gathered, scale = cells.layout, cells.gathered, cells.scale
            places = replace(surfaces.places(pose, layout), overlap=mean_overlap(surfaces, pose, layout).ravel())
            speed, rigid = self._rigid(places, motion)
            body = self._compliance(gathered, rigid is not None)
            clock.ends("compliance")
            n = len(places.area)
            if q is None or len(q) != 2 * n:
                q = np.zeros(2 * n)
            # what a scale does to displacements it undoes to the overlap
            found = solve_tractions(
                body,
                places.overlap / scale,
                rigid,
                laws=self.laws,
                speed=speed,
                guess=(np.maximum(pressure.ravel(), 0.0), q),
                options=self.options,
                count=count,
            )
            clock.ends("solve")
            cells = replace(cells, raised=raised, traction=found.tangential.T.ravel())
            around = Linearisation(
                places, pose.origin, motion, body, rigid, speed, self.laws, found, self.fineness.cells, scale
            )
            if rigid is None:
                break
            # friction presses the bodies together or apart, where one patch pushes another one sideways, too
            by_friction = scale * (gathered.displacement[2 * n :, : 2 * n] @ found.tangential.T.ravel())
            by_friction = by_friction.reshape(len(layout.sides), -1)
            after = Raised.by(layout, by_friction if aside is None else by_friction - approach * aside.at(layout))
            held = added(raised, layout)
            change = float(np.abs(after.at(layout) - held).max())
            log.debug("friction changes the overlap by %.1e of the approach", change / approach)
            if change <= RAISED * approach:
                if aside is not None:
                    cells = replace(cells, aside=aside.times(FADING).between(layout, RAISED, ASIDE))
                    settled = False
                break
            off = Raised.by(layout, (by_friction - held) / approach).between(layout, RAISED, ASIDE)
            rounds.append((change, replace(cells, aside=off), around))
            now = raised, after
            raised, q = after if before is None else settling(layout, before, now), found.tangential.T.ravel()
            before = now
        else:
            settled = False
            if start is None:
                cells = replace(cells, raised=raised)
            else:  # two answers may bring about each other's cells: stay with what is nearest to rest
                _, cells, around = min(rounds, key=lambda found: found[0])
        statistics = Statistics(
            newton=count.newton,
            linear=count.linear,
            points=len(around.places.area),
            residual=count.residual,
            settled=settled,
            seconds=clock.spent,
        )
        return self._result(around, cells, approach, statistics)

    @cached_property
    def _lines(self) -> Array:
        """Where the overlap is looked for, m: more finely than the lines of the compliance."""
        arc = self.operators.upper.arc
        return np.asarray(np.linspace(arc[0], arc[-1], max(2 * len(arc), LINES)))

    def _compliance(self, gathered: Gathered, tangential: bool) -> Elastic:
        """Compliance for the tractions, and what earlier solves made of it."""
        if not tangential:
            return gathered.frictionless
        return gathered.shifting if self.tangential == "shift" else gathered.rolling

    def _result(
        self,
        around: Linearisation,
        cells: Cells,
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
        result = outcome(
            places,
            node=np.arange(n),
            patch=np.where(p > 0, np.repeat(strip, self.fineness.cells), -1),
            pressure=p,
            traction=q,
            slip=found.slip,
            motion=around.motion,
            speed=around.speed,
            displacement=moved,
            approach=approach,
            bound=bound,
            statistics=statistics,
        )
        return replace(sharpened(result, layout, bound), force_tangent=tangent_of(around), warm_start=cells)

    def _fitted(
        self, pose: Pose, ridge: Ridge, start: Cells | None, raised: Raised | None, count: Count
    ) -> tuple[Cells, Array, bool] | None:
        """Cells, their pressures (S, M) Pa under an overlap raised by friction, and whether they settled; None without
        contact. From cells to start from, which may do as a whole, or from a first look.
        """
        surfaces = self.operators.surfaces

        def normal(layout: Layout) -> Factors:
            return Factors(self.operators.normal(pose, layout))

        def gather(layout: Layout) -> Gathered:
            return Gathered(self.operators, pose, layout, self.laws)

        def overlap(layout: Layout) -> Array:
            free = mean_overlap(surfaces, pose, layout)
            return free if raised is None else free + raised.at(layout)

        if start is not None and self.warm:
            start, pressures = follow(overlap, start, gather, tolerance=FOLLOWED * self.tolerance, count=count)
            if pressures is not None:
                return start, pressures, True
        rolls = self.laws.friction > 0 and self.tangential == "rolling"
        full, tolerance = marks(self.fineness.cells, rolling=rolls), self.tolerance
        # equal cells find the ends from afar; those that shrink towards the leading end only from near
        few = marks(max(self.fineness.cells // 2, 4), rolling=False)

        def fitted(layout: Layout | None, cells: Array, near: float) -> Fitted | None:
            if layout is None:
                return None
            return fit(overlap, normal, replace(layout, marks=cells), self.fineness, tolerance=near, count=count)

        if start is not None:
            found = fitted(start.layout, full, tolerance)
        else:
            found = fitted(single(ridge, self.fineness, few), few, 5 * tolerance)
            if found is not None:
                found = fitted(recounted(found.layout, self.fineness), full, tolerance)
            if found is None or not found.settled or found.divided:
                found = fitted(patches(*coarse(ridge, overlap, normal, count), self.fineness, few), few, 5 * tolerance)
                found = None if found is None else fitted(found.layout, full, tolerance)
        if found is None:
            return None
        gathered = Gathered(self.operators, pose, found.layout, self.laws, found.normal)
        return Cells(found.layout, raised, gathered, 1.0, np.zeros(0)), found.pressure, found.settled

    def _rigid(self, places: Places, motion: Motion) -> tuple[float, Array | None]:
        """Rolling speed [m/s] and rigid creepage, or the shift [m]; none without friction."""
        if not self.laws.friction:
            return 0.0, None
        return (0.0, shift(places, motion)) if self.tangential == "shift" else creepage(places, motion)
