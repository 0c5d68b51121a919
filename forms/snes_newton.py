"""Newton's method of PETSc's SNES with the interface of dolfinx's NewtonSolver, removed after dolfinx 0.11."""

from __future__ import annotations

import weakref
from collections.abc import Callable
from typing import Any

from petsc4py import PETSc

PREFIX = "wheelrail_newton_"
# steps of full length, as changed by the update; divergence is bounded by the number of steps
OPTIONS = {"snes_type": "newtonls", "snes_linesearch_type": "basic", "snes_divergence_tolerance": 1e300}


class SnesNewton:
    """F(x) = 0 from callbacks on PETSc's vectors and matrices; the attributes are those of dolfinx's NewtonSolver.

    Parameters:
        comm: communicator of mpi4py.

    Only the criterion "residual" is provided: converged with a norm of F of at most atol, or rtol times the first.
    """

    def __init__(self, comm: Any) -> None:
        self.snes = PETSc.SNES().create(comm)
        self.snes.setOptionsPrefix(PREFIX)
        options = PETSc.Options(PREFIX)
        for name, value in OPTIONS.items():
            options[name] = value
        self.snes.setFromOptions()
        if self.snes.comm.size == 1:  # objects of several processes are left to PETSc's collective clean-up
            weakref.finalize(self, self.snes.destroy)
        solver = weakref.proxy(self)
        self.snes.setLineSearchPreCheck(lambda x, step: solver.__updated(x, step))
        self.atol, self.rtol, self.max_it = 1e-10, 1e-9, 50
        self.convergence_criterion, self.error_on_nonconvergence, self.report = "residual", True, False
        # mangled, as subclasses have names of their own
        self.__form: Callable[[Any], None] = lambda x: None
        self.__jacobian: tuple[Callable[[Any, Any], None], Any] | None = None
        self.__update: Callable[[Any, Any, Any], None] | None = None

    @property
    def krylov_solver(self) -> Any:
        """Solver of the linear systems, PETSc's KSP."""
        return self.snes.getKSP()

    def setF(self, F: Callable[[Any, Any], None], b: Any) -> None:
        """Set the function that computes F at x into b, and the vector b."""
        solver = weakref.proxy(self)

        def function(_: Any, x: Any, residual: Any) -> None:
            solver.__form(x)
            F(x, residual)
            solver.snes.setTolerances(atol=solver.atol)  # which F may change, as with dolfinx's NewtonSolver

        self.snes.setFunction(function, b)

    def setJ(self, J: Callable[[Any, Any], None], matrix: Any) -> None:
        """Set the function that computes the Jacobian at x into a matrix, and the matrix."""
        self.__jacobian = J, matrix
        self.setP(lambda x, P: None, matrix)

    def setP(self, P: Callable[[Any, Any], None], matrix: Any) -> None:
        """Set the function that computes the matrix of the preconditioner at x, and the matrix; after setJ."""
        assert self.__jacobian is not None
        J, jacobian = self.__jacobian

        def compute(_: Any, x: Any, A: Any, B: Any) -> None:
            J(x, A)
            P(x, B)

        self.snes.setJacobian(compute, jacobian, matrix)

    def set_form(self, form: Callable[[Any], None]) -> None:
        """Set a function called with x before F."""
        self.__form = form

    def set_update(self, update: Callable[[Any, Any, Any], None]) -> None:
        """Set the function of solver, step and x that replaces x by x - step."""
        self.__update = update

    def solve(self, x: Any) -> tuple[int, bool]:
        """Number of steps, and whether x, the start and the solution, has converged.

        Raises ValueError for another criterion than the residual, RuntimeError without convergence unless
        error_on_nonconvergence is False.
        """
        if self.convergence_criterion != "residual":
            raise ValueError(f'convergence_criterion = {self.convergence_criterion!r}: must be "residual"')
        self.snes.setTolerances(rtol=self.rtol, atol=self.atol, stol=0.0, max_it=self.max_it)
        try:
            self.snes.solve(None, x)
        except PETSc.Error as error:
            raise error.__cause__ or error from None  # of a callback, for which newer petsc4py has its own error
        converged = self.snes.getConvergedReason() > 0
        if self.error_on_nonconvergence and not converged:
            raise RuntimeError(f"Newton's method: no convergence, reason {self.snes.getConvergedReason()} of SNES")
        return int(self.snes.getIterationNumber()), converged

    def __updated(self, x: Any, step: Any) -> bool:
        """Replace a step by that of the update; returns whether it is changed."""
        if self.__update is None:
            return False
        updated = x.copy()
        self.__update(self, step, updated)
        updated.aypx(-1.0, x)  # x - updated
        updated.copy(step)
        updated.destroy()
        return True
