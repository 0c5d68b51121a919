"""Contact on strips of a lattice fixed on the upper body: the force is a function of the pose alone."""

from __future__ import annotations

import logging
from dataclasses import dataclass, field, replace
from functools import cached_property
from time import perf_counter
from typing import Literal

import numpy as np

from wheelrail.bindings._contact import StripBasis, SurfaceData
from wheelrail.contact.geometry.interpenetration import TOO_DEEP
from wheelrail.contact.geometry.strip_lattice import cells_along, lattice_sides
from wheelrail.contact.kinematics.contact_points import OutsideSurface
from wheelrail.contact.kinematics.creepage import NotRolling
from wheelrail.contact.kinematics.frames import Pose, RigidMotion
from wheelrail.contact.laws.parameters import ContactLaws
from wheelrail.contact.models.lattice.blend import blended
from wheelrail.contact.models.lattice.bulk_displacement import BulkDisplacement
from wheelrail.contact.models.lattice.influence.basis import strip_basis
from wheelrail.contact.models.lattice.influence.pair_tables import LatticeTables
from wheelrail.contact.models.lattice.influence.strip_operators import StripOperators
from wheelrail.contact.models.lattice.levels import ORDINARY, LevelShares, LevelSolutions, level_shares
from wheelrail.contact.models.lattice.resolution import LatticeResolution, strips_apart
from wheelrail.contact.models.lattice.results import contact_result
from wheelrail.contact.models.lattice.solver.cold_start import cold_start
from wheelrail.contact.models.lattice.solver.entry import penetrating
from wheelrail.contact.models.lattice.solver.newton import LatticeNewton, LatticeSolution
from wheelrail.contact.models.lattice.system.friction import CellFriction
from wheelrail.contact.models.lattice.system.problem import MARGIN, LatticeProblem
from wheelrail.contact.models.lattice.system.surface import surface_data
from wheelrail.contact.results.extrapolation import estimate
from wheelrail.contact.results.result import ContactResult, Statistics
from wheelrail.contact.solvers.options import IterationCount, NotConverged
from wheelrail.support.memory import check_memory

log = logging.getLogger(__name__)

FARTHEST = 0.5  # first step from an earlier result beyond which a start without it needs fewer iterations
WARM_ITERATIONS = 12  # from an earlier result: from none, 8 to 12 suffice nearly always
MATRICES = 2.0  # of the size of the Jacobian: itself, its factors and slips in single precision
SPEED = 5e9  # 1/s, operations of a factorisation on one core
LONG = 2.0  # s per Newton step, from which on the time is logged
# m, approach of a wheel on half-spaces, and on bodies that bend: with 3 mm one on the tread carries 5 MN
DEEPEST = 3e-3, 1e-2
START_CELLS = 8, 12, 16, 24  # along a strip, at a start without an earlier result
MOST_CELLS, NARROWER = 48, (1, 2)  # along a strip, and halvings of its width, in search of a pressure without tension
TENSION = "the pressure is negative at an end of a strip; more strips may serve"
ITERATIONS = 25  # from such a start: 99.9 % of random poses need at most 21


@dataclass(frozen=True)
class LatticeContact:
    """Contact model on a lattice of strips: pose and velocities in, `ContactResult` out.

    Parameters:
        operators: compliance and surfaces of both bodies.
        laws: of the interface.
        resolution: strips over a usual patch, cells along a strip.
        tangential: steady "rolling", or "shift", one step of tangential loading from none (Cattaneo, Mindlin): the
            motion's velocities are displacements in m and rad.
        tolerance: of the last step, relative to the largest pressure and length; it is taken. With a new Jacobian the
            error is about its square, with a kept one up to 0.3 of it, that of forces some 1e-7 at the default.
        estimate: results carry an error estimate, from two lattices of half the resolution.
        offset: of the lattice, in strips.
        level: halvings of the strips' width, see `wheelrail.contact.models.lattice.levels`. Level 0, the model itself,
            solves narrow contacts on its finer levels.

    The guess is an initial guess only: results do not depend on it. Raises ValueError for a penalty, whose pressure has
    no sharp ends, and for a friction law that depends on the slip velocity together with tangential = "shift".
    """

    operators: StripOperators
    laws: ContactLaws
    resolution: LatticeResolution = field(default_factory=LatticeResolution)
    tangential: Literal["rolling", "shift"] = "rolling"
    tolerance: float = 1e-5
    estimate: bool = False
    offset: float = 0.0
    level: int = 0

    def __post_init__(self) -> None:
        if not self.laws.exact_normal:
            raise ValueError(f"a lattice needs the exact normal law, got {self.laws}")
        if self.tangential == "shift" and self.laws.depend_on_slip:
            raise ValueError("friction that depends on the slip velocity needs rolling, not a tangential displacement")

    def __call__(self, pose: Pose, motion: RigidMotion, guess: ContactResult | None = None) -> ContactResult:
        """Result of a pose and motion; the guess changes the number of iterations only."""
        problem = self.problem(pose, motion)
        if self.level > 0:
            result = self.solve(problem, guess)
        elif self.tables.bodies:
            result = self._on_finite_bodies(problem, guess)
        else:
            shares = level_shares(problem, self.resolution.strips)
            result = self.solve(problem, guess) if shares is ORDINARY else self._on_levels(shares, problem, guess)
        if not (self.estimate and result.patches):
            return result
        return replace(result, error_estimate=estimate(result, [model(pose, motion) for model in self.coarse]))

    def _on_finite_bodies(self, problem: LatticeProblem, guess: ContactResult | None) -> ContactResult:
        """Result of finite bodies, whose displacement on ordinary strips tells how wide the contact is."""
        ordinary = self.solve(problem, guess)
        if not ordinary.ok:
            return ordinary
        solution = _solution(ordinary)
        bulk = None if solution is None else BulkDisplacement(problem, solution)
        shares = level_shares(problem, self.resolution.strips, bulk)
        return ordinary if shares is ORDINARY else self._on_levels(shares, problem, guess, ordinary)

    def _on_levels(
        self,
        shares: LevelShares,
        problem: LatticeProblem,
        guess: ContactResult | None,
        ordinary: ContactResult | None = None,
    ) -> ContactResult:
        """Result of a narrow contact; ordinary: that on ordinary strips, if it is known."""
        known = {} if ordinary is None else {0: ordinary}
        for level in shares.levels:
            if level not in known:
                model = self.on(level)
                at = problem if model is self else model.problem(problem.pose, problem.motion)
                known[level] = model.solve(at, guess)
        results = [known[level] for level in shares.levels]
        result = results[0] if len(results) == 1 else blended(results[0], results[1], shares)
        solutions = {level: _solution(own) for level, own in known.items()}
        counted = tuple(solutions[level] for level in shares.levels)
        return replace(result, warm_start=LevelSolutions(shares.levels, counted, solutions.get(0)))

    def on(self, level: int) -> LatticeContact:
        """The model on one level of its lattice alone, stored."""
        if level == self.level:
            return self
        if level not in self._levels:
            model = replace(self, level=level, estimate=False)
            model.__dict__.update(_tables=self._tables, surface=self.surface, basis=self.basis)
            self._levels[level] = model
        return self._levels[level]

    @cached_property
    def _levels(self) -> dict[int, LatticeContact]:
        return {}

    @cached_property
    def coarse(self) -> tuple[LatticeContact, LatticeContact]:
        """Models of half the resolution, one on strips that are offset by half their width: errors scatter with it."""
        one = replace(self, resolution=self.resolution.coarsened(), estimate=False)
        return one, replace(one, offset=0.5)

    @cached_property
    def frictionless(self) -> LatticeContact:
        """The model without friction on the same strips, a fifth of the unknowns; itself if it has none."""
        if not self.laws.frictional:
            return self
        model = replace(self, laws=ContactLaws(friction=0.0), estimate=False)
        model.__dict__.update(_tables=self._tables, surface=self.surface)
        return model

    @property
    def tables(self) -> LatticeTables:
        """Compliance of pairs of strips of the lattice."""
        if self.level not in self._tables:
            surfaces, upper = self.operators.surfaces, self.operators.upper
            sides = lattice_sides(surfaces, upper.arc, self.resolution.strips * 2**self.level, self.offset)
            self._tables[self.level] = LatticeTables(self.operators, sides, rolls=self.tangential == "rolling")
        return self._tables[self.level]

    @cached_property
    def _tables(self) -> dict[int, LatticeTables]:
        """Those of the levels that were needed."""
        return {}

    @cached_property
    def surface(self) -> SurfaceData:
        """Surfaces of both bodies, for compiled code."""
        return surface_data(self.operators.surfaces)

    @cached_property
    def basis(self) -> StripBasis:
        return strip_basis(self.cells, self.tangential if self.laws.frictional else "none")

    @cached_property
    def cells(self) -> int:
        """Cells along a strip."""
        return cells_along(self.operators.surfaces, self.resolution.cells)

    @cached_property
    def friction(self) -> CellFriction | None:
        """Law of friction in the cells; None without."""
        return CellFriction.of(self.laws) if self.laws.frictional else None

    def problem(self, pose: Pose, motion: RigidMotion) -> LatticeProblem:
        """Equations of a pose and motion."""
        margin = MARGIN / 2**self.level  # the approach falls with the square of the width or, of long patches, less
        apart = strips_apart(self.resolution.strips * 2**self.level)
        return LatticeProblem(self.surface, self.tables, self.basis, self.friction, pose, motion, margin, apart)

    def solve(self, problem: LatticeProblem, guess: ContactResult | None = None) -> ContactResult:
        """Result of the equations on the strips of this level, however few of them are loaded."""
        start, count = perf_counter(), IterationCount()
        approach = problem.approach
        if approach <= 0:
            return ContactResult.failed(problem.overlap) if problem.overlap else ContactResult.separated(approach)
        if problem.surface.revolves and approach > DEEPEST[bool(self.tables.bodies)]:
            return ContactResult.failed(f"{TOO_DEEP}: both overlap by {1e3 * approach:.3g} mm", approach)
        try:
            problem.check_inside()
            solution = self._from_earlier(problem, guess, count) or self._from_none(problem, count)
            problem.check_loaded(solution.state.strips)
            if problem.tensile(solution.state):
                return self._without_tension(problem, solution)
            statistics = Statistics(
                newton=count.newton,
                linear=count.linear,
                points=len(solution.state.strips) * problem.cells,
                residual=count.residual,
                seconds={"solve": perf_counter() - start},
            )
            return contact_result(problem, solution, statistics)
        except (OutsideSurface, NotRolling, NotConverged, np.linalg.LinAlgError) as error:
            return ContactResult.failed(str(error), approach)

    def _without_tension(self, problem: LatticeProblem, solution: LatticeSolution) -> ContactResult:
        """Result with more cells along the strips of a solution with tension, or on narrower strips. Raises
        NotConverged.
        """
        few = len(solution.state.strips) <= self.resolution.strips  # wider contacts have enough
        for model in self._finer if few else self._finer[: -len(NARROWER)]:
            log.debug("tension; with %d cells along strips of level %d", model.cells, model.level)
            result = model.solve(model.problem(problem.pose, problem.motion))
            if result.ok:
                return replace(result, warm_start=solution)
        raise NotConverged(TENSION)

    @cached_property
    def _finer(self) -> tuple[LatticeContact, ...]:
        """The model with more cells along the same strips, then on narrower ones; without finer ones of their own."""
        cells = [n * self.resolution.cells for n in (2, 4) if n * self.cells <= MOST_CELLS]
        models = [replace(self, resolution=replace(self.resolution, cells=n), estimate=False) for n in cells]
        models += [replace(self, level=self.level + n, estimate=False) for n in NARROWER]
        for model in models:
            model.__dict__.update(_tables=self._tables, surface=self.surface, _finer=())
        return tuple(models)

    def _from_earlier(
        self, problem: LatticeProblem, guess: ContactResult | None, count: IterationCount
    ) -> LatticeSolution | None:
        """Solution from the strips of an earlier result; None where that is too far away."""
        earlier = None if guess is None else guess.warm_start
        if isinstance(earlier, LevelSolutions):
            earlier = earlier.on(self.level)
        elif self.level > 0:
            return None
        if not isinstance(earlier, LatticeSolution):
            return None
        if earlier.state.values.shape[1] != self._block:
            return None
        newton, state = LatticeNewton(problem, self.tolerance, count), earlier.state
        remain = problem.lines.near[state.strips]
        if not remain.any():
            return None
        try:
            if remain.all():
                return newton.from_earlier(earlier, WARM_ITERATIONS, FARTHEST)
            return newton.solve(state.at(remain), WARM_ITERATIONS, FARTHEST)
        except (NotConverged, OutsideSurface) as error:
            log.debug("from the earlier result: %s", error)
            return None

    @cached_property
    def _block(self) -> int:
        """Unknowns of a strip."""
        tractions = 2 * self.cells if self.laws.frictional else 0
        return tractions + len(self.basis.moments)

    def _check_size(self, strips: int) -> None:
        """Log memory and time of Newton's method on some strips if they are large. Raises TooLarge."""
        unknowns = strips * self._block
        gigabytes, seconds = MATRICES * 8e-9 * unknowns**2, 2 / 3 * unknowns**3 / SPEED
        name = f"{strips} strips, {self.cells} cells along each: {unknowns} unknowns"
        check_memory(name, gigabytes)
        if seconds > LONG:
            log.info("%s: %.2g GB, about %.2g s per Newton step", name, gigabytes, seconds)

    def _from_none(self, problem: LatticeProblem, count: IterationCount) -> LatticeSolution:
        """Solution without an earlier result, from cells that are refined until Newton's method converges: strips with
        little load need more of them. Raises TooLarge, NotConverged, OutsideSurface.
        """
        self._check_size(len(problem.candidates))
        for cells in START_CELLS[:-1]:
            try:
                return self._from_cells(problem, cells, count)
            except (NotConverged, OutsideSurface, np.linalg.LinAlgError) as error:
                log.debug("from %d cells: %s", cells, error)
        return self._from_cells(problem, START_CELLS[-1], count)

    def _from_cells(self, problem: LatticeProblem, cells: int, count: IterationCount) -> LatticeSolution:
        """Solution from complementarity on a number of equal cells along each strip."""
        state = cold_start(problem, self.laws, cells, IterationCount())
        apart = penetrating(problem, state, set(problem.candidates.tolist()))
        if len(apart.strips):
            state = cold_start(problem, self.laws, cells, IterationCount(), (apart.strips, apart.ends))
        return LatticeNewton(problem, self.tolerance, count).solve(state, iterations=ITERATIONS)


def _solution(result: ContactResult) -> LatticeSolution | None:
    """That of a result; None without load."""
    return result.warm_start if isinstance(result.warm_start, LatticeSolution) else None
