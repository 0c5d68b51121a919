"""The full two-body problem (12) against the condensed one (15): other unknowns and solver, same solution."""

from __future__ import annotations

import logging
import os
import re
import signal
from typing import Any

import numpy as np
import pytest
from small_pairs import AT_REST, BRICKS, CREEP, QUADRATIC, STEEL, TETRAHEDRA, compliance, condensed, full, rolling

from wheelrail.contact.elasticity.solid_compliance import TILE
from wheelrail.contact.kinematics.creepage import creepage
from wheelrail.contact.kinematics.frames import Pose, RigidMotion
from wheelrail.contact.laws.friction import FallingFriction
from wheelrail.contact.laws.material import Material
from wheelrail.contact.laws.parameters import ContactLaws
from wheelrail.contact.loading.hertz import hertz_pose
from wheelrail.contact.models.full import model as full_model
from wheelrail.contact.models.full import newton
from wheelrail.contact.models.full.discrete_problem import DiscreteProblem
from wheelrail.contact.models.full.model import FullContact, FullStart
from wheelrail.contact.models.full.newton import FullOptions
from wheelrail.contact.models.full.primal_dual import primal_dual_tangent
from wheelrail.contact.results.result import ContactResult
from wheelrail.support.arrays import Array
from wheelrail.support.interrupts import deferred_interrupts
from wheelrail.support.memory import TooLarge

SIZE, RADIUS = 1e-3, 0.3
FRICTIONLESS, ROLLING = ContactLaws(1e15, friction=0.0), ContactLaws(1e15, friction=0.3, regularisation=1e-5)
FALLING = ContactLaws(1e15, FallingFriction(0.3, 0.4, 10.0), 1e-5)
DISSIMILAR = (Material(210e9, 0.1), Material(180e9, 0.3))


def pose(radius: float) -> Pose:
    """Pose of a sphere that penetrates a plane within a circle of a number of cells."""
    return hertz_pose((radius * SIZE) ** 2 / (2 * RADIUS))


def difference(first: Array, second: Array) -> float:
    return float(np.abs(first - second).max() / max(np.abs(second).max(), 1e-300))


def assert_agree(first: ContactResult, second: ContactResult, tolerance: float) -> None:
    assert first.status == second.status == "converged"
    assert first.fields is not None
    assert second.fields is not None
    assert difference(first.force, second.force) < tolerance
    assert difference(first.moment, second.moment) < tolerance
    for name in ("pressure", "traction", "slip", "displacement"):
        assert difference(getattr(first.fields, name), getattr(second.fields, name)) < tolerance, name
    for mine, other in zip(first.patches, second.patches, strict=True):
        assert mine.area == other.area
        assert mine.stick_area == pytest.approx(other.stick_area)


CASES = {
    "tetrahedra, frictionless": (TETRAHEDRA, FRICTIONLESS, AT_REST, (STEEL, STEEL), 2, 3.2),
    "tetrahedra, rolling": (TETRAHEDRA, ROLLING, CREEP, (STEEL, STEEL), 2, 3.2),
    "tetrahedra, nearly all sticks": (TETRAHEDRA, ROLLING, rolling(5e-5, 0.0, 0.0), (STEEL, STEEL), 2, 3.2),
    "tetrahedra, all slides": (TETRAHEDRA, ROLLING, rolling(0.0, 0.1, 0.0), (STEEL, STEEL), 2, 3.2),
    "tetrahedra, first order slip": (TETRAHEDRA, ROLLING, CREEP, (STEEL, STEEL), 1, 3.2),
    "tetrahedra, dissimilar": (TETRAHEDRA, ROLLING, CREEP, DISSIMILAR, 2, 3.2),
    "tetrahedra, dissimilar, frictionless": (TETRAHEDRA, FRICTIONLESS, AT_REST, DISSIMILAR, 2, 3.2),
    "tetrahedra, soft law": (TETRAHEDRA, ContactLaws(1e13, 0.3, 1e-4), CREEP, (STEEL, STEEL), 2, 3.2),
    "tetrahedra, falling friction": (TETRAHEDRA, FALLING, CREEP, DISSIMILAR, 2, 3.2),
    "tetrahedra, exact, frictionless": (TETRAHEDRA, ContactLaws(friction=0.0), AT_REST, DISSIMILAR, 2, 3.2),
    "tetrahedra, exact, rolling": (TETRAHEDRA, ContactLaws(), CREEP, DISSIMILAR, 2, 3.2),
    "tetrahedra, exact, all slides": (TETRAHEDRA, ContactLaws(), rolling(0.0, 0.1, 0.0), (STEEL, STEEL), 2, 3.2),
    "tetrahedra, exact pressure alone": (TETRAHEDRA, ContactLaws(np.inf, 0.3, 1e-5), CREEP, (STEEL, STEEL), 2, 3.2),
    "tetrahedra, exact friction alone": (TETRAHEDRA, ContactLaws(1e15, 0.3, 0.0), CREEP, (STEEL, STEEL), 2, 3.2),
    "tetrahedra, exact, falling": (TETRAHEDRA, ContactLaws(friction=FALLING.friction), CREEP, DISSIMILAR, 2, 3.2),
    "hexahedra, rolling": (BRICKS, ROLLING, CREEP, (STEEL, STEEL), 2, 3.2),
    "quadratic, rolling": (QUADRATIC, ROLLING, CREEP, (STEEL, STEEL), 2, 1.4),
}


def displacement(result: ContactResult) -> Array:
    assert isinstance(result.warm_start, FullStart)
    return result.warm_start.displacement


@pytest.mark.parametrize("case", CASES)
def test_full_and_condensed_agree(case: str) -> None:
    mesh, laws, motion, steels, order, radius = CASES[case]
    sphere = (RADIUS, RADIUS)
    first = full(mesh, sphere, size=SIZE, laws=laws, steels=steels, order=order)(pose(radius), motion)
    second = condensed(mesh, sphere, size=SIZE, laws=laws, steels=steels, order=order)(pose(radius), motion)
    assert_agree(first, second, 1e-6)
    assert first.fields is not None
    assert (first.fields.pressure > 0).sum() >= 16
    if laws.frictional:
        ratio = np.hypot(first.force[0], first.force[1]) / first.force[2]
        assert (0.29 if "slides" in case else 1e-3) < ratio < 0.3001


@pytest.mark.parametrize(
    "options",
    [
        FullOptions(jacobian="difference"),
        FullOptions(preconditioner="cholesky"),
        FullOptions(preconditioner="icc"),
        FullOptions(preconditioner="cholesky", jacobian="difference", forcing=1e-3),
    ],
    ids=["difference", "cholesky", "icc", "cholesky, difference"],
)
@pytest.mark.parametrize("laws", [FRICTIONLESS, ROLLING], ids=["frictionless", "rolling"])
def test_all_solver_options_give_the_same_solution(laws: ContactLaws, options: FullOptions) -> None:
    motion = CREEP if laws.frictional else AT_REST
    sphere = (RADIUS, RADIUS)
    usual = full(TETRAHEDRA, sphere, size=SIZE, laws=laws)(pose(3.2), motion)
    other = full(TETRAHEDRA, sphere, size=SIZE, laws=laws, options=options)(pose(3.2), motion)
    assert_agree(other, usual, 1e-6)
    assert other.statistics.linear > usual.statistics.linear or options.preconditioner == "corrected"


def problem(model: FullContact, motion: RigidMotion) -> DiscreteProblem:
    points, _ = model.geometry.contact_points(pose(3.2), model.order)
    assert points is not None
    return DiscreteProblem.of(points, (model.wheel, model.rail), model.law, model.order, creepage(points, motion)[1])


def test_tangent_is_the_derivative_of_the_contact_forces() -> None:
    model = full(TETRAHEDRA, (RADIUS, RADIUS), size=SIZE, laws=ContactLaws(1e13, 0.3, 1e-4), steels=DISSIMILAR)
    equations = problem(model, CREEP)
    rng = np.random.default_rng(1)
    u, direction = (rng.normal(size=equations.displacement.shape[1]) * 1e-7 for _ in range(2))
    contact = equations.linearised(u, equations.state(u)[1])
    exact = equations.forces @ equations.change(contact.tangent, direction).T.ravel()
    errors = []
    steps = np.array([1e-1, 3e-2, 1e-2])
    for step in steps:
        moved = equations.contact_forces(u + step * direction) - equations.contact_forces(u)
        errors.append(np.linalg.norm(moved - step * exact))
    assert np.linalg.norm(exact) > 1.0
    assert np.polyfit(np.log(steps), np.log(errors), 1)[0] > 1.9  # Taylor: the remainder is of second order


def test_residual_of_the_solution_vanishes_on_both_bodies() -> None:
    model = full(TETRAHEDRA, (RADIUS, RADIUS), size=SIZE, laws=ROLLING)
    equations = problem(model, CREEP)
    u, status, count = model.solver.run(equations)
    assert status == "converged"
    assert count.newton > 0
    forces = np.split(equations.contact_forces(u), 2)
    assert np.linalg.norm(forces[0]) > 1e3
    for displacements, force in zip(np.split(u, 2), forces, strict=True):
        x, y = model.wheel.stiffness.createVecs()  # both bodies are the same mesh
        x.array[:] = displacements
        model.wheel.stiffness.mult(x, y)
        assert np.linalg.norm(y.array - force) <= 1e-8 * np.linalg.norm(force)
    assert count.residual <= 1e-9


def test_warm_start_saves_steps_without_changing_the_result() -> None:
    model = full(TETRAHEDRA, (RADIUS, RADIUS), size=SIZE, laws=ROLLING)
    cold = model(pose(3.2), CREEP)
    again = model(pose(3.2), CREEP, cold)
    assert again.statistics.newton <= 1
    assert_agree(again, cold, 1e-6)
    near = model(pose(3.3), rolling(1.1e-3, -5e-4, 0.3), again)
    assert near.statistics.newton < cold.statistics.newton
    fresh = full(TETRAHEDRA, (RADIUS, RADIUS), size=SIZE, laws=ROLLING)(pose(3.3), rolling(1.1e-3, -5e-4, 0.3))
    assert_agree(near, fresh, 1e-6)


def test_failed_solve_has_status_and_no_force() -> None:
    sphere = (RADIUS, RADIUS)
    lazy = FullOptions(iterations=1, tolerance=1e-13)
    results = {
        "relative residual": full(TETRAHEDRA, sphere, size=SIZE, laws=ROLLING, options=lazy)(pose(3.2), CREEP),
        "rolls forward": full(TETRAHEDRA, sphere, size=SIZE, laws=ROLLING)(pose(3.2), AT_REST),
        "exceeds the meshed strip": full(TETRAHEDRA, sphere, size=SIZE, laws=ROLLING)(pose(4.2), CREEP),
    }
    for reason, result in results.items():
        assert result.status.startswith("failed: ")
        assert reason in result.status
        assert not result.ok
        assert not result.force.any()


def test_no_force_without_penetration() -> None:
    result = full(TETRAHEDRA, (RADIUS, RADIUS), size=SIZE, laws=ROLLING)(hertz_pose(-1e-6), CREEP)
    assert result.status == "separated"
    assert not result.force.any()
    assert result.approach == pytest.approx(-1e-6)


def test_solve_depends_on_its_guess_only() -> None:
    """Bitwise, for two wheels that use one model and for resumed runs."""
    sphere, near, other = (RADIUS, RADIUS), rolling(1.1e-3, -5e-4, 0.3), rolling(-1e-3, 2e-3, 0.0)
    model = full(TETRAHEDRA, sphere, size=SIZE, laws=ROLLING)
    start = model(pose(3.2), CREEP)
    first = model(pose(3.3), near, start)
    model(pose(2.7), other, model(pose(2.6), other))
    again = model(pose(3.3), near, start)
    elsewhere = full(TETRAHEDRA, sphere, size=SIZE, laws=ROLLING)(pose(3.3), near, start)
    for result in (again, elsewhere):
        np.testing.assert_array_equal(result.force, first.force)
        np.testing.assert_array_equal(displacement(result), displacement(first))


@pytest.mark.parametrize("laws", [FRICTIONLESS, ROLLING, FALLING, ContactLaws()], ids=["frictionless", *"pfe"])
def test_tangent_of_the_forces_is_that_of_condensed(laws: ContactLaws) -> None:
    motion = CREEP if laws.frictional else AT_REST
    first, second = (
        build(TETRAHEDRA, (RADIUS, RADIUS), size=SIZE, laws=laws, steels=DISSIMILAR)(pose(3.2), motion).tangent()
        for build in (full, condensed)
    )
    scale = np.abs(second).max(axis=0)
    assert (scale > 0).sum() >= (6 if laws.frictional else 3)
    assert (np.abs(first - second).max(axis=0) <= 1e-5 * scale).all()


def test_tangent_of_the_forces_is_their_derivative() -> None:
    model = full(TETRAHEDRA, (RADIUS, RADIUS), size=SIZE, laws=ROLLING, options=FullOptions(tolerance=1e-12))
    depth, step = (3.2 * SIZE) ** 2 / (2 * RADIUS), 1e-10
    plus, minus = (model(hertz_pose(depth + sign * step), CREEP).force for sign in (1, -1))
    tangent = model(hertz_pose(depth), CREEP).tangent()
    np.testing.assert_allclose((minus - plus) / (2 * step), tangent[:3, 2], rtol=1e-6)


def test_no_tangent_without_the_compliance_of_the_points() -> None:
    options = FullOptions(preconditioner="cholesky")
    result = full(TETRAHEDRA, (RADIUS, RADIUS), size=SIZE, laws=ROLLING, options=options)(pose(2.2), CREEP)
    assert result.ok
    with pytest.raises(ValueError, match="has no tangent"):
        result.tangent()


def test_factors_and_compliance_are_computed_once() -> None:
    model = full(TETRAHEDRA, (RADIUS, RADIUS), size=SIZE, laws=ROLLING)
    cold = model(pose(3.2), CREEP)
    preconditioner, factors = model.solver.preconditioner, (model.wheel.factor, model.rail.factor)
    assert preconditioner is not None
    columns = [body.columns_solved for body in preconditioner.compliances]
    assert min(columns) > 0
    before = preconditioner.solves
    warm = model(pose(3.19), rolling(1.01e-3, -5e-4, 0.3), cold)
    assert 1 <= warm.statistics.newton < cold.statistics.newton
    assert warm.statistics.linear == warm.statistics.newton  # the preconditioner is the inverse
    assert warm.statistics.newton <= preconditioner.solves - before <= 1.5 * warm.statistics.newton
    assert [body.columns_solved for body in preconditioner.compliances] == columns
    assert (model.wheel.factor, model.rail.factor) == factors
    assert len(factors[0].getInfo()) > 0


def test_preconditioner_is_the_inverse_of_the_jacobian() -> None:
    model = full(TETRAHEDRA, (RADIUS, RADIUS), size=SIZE, laws=ContactLaws(1e13, 0.3, 1e-4), steels=DISSIMILAR)
    equations, solver = problem(model, CREEP), model.solver
    solver.run(equations)  # about a state of contact
    preconditioner = solver.preconditioner
    assert preconditioner is not None
    u = 1.02 * solver._x.array_r
    x, y, z = (solver.stiffness.createVecRight() for _ in range(3))
    solver._predicted = equations.state(u)[1]
    x.array[:] = u
    solver._residual(x, solver._b)
    solver._linearise(x, None)
    rng = np.random.default_rng(3)
    for right in (rng.normal(size=len(u)), solver._b.array_r.copy()):
        x.array[:] = right
        preconditioner.apply(None, x, y)
        solver._product.mult(None, y, z)
        assert difference(z.array_r, right) < 1e-6
    x.array[:] = 1e-4 * solver._b.array_r  # below the tolerance of a linear solve
    solves = preconditioner.solves
    preconditioner.apply(None, x, y)
    assert preconditioner.solves == solves
    assert difference(y.array_r / np.abs(y.array_r).max(), x.array_r / np.abs(x.array_r).max()) < 1e-12


def test_a_start_without_contact_costs_no_step() -> None:
    """Displacements of exact laws penetrate only with the multipliers."""
    model = full(TETRAHEDRA, (RADIUS, RADIUS), size=SIZE, laws=ContactLaws())
    cold = model(pose(3.2), CREEP)
    warm = model(pose(3.15), rolling(1.1e-3, -5e-4, 0.3), cold)
    assert cold.status == warm.status == "converged"
    assert warm.statistics.newton <= 1.3 * cold.statistics.newton


@pytest.mark.parametrize("change", [0.0, 1e-6])
def test_a_start_with_hardly_any_contact_costs_no_step(change: float) -> None:
    """The tolerance was 1e-10 of the contact forces of the start, nearly none: 50 steps at the noise of rounding."""
    model = full(TETRAHEDRA, (RADIUS, RADIUS), size=SIZE, laws=ContactLaws())
    cold = model(pose(3.2), CREEP)
    warm = model(pose(3.2 + change), CREEP, cold)
    assert warm.statistics.newton <= 1.3 * cold.statistics.newton
    assert_agree(warm, cold, 1e-5)


def test_a_cold_start_needs_few_steps_and_no_continuation() -> None:
    for creep in ((1e-3, -5e-4, 0.3), (0.0, 0.1, 0.0), (5e-5, 0.0, 0.0), (1e-2, 1e-2, 2.0)):
        result = full(TETRAHEDRA, (RADIUS, RADIUS), size=SIZE, laws=ROLLING)(pose(3.2), rolling(*creep))
        assert result.status == "converged"
        assert result.statistics.newton <= 9, creep


def _coulomb(z: Array, stiffness: float, friction: float, eps: float) -> tuple[Array, Array]:
    """Forces (n, 3) of the penalty and of regularised friction at z (n, 3), and their derivative (n, 3, 3)."""
    d, s = z[:, 0], z[:, 1:]
    length = np.maximum(np.hypot(*s.T), eps)
    bound = friction * stiffness * d
    forces = np.column_stack([-stiffness * d, -bound[:, None] * s / length[:, None]])
    derivative = np.zeros((len(z), 3, 3))
    derivative[:, 0, 0] = -stiffness
    derivative[:, 1:, 0] = -friction * stiffness * s / length[:, None]
    unit = s / length[:, None]
    slides = (np.hypot(*s.T) > eps)[:, None, None]
    projection = np.eye(2) - np.where(slides, unit[:, :, None] * unit[:, None], 0.0)
    derivative[:, 1:, 1:] = -(bound / length)[:, None, None] * projection
    return forces, derivative


def test_primal_dual_tangent_has_the_direction_of_the_predicted_traction() -> None:
    z = np.array([[1e-6, 3e-4, -4e-4], [1e-6, 3e-6, 4e-6], [2e-6, 0.0, 0.0]])
    forces, derivative = _coulomb(z, 1e15, 0.3, 1e-5)
    np.testing.assert_allclose(primal_dual_tangent(derivative, z, forces, forces), derivative, rtol=1e-12, atol=1.0)
    tangent = primal_dual_tangent(derivative, z, forces, np.zeros((3, 3)))
    np.testing.assert_array_equal(tangent[:, 0], derivative[:, 0])
    np.testing.assert_allclose(tangent[1:, :, 1:], derivative[1:, :, 1:], rtol=1e-12, atol=1.0)  # viscous: as it is
    secant = 0.3 * 1e15 * 1e-6 / 5e-4
    np.testing.assert_allclose(tangent[0, 1:], [[0.0, -secant, 0.0], [0.0, 0.0, -secant]], rtol=1e-12)
    assert np.isfinite(tangent).all()
    normal = np.ones((3, 1, 1))
    assert primal_dual_tangent(normal, z[:, :1], forces[:, :1], forces[:, :1]) is normal


def test_ctrl_c_ends_newtons_method_at_its_next_step(monkeypatch: pytest.MonkeyPatch) -> None:
    """Through dolfinx's Newton solver; the model can be used again."""
    model, steps, linearised = (
        full(TETRAHEDRA, (RADIUS, RADIUS), size=SIZE, laws=FRICTIONLESS),
        [],
        DiscreteProblem.linearised,
    )

    def interrupted(problem: DiscreteProblem, *arguments: Any) -> Any:
        steps.append(1)
        os.kill(os.getpid(), signal.SIGINT)
        return linearised(problem, *arguments)

    monkeypatch.setattr(DiscreteProblem, "linearised", interrupted)
    with pytest.raises(KeyboardInterrupt), deferred_interrupts():
        model(pose(3.2), AT_REST)
    assert len(steps) == 1
    monkeypatch.undo()
    assert model(pose(3.2), AT_REST).status == "converged"


def test_full_models_tell_time_and_progress(caplog: pytest.LogCaptureFixture, monkeypatch: pytest.MonkeyPatch) -> None:
    """Columns of compliances that are missing are counted before they are solved: none of a second solve."""
    contact, deep = full(TETRAHEDRA, (RADIUS, RADIUS), size=SIZE, laws=ROLLING), pose(3.2)
    monkeypatch.setattr("wheelrail.support.memory.os.sysconf", lambda _: 400)
    with pytest.raises(TooLarge, match=r"^full model: \d+ contact points: about .* GB of memory or more"):
        contact(deep, CREEP)
    monkeypatch.undo()
    monkeypatch.setattr(full_model, "LONG", 0.0)
    monkeypatch.setattr(newton, "PERIOD", 0.0)
    for ends in (r"at most [0-9.e-]*[1-9][0-9.e-]* s", "at most 0 s"):
        caplog.clear()
        with caplog.at_level(logging.INFO, "wheelrail"):
            result = contact(deep, CREEP)
        told = [record.getMessage() for record in caplog.records if record.getMessage().startswith("full model")]
        points = result.statistics.points
        assert re.fullmatch(
            rf"full model: {points} contact points: about \S+ s per Newton step, {ends} for compliances before", told[0]
        )
        assert [text.split(",")[0] for text in told[1:]] == [
            f"full model: {step} Newton steps" for step in range(1, result.statistics.newton + 1)
        ]


def test_columns_of_a_compliance_are_counted_before_they_are_solved() -> None:
    body = compliance(TETRAHEDRA, STEEL, SIZE)
    nodes = np.arange(3)
    count = body.columns_missing(nodes, (2,))
    body.block(nodes, (2,))
    assert (count, body.columns_missing(nodes, (2,))) == (3 * TILE, 0)
