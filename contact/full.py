"""All displacements of both bodies in one sparse problem, eq. (12): dolfinx's NewtonSolver with PETSc's BiCGStab.

Unknown U = (U_w, U_r); z = z0 + G U collects overlap and slip at the contact points, T(z) the nodal contact forces of
the law in UFL. Residual F = K U - B^T T(z0 + G U), Jacobian K - B^T D G with D = dT/dz. B carries forces to both
bodies, so action equals reaction to round-off.
"""

from __future__ import annotations

from dataclasses import dataclass, field
from functools import cached_property
from time import perf_counter

import numpy as np
import scipy.sparse as sp
from petsc4py import PETSc

from contact.body import ElasticBody
from contact.full_problem import Problem
from contact.kinematics import NotRolling, creepage
from contact.laws import Laws
from contact.newton import FullOptions, Newton
from contact.patches import outcome
from contact.points import Geometry, OutsideGrid
from contact.pose import Motion, Pose
from contact.result import ContactResult, Statistics
from contact.surface_law import SurfaceLaw


@dataclass
class Full:
    """Contact model on the complete 3D meshes: pose and velocities in, `ContactResult` out."""

    geometry: Geometry
    wheel: ElasticBody
    rail: ElasticBody
    laws: Laws
    order: int = 2
    options: FullOptions = field(default_factory=FullOptions)

    def __post_init__(self) -> None:
        """Raises ValueError for the exact laws: displacements alone cannot carry them."""
        if self.laws.normal_compliance == 0 or (self.laws.friction > 0 and self.laws.regularisation == 0):
            raise ValueError(f"the full model needs a finite penalty and a regularised friction, got {self.laws}")

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
            return ContactResult.failed(str(error))
        if points is None:
            return ContactResult.separated(approach)
        try:
            rigid = creepage(points, motion)[1] if order else None
        except NotRolling as error:
            return ContactResult.failed(str(error), approach)
        problem = Problem.of(points, self, rigid)
        solver = self.solver
        ready = perf_counter()
        u, status, relative, count = solver.run(problem, warm=guess is not None and guess.ok)
        solved = perf_counter()
        if status != "converged":
            return ContactResult.failed(status, approach)
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
