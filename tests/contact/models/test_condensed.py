"""The condensed model: compliance against direct solves, the laws at its points, rolling against CONTACT."""

from __future__ import annotations

from dataclasses import replace
from functools import cache
from pathlib import Path

import numpy as np
import pytest
from contact_sphere import CONTACT_SPHERE
from small_pairs import (
    AT_REST,
    BRICKS,
    CREEP,
    QUADRATIC,
    STEEL,
    TETRAHEDRA,
    Block,
    compliance,
    condensed,
    elastic,
    hertzian,
    rolling,
)

from wheelrail.contact.analytical.hertz import Hertz
from wheelrail.contact.geometry.contact_operators import pair_operators
from wheelrail.contact.geometry.grid_points import GridPoints
from wheelrail.contact.kinematics.frames import Pose
from wheelrail.contact.laws.material import Material
from wheelrail.contact.laws.parameters import ContactLaws
from wheelrail.contact.loading.hertz import hertz_pose, hertz_under_load
from wheelrail.contact.models.condensed import CondensedContact
from wheelrail.contact.results.result import ContactResult
from wheelrail.contact.results.resultants import components
from wheelrail.contact.solvers.options import NewtonOptions
from wheelrail.support.arrays import Array

SIZE, RADIUS = 1e-3, 0.3
SPHERE = (RADIUS, RADIUS)


def pose(radius: float) -> Pose:
    """Pose of a sphere that penetrates a plane within a circle of a number of cells."""
    return hertz_pose((radius * SIZE) ** 2 / (2 * RADIUS))


@pytest.mark.parametrize("mesh", [TETRAHEDRA, BRICKS, QUADRATIC], ids=["P1", "Q1", "P2"])
def test_compliance_is_the_inverse_of_the_stiffness(mesh: Block) -> None:
    """Force on one node, displacement of all: solved by conjugate gradients in real units, without any factor."""
    from petsc4py import PETSc

    steel = Material(70e9, 0.2)
    body = elastic(mesh, steel, SIZE)
    scaled = compliance(mesh, steel, SIZE)
    nodes = np.flatnonzero(body.grid.weight.ravel() > 0)[3::7]
    block = scaled.block(nodes, (0, 2))
    np.testing.assert_allclose(block, block.T, atol=1e-9 * np.abs(block).max())
    assert np.linalg.eigvalsh(0.5 * (block + block.T)).min() > 0
    solver = PETSc.KSP().create(PETSc.COMM_SELF)
    solver.setOperators(body.stiffness)
    solver.setType("cg")
    solver.getPC().setType("jacobi")
    solver.setTolerances(rtol=1e-12, max_it=5000)
    unknowns = (3 * body.nodes.ravel()[nodes][:, None] + np.array([0, 2])).ravel()
    for column in (0, 5):
        force, moved = body.stiffness.createVecs()
        force.array[unknowns[column]] = 1.0
        solver.solve(force, moved)
        assert solver.getConvergedReason() > 0
        np.testing.assert_allclose(block[:, column], moved.array[unknowns], atol=1e-8 * np.abs(block).max())


def test_compliance_is_solved_for_requested_nodes_only(monkeypatch: pytest.MonkeyPatch, tmp_path: object) -> None:
    monkeypatch.setenv("WHEELRAIL_CACHE", str(tmp_path))
    surface = compliance(TETRAHEDRA, Material(210e9, 0.21), SIZE)
    nx, ns = surface.shape
    few = np.array([nx // 2 * ns + ns // 2, nx // 2 * ns + ns // 2 + 1])
    surface.block(few, (2,))
    once = surface.columns_solved
    assert 2 <= once <= 2 * nx  # at most these two lines, in one direction
    surface.block(few)
    assert surface.columns_solved == 3 * once
    monkeypatch.setattr(
        "wheelrail.contact.elasticity.solid_compliance.load", lambda name: pytest.fail("what is known was read again")
    )
    surface.block(few)
    assert surface.columns_solved == 3 * once


def test_compliance_is_bitwise_independent_of_the_order_of_requests(
    monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    nodes, blocks = np.arange(20, 90), []
    for name, orders in (("one", [nodes]), ("other", [nodes[33:40], nodes[:5], nodes])):
        monkeypatch.setenv("WHEELRAIL_CACHE", str(tmp_path / name))
        surface = compliance(TETRAHEDRA, Material(210e9, 0.21), SIZE)
        blocks.append([surface.block(asked, (2,)) for asked in orders][-1])
    np.testing.assert_array_equal(*blocks)


def relative_compliance(points: GridPoints, model: CondensedContact, order: int) -> tuple[Array, Array]:
    """Displacements and slips at the points by forces on them, dense from end to end."""
    totals = []
    for coupling, surface in zip(pair_operators(points, order), (model.wheel, model.rail), strict=True):
        every = np.arange(surface.shape[0] * surface.shape[1])
        whole = surface.block(every)
        columns = (3 * coupling.nodes[:, None] + np.asarray(coupling.directions)).ravel()
        operator = np.zeros((coupling.displacement.shape[0], len(whole)))
        operator[:, columns] = coupling.displacement.toarray()
        assert coupling.slip is not None
        slip = np.zeros((coupling.slip.shape[0], len(whole)))
        slip[:, columns] = coupling.slip.toarray()
        totals.append((operator @ whole @ operator.T, slip @ whole @ operator.T))
    (first, one), (second, two) = totals
    return first + second, one + two


@pytest.mark.parametrize(
    "laws",
    [ContactLaws.penalty(), ContactLaws(np.inf, 0.3, 0.0), ContactLaws(1e14, 0.5, 1e-3)],
    ids=["paper", "exact", "soft"],
)
@pytest.mark.parametrize("steels", [(STEEL, STEEL), (Material(210e9, 0.1), STEEL)], ids=["equal", "dissimilar"])
def test_result_fulfils_the_equations(laws: ContactLaws, steels: tuple[Material, Material]) -> None:
    model = condensed(TETRAHEDRA, SPHERE, size=SIZE, laws=laws, steels=steels)
    result = model(pose(3.2), CREEP)
    assert result.status == "converged"
    points, approach = model.geometry.contact_points(pose(3.2), 2)
    fields = result.fields
    assert points is not None
    assert fields is not None
    displacement, slip = relative_compliance(points, model, 2)
    p, q = fields.pressure, fields.traction
    forces = (np.column_stack([q, -p]) * points.area[:, None]).T.ravel()
    n = len(p)
    np.testing.assert_allclose(fields.displacement.T.ravel(), displacement @ forces, atol=1e-9 * approach)
    # the gap: closed to p / K where it presses, open elsewhere
    gap = points.penetration + fields.displacement[:, 2] - p * laws.normal_compliance
    assert gap.max() < 1e-9 * approach
    assert np.abs(gap[p > 0]).max() < 1e-9 * approach
    assert 0 < (p > 0).sum() < n
    # the slip: rigid and elastic
    creep = np.concatenate([1e-3 - 0.3 * points.point[:, 1], -5e-4 + 0.3 * points.point[:, 0]])
    np.testing.assert_allclose(fields.slip.T.ravel(), creep + slip @ forces, atol=1e-9)
    # Coulomb
    bound, length, speed = laws.friction_bound(p, np.zeros(len(p)), 0.0), np.hypot(*q.T), np.hypot(*fields.slip.T)
    assert (length <= bound * (1 + 1e-7) + 1e-7 * bound.max()).all()
    slides = (p > 0) & (speed > laws.regularisation + 1e-7)
    assert slides.any()
    opposed = -(bound[slides] / speed[slides])[:, None] * fields.slip[slides]
    np.testing.assert_allclose(q[slides], opposed, atol=1e-6 * bound.max())
    sticks = (p > 0) & ~slides
    if laws.regularisation:
        np.testing.assert_allclose(
            q[sticks], -(bound[sticks] / laws.regularisation)[:, None] * fields.slip[sticks], atol=1e-4 * bound.max()
        )
    else:
        assert sticks.any()
        assert np.abs(fields.slip[sticks]).max() < 1e-7
    # the sums
    (patch,) = result.patches
    np.testing.assert_allclose(result.force, [*(points.area @ q), points.area @ p], rtol=1e-12)
    assert result.moment[2] == pytest.approx(
        float((points.point[:, 0] * q[:, 1] - points.point[:, 1] * q[:, 0]) @ points.area)
    )
    assert patch.area == pytest.approx(float(points.area[p > 0].sum()))
    assert patch.normal_force == pytest.approx(result.force[2])
    np.testing.assert_allclose(patch.tangential_force, result.force[:2], rtol=1e-12)


def test_friction_does_not_change_the_pressure_of_equal_bodies() -> None:
    with_friction = condensed(TETRAHEDRA, SPHERE, size=SIZE, laws=ContactLaws.penalty())(pose(3.2), CREEP)
    without = condensed(TETRAHEDRA, SPHERE, size=SIZE, laws=ContactLaws.penalty(0.0))(pose(3.2), AT_REST)
    assert with_friction.fields is not None
    assert without.fields is not None
    np.testing.assert_allclose(with_friction.fields.pressure, without.fields.pressure, rtol=1e-9)
    assert not without.fields.traction.any()
    assert not without.force[:2].any()


def test_bicgstab_gives_the_same_solution() -> None:
    model = condensed(TETRAHEDRA, SPHERE, size=SIZE, laws=ContactLaws.penalty(), steels=(Material(210e9, 0.1), STEEL))
    direct = model(pose(3.2), CREEP)
    iterative = replace(model, options=NewtonOptions(linear="bicgstab"))(pose(3.2), CREEP)
    np.testing.assert_allclose(iterative.force, direct.force, rtol=1e-7)
    assert iterative.statistics.linear > 0
    assert direct.statistics.linear == 0


def test_warm_start_saves_steps_without_changing_the_result() -> None:
    model = condensed(TETRAHEDRA, SPHERE, size=SIZE, laws=ContactLaws.penalty())
    cold = model(pose(3.2), CREEP)
    again = model(pose(3.2), CREEP, cold)
    assert again.statistics.newton < cold.statistics.newton
    np.testing.assert_allclose(again.force, cold.force, rtol=1e-8)
    # initial guess from a smaller patch at another position
    moved = model(Pose(np.array([6e-4, -8e-4, -3e-6]), np.eye(3)), CREEP)
    np.testing.assert_allclose(model(pose(3.2), CREEP, moved).force, cold.force, rtol=1e-7)
    failed = model(pose(3.2), AT_REST)
    np.testing.assert_allclose(model(pose(3.2), CREEP, failed).force, cold.force, rtol=1e-8)


def test_failed_solve_has_status_and_no_force() -> None:
    model = condensed(TETRAHEDRA, SPHERE, size=SIZE, laws=ContactLaws.penalty())
    hurried = replace(model, options=NewtonOptions(iterations=1))
    results = {
        "Newton steps": hurried(pose(3.2), CREEP),
        "rolls forward": model(pose(3.2), AT_REST),
        "exceeds the meshed strip": model(pose(4.2), CREEP),
    }
    for reason, result in results.items():
        assert result.status.startswith("failed: ")
        assert reason in result.status
        assert not result.ok
        assert not result.force.any()
        assert not result.moment.any()
        assert not result.patches


def test_patches_are_connected_over_corners() -> None:
    picture = np.array([[1, 0, 0, 0, 1], [0, 1, 0, 0, 1], [0, 0, 0, 0, 0], [1, 1, 0, 1, 0]])
    labels = components(np.flatnonzero(picture), (4, 5))
    places = dict(zip(np.flatnonzero(picture).tolist(), labels.tolist(), strict=True))
    assert places[0] == places[6]
    assert places[4] == places[9]
    assert places[15] == places[16]
    assert len(set(places.values())) == 4
    assert len(components(np.empty(0, dtype=int), (4, 5))) == 0


def test_two_patches() -> None:
    """Concave lower body with a smaller radius than the upper one: contact on both sides."""

    class Saddle:
        """Two bumps across the rolling direction on the plane grid of a pair."""

        def __init__(self, model: CondensedContact) -> None:
            self.model = model

        def contact_points(self, pose: Pose, steps: int) -> tuple[GridPoints | None, float]:
            points, _ = self.model.geometry.contact_points(hertz_pose((3.4 * SIZE) ** 2 / (2 * RADIUS)), steps)
            assert points is not None
            x, y = points.point[:, 0], points.point[:, 1]
            overlap = 4e-6 - (x**2 + (np.abs(y) - 2.5e-3) ** 2 * (1.5 if pose.origin[2] < 0 else 1.0)) / (2 * 0.2)
            return replace(points, penetration=np.maximum(overlap, 1e-12)), float(overlap.max())

    model = condensed(TETRAHEDRA, SPHERE, size=SIZE, laws=ContactLaws.penalty())
    result = replace(model, geometry=Saddle(model))(hertz_pose(1e-6), CREEP)
    assert result.status == "converged"
    assert len(result.patches) == 2
    first, second = result.patches
    assert first.normal_force >= second.normal_force > 0
    assert first.normal_force + second.normal_force == pytest.approx(result.force[2])
    assert first.wheel_s * second.wheel_s < 0
    np.testing.assert_allclose(first.force + second.force, result.force, rtol=1e-12)
    assert result.fields is not None
    assert set(result.fields.patch[result.fields.pressure > 0].tolist()) == {0, 1}


SPHERE_57 = hertzian((0.46, 0.46), 57e3)
# Slip is a difference: the deformation that these blocks lack is nearly uniform under the patch.
MESHES = {"tetrahedra": Block((12, 9), 24.0), "hexahedra": Block((12, 10), 16.0, "hexahedron", growth=0.6)}


@cache
def loaded(name: str, across: float) -> tuple[CondensedContact, Pose, Hertz]:
    """Exact laws, the pose under 57 kN, and Hertz's, with so many points across the patch."""
    size = 2 * SPHERE_57.semi_axes[0] / across
    mesh, radii = MESHES[name], (0.46, 0.46)
    normal = condensed(mesh, radii, size=size, laws=ContactLaws(np.inf, friction=0.0))
    depth = hertz_under_load(normal, AT_REST, 57e3, expected=0.9 * SPHERE_57.approach).depth
    return condensed(mesh, radii, size=size, laws=ContactLaws(np.inf, 0.3, 0.0)), hertz_pose(depth), SPHERE_57


def resultants(result: ContactResult) -> Array:
    assert result.status == "converged"
    return np.array([result.force[0], result.force[1], result.moment[2]])


@pytest.mark.parametrize(("name", "across"), zip(MESHES, [10.2, 10.8], strict=True))
def test_creep_forces_against_contact(name: str, across: float) -> None:
    model, at, expected = loaded(name, across)
    a = expected.semi_axes[0]
    errors = [
        resultants(model(at, rolling(*creepages))) / 0.3 / 57e3 / [1, 1, a] - reference
        for creepages, reference in CONTACT_SPHERE
    ]
    # Staircase edge in steps of a tenth of the patch: errors of up to 10 % in area, largest in spin moments
    assert np.sqrt(np.mean(np.square(errors))) < 0.015
    assert np.abs(errors).max() < 0.045


def test_kalker_coefficients() -> None:
    # Kalker, Three-Dimensional Elastic Bodies in Rolling Contact, 1990, table E.3, a / b = 1: 4.12, 3.67, 1.47 at
    # nu = 0.25 and by interpolation in it, at nu = 0.3
    table = np.array([4.30, 3.73, 1.50])
    model, at, expected = loaded("tetrahedra", 10.2)
    a, G, small = expected.semi_axes[0], 210e9 / 2.6, 1e-7
    straight, lateral, spin = (
        model(at, rolling(*creepages)) for creepages in ((small, 0, 0), (0, small, 0), (0, 0, small / a))
    )
    (patch,) = spin.patches
    assert patch.stick_area == patch.area
    radius = np.sqrt(patch.area / np.pi)  # of the circle with the area of the staircase
    found = -np.array([straight.force[0] / radius**2, lateral.force[1] / radius**2, spin.force[1] * a / radius**3])
    np.testing.assert_allclose(found / (G * small), table, rtol=0.05)


def test_rigid_motion_causes_no_slip() -> None:
    model = condensed(TETRAHEDRA, SPHERE, size=SIZE, laws=ContactLaws.penalty())
    result = model(pose(3.2), rolling(0.0, 0.0, 0.0))
    # equal bodies: pressure causes no slip
    assert np.abs(result.force[:2]).max() < 1e-9 * result.force[2]


def test_second_order_slip_is_more_accurate() -> None:
    forces = {}
    for across in (5.4, 10.8):
        size = 2 * SPHERE_57.semi_axes[0] / across
        for order in (1, 2):
            model = condensed(
                MESHES["tetrahedra"], (0.46, 0.46), size=size, laws=ContactLaws(np.inf, 0.3, 0.0), order=order
            )
            forces[order, across] = model(hertz_pose(0.9 * SPHERE_57.approach), rolling(-3e-4, 0.0, 0.0)).force
    normalised = {key: force[0] / force[2] for key, force in forces.items()}
    limit = normalised[2, 10.8]
    assert abs(normalised[2, 5.4] - limit) < 0.5 * abs(normalised[1, 5.4] - limit)
    assert normalised[1, 10.8] > limit
