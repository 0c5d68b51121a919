"""SNES behind the interface of dolfinx's NewtonSolver, as it is used where dolfinx has none."""

from __future__ import annotations

import gc
import importlib.util
import sys
import weakref
from types import ModuleType
from typing import Any

import dolfinx
import numpy as np
import pytest
from petsc4py import PETSc
from small_pairs import CREEP, TETRAHEDRA, full

from wheelrail.contact.laws.parameters import ContactLaws
from wheelrail.contact.loading.hertz import hertz_pose
from wheelrail.contact.models.full import newton
from wheelrail.contact.models.full.model import FullStart
from wheelrail.contact.models.full.newton import FullOptions
from wheelrail.contact.models.full.two_body_stiffness import two_body_stiffness
from wheelrail.forms import compat
from wheelrail.forms.snes_newton import SnesNewton

SIZE, RADIUS = 1e-3, 0.3
POSE = hertz_pose((3.2 * SIZE) ** 2 / (2 * RADIUS))
ROLLING = ContactLaws(1e15, friction=0.3, regularisation=1e-5)


@pytest.fixture
def by_snes(monkeypatch: pytest.MonkeyPatch) -> ModuleType:
    """The module of Newton's method, imported again where dolfinx has no NewtonSolver."""
    monkeypatch.delattr(dolfinx.cpp.nls.petsc, "NewtonSolver")
    spec = importlib.util.spec_from_file_location("newton_by_snes", str(newton.__file__))
    assert spec is not None
    assert spec.loader is not None
    module = importlib.util.module_from_spec(spec)
    monkeypatch.setitem(sys.modules, "newton_by_snes", module)  # where dataclasses look their annotations up
    spec.loader.exec_module(module)
    assert issubclass(module.Newton, SnesNewton)
    return module


def test_dolfinx_is_preferred() -> None:
    assert compat.newton_base() is dolfinx.cpp.nls.petsc.NewtonSolver


@pytest.mark.parametrize(
    ("jacobian", "preconditioner"), [("exact", "corrected"), ("exact", "icc"), ("difference", "corrected")]
)
def test_both_solvers_take_the_same_steps(by_snes: ModuleType, preconditioner: Any, jacobian: Any) -> None:
    options = FullOptions(preconditioner=preconditioner, jacobian=jacobian)
    model = full(TETRAHEDRA, (RADIUS, RADIUS), size=SIZE, laws=ROLLING, options=options)
    usual = model(POSE, CREEP)
    other = full(TETRAHEDRA, (RADIUS, RADIUS), size=SIZE, laws=ROLLING, options=options)
    bodies = other.wheel, other.rail
    other.__dict__["solver"] = by_snes.Newton(two_body_stiffness(*bodies), options, bodies)
    result = other(POSE, CREEP)
    assert usual.status == result.status == "converged"
    assert result.statistics.newton == usual.statistics.newton
    assert result.statistics.linear == usual.statistics.linear
    assert result.statistics.newton >= 4
    np.testing.assert_allclose(result.force, usual.force, rtol=1e-9)
    assert isinstance(usual.warm_start, FullStart)
    assert isinstance(result.warm_start, FullStart)
    expected = usual.warm_start.displacement
    np.testing.assert_allclose(result.warm_start.displacement, expected, rtol=0, atol=1e-8 * np.abs(expected).max())


class SquareRoots(SnesNewton):
    """x^2 = (4, 9), element by element; counts the Jacobians."""

    def __init__(self, **attributes: Any) -> None:
        super().__init__(PETSc.COMM_SELF)
        self.jacobians = 0
        self.residual, self.matrix = PETSc.Vec().createSeq(2), PETSc.Mat().createAIJ([2, 2], nnz=1)
        solver = weakref.proxy(self)

        def jacobian(x: Any, matrix: Any) -> None:
            solver.jacobians += 1
            for i, value in enumerate(x.array_r):
                matrix[i, i] = 2 * value
            matrix.assemble()

        def residual(x: Any, b: Any) -> None:
            b.array[:] = x.array_r**2 - [4.0, 9.0]

        self.setF(residual, self.residual)
        self.setJ(jacobian, self.matrix)
        self.krylov_solver.setType("preonly")
        self.krylov_solver.getPC().setType("lu")
        for name, value in attributes.items():
            setattr(self, name, value)


def start(value: float) -> Any:
    x = PETSc.Vec().createSeq(2)
    x.set(value)
    return x


def test_tolerances_updates_and_failures() -> None:
    x, solver = start(1.0), SquareRoots(atol=1e-12, rtol=0.0)
    steps, converged = solver.solve(x)
    assert converged
    assert steps == solver.jacobians > 4
    np.testing.assert_allclose(x.array, [2.0, 3.0], rtol=1e-13)
    assert SquareRoots(atol=1e-12, rtol=0.0).solve(x) == (0, True)

    damped, halves = start(1.0), SquareRoots(atol=1e-9, rtol=0.0, max_it=100)
    halves.set_update(lambda _, step, x: x.axpy(-0.5, step))
    steps_damped, converged = halves.solve(damped)
    assert converged
    assert steps_damped > 2 * steps
    np.testing.assert_allclose(damped.array, [2.0, 3.0], rtol=1e-9)

    lazy = SquareRoots(max_it=1, error_on_nonconvergence=False)
    assert lazy.solve(start(1.0)) == (1, False)
    lazy.error_on_nonconvergence = True
    with pytest.raises(RuntimeError, match="no convergence"):
        lazy.solve(start(1.0))
    lazy.convergence_criterion = "incremental"
    with pytest.raises(ValueError, match="'incremental': must be \"residual\""):
        lazy.solve(start(1.0))


def test_an_error_of_a_callback_is_raised() -> None:
    solver = SquareRoots()

    def update(*_: Any) -> None:
        raise KeyboardInterrupt

    solver.set_update(update)
    with pytest.raises(KeyboardInterrupt):
        solver.solve(start(1.0))


def test_a_solver_is_freed() -> None:
    solver = SquareRoots()
    solver.solve(start(1.0))
    held, gone = solver.snes, weakref.ref(solver)
    assert held
    del solver
    gc.collect()
    assert gone() is None
    assert not held
