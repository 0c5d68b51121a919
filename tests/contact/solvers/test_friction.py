"""Falling friction, one step of tangential loading, and robustness of the solver."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from half_space import Cells, HalfSpaces, creepage, forces

from wheelrail.contact.analytical.hertz import hertz, modulus
from wheelrail.contact.kinematics.frames import RigidMotion, Twist
from wheelrail.contact.laws.friction import FallingFriction
from wheelrail.contact.laws.material import Material
from wheelrail.contact.laws.parameters import ContactLaws
from wheelrail.contact.loading.hertz import hertz_pose
from wheelrail.contact.models.builders import hertz_pair
from wheelrail.contact.models.discretisation import Discretisation
from wheelrail.contact.models.lattice.model import LatticeContact
from wheelrail.contact.solvers.active_set import CachedFactors, CoupledPressure
from wheelrail.contact.solvers.options import IterationCount, NewtonOptions, NotConverged
from wheelrail.contact.solvers.semismooth_newton import newton, tangential_contact
from wheelrail.contact.solvers.tangential import FrictionProblem
from wheelrail.contact.solvers.tractions import ContactCompliance, Tractions, solve_tractions
from wheelrail.support.arrays import Array

STEEL = Material(210e9, 0.3)
E_STAR = modulus((210e9, 0.3), (210e9, 0.3))
RADIUS, SPEED = 0.3, 20.0
PATCH = hertz(0.5 / RADIUS, 0.5 / RADIUS, E_STAR, force=10e3)
COULOMB = ContactLaws()
FALLING = ContactLaws(friction=FallingFriction(0.3, 0.4, 0.6))


def sphere(across: float, *, shift: float = 0.0) -> tuple[Cells, Array]:
    """Penetrating cells of a sphere on a plane and their penetration [m]; grid shifted by a number of cells."""
    size = 2 * PATCH.semi_axes[0] / across
    half = int(np.ceil(0.75 * across))
    line = (np.arange(-half, half + 1) + shift) * size
    x, y = (part.ravel() for part in np.meshgrid(line, line, indexing="ij"))
    overlap = PATCH.approach - (x**2 + y**2) / 2 / RADIUS
    kept = overlap > 0
    return Cells(x[kept], y[kept], size, size), overlap[kept]


CELLS, OVERLAP = sphere(7)
ALIKE = HalfSpaces(CELLS, STEEL, STEEL).operator(2)
UNLIKE = HalfSpaces(CELLS, Material(210e9, 0.0), Material(210e9, 0.45)).operator(2)


def solve(operator: Array, creepages: tuple[float, float, float], laws: ContactLaws, speed: float = SPEED) -> Tractions:
    return solve_tractions(
        operator, OVERLAP, creepage(CELLS, *creepages), laws=laws, speed=speed, count=IterationCount()
    )


@pytest.mark.parametrize("operator", [ALIKE, UNLIKE], ids=["alike", "unlike"])
def test_falling_friction_with_full_fraction_is_coulomb(operator: Array) -> None:
    for eps in (0.0, 1e-4):
        falling, plain = (
            ContactLaws(friction=FallingFriction(0.3, 1.0, 5.0), regularisation=eps),
            ContactLaws(regularisation=eps),
        )
        first, second = (solve(operator, (1e-3, -5e-4, 0.3), laws) for laws in (falling, plain))
        np.testing.assert_allclose(first.tangential, second.tangential, atol=1e-9 * np.abs(second.tangential).max())


def test_creep_force_has_a_maximum_and_falls_beyond_it() -> None:
    creepages = np.array([1e-4, 1e-3, 3e-3, 1e-2, 3e-2, 1e-1])
    found = np.array([-forces(CELLS, solve(ALIKE, (xi, 0.0, 0.0), FALLING).tangential)[0] for xi in creepages])
    top = int(found.argmax())
    assert 0 < top < 4
    assert (np.diff(found[: top + 1]) > 0).all()
    assert (np.diff(found[top:]) < 0).all()
    normal = solve(ALIKE, (0.1, 0.0, 0.0), FALLING).pressure.sum() * CELLS.area
    # full sliding at nearly the rigid slip of 0.1
    assert found[-1] / normal == pytest.approx(0.3 * (0.6 * np.exp(-0.6 * 0.1 * SPEED) + 0.4), rel=5e-3)


@pytest.mark.parametrize("eps", [0.0, 1e-5, 1e-3])
@pytest.mark.parametrize("operator", [ALIKE, UNLIKE], ids=["alike", "unlike"])
def test_falling_friction_holds_at_every_point(operator: Array, eps: float) -> None:
    laws = ContactLaws(1e15, FallingFriction(0.4, 0.3, 2.0), eps)
    found = solve(operator, (2e-3, -1e-3, 0.4), laws)
    slip, length = np.hypot(*found.slip.T), np.hypot(*found.tangential.T)
    mu = 0.4 * (0.7 * np.exp(-2.0 * slip * SPEED) + 0.3)
    bound = mu * found.pressure
    assert (length <= bound + 1e-8 * bound.max()).all()
    slides = (found.pressure > 0) & (slip > eps + 1e-8)
    assert slides.any()
    expected = -(bound[slides] / slip[slides])[:, None] * found.slip[slides]
    np.testing.assert_allclose(found.tangential[slides], expected, atol=1e-7 * bound.max())
    assert mu[slides].min() < 0.9 * 0.4


@pytest.mark.parametrize("eps", [0.0, 1e-4])
def test_newton_step_is_that_of_the_derivative(eps: float) -> None:
    n = len(OVERLAP)
    friction = FrictionProblem(
        UNLIKE[: 2 * n, : 2 * n],
        creepage(CELLS, 1e-3, -5e-4, 0.3),
        -UNLIKE[: 2 * n, 2 * n :],
        CoupledPressure(CachedFactors(UNLIKE[2 * n :, 2 * n :]), OVERLAP, UNLIKE[2 * n :, : 2 * n]),
        ContactLaws(np.inf, FallingFriction(0.3, 0.4, 1.0), eps),
        SPEED,
    )
    q = np.random.default_rng(3).normal(size=(2, n)) * 3e7
    start, options = friction.at(q, OVERLAP > 0, IterationCount()), NewtonOptions(tolerance=1e-12)
    step = friction.step(start, options, IterationCount())
    y = friction.rho * start.q - start.s
    slides = np.hypot(*y) > start.bound * friction.rho + eps
    assert slides.any()
    assert not slides[start.active].all()
    sizes, errors = np.array([1e-3, 3e-4, 1e-4]), []
    for size in sizes:
        moved = friction.at(q + size * step, start.active, IterationCount())
        errors.append(np.linalg.norm(moved.F - (1 - size) * start.F))
    assert np.polyfit(np.log(sizes), np.log(errors), 1)[0] > 1.9
    assert errors[-1] < 1e-5 * start.norm


def pushed(cells: Cells, overlap: Array, distance: float) -> Tractions:
    operator = HalfSpaces(cells, STEEL, STEEL).compliance().transpose(0, 2, 1, 3).reshape(3 * len(overlap), -1)
    rigid = np.repeat([distance, 0.0], len(overlap))
    return solve_tractions(operator, overlap, rigid, laws=COULOMB, speed=0.0, count=IterationCount())


def test_shift_against_cattaneo() -> None:
    """Cattaneo 1938, Mindlin 1949: Johnson, Contact Mechanics, 1985, eqs. 7.36, 7.39 and 7.42, nu = 0.3."""
    a, G = PATCH.semi_axes[0], 210e9 / 2.6
    full = 3 * 0.3 * PATCH.force * 1.7 / (8 * G * a)  # shift at full sliding
    across, errors = np.array([8, 11, 15, 20]), []
    for n in across:
        found = []
        for place in (0.0, 0.5):
            cells, overlap = sphere(float(n), shift=place)
            for share in (0.3, 0.6, 0.9):
                result, stick = pushed(cells, overlap, share * full), np.sqrt(1 - share)  # stick: c / a
                total = -forces(cells, result.tangential)[0] / (0.3 * PATCH.force)
                r = np.hypot(cells.x, cells.y) / a
                expected = np.sqrt(np.maximum(1 - r**2, 0)) - stick * np.sqrt(np.maximum(1 - (r / stick) ** 2, 0))
                traction = -result.tangential[:, 0] / (0.3 * PATCH.peak) - expected
                presses = result.pressure > 0
                sticks = presses & (np.hypot(*result.tangential.T) < 0.3 * result.pressure * (1 - 1e-9))
                part = sticks.sum() / presses.sum() - (1 - total) ** (2 / 3)
                found.append([total - (1 - stick**3), np.sqrt(np.mean(traction[presses] ** 2)), part])
        errors.append(np.sqrt(np.mean(np.square(found), axis=0)))
    # force over mu F_n, tractions over mu p0, and the part of the patch that sticks, RMS over shifts and grids
    assert (np.array(errors[-1]) < [2e-3, 0.02, 0.02]).all()
    slopes = -np.polyfit(np.log(across), np.log(np.array(errors)), 1)[0]
    assert slopes[1] > 0.9
    assert slopes[2] > 0.7


def test_shift_of_a_pair() -> None:
    how = Discretisation(PATCH.semi_axes[0] / 6, bodies="waveguide")
    rolling = hertz_pair(((RADIUS, RADIUS), (np.inf, np.inf)), (STEEL, STEEL), COULOMB, how, load=10e3)
    pair = replace(rolling, tangential="shift")
    full = 3 * 0.3 * PATCH.force * 1.7 / (8 * 210e9 / 2.6 * PATCH.semi_axes[0])
    still = np.zeros(3)
    for angle in (0.0, 0.7):
        way = np.array([np.cos(angle), np.sin(angle), 0.0])
        motion = RigidMotion(Twist(0.5 * full * way, still, still), Twist(still, still, still))
        result = pair(hertz_pose(PATCH.approach), motion, None)
        assert result.ok
        # Cattaneo's stick radius of sqrt(1 - 0.5)
        assert result.force[:2] @ way[:2] / result.force[2] == pytest.approx(-0.3 * (1 - 0.5**1.5), rel=0.03)
        (patch,) = result.patches
        assert patch.stick_area / patch.area == pytest.approx(0.5, abs=0.06)
    assert isinstance(pair, LatticeContact)
    with pytest.raises(ValueError, match="slip velocity"):
        replace(pair, laws=ContactLaws(regularisation=1e-5))


def test_random_laws_never_fail() -> None:
    rng = np.random.default_rng(8)
    cells, overlap = sphere(5)
    n, a = len(overlap), PATCH.semi_axes[0]
    bodies = [(0.3, 0.3), (0.0, 0.45), (0.49, 0.0), (0.1, 0.3), (0.25, 0.49)]
    operators = [
        HalfSpaces(cells, Material(210e9, one), Material(E, two)).operator(order)
        for one, two in bodies
        for E in (70e9, 210e9)
        for order in (1, 2)
    ]
    most = 0
    for _ in range(800):
        operator = operators[rng.integers(len(operators))]
        xi, eta, spin = 10 ** rng.uniform(-5, -1, 3) * rng.choice([-1, 0, 1], 3) * [1, 1, 1 / a]
        falling = (rng.uniform(), 10 ** rng.uniform(-2, 1)) if rng.random() < 0.4 else None
        K = np.inf if rng.random() < 0.4 else 10 ** rng.uniform(12, 16)
        mu, eps = rng.uniform(0, 0.8), rng.choice([0.0, 10 ** rng.uniform(-7, -1)])
        laws = ContactLaws(K, FallingFriction(mu, *falling) if falling else mu, eps)
        speed, count = 10 ** rng.uniform(0, 2), IterationCount()
        found = solve_tractions(operator, overlap, creepage(cells, xi, eta, spin), laws=laws, speed=speed, count=count)
        p, q, s = found.pressure, found.tangential, found.slip
        gap = operator[2 * n :] @ np.concatenate([-q.T.ravel(), p]) + p * laws.normal_compliance - overlap
        assert p.min() >= 0
        assert gap.min() > -1e-9 * overlap.max()
        assert np.abs(gap[p > 0]).max() < 1e-9 * overlap.max()
        slip = np.hypot(*s.T)
        bound = laws.friction_bound(p, slip, speed)
        assert (np.hypot(*q.T) <= bound + 1e-8 * max(bound.max(), 1e-300)).all()
        # q max(|s|, eps) = -b s: sticks, creeps or slides
        scale = max(slip.max(), laws.regularisation, 1e-6) * max(bound.max(), 1e-300)
        left = q * np.maximum(slip, laws.regularisation)[:, None] + bound[:, None] * s
        assert np.abs(left).max() < 1e-7 * scale
        assert count.residual < 1e-9
        most = max(most, count.newton)
    assert most < 60


def test_full_newton_steps_cross_a_kink() -> None:
    """Three points whose pressures depend on friction, as in heavily loaded flange contact."""
    slip = np.array(
        [
            [0.8, 0.1, 0.1, 0.0, 0.1, -0.3],
            [-0.3, 0.9, -0.1, -0.2, 0.2, -0.1],
            [0.2, 0.2, 1.3, 0.1, -0.1, -0.4],
            [0.2, 0.1, -0.1, 0.5, -0.1, 0.0],
            [-0.1, 0.1, -0.2, -0.1, 0.9, 0.2],
            [0.2, -0.4, -0.4, 0.0, 0.0, 0.9],
        ]
    )
    coupling = np.array(
        [[0.0, 1.0, -1.3, -0.4, -0.3, -0.2], [-0.6, -0.5, 0.2, -0.2, -0.1, 0.3], [0.1, 0.5, 0.0, -1.3, 0.7, -1.0]]
    )
    rigid, normal, mu = np.array([-1.1, 0.6, -0.4, 0.1, 0.5, 0.6]), np.eye(3) + 0.3, 0.6
    pressures = CoupledPressure(CachedFactors(normal), np.ones(3), coupling)
    friction = FrictionProblem(slip, rigid, np.zeros((6, 3)), pressures, ContactLaws(friction=mu), SPEED)
    q, active, options = np.zeros((2, 3)), np.ones(3, dtype=bool), NewtonOptions()
    with pytest.raises(NotConverged):
        newton(friction, friction.at(q, active, IterationCount()), options, IterationCount())
    count = IterationCount()
    found = tangential_contact(friction, q, active, options, count)
    assert count.newton < 30  # 166 with fixed bounds
    p, t, s = found.pressure, found.q, (rigid + slip @ found.q.ravel()).reshape(2, 3)
    np.testing.assert_allclose(normal @ p, np.ones(3) + coupling @ t.ravel(), rtol=1e-9)
    fast = np.hypot(*s) > 1e-6
    assert fast.sum() == 2
    np.testing.assert_allclose(t[:, fast], -mu * p[fast] * s[:, fast] / np.hypot(*s)[fast], atol=1e-6)
    assert (np.hypot(*t)[~fast] < mu * p[~fast]).all()


def test_cache_serves_the_points_that_it_was_filled_for() -> None:
    # the tangent uses the loaded points, at which Newton's last step was linearised
    body = ContactCompliance(UNLIKE, len(OVERLAP), COULOMB)
    assert body.coupling is not None
    solution = solve_tractions(
        body, OVERLAP, creepage(CELLS, 1e-3, -5e-4, 0.3), laws=COULOMB, speed=SPEED, count=IterationCount()
    )
    active = solution.active
    assert 0 < active.sum() < len(active)
    stored = body.cache.linearised_for(active, active)
    assert stored is not None
    index, slip, slope = stored
    np.testing.assert_array_equal(index, np.flatnonzero(active))
    assert slope is not None
    assert slip.shape == (2 * len(index), 2 * len(index))
    assert body.cache.factors is not None
    every = np.ones_like(active)
    assert body.cache.linearised_for(active, every) is None
    assert body.cache.linearised_for(every, active) is None
    body.cache.store(every, every, stored)
    assert body.cache.factors is None
    assert body.cache.linearised_for(active, active) is None
