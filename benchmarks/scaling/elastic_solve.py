"""The elastic solve behind `full`, K u = f, on one and two ranks: one block under Hertz's pressure."""

from __future__ import annotations

from collections.abc import Iterator
from time import perf_counter
from typing import Any

import numpy as np
import ufl
from dolfinx import fem
from dolfinx import mesh as dmesh
from dolfinx.fem.petsc import assemble_vector
from mpi4py import MPI
from petsc4py import PETSc

from benchmarks.common.hertz_cases import block_correction
from benchmarks.common.hertz_pairs import STEEL
from benchmarks.common.measurement import Row, peak
from benchmarks.scaling.refined_body import PAIR, body, depth
from wheelrail.contact.models.full.two_body_stiffness import with_rigid_motions
from wheelrail.forms import compat
from wheelrail.forms.elasticity import lame, stiffness

RTOL = 1e-8
METHODS: dict[str, tuple[str, str, str]] = {  # Krylov method, preconditioner, package of factors
    "CG + GAMG": ("cg", "gamg", ""),
    "MUMPS": ("preonly", "cholesky", "mumps"),
    "CHOLMOD": ("preonly", "cholesky", "cholmod"),
    "BiCGStab + ICC": ("bcgs", "icc", ""),
}


def elastic(*, method: str, across: int) -> Iterator[Row]:
    """One solve: seconds of assembly, set-up and solution, iterations, MB of all ranks, relative residual, and error of
    the work relative to a half-space in %.
    """
    world = MPI.COMM_WORLD
    domain = _spread(across)
    space = compat.space(domain, 1)
    start = perf_counter()
    matrix, right = _assembled(domain, space)
    assembled = perf_counter()
    matrix.setOption(PETSc.Mat.Option.SPD, True)
    owned = space.dofmap.index_map.size_local
    with_rigid_motions(matrix, space.tabulate_dof_coordinates()[:owned])
    solver = _solver(method, matrix)
    ready = perf_counter()
    x = right.duplicate()
    solver.solve(right, x)
    solved = perf_counter()
    if solver.getConvergedReason() < 0:
        raise RuntimeError(f"Error: not converged, reason {solver.getConvergedReason()}")
    work, residual = float(right.dot(x)), matrix * x - right
    a, p0, load = PAIR.exact.semi_axes[0], PAIR.exact.peak, PAIR.load
    exact_work = 0.4 * np.pi * p0 * (1 - STEEL.nu**2) * a / STEEL.E * load  # of p by u under it, closed form
    exact_work -= block_correction(STEEL.nu)[0] * load**2 / (STEEL.E * depth())
    row: Row = {
        "unknowns": matrix.getSize()[0],
        "assembly": assembled - start,
        "set-up": ready - assembled,
        "solve": solved - ready,
        "iterations": solver.getIterationNumber(),
        "memory": world.allreduce(peak()),
        "residual": residual.norm() / right.norm(),
        "work error": 100 * (work / exact_work - 1),
    }
    if world.rank == 0:
        yield row


def _spread(across: int) -> Any:
    """The mesh distributed over all ranks, read on the first."""
    world, cells, points = MPI.COMM_WORLD, np.empty((0, 4), dtype=np.int64), np.empty((0, 3))
    if world.rank == 0:
        solid = body(across)
        cells, points = solid.cells, solid.points
    return compat.mesh_from_arrays(world, "tetrahedron", cells, points)


def _assembled(domain: Any, space: Any) -> tuple[Any, Any]:
    """Stiffness clamped at the bottom, and the load of Hertz's pressure."""
    u, v = ufl.TrialFunction(space), ufl.TestFunction(space)
    bottom = dmesh.locate_entities_boundary(domain, 2, lambda x: x[2] < -depth() * (1 - 1e-6))
    fixed = fem.locate_dofs_topological(space, 2, bottom)
    bc = fem.dirichletbc(np.zeros(3, dtype=PETSc.ScalarType), fixed, space)
    matrix = compat.assemble_matrix(fem.form(stiffness(u, v, *lame(STEEL.E, STEEL.nu))), bc, STEEL.E * depth() / 100)
    x = ufl.SpatialCoordinate(domain)
    inside = 1 - (x[0] ** 2 + x[1] ** 2) / PAIR.exact.semi_axes[0] ** 2
    # the load on the middle of the bottom, which is clamped, is set to zero below
    pressure = PAIR.exact.peak * ufl.conditional(ufl.gt(inside, 0), ufl.sqrt(abs(inside)), 0.0)
    right = assemble_vector(fem.form(-pressure * v[2] * ufl.ds(metadata={"quadrature_degree": 4})))
    right.ghostUpdate(addv=PETSc.InsertMode.ADD, mode=PETSc.ScatterMode.REVERSE)
    fem.petsc.set_bc(right, [bc])
    return matrix, right


def _solver(method: str, matrix: Any) -> Any:
    """Solver of PETSc, set up; incomplete factorisations are local to each rank."""
    krylov, kind, package = METHODS[method]
    solver = PETSc.KSP().create(matrix.comm)
    solver.setOperators(matrix)
    solver.setType(krylov)
    solver.setTolerances(rtol=RTOL, max_it=5000)
    pc = solver.getPC()
    if kind == "icc" and MPI.COMM_WORLD.size > 1:
        pc.setType("bjacobi")
        PETSc.Options()["sub_pc_type"] = "icc"
    else:
        pc.setType(kind)
    if package:
        pc.setFactorSolverType(package)
    solver.setFromOptions()  # sets PETSc's defaults of multigrid
    solver.setUp()
    solver.setUpOnBlocks()
    return solver
