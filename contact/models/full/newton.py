"""dolfinx's NewtonSolver for eq. (12): BiCGStab, forcing term, primal-dual tangent of friction, Armijo."""

from __future__ import annotations

import logging
import weakref
from dataclasses import dataclass
from time import monotonic
from typing import Any

import numpy as np
from petsc4py import PETSc

from wheelrail.contact.elasticity.solid_body import ElasticBody
from wheelrail.contact.models.full.discrete_problem import DiscreteProblem, Linearisation
from wheelrail.contact.models.full.jacobian import Jacobian, JacobianOperator
from wheelrail.contact.models.full.preconditioner import ContactPreconditioner, Preconditioner, choose
from wheelrail.forms import compat
from wheelrail.support.arrays import Array
from wheelrail.support.interrupts import check_interrupt
from wheelrail.support.terminal import PERIOD

log = logging.getLogger(__name__)

LEVELS = (300.0, 10.0)  # multiples of the regularisation in the continuation
ROUGH = 1e-2  # tolerance of the relative residual at these


@dataclass(frozen=True)
class FullOptions:
    """Options of the Newton method.

    Parameters:
        tolerance: residual force over contact force.
        iterations: largest number of Newton steps.
        forcing: relative tolerance of the linear solves, eq. (18).
        jacobian: exact product or finite difference (20).
        preconditioner: from the elastic stiffness (19), see `wheelrail.contact.models.full.preconditioner`.
        armijo: largest number of halvings of a step, where steps of full length fail.
    """

    tolerance: float = 1e-10
    iterations: int = 50
    forcing: float = 0.01
    jacobian: Jacobian = "exact"
    preconditioner: Preconditioner = "corrected"
    armijo: int = 12


@dataclass
class FullIterationCount:
    """Newton and BiCGStab iterations, failed linear solves, Armijo halvings, augmented-Lagrangian iterations (loops),
    and the relative residual.
    """

    newton: int = 0
    linear: int = 0
    failed_linear: int = 0
    backtracks: int = 0
    loops: int = 0
    residual: float = np.inf

    def add(self, more: FullIterationCount) -> None:
        """Add the counts of another solve."""
        self.newton += more.newton
        self.linear += more.linear
        self.failed_linear += more.failed_linear
        self.backtracks += more.backtracks


class Newton(compat.newton_base()):  # type: ignore[misc]
    """dolfinx's NewtonSolver for a changing `DiscreteProblem`, with Armijo backtracking and a check of every linear
    solve.
    """

    def __init__(self, stiffness: Any, options: FullOptions, bodies: tuple[ElasticBody, ElasticBody]) -> None:
        ranks = bodies[0].ranks
        super().__init__(ranks.comm)
        self.options, self.stiffness, self.ranks = options, stiffness, ranks
        self.problem: DiscreteProblem | None = None
        self.count = FullIterationCount()
        self._b, self._work = stiffness.createVecs()
        self._x = self._work.duplicate()
        self._halvings = 0  # largest number in the present attempt
        self._told = 0.0  # s, time of the last message
        self._contact = 0.0  # norm of the contact forces, reference of the relative residual
        self._sought = options.tolerance  # relative residual
        self._predicted: Array = np.empty((0, 0))  # nodal forces by the last linear step
        self._linearisation: tuple[Linearisation, Array] | None = None  # and its displacements
        self._product = JacobianOperator(stiffness)
        jacobian = PETSc.Mat().createPython(stiffness.getSizes(), self._product, comm=ranks.comm)
        jacobian.setUp()
        compat.freed_with(self, stiffness, self._b, self._work, self._x, jacobian)
        solver = weakref.proxy(self)  # strong references in callbacks of C++ would never be freed
        self.setF(lambda x, b: solver._residual(x, b), self._b)
        self.setJ(lambda x, J: solver._linearise(x, J), jacobian)
        self.setP(lambda x, P: None, stiffness)
        self.set_form(lambda x: None)
        self.set_update(lambda _, step, x: solver._update(step, x))
        krylov = self.krylov_solver
        krylov.setOperators(jacobian, stiffness)
        krylov.setType("fbcgs")
        krylov.setTolerances(rtol=options.forcing, atol=1e-300, max_it=500)
        pc = krylov.getPC()
        corrected = options.preconditioner == "corrected"
        self.preconditioner = ContactPreconditioner(bodies, options.forcing) if corrected else None
        if self.preconditioner is not None:
            pc.setType("python")
            pc.setPythonContext(self.preconditioner)
        else:
            choose(pc, options.preconditioner, ranks)
        pc.setReusePreconditioner(True)
        self.convergence_criterion = "residual"
        self.rtol = 0.0
        self.max_it = options.iterations
        self.error_on_nonconvergence = False
        self.report = False

    def run(
        self, problem: DiscreteProblem, start: Array | None = None, earlier: tuple[Array, Array] | None = None
    ) -> tuple[Array, str, FullIterationCount]:
        """Displacements of this rank, status and cost.

        Parameters:
            problem: of one pose.
            start: initial displacements of this rank.
            earlier: z and nodal forces (n, c) N of an earlier solution at the same nodes.

        With both, and the compliance between the points, displacements start from the linear response of the earlier
        solution to the change of the pose: at its displacements, a wheel that has moved up by more than the penalty's
        penetration has no contact.

        Without a start, or if the solve from it fails, displacements start from zero, and steps have their full length:
        those of the primal-dual tangent do not reduce the residual at first. If that fails, too, by Armijo's rule and
        continuation in the regularisation of friction, as by differences of F: Newton's method with the exact tangent
        does not converge directly on the nearly discontinuous law.
        """
        self.problem, self.count, self._told = problem, FullIterationCount(), monotonic()
        if self.preconditioner is not None and problem.compliance is None:
            problem.condense(self.preconditioner.compliances)
        law = problem.law
        law.regularisation = final = law.laws.regularisation
        zero = np.zeros((len(problem.nodes), law.components))
        levels = [final * k for k in LEVELS] if law.components == 3 else []
        x, relative = self._x, np.inf
        undeformed = np.zeros(x.local_size)
        attempts = [] if start is None else [(*self._predicted_start(problem, start, earlier), [final])]
        if self.options.jacobian == "exact":
            attempts.append((undeformed, zero, [final]))
        attempts.append((undeformed, zero, [*levels, final]))
        for number, (displacement, self._predicted, regularisations) in enumerate(attempts, start=1):
            x.array[:] = displacement
            self._halvings = self.options.armijo if number == len(attempts) else 0
            relative = self._continuation(x, regularisations, final)
            if relative <= self.options.tolerance:
                break
        status = "converged"
        if not relative <= self.options.tolerance:
            status = f"relative residual {relative:.1e} after {self.count.newton} Newton steps"
            if self.count.failed_linear:
                status += f", {self.count.failed_linear} linear solves without convergence"
        self.count.residual = relative
        return x.array_r.copy(), status, self.count

    def _predicted_start(
        self, problem: DiscreteProblem, start: Array, earlier: tuple[Array, Array] | None
    ) -> tuple[Array, Array]:
        """Displacements m of this rank and nodal forces (n, c) N, parameters as for `run`."""
        if earlier is None:
            return start, np.zeros((len(problem.nodes), problem.law.components))
        if self.preconditioner is None:
            return start, earlier[1]
        forces = problem.predicted(*earlier)
        return self.preconditioner.inverse(problem.forces @ forces.T.ravel()), forces

    def _continuation(self, x: Any, levels: list[float], final: float) -> float:
        """Newton's method at each regularisation in turn, from and into x; returns the last relative residual."""
        assert self.problem is not None
        relative = np.inf
        for level in levels:
            self.problem.law.regularisation = level
            self._sought = self.options.tolerance if level == final else ROUGH
            relative, converged = self._relative(x), True
            if self._contact == 0:  # separated, as without the multipliers of exact laws: nothing to start from
                return np.inf
            if relative > self._sought:
                check_interrupt()
                converged = self.solve(x)[1]
                relative = self._relative(x)
            if not converged:
                break
        return relative

    def _relative(self, x: Any) -> float:
        """Residual over the contact force."""
        return float(self.ranks.norm(self._evaluate(x)) / max(self._contact, 1e-300))

    def _evaluate(self, x: Any) -> Array:
        """F(U) = K U - B^T T."""
        assert self.problem is not None
        self.stiffness.mult(x, self._work)
        force = self.problem.contact_forces(x.array_r)
        self._contact = self.ranks.norm(force)
        return np.asarray(self._work.array_r - force)

    def _residual(self, x: Any, b: Any) -> None:
        b.array[:] = self._evaluate(x)
        self.atol = 0.5 * self._sought * self._contact  # of these contact forces: those of a start may be none

    def _linearise(self, x: Any, _: Any) -> None:
        assert self.problem is not None
        u = x.array_r.copy()
        contact = self.problem.linearised(u, self._predicted)
        self._linearisation = contact, u
        self._product.at(self.problem, u, contact.tangent if self.options.jacobian == "exact" else None)
        if self.preconditioner is not None:
            self.preconditioner.correct(self.problem, contact, self._b.array_r.copy())

    def _update(self, step: Any, x: Any) -> None:
        check_interrupt()  # dolfinx passes the exception on
        self.count.newton += 1
        self.count.linear += self.krylov_solver.getIterationNumber()
        # dolfinx continues after a failed linear solve: it is counted, and the Armijo rule limits the step
        self.count.failed_linear += self.krylov_solver.getConvergedReason() < 0
        start, residual = x.array_r.copy(), self.ranks.norm(self._b.array_r)
        if (now := monotonic()) - self._told >= PERIOD:
            self._told, relative = now, residual / max(self._contact, 1e-300)
            text = "full model: %d Newton steps, relative residual %.0e before the last, %.0e sought"
            log.info(text, self.count.newton, relative, self._sought)
        damping = 1.0
        x.array[:] = start - step.array_r
        for _ in range(self._halvings):
            if self.ranks.norm(self._evaluate(x)) <= (1 - 1e-4 * damping) * residual:
                break
            damping /= 2
            self.count.backtracks += 1
            x.array[:] = start - damping * step.array_r
        assert self._linearisation is not None
        assert self.problem is not None
        contact, u = self._linearisation
        self._predicted = contact.forces + self.problem.change(contact.tangent, x.array_r - u)
