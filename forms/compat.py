"""Compatibility with dolfinx 0.5 and from 0.9 on."""

from __future__ import annotations

import logging
import weakref
from collections.abc import Iterator
from contextlib import contextmanager
from typing import Any

import dolfinx
import dolfinx.fem.petsc
import dolfinx.log
import numpy as np
import ufl
from dolfinx import fem
from mpi4py import MPI
from numpy.typing import NDArray
from petsc4py import PETSc

from wheelrail.forms.compilation import compiling
from wheelrail.forms.snes_newton import SnesNewton

OLD = not hasattr(fem, "functionspace")  # 0.5 and 0.6
RECENT = tuple(int(part) for part in dolfinx.__version__.split(".")[:2]) >= (0, 10)

# Results have a status; warnings of dolfinx on standard error, as on a step that its solvers repeat, add nothing to it.
dolfinx.log.set_log_level(dolfinx.log.LogLevel.ERROR)
# Forms are compiled through distutils, which reports every command of the C compiler to the root logger.
logging.getLogger().addFilter(lambda record: record.levelno >= logging.WARNING or "distutils" not in record.pathname)


def mesh_from_arrays(comm: MPI.Comm, cell: str, cells: NDArray[Any], points: NDArray[Any]) -> Any:
    """Mesh of straight cells from connectivity (m, k) and points (n, 2) or (n, 3) m."""
    dim = points.shape[1]
    if OLD:
        domain = ufl.Mesh(ufl.VectorElement("Lagrange", ufl.Cell(cell, geometric_dimension=dim), 1))
    else:
        import basix.ufl

        domain = ufl.Mesh(basix.ufl.element("Lagrange", cell, 1, shape=(dim,)))
    cells = np.ascontiguousarray(cells, dtype=np.int64)
    points = np.ascontiguousarray(points, dtype=np.float64)
    with compiling():
        if RECENT:
            return dolfinx.mesh.create_mesh(comm, cells, domain, points)
        return dolfinx.mesh.create_mesh(comm, cells, points, domain)


def space(mesh: Any, degree: int, dim: int = 3) -> Any:
    """Continuous Lagrange space with values of length dim (1: scalars)."""
    with compiling():
        if OLD:
            if dim == 1:
                return fem.FunctionSpace(mesh, ("Lagrange", degree))
            return fem.VectorFunctionSpace(mesh, ("Lagrange", degree), dim=dim)
        return fem.functionspace(mesh, ("Lagrange", degree) if dim == 1 else ("Lagrange", degree, (dim,)))


def nodal_space(mesh: Any, shape: tuple[int, ...]) -> Any:
    """Linear Lagrange space with values of a shape: () scalars, (3,) vectors, (3, 3) tensors."""
    with compiling():
        if OLD:
            if not shape:
                return fem.FunctionSpace(mesh, ("Lagrange", 1))
            kind = fem.VectorFunctionSpace if len(shape) == 1 else fem.TensorFunctionSpace
            return kind(mesh, ("Lagrange", 1))
        return fem.functionspace(mesh, ("Lagrange", 1, shape) if shape else ("Lagrange", 1))


def assemble_matrix(form: Any, bc: Any, diagonal: float) -> Any:
    """Assembled matrix; rows and columns of constrained unknowns are zero except for a diagonal value."""
    matrix = fem.petsc.assemble_matrix(form, bcs=[bc], **{"diag" if RECENT else "diagonal": diagonal})
    matrix.assemble()
    return matrix


def freed_with(owner: object, *objects: Any) -> None:
    """Free objects of PETSc together with their owner.

    Before 3.20 PETSc defers the destruction of unreferenced objects to a collective clean-up. Objects of several
    processes are left to it, as their finalisation is not simultaneous.
    """
    for item in objects:
        if item.comm.size == 1:
            weakref.finalize(owner, item.destroy)


def set_cholesky(pc: PETSc.PC) -> None:
    """Complete Cholesky factorisation: by CHOLMOD, on several ranks by MUMPS.

    MUMPS estimates its workspace for a static distribution of work over the ranks and ends with its error -9 where
    the dynamic one needs more (ICNTL(14), 20 % by default: 2 of 80 factors of 10 000 unknowns on two ranks). Pages
    that remain unused cost nothing.
    """
    several = pc.comm.size > 1
    pc.setType("cholesky")
    pc.setFactorSolverType("mumps" if several else "cholmod")
    if several:
        PETSc.Options()["mat_mumps_icntl_14"] = 200


def create_vector(form: Any) -> Any:
    """Vector into which a linear form is assembled."""
    return fem.petsc.create_vector(form.function_spaces[0] if RECENT else form)


@contextmanager
def quiet() -> Iterator[None]:
    """Suppress UFL's warnings about quadrature rules given by their points, which are intended."""
    logger = logging.getLogger("UFL")
    level = logger.level
    logger.setLevel(logging.ERROR)
    try:
        yield
    finally:
        logger.setLevel(level)


def newton_base() -> Any:
    """C++ NewtonSolver with callbacks on PETSc objects (0.5 to 0.11), or, if missing, an equivalent with SNES."""
    solver = getattr(getattr(getattr(dolfinx.cpp, "nls", None), "petsc", None), "NewtonSolver", None)
    return SnesNewton if solver is None else solver


def assemble_csr(form: Any) -> tuple[NDArray[np.int32], NDArray[np.int32], NDArray[np.float64]]:
    """Row pointers, columns and values of an assembled square matrix without boundary conditions."""
    matrix = fem.petsc.assemble_matrix(form)
    matrix.assemble()
    pointer, columns, values = matrix.getValuesCSR()
    matrix.destroy()
    return pointer, columns, values
