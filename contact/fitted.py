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

from contact.coarse import coarse, mean_overlap
from contact.error_estimate import ErrorEstimate, difference
from contact.fineness import Fineness
from contact.fitting import fit
from contact.kinematics import NotRolling, creepage, shift
from contact.laws import Laws
from contact.parts import patches
from contact.patches import outcome
from contact.points import OutsideGrid, Places
from contact.pose import Array, Motion, Pose
from contact.raised import Raised
from contact.result import ContactResult, Statistics
from contact.strip_moments import sharpened
from contact.strip_operators import StripOperators
from contact.strip_surfaces import Ridge
from contact.strips import Layout, connected, marks
from contact.tractions import Count, NewtonOptions, NotConverged, solve_tractions

log = logging.getLogger(__name__)

ROUNDS = 6  # of fitting and solving, where friction changes the overlap
RAISED = 1e-2  # of the approach, that friction may still change it by
LINES = 241  # where the overlap of two profiles is looked for: 0.4 mm apart


@dataclass(frozen=True)
class FittedContact:
    """Contact model on strips of cells that end where the contact ends: pose and velocities in, `ContactResult` out.

    tolerance: RMS of the last movement of the strips' ends over their length. tangential as for `Condensed`. estimate:
    every result carries an estimate of its error, for about a third more time. Raises ValueError for a penalty, whose
    pressure has no such ends, and for friction that a shift cannot have.
    """

    operators: StripOperators
    laws: Laws
    fineness: Fineness = field(default_factory=Fineness)
    tolerance: float = 1e-3
    options: NewtonOptions = field(default_factory=NewtonOptions)
    tangential: Literal["rolling", "shift"] = "rolling"
    estimate: bool = False

    def __post_init__(self) -> None:
        if self.laws.normal_compliance > 0:
            raise ValueError(f"fitted cells need the exact normal law, got {self.laws}")
        if self.tangential == "shift" and (self.laws.regularisation > 0 or self.laws.falling is not None):
            raise ValueError(f"a shift has no slip velocity for friction to depend on, got {self.laws}")

    def __call__(self, pose: Pose, motion: Motion, guess: ContactResult | None = None) -> ContactResult:
        """The guess is not used: the same pose and motion always give the same result."""
        result = self._solved(pose, motion)
        if not (self.estimate and result.patches):
            return result
        rough = replace(self, fineness=self.fineness.halved(), estimate=False)(pose, motion)
        return replace(result, error_estimate=difference(result, rough) if rough.ok else ErrorEstimate.unknown())

    def _solved(self, pose: Pose, motion: Motion) -> ContactResult:
        start = perf_counter()
        surfaces, count = self.operators.surfaces, Count()
        ridge = surfaces.ridge(pose, self._lines)
        approach = float(ridge.overlap.max())
        if approach <= 0:
            return ContactResult.separated(approach)
        spent = {"fit": 0.0, "compliance": 0.0, "solve": 0.0}
        raised: Raised | None = None
        try:
            for _ in range(ROUNDS):
                fit_found = self._fitted(pose, ridge, raised, count)
                if fit_found is None:
                    return ContactResult.separated(approach)
                layout, pressure, settled = fit_found
                fitted = perf_counter()
                overlap = mean_overlap(surfaces, pose, layout).ravel()
                places = replace(surfaces.places(pose, layout), overlap=overlap)
                n = len(overlap)
                speed, rigid = self._rigid(places, motion)
                if rigid is None:
                    displacement = operator = self.operators.normal(pose, layout)
                else:
                    displacement, slip = self.operators.all(pose, layout, places)
                    slip = displacement[: 2 * n] if self.tangential == "shift" else slip
                    # a pressure pushes along the inward normal: the last columns count -p
                    operator = np.vstack([slip, displacement[2 * n :]])
                gathered = perf_counter()
                found = solve_tractions(
                    operator,
                    overlap,
                    rigid,
                    laws=self.laws,
                    speed=speed,
                    guess=(np.maximum(pressure.ravel(), 0.0), np.zeros(2 * n)),
                    options=self.options,
                    count=count,
                )
                solved = perf_counter()
                for phase, seconds in zip(spent, (fitted - start, gathered - fitted, solved - gathered), strict=True):
                    spent[phase] += seconds
                start = solved
                if rigid is None:
                    break
                # friction presses the bodies together or apart, where one patch pushes another one sideways, too
                by_friction = (displacement[2 * n :, : 2 * n] @ found.tangential.T.ravel()).reshape(pressure.shape)
                after = Raised.by(layout, by_friction)
                change = float(np.abs(after.at(layout) - (0.0 if raised is None else raised.at(layout))).max())
                log.debug("friction changes the overlap by %.1e of the approach", change / approach)
                if change <= RAISED * approach:
                    break
                raised = after
            else:
                settled = False
        except (OutsideGrid, NotRolling, NotConverged, np.linalg.LinAlgError) as error:
            return ContactResult.failed(str(error), approach)
        p, q = found.pressure, found.tangential
        loads = -p if rigid is None else np.concatenate([*q.T, -p])
        moved = np.zeros((n, 3))
        moved[:, 3 - len(displacement) // n :] = (displacement @ loads).reshape(-1, n).T
        bound = self.laws.friction_at(np.hypot(*found.slip.T), speed)[0] * p
        strip = connected(layout, p.reshape(len(layout.sides), -1))
        patch = np.where(p > 0, np.repeat(strip, self.fineness.cells), -1)
        result = outcome(
            places,
            node=np.arange(n),
            patch=patch,
            pressure=p,
            traction=q,
            slip=found.slip,
            displacement=moved,
            approach=approach,
            bound=bound,
            statistics=Statistics(
                newton=count.newton,
                linear=count.linear,
                points=n,
                residual=count.residual,
                settled=settled,
                seconds=spent,
            ),
        )
        return sharpened(result, layout, bound)

    @cached_property
    def _lines(self) -> Array:
        """Where the overlap is looked for, m: more finely than the lines of the compliance."""
        arc = self.operators.upper.arc
        return np.asarray(np.linspace(arc[0], arc[-1], max(2 * len(arc), LINES)))

    def _fitted(
        self, pose: Pose, ridge: Ridge, raised: Raised | None, count: Count
    ) -> tuple[Layout, Array, bool] | None:
        """Cells, their pressures (S, M) Pa under an overlap raised by friction, and whether they settled; None without
        contact.
        """
        surfaces = self.operators.surfaces

        def normal(layout: Layout) -> Array:
            return self.operators.normal(pose, layout)

        def overlap(layout: Layout) -> Array:
            free = mean_overlap(surfaces, pose, layout)
            return free if raised is None else free + raised.at(layout)

        if ridge.overlap[0] > 0 or ridge.overlap[-1] > 0:
            raise OutsideGrid("the wheel overlaps the rail beyond the part of its surface that carries contact points")
        rough, pressure = coarse(ridge, overlap, normal, count)
        rolls = self.laws.friction > 0 and self.tangential == "rolling"
        few, tolerance = max(self.fineness.cells // 2, 4), 5 * self.tolerance
        # equal cells find the ends from afar; those that shrink towards the leading end only from near
        layout = patches(rough, pressure, self.fineness, marks(few, rolling=False))
        settled = True
        for cells in (marks(few, rolling=False), marks(self.fineness.cells, rolling=rolls)):
            if layout is None:
                return None
            start = replace(layout, marks=cells)
            found = fit(overlap, normal, start, self.fineness, tolerance=tolerance, count=count)
            if found is None:
                return None
            layout, pressure, settled = found.layout, found.pressure, found.settled
            tolerance = self.tolerance
        return None if layout is None else (layout, pressure, settled)

    def _rigid(self, places: Places, motion: Motion) -> tuple[float, Array | None]:
        """Rolling speed [m/s] and rigid creepage, or the shift [m]; none without friction."""
        if not self.laws.friction:
            return 0.0, None
        return (0.0, shift(places, motion)) if self.tangential == "shift" else creepage(places, motion)
