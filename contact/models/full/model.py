"""All displacements of both bodies in one sparse problem, eq. (12): dolfinx's NewtonSolver with PETSc's BiCGStab.

Unknown U = (U_w, U_r); z = z0 + G U: penetration and slip at the contact points; T(z): nodal contact forces of the law
in UFL. Residual F = K U - B^T T(z0 + G U), Jacobian K - B^T D G with D = dT/dz. The same B applies the forces to both
bodies, so action equals reaction to round-off. The tangent of the resultants by the pose is that of the contact points
condensed with the compliance C = G K^-1 B^T, which the preconditioner has.

Exact laws by augmented-Lagrangian iterations, see `wheelrail.contact.laws.augmented_lagrangian`: each is one such solve
from the last displacements.
"""

from __future__ import annotations

import logging
from dataclasses import dataclass, field, replace
from functools import cached_property
from time import perf_counter
from typing import ClassVar

import numpy as np

from wheelrail.bindings._contact import overloaded
from wheelrail.contact.elasticity.solid_body import ElasticBody
from wheelrail.contact.geometry.grid_points import GridPoints, SurfacePair
from wheelrail.contact.kinematics.contact_points import OutsideSurface
from wheelrail.contact.kinematics.creepage import NotRolling, creepage
from wheelrail.contact.kinematics.frames import Pose, RigidMotion
from wheelrail.contact.laws.augmented_lagrangian import LOOPS, offset, softened
from wheelrail.contact.laws.parameters import ContactLaws
from wheelrail.contact.models.full.discrete_problem import DiscreteProblem, body_displacements
from wheelrail.contact.models.full.newton import FullIterationCount, FullOptions, Newton
from wheelrail.contact.models.full.surface_traction import SurfaceLaw
from wheelrail.contact.models.full.two_body_stiffness import two_body_stiffness, with_rigid_motions
from wheelrail.contact.results.result import ContactResult, Statistics
from wheelrail.contact.results.resultants import FrictionalWork, assemble_result, connected
from wheelrail.contact.results.touching_material import symmetric
from wheelrail.contact.solvers.tangent import TangentProblem, tangent_of
from wheelrail.contact.solvers.tractions import ContactCompliance, Tractions
from wheelrail.support.arrays import Array, Nodes
from wheelrail.support.memory import check_memory, dense_seconds, solution_seconds

log = logging.getLogger(__name__)

MATRICES = 4.0  # of the size of a Newton step's dense one: compliance, its rows by components, product, factors
STEPS = 7  # of Newton's method from zero
LONG = 10.0  # s of a solve, from which on its time is logged


@dataclass(frozen=True)
class FullStart:
    """Solution from which a next solve starts.

    Parameters:
        displacement: of all unknowns, wheel before rail, m; under `mpirun` those of this rank.
        node: (n,) contact points on the wheel's grid.
        z: (n, c) penetration m and slip at them.
        traction: (n, c) normal (negative) and tangential, Pa.
    """

    displacement: Array
    node: Nodes
    z: Array
    traction: Array


@dataclass
class FullContact:
    """Contact model on the complete 3D meshes: pose and velocities in, `ContactResult` out.

    Parameters:
        geometry: surfaces of both bodies and their grids.
        wheel, rail: meshed solids with their stiffness.
        laws: of the interface.
        order: of the upstream difference formula for the slip, 1 or 2.
        options: of the solvers.
        modulus: contact modulus of both bodies, Pa, which bounds the pressure.

    Under `mpirun` all ranks call it together, with distributed bodies, and get the same result except for the
    displacements in its `warm_start`.
    """

    geometry: SurfacePair
    wheel: ElasticBody
    rail: ElasticBody
    laws: ContactLaws
    order: int = 2
    options: FullOptions = field(default_factory=FullOptions)
    modulus: float = np.inf

    concurrent: ClassVar = False  # PETSc solves in one thread

    @cached_property
    def soft(self) -> ContactLaws:
        """The regularised laws with which displacements are solved."""
        size = float(np.sqrt(self.wheel.grid.weight.max()))
        return softened(self.laws, modulus=self.wheel.steel.E, size=size)

    @cached_property
    def law(self) -> SurfaceLaw:
        gained = 0.0 if self.laws.regularisation else self.soft.regularisation
        wheel = self.wheel
        return wheel.ranks.first_then_all(
            lambda: SurfaceLaw(wheel.solid, wheel.grid, wheel.degree, self.soft, gained=gained)
        )

    @cached_property
    def solver(self) -> Newton:
        """Solver with the stiffness of both bodies and its preconditioner (19), computed once."""
        matrix = two_body_stiffness(self.wheel, self.rail)
        if self.options.preconditioner == "gamg":
            with_rigid_motions(matrix, np.concatenate([self.wheel.coordinates, self.rail.coordinates]))
        return Newton(matrix, self.options, (self.wheel, self.rail))

    def __call__(self, pose: Pose, motion: RigidMotion, guess: ContactResult | None = None) -> ContactResult:
        began = perf_counter()
        order, ranks = self.order if self.laws.frictional else 0, self.wheel.ranks
        try:
            points, approach = ranks.broadcast(lambda: self.geometry.contact_points(pose, order))
        except OutsideSurface as error:
            return ContactResult.failed(str(error))
        if points is None:
            return ContactResult.separated(approach)
        try:
            speed, rigid = creepage(points, motion) if order else (0.0, None)
        except NotRolling as error:
            return ContactResult.failed(str(error), approach)
        problem = DiscreteProblem.of(points, (self.wheel, self.rail), self.law, self.order, rigid)
        ready = perf_counter()
        self.law.at_speed(speed)
        self._tell(problem)
        earlier = guess.warm_start if guess is not None and isinstance(guess.warm_start, FullStart) else None
        start = self._start(earlier), earlier_contact(earlier, points, self.law.components)
        u, z, forces, status, count = self._solve(problem, points.area, speed, *start)
        solved = perf_counter()
        if status != "converged":
            return ContactResult.failed(status, approach)
        traction = forces / points.area[:, None]
        failure = overloaded(approach, -float(traction[:, 0].min(initial=0.0)), self.modulus)
        if failure:
            return ContactResult.failed(failure, approach)
        n = len(points.node)
        displacement = np.zeros((n, 3))
        local = ranks.all_reduce(problem.displacement @ u).reshape(-1, n).T
        displacement[:, 3 - local.shape[1] :] = local
        tangential = traction[:, 1:] if order else np.zeros((n, 2))
        bound = self.laws.friction_bound(-traction[:, 0], np.hypot(*z[:, 1:].T) if order else np.zeros(n), speed)
        moved = None if symmetric(points, tangential) else body_displacements(points, u, (self.wheel, self.rail))
        result = assemble_result(
            FrictionalWork.below(bound, points, tangential, motion, speed),
            node=points.node,
            patch=connected(points.node, traction[:, 0] < 0, self.wheel.grid.shape),
            pressure=-traction[:, 0] + 0.0,
            slip=z[:, 1:] if order else np.zeros((n, 2)),
            displacement=displacement,
            approach=approach,
            statistics=Statistics(
                newton=count.newton,
                linear=count.linear,
                points=n,
                residual=count.residual,
                seconds={"points": ready - began, "solve": solved - ready},
            ),
            bodies=None if moved is None else lambda: moved,
        )
        tangent = None
        if problem.compliance is not None:
            tractions = Tractions(-traction[:, 0], tangential, z[:, 1:] if order else tangential, traction[:, 0] < 0)
            operator = ContactCompliance(problem.by_traction(points.area), n, self.laws)
            tangent = tangent_of(
                TangentProblem(points, pose.origin, motion, operator, rigid, speed, self.laws, tractions)
            )
        return replace(result, warm_start=FullStart(u, points.node, z, traction), force_tangent=tangent)

    def _tell(self, problem: DiscreteProblem) -> None:
        """Log memory and time of a solve if long. Raises TooLarge."""
        preconditioner = self.solver.preconditioner
        if preconditioner is None:
            return
        n, products, columns = len(problem.nodes), 0.0, 0.0
        for body, operators, compliance in zip(
            (self.wheel, self.rail), problem.operators, preconditioner.compliances, strict=True
        ):
            one = solution_seconds(body.stiffness.getSize()[0])
            products += one
            columns += one * compliance.columns_missing(operators.nodes, operators.directions)
        dense = self.law.components * n
        name = f"full model: {n} contact points"
        check_memory(name, MATRICES * 8e-9 * dense**2)
        step = dense_seconds(dense) + products
        if columns + STEPS * step > LONG:
            log.info("%s: about %.2g s per Newton step, at most %.2g s for compliances before", name, step, columns)

    def _start(self, earlier: FullStart | None) -> Array | None:
        """Displacements of an earlier result; None if they belong to other meshes or another distribution."""
        displacement = None if earlier is None else earlier.displacement
        owned = 3 * (self.wheel.owned + self.rail.owned)
        mismatches = self.wheel.ranks.all_reduce(np.array(float(displacement is None or len(displacement) != owned)))
        return None if mismatches else displacement

    def _solve(
        self,
        problem: DiscreteProblem,
        area: Array,
        speed: float,
        start: Array | None,
        earlier: tuple[Array, Array] | None,
    ) -> tuple[Array, Array, Array, str, FullIterationCount]:
        """Displacements m, z (n, c) and nodal forces (n, c) N of the laws, status and cost.

        Parameters:
            problem: of one pose.
            area: (n,) m2.
            speed: of rolling, m/s.
            start: initial displacements m of this rank.
            earlier: see `earlier_contact`; that of exact laws has other multipliers.
        """
        regularised = self.soft == self.laws or (self.law.components == 1 and not self.laws.exact_normal)
        u, status, count = self.solver.run(problem, start, earlier if regularised else None)
        constant = problem.constant
        multiplier_offset: Array = np.zeros((len(area), self.law.components))
        z, forces = problem.state(u)
        if regularised:
            return u, z, forces, status, count
        for _ in range(LOOPS):
            if status != "converged":
                break
            count.loops += 1
            slip = (z - multiplier_offset)[:, 1:]
            multiplier_offset = offset(self.laws, self.soft, forces / area[:, None], slip, speed)
            problem.constant = constant + multiplier_offset.T.ravel()
            u, status, inner = self.solver.run(problem, u, (z, forces))
            count.add(inner)
            previous = forces
            z, forces = problem.state(u)
            change = float(np.linalg.norm(forces - previous)) / max(float(np.linalg.norm(forces)), 1e-300)
            count.residual = max(inner.residual, change)
            if change <= max(10 * self.options.tolerance, 1e-9):
                return u, z - multiplier_offset, forces, status, count
        else:
            status = f"relative change of the multipliers {change:.1e} after {LOOPS} augmented-Lagrangian iterations"
        return u, z - multiplier_offset, forces, status, count


def earlier_contact(earlier: FullStart | None, points: GridPoints, components: int) -> tuple[Array, Array] | None:
    """z and nodal forces (n, c) N of an earlier solution at contact points, separated at new nodes; None without."""
    if earlier is None or earlier.z.shape[1] != components:
        return None
    z, traction = np.zeros((2, len(points.node), components))
    z[:, 0] = -1.0
    _, index, before = np.intersect1d(points.node, earlier.node, assume_unique=True, return_indices=True)
    z[index], traction[index] = earlier.z[before], earlier.traction[before]
    return z, traction * points.area[:, None]
