"""The laws at the contact points, on elastic half-spaces, against closed forms."""

from __future__ import annotations

from dataclasses import dataclass
from functools import partial

import numpy as np
import pytest
from contact_sphere import CONTACT_SPHERE
from half_space import Cells, HalfSpaces, creepage, forces
from scipy.optimize import nnls

from wheelrail.contact.analytical.hertz import Hertz, hertz, modulus
from wheelrail.contact.laws.material import Material
from wheelrail.contact.laws.parameters import ContactLaws
from wheelrail.contact.solvers.active_set import PrescribedPressure, normal_contact
from wheelrail.contact.solvers.options import IterationCount, NewtonOptions, NotConverged
from wheelrail.contact.solvers.semismooth_newton import tangential_contact
from wheelrail.contact.solvers.tangential import FrictionProblem
from wheelrail.contact.solvers.tractions import Tractions, solve_tractions
from wheelrail.support.arrays import Array

STEEL = Material(210e9, 0.3)
E_STAR = modulus((210e9, 0.3), (210e9, 0.3))
RADIUS = 0.3


@dataclass(frozen=True)
class Sphere:
    """Sphere on a plane: undeformed penetration at the candidate cells."""

    expected: Hertz
    cells: Cells
    penetration: Array

    @classmethod
    def with_cells(cls, across: float, force: float = 10e3) -> Sphere:
        """So many cells across the patch [N]."""
        expected = hertz(0.5 / RADIUS, 0.5 / RADIUS, E_STAR, force=force)
        size = 2 * expected.semi_axes[0] / across
        line = (np.arange(int(1.5 * across)) - (int(1.5 * across) - 1) / 2) * size
        x, y = (part.ravel() for part in np.meshgrid(line, line, indexing="ij"))
        overlap = expected.approach - (x**2 + y**2) / 2 / RADIUS
        kept = overlap > 0
        return cls(expected, Cells(x[kept], y[kept], size, size), overlap[kept])

    def solve(
        self,
        operator: Array,
        creepages: tuple[float, float, float],
        *,
        K: float = np.inf,
        friction: float = 0.3,
        regularisation: float = 0.0,
        guess: tuple[Array, Array] | None = None,
        options: NewtonOptions | None = None,
    ) -> Tractions:
        return solve_tractions(
            operator,
            self.penetration,
            creepage(self.cells, *creepages),
            laws=ContactLaws(K, friction, regularisation),
            speed=10.0,
            guess=guess,
            options=options,
            count=IterationCount(),
        )


COARSE = Sphere.with_cells(8)
OPERATOR = HalfSpaces(COARSE.cells, STEEL, STEEL).operator(2)


def frictionless(sphere: Sphere, K: float) -> Array:
    normal = HalfSpaces(sphere.cells, STEEL, STEEL).compliance()[2, 2]
    return solve_tractions(
        normal, sphere.penetration, None, laws=ContactLaws(K, friction=0.0), speed=0.0, count=IterationCount()
    ).pressure


def test_hertz_pressure_on_half_spaces() -> None:
    errors, across = [], np.array([8, 16, 32])
    for n in across:
        sphere = Sphere.with_cells(float(n))
        pressure = frictionless(sphere, np.inf)
        error = np.abs(pressure - sphere.expected.pressure(sphere.cells.x, sphere.cells.y)).sum() * sphere.cells.area
        errors.append(error / sphere.expected.force)
    assert pressure.max() == pytest.approx(sphere.expected.peak, rel=5e-3)
    assert pressure.sum() * sphere.cells.area == pytest.approx(sphere.expected.force, rel=5e-3)
    assert -np.polyfit(np.log(across), np.log(errors), 1)[0] > 1.0


@pytest.mark.parametrize("K", [1e13, 1e15, np.inf])
@pytest.mark.parametrize("eps", [0.0, 1e-6, 1e-3])
@pytest.mark.parametrize(
    "creepages", [(2e-4, 0.0, 0.0), (-1e-3, 5e-4, 0.3), (0.0, 0.0, 1.0), (0.0, 1.0, 0.0), (0.0, 0.0, 0.0)]
)
def test_laws_hold_at_every_point(creepages: tuple[float, float, float], eps: float, K: float) -> None:
    found = COARSE.solve(OPERATOR, creepages, K=K, regularisation=eps)
    n, p, q, s = len(COARSE.penetration), found.pressure, found.tangential, found.slip
    gap = COARSE.penetration - OPERATOR[2 * n :, 2 * n :] @ p - p / K
    assert p.min() >= 0
    assert gap.max() <= 1e-10 * COARSE.penetration.max()
    assert np.abs(p * gap).max() <= 1e-10 * p.max() * COARSE.penetration.max()
    bound, length, speed = 0.3 * p, np.hypot(*q.T), np.hypot(*s.T)
    assert (length - bound).max() <= 1e-8 * bound.max()
    sticks = length < bound - 1e-7 * bound.max()
    slides = (p > 0) & ~sticks
    scale = max(np.abs(creepage(COARSE.cells, *creepages)).max(), 1e-12)
    viscous = eps * q[sticks] / bound[sticks, None]
    np.testing.assert_allclose(s[sticks], -viscous, atol=1e-7 * scale)  # no slip at all when eps is zero
    opposed = (q[slides] * s[slides]).sum(axis=1) + length[slides] * speed[slides]
    assert (opposed <= 1e-7 * scale * length[slides]).all()
    assert (speed[slides] >= eps - 1e-7 * scale).all()
    if creepages[1] == 1.0:  # so fast that all of it slides
        assert slides.sum() == (p > 0).sum()


def test_slip_agrees_with_the_operator() -> None:
    found = COARSE.solve(OPERATOR, (5e-4, 0.0, 0.2))
    n = len(COARSE.penetration)
    loads = np.concatenate([*found.tangential.T, -found.pressure])
    expected = creepage(COARSE.cells, 5e-4, 0.0, 0.2) + OPERATOR[: 2 * n] @ loads
    np.testing.assert_allclose(found.slip.T.ravel(), expected, rtol=1e-9, atol=1e-14)


# Normalised creep forces of an ellipse of 6 x 4 mm, 54.5 kN, mu = 0.3, exact Coulomb: a separate solver of the same
# equations (grid over the ellipse, order of the upstream differences, creepages, Fx and Fy over mu F).
CREEP_FORCES = [
    ((14, 10), 1, (2e-4, 0.0, 0.0), (-0.1162, 0.0)),
    ((14, 10), 2, (2e-4, 0.0, 0.0), (-0.1103, 0.0)),
    ((14, 10), 1, (5e-4, 5e-4, 0.1), (-0.2599, -0.3578)),
    ((14, 10), 2, (5e-4, 5e-4, 0.1), (-0.2468, -0.3429)),
    ((20, 14), 2, (2e-4, 0.0, 0.0), (-0.1098, 0.0)),
    ((30, 20), 2, (2e-4, 0.0, 0.0), (-0.1093, 0.0)),
    ((44, 30), 2, (2e-4, 0.0, 0.0), (-0.1091, 0.0)),  # 1040 points
]


def hertzian(cells: Cells, a: float, b: float, load: float) -> Array:
    pressure = np.sqrt(1 - (cells.x / a) ** 2 - (cells.y / b) ** 2)
    return np.asarray(pressure * load / (pressure.sum() * cells.area))


def rolling(cells: Cells, bound: Array, creepages: tuple[float, float, float], order: int = 2) -> Array:
    """Tractions (n, 2) for a pressure that is given."""
    n = len(cells.x)
    slip = HalfSpaces(cells, STEEL, STEEL).operator(order)[: 2 * n, : 2 * n]
    rigid = creepage(cells, *creepages)
    return under(bound, slip, rigid).T


def under(pressure: Array, slip: Array, rigid: Array) -> Array:
    """Tractions (2, n) under a given pressure and friction 1."""
    friction = FrictionProblem(slip, rigid, None, PrescribedPressure(pressure), ContactLaws(friction=1.0), 0.0)
    start = np.zeros((2, len(pressure)))
    return tangential_contact(friction, start, pressure > 0, NewtonOptions(), IterationCount()).q


@pytest.mark.parametrize(("grid", "order", "creepages", "expected"), CREEP_FORCES)
def test_creep_forces_of_an_ellipse(
    grid: tuple[int, int], order: int, creepages: tuple[float, float, float], expected: tuple[float, float]
) -> None:
    cells = Cells.inside_ellipse(6e-3, 4e-3, *grid)
    bound = 0.3 * hertzian(cells, 6e-3, 4e-3, 54.5e3)
    found = forces(cells, rolling(cells, bound, creepages, order))[:2] / 0.3 / 54.5e3
    np.testing.assert_allclose(found, expected, atol=6e-5)


def test_creep_forces_against_contact() -> None:
    expected = hertz(0.5 / 0.46, 0.5 / 0.46, E_STAR, force=57e3)
    a = expected.semi_axes[0]
    cells = Cells.inside_ellipse(a, a, 20, 20)
    bound = 0.3 * hertzian(cells, a, a, 57e3)
    errors = [
        forces(cells, rolling(cells, bound, creepages)) / 0.3 / 57e3 / [1, 1, a] - reference
        for creepages, reference in CONTACT_SPHERE
    ]
    # the edge of the patch is a staircase of 316 cells, and spin, which lives there, feels it most
    assert np.abs(errors).max() < 0.015
    assert np.sqrt(np.mean(np.square(errors))) < 0.005


def test_kalker_coefficients() -> None:
    # Kalker, Three-Dimensional Elastic Bodies in Rolling Contact, 1990, table E.3, nu = 0.25, a / b = 1
    steel, a = Material(210e9, 0.25), 5e-3
    G = steel.E / 2 / 1.25
    across, found = np.array([10, 14, 20, 28]), []
    for m in across:
        cells = Cells.inside_ellipse(a, a, m, m)
        n = len(cells.x)
        slip = HalfSpaces(cells, steel, steel).operator(2)[: 2 * n, : 2 * n]

        def coefficients(xi: float, eta: float, spin: float, cells: Cells = cells, slip: Array = slip) -> Array:
            rigid = creepage(cells, xi, eta, spin)
            stick = np.linalg.solve(slip, -rigid)
            bound = np.full(len(cells.x), 10 * np.abs(stick).max())  # so strong that all of it sticks
            q = under(bound, slip, rigid)
            np.testing.assert_allclose(q.ravel(), stick, atol=1e-6 * bound.max())
            return -forces(cells, q.T) / G

        radius = np.sqrt(n * cells.area / np.pi)  # of the circle that has the area of the staircase
        straight, lateral, spin = (coefficients(*unit) for unit in np.eye(3))
        assert spin[1] == pytest.approx(-lateral[2], rel=1e-6)  # C23 = -C32, Betti
        found.append([straight[0] / radius**2, lateral[1] / radius**2, spin[1] / radius**3])
    table = np.array([4.12, 3.67, 1.47])
    _, limit = np.polyfit(1 / across, np.array(found), 1)
    np.testing.assert_allclose(limit, table, rtol=0.01)
    np.testing.assert_allclose(found[-1], table, rtol=0.03)


@pytest.mark.parametrize("eps", [0.0, 1e-5])
@pytest.mark.parametrize("other", [0.3, 0.1])
def test_bicgstab_and_lu_agree(eps: float, other: float) -> None:
    operator = HalfSpaces(COARSE.cells, Material(210e9, other), STEEL).operator(2)
    counts = IterationCount()
    rigid = creepage(COARSE.cells, -5e-4, 3e-4, 0.3)

    def solve(linear: str) -> Array:
        options = NewtonOptions(linear=linear)  # type: ignore[arg-type]
        return solve_tractions(
            operator,
            COARSE.penetration,
            rigid,
            laws=ContactLaws(1e15, 0.3, eps),
            speed=10.0,
            options=options,
            count=counts,
        ).tangential

    direct, iterations = solve("lu"), counts.linear
    assert iterations == 0
    iterative = solve("bicgstab")
    assert counts.linear > 0
    np.testing.assert_allclose(iterative, direct, atol=1e-7 * np.abs(direct).max())


def test_dissimilar_bodies_couple_pressure_and_friction() -> None:
    stiff, soft = Material(210e9, 0.0), Material(210e9, 0.45)
    operator = HalfSpaces(COARSE.cells, stiff, soft).operator(2)
    n = len(COARSE.penetration)
    found = COARSE.solve(operator, (1e-3, 0.0, 0.0))
    coupling, normal = operator[2 * n :, : 2 * n], operator[2 * n :, 2 * n :]
    gap = COARSE.penetration + coupling @ found.tangential.T.ravel() - normal @ found.pressure
    assert gap.max() <= 1e-9 * COARSE.penetration.max()
    assert np.abs(gap[found.pressure > 0]).max() <= 1e-9 * COARSE.penetration.max()
    # and it matters: the pressure is not the frictionless one
    assert np.abs(found.pressure - frictionless(COARSE, np.inf)).max() > 0.01 * found.pressure.max()


@pytest.mark.parametrize(("upper", "levels"), [(0.3, (0.0, 1e-6, 1e-3)), (0.0, (0.0, 1e-6, 1e-5))])
def test_random_rolling_never_fails(upper: float, levels: tuple[float, ...]) -> None:
    rng = np.random.default_rng(2)
    sphere = Sphere.with_cells(6)
    n = len(sphere.penetration)
    operator = HalfSpaces(sphere.cells, Material(210e9, upper), STEEL).operator(2)
    for _ in range(25):
        xi, eta, spin = rng.normal(size=3) * 10 ** rng.uniform(-6, 0) * [1, 1, 1 / sphere.expected.semi_axes[0]]
        friction = float(rng.choice([0.05, 0.3, 1.0]))
        for eps in levels:
            K = float(rng.choice([1e13, 1e15, np.inf]))
            solve = partial(sphere.solve, operator, K=K, friction=friction, regularisation=eps)
            cold, near = solve((xi, eta, spin)), solve((1.3 * xi, 1.3 * eta, 1.3 * spin))
            guesses = [(near.pressure, near.tangential.T.ravel())]
            if upper == 0.3:  # equal bodies: any initial guess converges
                guesses += [(np.maximum(rng.normal(size=n), 0) * 1e9, rng.normal(size=2 * n) * 1e9)]
            for guess in guesses:
                warm = solve((xi, eta, spin), guess=guess)
                np.testing.assert_allclose(warm.pressure, cold.pressure, atol=1e-6 * cold.pressure.max())
                bound = friction * cold.pressure.max()
                np.testing.assert_allclose(warm.tangential, cold.tangential, atol=1e-5 * bound)


def reference_pressure(compliance: Array, overlap: Array) -> Array:
    """min p N p / 2 - d p over p >= 0, by nonnegative least squares on the Cholesky factor."""
    factor = np.linalg.cholesky(compliance)
    return np.asarray(nnls(factor.T, np.linalg.solve(factor, overlap), maxiter=3000)[0])


def random_compliance(rng: np.random.Generator, n: int, kind: str) -> Array:
    """Symmetric and positive definite, of several kinds."""
    if kind == "wishart":  # signs of all kinds off the diagonal: plain active sets cycle on these
        a = rng.normal(size=(n, n + 1))
        return np.asarray(a @ a.T + 1e-3 * np.eye(n))
    if kind == "stiff":  # condition number 1e8
        q, _ = np.linalg.qr(rng.normal(size=(n, n)))
        return np.asarray((q * np.logspace(0, -8, n)) @ q.T)
    if kind == "doubled":  # two points at one position, distinct by the penalty's compliance only
        half = random_compliance(rng, n // 2, "wishart")
        return np.kron(half, np.ones((2, 2))) + 1e-6 * np.eye(2 * (n // 2))
    place = rng.uniform(size=(n, 2))
    distance = np.hypot(*(place[:, None] - place).transpose(2, 0, 1))
    return np.asarray(1 / (distance + 0.02) + 5 * np.eye(n))


@pytest.mark.parametrize("kind", ["wishart", "stiff", "doubled", "points"])
def test_normal_contact_against_nonnegative_least_squares(kind: str) -> None:
    rng = np.random.default_rng(3)
    for trial in range(60):
        compliance = random_compliance(rng, int(rng.integers(2, 40)), kind)
        compliance = 0.5 * (compliance + compliance.T)
        n = len(compliance)
        overlap = rng.normal(size=n)
        if trial % 3 == 0:
            overlap = np.abs(overlap)  # as in a contact: all candidates penetrate
        start = rng.random(n) < (0.0, 0.5, 1.0)[trial % 3 - 1]
        pressure, active = normal_contact(compliance, overlap, start, IterationCount())
        gap = compliance @ pressure - overlap
        scale = np.abs(overlap).max()
        assert pressure.min() >= 0
        assert not pressure[~active].any()
        assert gap.min() > -1e-7 * scale
        assert np.abs(gap[active]).max(initial=0.0) < 1e-7 * scale
        expected = reference_pressure(compliance, overlap)

        def energy(p: Array, compliance: Array = compliance, overlap: Array = overlap) -> float:
            return float(0.5 * p @ compliance @ p - overlap @ p)

        # the minimum itself is flat where the matrix is nearly singular
        assert energy(pressure) <= energy(expected) + 1e-9 * abs(energy(expected))
        if kind != "stiff":
            np.testing.assert_allclose(pressure, expected, atol=1e-6 * max(expected.max(), 1e-12))


def test_points_of_different_area() -> None:
    # columns scaled by areas: no longer symmetric, forces solve the symmetric problem
    rng = np.random.default_rng(4)
    compliance, area = random_compliance(rng, 30, "points"), rng.uniform(0.1, 2.0, 30)
    overlap = rng.normal(size=30)
    pressure, _ = normal_contact(compliance * area, overlap, overlap > 0, IterationCount())
    np.testing.assert_allclose(pressure * area, reference_pressure(compliance, overlap), atol=1e-9)


def test_no_pressure_without_penetration() -> None:
    compliance = random_compliance(np.random.default_rng(5), 12, "points")
    for overlap in (np.zeros(12), -np.ones(12)):
        pressure, active = normal_contact(compliance, overlap, np.ones(12, dtype=bool), IterationCount())
        assert not pressure.any()
        assert not active.any() or not overlap.any()


def test_exceeded_iterations_are_an_error() -> None:
    with pytest.raises(NotConverged, match="Newton steps"):
        COARSE.solve(OPERATOR, (1e-3, 5e-4, 0.5), options=NewtonOptions(iterations=1))
