"""All displacements of both bodies in one sparse problem, eq. (12): dolfinx's NewtonSolver with PETSc's BiCGStab.

Unknown U = (U_w, U_r); z = z0 + G U collects overlap and slip at the contact points, T(z) the nodal contact forces of
the law in UFL. Residual F = K U - B^T T(z0 + G U), Jacobian K - B^T D G with D = dT/dz. B carries forces to both
bodies, so action equals reaction to round-off.
"""

from __future__ import annotations

from dataclasses import dataclass, field, replace
from functools import cached_property
from time import perf_counter
from typing import Any, Literal

import numpy as np
import scipy.sparse as sp
from mpi4py import MPI
from petsc4py import PETSc

from contact.body import ElasticBody
from contact.kinematics import NotRolling, creepage
from contact.laws import Laws
from contact.patches import outcome
from contact.points import ContactPoints, Coupling, Geometry, OutsideGrid, couple_both
from contact.pose import Array, Motion, Nodes, Pose
from contact.result import ContactResult, Statistics
from contact.surface_law import SurfaceLaw
from forms import compat

LEVELS = (300.0, 10.0)  # multiples of the regularisation on the way to it
ROUGH = 1e-2  # relative residual that is enough on the way

Jacobian = Literal["exact", "difference"]
Preconditioner = Literal["cholesky", "icc"]


@dataclass(frozen=True)
class FullOptions:
    """tolerance: residual force over contact force; forcing: eq. (18); jacobian: exact product or finite difference
    (20); preconditioner from the elastic stiffness (19): complete or incomplete Cholesky; armijo: halvings of a step.
    """

    tolerance: float = 1e-9
    iterations: int = 50
    forcing: float = 0.01
    jacobian: Jacobian = "exact"
    preconditioner: Preconditioner = "cholesky"
    armijo: int = 12


@dataclass
class Count:
    newton: int = 0
    linear: int = 0
    failed_linear: int = 0
    backtracks: int = 0


@dataclass
class Full:
    """Contact model on the complete 3D meshes: pose and velocities in, `ContactResult` out."""

    geometry: Geometry
    wheel: ElasticBody
    rail: ElasticBody
    laws: Laws
    order: int = 2
    options: FullOptions = field(default_factory=FullOptions)

    @cached_property
    def law(self) -> SurfaceLaw:
        return SurfaceLaw(self.wheel.solid, self.wheel.grid, self.wheel.degree, self.laws)

    @cached_property
    def solver(self) -> Newton:
        """Solver with the stiffness of both bodies and its factorisation (19), made once."""
        parts = []
        for body in (self.wheel, self.rail):
            pointer, columns, data = body.stiffness.getValuesCSR()
            parts.append(sp.csr_matrix((data, columns, pointer)))
        both = sp.block_diag(parts, format="csr")
        matrix = PETSc.Mat().createAIJ(both.shape, csr=(both.indptr, both.indices, both.data), comm=PETSc.COMM_SELF)
        matrix.setOption(PETSc.Mat.Option.SPD, True)
        return Newton(matrix, self.options)

    def __call__(self, pose: Pose, motion: Motion, guess: ContactResult | None = None) -> ContactResult:
        start = perf_counter()
        order = self.order if self.laws.friction > 0 else 0
        try:
            points, approach = self.geometry.contact_points(pose, order)
        except OutsideGrid as error:
            return replace(ContactResult.separated(), status=f"failed: {error}")
        if points is None:
            return ContactResult.separated(approach)
        try:
            rigid = creepage(points, motion)[1] if order else None
        except NotRolling as error:
            return replace(ContactResult.separated(approach), status=f"failed: {error}")
        problem = Problem.of(points, self, rigid)
        solver = self.solver
        ready = perf_counter()
        u, status, relative, count = solver.run(problem, warm=guess is not None and guess.ok)
        solved = perf_counter()
        if status != "converged":
            return replace(ContactResult.separated(approach), status=f"failed: {status}")
        z, forces = problem.state(u)
        traction = forces / points.area[:, None]
        n = len(points.node)
        moved = np.zeros((n, 3))
        local = (problem.displacement @ u).reshape(-1, n).T
        moved[:, 3 - local.shape[1] :] = local
        return outcome(
            points,
            self.wheel.grid.shape,
            pressure=-traction[:, 0] + 0.0,
            traction=traction[:, 1:] if order else np.zeros((n, 2)),
            slip=z[:, 1:] if order else np.zeros((n, 2)),
            displacement=moved,
            approach=approach,
            bound=-self.laws.friction * traction[:, 0],
            statistics=Statistics(
                newton=count.newton,
                linear=count.linear,
                points=n,
                residual=relative,
                seconds={"points": ready - start, "solve": solved - ready},
            ),
        )


def spread(coupling: Coupling, body: ElasticBody) -> tuple[sp.csr_array, sp.csr_array | None]:
    """Operators of one body on all its unknowns."""
    nodes = body.nodes.ravel()[coupling.nodes]
    columns = (3 * nodes[:, None] + np.asarray(coupling.directions)).ravel()
    size = body.stiffness.getSize()[0]

    def widen(operator: sp.csr_array) -> sp.csr_array:
        return sp.csr_array(
            (operator.data, columns[operator.indices], operator.indptr), shape=(operator.shape[0], size)
        )

    return widen(coupling.displacement), None if coupling.slip is None else widen(coupling.slip)


@dataclass
class Problem:
    """Contact forces and their tangent for one pose."""

    law: SurfaceLaw
    nodes: Nodes
    displacement: sp.csr_array  # B, components (t1, t2, n) or (n)
    forces: sp.csr_array  # B^T, components (n, t1, t2)
    gradient: sp.csr_array  # G, rows (d, s1, s2)
    constant: Array  # z0

    @classmethod
    def of(cls, points: ContactPoints, model: Full, rigid: Array | None) -> Problem:
        wheel, rail = couple_both(points, model.order if rigid is not None else 0)
        (bw, sw), (br, sr) = spread(wheel, model.wheel), spread(rail, model.rail)
        displacement = sp.csr_array(sp.hstack([bw, -br], format="csr"))
        n = len(points.node)
        normal = displacement[-n:]
        if rigid is None or sw is None or sr is None:
            return cls(model.law, points.node, displacement, normal.T.tocsr(), normal, points.overlap)
        gradient = sp.csr_array(sp.vstack([normal, sp.hstack([sw, -sr])], format="csr"))
        ordered = sp.csr_array(sp.vstack([normal, displacement[: 2 * n]], format="csr"))
        return cls(
            model.law, points.node, displacement, ordered.T.tocsr(), gradient, np.concatenate([points.overlap, rigid])
        )

    def state(self, u: Array) -> tuple[Array, Array]:
        """z (n, c) and nodal forces T (n, c) at displacements u."""
        z = (self.constant + self.gradient @ u).reshape(self.law.components, -1).T
        return z, self.law.force(self.nodes, z)

    def contact_forces(self, u: Array) -> Array:
        """B^T T, forces of the contact on all unknowns [N]."""
        return np.asarray(self.forces @ self.state(u)[1].T.ravel())

    def tangent(self, u: Array) -> sp.csr_array:
        """D G: change of the nodal contact forces with the displacements."""
        z = (self.constant + self.gradient @ u).reshape(self.law.components, -1).T
        blocks = self.law.tangent(self.nodes, z)
        c = self.law.components
        rows = [sp.hstack([sp.diags(blocks[:, i, j]) for j in range(c)]) for i in range(c)]
        return sp.csr_array(sp.vstack(rows, format="csr") @ self.gradient)


class Newton(compat.newton_base()):  # type: ignore[misc]
    """dolfinx's NewtonSolver for a changing `Problem`, with Armijo backtracking and a check of every linear solve."""

    def __init__(self, stiffness: Any, options: FullOptions) -> None:
        super().__init__(MPI.COMM_SELF)
        self.options, self.stiffness = options, stiffness
        self.problem: Problem | None = None
        self.count = Count()
        size = stiffness.getSize()[0]
        self._b, self._work = PETSc.Vec().createSeq(size), PETSc.Vec().createSeq(size)
        self._last: Array | None = None
        self._contact = 0.0  # norm of the contact forces: what a residual is measured by
        self._product = Product(stiffness)
        jacobian = PETSc.Mat().createPython([size, size], self._product, comm=PETSc.COMM_SELF)
        jacobian.setUp()
        self.setF(self._residual, self._b)
        self.setJ(self._linearise, jacobian)
        self.setP(lambda x, P: None, stiffness)
        self.set_form(lambda x: None)
        self.set_update(self._update)
        krylov = self.krylov_solver
        krylov.setOperators(jacobian, stiffness)
        krylov.setType("bcgs")
        krylov.setTolerances(rtol=options.forcing, atol=1e-300, max_it=500)
        pc = krylov.getPC()
        pc.setType("cholesky" if options.preconditioner == "cholesky" else "icc")
        if options.preconditioner == "cholesky":
            pc.setFactorSolverType("cholmod")
        pc.setReusePreconditioner(True)
        self.convergence_criterion = "residual"
        self.rtol = 0.0
        self.max_it = options.iterations
        self.error_on_nonconvergence = False
        self.report = False

    def run(self, problem: Problem, *, warm: bool = False) -> tuple[Array, str, float, Count]:
        """Displacements, status, relative residual and cost; warm starts from the displacements of the last solve.

        From afar, friction is sharpened in steps to its own regularisation: Newton on the nearly discontinuous law
        wanders, from the blunter law's answer it does not.
        """
        self.problem, self.count = problem, Count()
        law = problem.law
        sharp = law.laws.regularisation
        blunt = [sharp * k for k in LEVELS] if law.components == 3 else []
        x = PETSc.Vec().createSeq(self.stiffness.getSize()[0])
        relative = np.inf
        if warm and self._last is not None:
            x.array[:] = self._last
            relative = self._sharpen(x, [sharp], sharp)
        if not relative <= self.options.tolerance:
            x.set(0.0)
            relative = self._sharpen(x, [*blunt, sharp], sharp)
        status = "converged"
        if not relative <= self.options.tolerance:
            status = f"relative residual {relative:.1e} after {self.count.newton} Newton steps"
            if self.count.failed_linear:
                status += f", {self.count.failed_linear} linear solves without convergence"
        else:
            self._last = x.array_r.copy()
        return x.array_r.copy(), status, relative, self.count

    def _sharpen(self, x: Any, levels: list[float], sharp: float) -> float:
        """Newton at each regularisation in turn, from and into x; the last relative residual."""
        assert self.problem is not None
        relative = np.inf
        for level in levels:
            self.problem.law.regularisation = level
            tolerance = self.options.tolerance if level == sharp else ROUGH
            for _ in range(4):  # the norm of the contact forces, unknown at first, sets the absolute tolerance
                relative = float(np.linalg.norm(self._evaluate(x))) / max(self._contact, 1e-300)
                if relative <= tolerance:
                    break
                self.atol = 0.5 * tolerance * self._contact
                self.solve(x)
        return relative

    def _evaluate(self, x: Any) -> Array:
        """F(U) = K U - B^T T."""
        assert self.problem is not None
        self.stiffness.mult(x, self._work)
        force = self.problem.contact_forces(x.array_r)
        self._contact = float(np.linalg.norm(force))
        return np.asarray(self._work.array_r - force)

    def _residual(self, x: Any, b: Any) -> None:
        b.array[:] = self._evaluate(x)

    def _linearise(self, x: Any, _: Any) -> None:
        assert self.problem is not None
        self._product.at(self.problem, x.array_r.copy(), self.options.jacobian)

    def _update(self, _: Any, step: Any, x: Any) -> None:
        self.count.newton += 1
        self.count.linear += self.krylov_solver.getIterationNumber()
        # dolfinx goes on after a failed linear solve: count it, let Armijo judge the step
        self.count.failed_linear += self.krylov_solver.getConvergedReason() < 0
        old, before = x.array_r.copy(), float(np.linalg.norm(self._b.array_r))
        damping = 1.0
        for _ in range(self.options.armijo):
            x.array[:] = old - damping * step.array_r
            if np.linalg.norm(self._evaluate(x)) <= (1 - 1e-4 * damping) * before:
                break
            damping /= 2
            self.count.backtracks += 1


class Product:
    """Product of the Jacobian with a vector: exact, K v - B^T D G v, or by a finite difference of F, eq. (20)."""

    def __init__(self, stiffness: Any) -> None:
        self._stiffness = stiffness
        self._problem: Problem | None = None
        self._tangent: sp.csr_array | None = None
        self._u = self._base = np.empty(0)

    def at(self, problem: Problem, u: Array, kind: Jacobian) -> None:
        """Linearise about the displacements u."""
        self._problem, self._u = problem, u
        self._tangent = problem.tangent(u) if kind == "exact" else None
        if kind == "difference":
            self._base = problem.contact_forces(u)

    def mult(self, _: Any, v: Any, y: Any) -> None:
        """y = J v, called by PETSc."""
        assert self._problem is not None
        self._stiffness.mult(v, y)
        direction = v.array_r
        if self._tangent is not None:
            y.array[:] -= self._problem.forces @ (self._tangent @ direction)
            return
        length = float(np.linalg.norm(direction))
        if length > 0:
            # the elastic part is linear: only the contact forces need the difference
            eps = 1e-7 * max(float(np.linalg.norm(self._u)), 1e-9) / length
            y.array[:] -= (self._problem.contact_forces(self._u + eps * direction) - self._base) / eps
