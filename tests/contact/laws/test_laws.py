"""Laws in UFL: generated functions and their slopes, laws of a user in all models, refusals, cached sources."""

from __future__ import annotations

import hashlib
import math
import os
import subprocess
import sys
from collections.abc import Iterator
from dataclasses import dataclass, replace
from functools import cache
from pathlib import Path

import numpy as np
import pytest
import ufl
from small_pairs import AT_REST, CREEP, TETRAHEDRA, condensed, full

from wheelrail.bindings._contact import FrictionCode
from wheelrail.contact.kinematics.frames import RigidMotion
from wheelrail.contact.laws import pointwise, registry
from wheelrail.contact.laws.friction import Coulomb, FallingFriction, FrictionLaw, Stribeck
from wheelrail.contact.laws.material import Material
from wheelrail.contact.laws.normal import NormalLaw, Penalty, PowerPenalty
from wheelrail.contact.laws.parameters import ContactLaws
from wheelrail.contact.laws.pointwise import friction_functions, pressure_function
from wheelrail.contact.loading.hertz import hertz_pose
from wheelrail.contact.models.builders import hertz_pair
from wheelrail.contact.models.discretisation import Discretisation
from wheelrail.contact.models.standard.model import StandardContact
from wheelrail.support import c_library
from wheelrail.support.arrays import Array

ROOT = Path(__file__).parents[3]
FLAT = (np.inf, np.inf)
FAST = RigidMotion(
    *(
        replace(twist, velocity=10.0 * twist.velocity, rotation=10.0 * twist.rotation)
        for twist in (CREEP.wheel, CREEP.rail)
    )
)


@dataclass(frozen=True)
class Softening:
    """A user's law: friction that decreases with pressure and slip velocity."""

    mu: float = 0.5
    hard: float = 2e9

    def coefficient(self, w: ufl.core.expr.Expr, p: ufl.core.expr.Expr) -> ufl.core.expr.Expr:
        return self.mu / (1 + p / self.hard) * ufl.exp(-ufl.max_value(w, 0.0) / 10)


@dataclass(frozen=True)
class Rising:
    """A user's law with |x|, tanh and a power."""

    mu: float = 0.2
    more: float = 0.1

    def coefficient(self, w: ufl.core.expr.Expr, p: ufl.core.expr.Expr) -> ufl.core.expr.Expr:
        return self.mu + self.more * ufl.tanh(abs(w)) ** 2


LAWS: dict[str, FrictionLaw] = {
    "coulomb": Coulomb(0.3),
    "falling": FallingFriction(0.3, 0.4, 0.6),
    "polach": FallingFriction.polach(),
    "stribeck": Stribeck(0.4, 0.2, 0.5),
    "own, with pressure": Softening(),
    "own, rising": Rising(),
}
EXPECTED = {
    "coulomb": lambda w, p: 0.3 + 0 * w,
    "falling": lambda w, p: 0.3 * (0.6 * np.exp(-0.6 * w) + 0.4),
    "polach": lambda w, p: 0.55 * (0.6 * np.exp(-0.6 * w) + 0.4),
    "stribeck": lambda w, p: 0.2 + 0.2 * np.exp(-((w / 0.5) ** 2)),
    "own, with pressure": lambda w, p: 0.5 / (1 + p / 2e9) * np.exp(-w / 10),
    "own, rising": lambda w, p: 0.2 + 0.1 * np.tanh(w) ** 2,
}


@dataclass
class Points:
    """Random points: tractions q (2, n) Pa, slips s (2, n), pressures p (n,) Pa, rho (n,) 1/Pa; speed m/s, eps."""

    q: Array
    s: Array
    p: Array
    rho: Array
    speed: float = 20.0
    eps: float = 1e-5

    @classmethod
    def sample(cls, n: int, seed: int) -> Points:
        rng = np.random.default_rng(seed)
        size = 10.0 ** rng.uniform(-5, -1.5, n)
        angle = rng.uniform(0, 2 * np.pi, n)
        return cls(
            rng.normal(size=(2, n)) * 3e8,
            size * np.vstack([np.cos(angle), np.sin(angle)]),
            rng.uniform(1e7, 1.5e9, n),
            10.0 ** rng.uniform(-12.5, -11, n),
        )

    def bound(self, law: str) -> Array:
        return np.asarray(EXPECTED[law](np.hypot(*self.s) * self.speed, self.p) * self.p)


@pytest.mark.parametrize("law", LAWS)
@pytest.mark.parametrize("eps", [0.0, 1e-5])
def test_residual_is_that_of_the_formula(law: str, eps: float) -> None:
    x = Points.sample(192, 1)
    functions = friction_functions(LAWS[law])
    bound, F, norm = functions.residual(x.q, x.s, x.p, x.rho, x.speed, eps)
    y = x.rho * x.q - x.s
    expected = x.q - x.bound(law) * y / np.maximum(np.hypot(*y), x.bound(law) * x.rho + eps)
    np.testing.assert_allclose(bound, x.bound(law), rtol=1e-14)
    np.testing.assert_allclose(F, expected, atol=1e-14 * np.abs(x.q).max())
    assert norm == pytest.approx(float(np.linalg.norm(expected)), rel=1e-13)
    given, norm = functions.bounded_residual(x.q, x.s, x.bound(law), x.rho, eps)
    np.testing.assert_allclose(given, expected, atol=1e-14 * np.abs(x.q).max())
    np.testing.assert_allclose(functions.coefficient(np.hypot(*x.s) * x.speed, x.p) * x.p, bound, rtol=1e-14)


@pytest.mark.parametrize("law", LAWS)
def test_slopes_are_those_of_central_differences(law: str) -> None:
    """Fourth-order differences over steps small against the distance from the kink."""
    x = Points.sample(400, 2)
    functions, index = friction_functions(LAWS[law]), np.arange(400)
    y = np.hypot(*(x.rho * x.q - x.s))
    limit = x.bound(law) * x.rho + x.eps
    away = (np.abs(y - limit) > 0.02 * limit) & (np.hypot(*x.s) > 1e-5)
    assert away.sum() > 300
    slopes = functions.slopes(index, x.q, x.s, x.p, x.rho, x.speed, x.eps)

    def F(**change: Array | float) -> Array:
        z = replace(x, **change)
        return functions.residual(z.q, z.s, z.p, z.rho, z.speed, z.eps)[1]

    size = np.hypot(*x.s)
    steps = {
        "q": 1e-3 * np.minimum(y, limit) / x.rho,
        "s": 1e-3 * np.minimum(size, np.minimum(y, limit)),
        "p": 1e-3 * x.p,
    }
    for name, column, axis in (("q", 0, 0), ("q", 1, 1), ("s", 4, 0), ("s", 5, 1), ("p", 8, None), ("speed", 10, None)):
        h: Array | float = steps[name] if name in steps else 1e-3 * x.speed

        def moved(k: int, name: str = name, axis: int | None = axis, h: Array | float = h) -> Array:
            value = getattr(x, name)
            if axis is None:
                return F(**{name: value + k * h})
            value = value.copy()
            value[axis] += k * h
            return F(**{name: value})

        difference = (8 * (moved(1) - moved(-1)) - (moved(2) - moved(-2))) / (12 * h)
        own = slopes[:, [column, column + (2 if name in "qs" else 1)]].T
        scale = np.abs(x.q).max() / np.asarray(h) * 1e-3  # of a change of F relative to the step
        error = np.abs(difference - own)[:, away] / (scale[away] if np.ndim(scale) else scale)
        assert error.max() < 1e-9, (name, error.max())


@pytest.mark.parametrize("law", LAWS)
@pytest.mark.parametrize("eps", [0.0, 1e-5])
def test_slopes_are_finite_at_every_kink_and_zero_over_zero(law: str, eps: float) -> None:
    """No slip, no traction, no pressure, on the bound, tiny and huge numbers."""
    zero = np.zeros(2)
    cases = [
        (zero, zero, 0.0),
        (zero, zero, 1e9),
        (np.array([1e8, 0.0]), zero, 0.0),
        (zero, np.array([1e-3, 0.0]), 0.0),
    ]
    cases += [(np.array([0.3e9, 0.0]), zero, 1e9), (np.array([0.0, 1e100]), np.array([1.0, 0.0]), 1e60)]
    cases += [
        (np.array([1e-190, 0.0]), np.array([1e-200, 0.0]), 1e-180),
        (np.array([1e8, 1e8]), np.array([1e-300, 0.0]), 1e9),
    ]
    q, s, p = (np.array([case[i] for case in cases], dtype=float) for i in range(3))
    functions, n = friction_functions(LAWS[law]), len(cases)
    q, s, rho = np.ascontiguousarray(q.T), np.ascontiguousarray(s.T), np.full(n, 1e-12)
    for speed in (0.0, 20.0):
        bound, F, _ = functions.residual(q, s, p, rho, speed, eps)
        assert np.isfinite(F).all()
        assert np.isfinite(functions.slopes(np.arange(n), q, s, p, rho, speed, eps)).all()
        assert np.isfinite(functions.bounded_slopes(np.arange(n), q, s, bound, rho, eps)).all()


def test_points_on_the_bound_stick() -> None:
    """gt is strict: where |y| equals b rho the side of sticking is taken, dF/ds without rotation."""
    functions = friction_functions(Coulomb(0.5))
    q, s, p, rho = np.array([[2.0], [0.0]]), np.zeros((2, 1)), np.array([4.0]), np.array([1.0])
    slopes = functions.slopes(np.arange(1), q, s, p, rho, 1.0, 0.0)[0]
    np.testing.assert_array_equal(slopes[:8].reshape(2, 2, 2), [[[0, 0], [0, 0]], [[1, 0], [0, 1]]])


@pytest.mark.parametrize("law", [Penalty(1e15), PowerPenalty(2e17, 1.5), PowerPenalty(1e15, 1.0)])
def test_pressure_and_its_slope(law: NormalLaw) -> None:
    d = np.array([-1e-6, 0.0, 1e-7, 3e-6])
    p, slope = pressure_function(law)(d)
    K, m = (law.stiffness, 1.0) if isinstance(law, Penalty) else (law.stiffness, law.exponent)  # type: ignore[attr-defined]
    np.testing.assert_allclose(p, K * np.maximum(d, 0) ** m, rtol=1e-14)
    np.testing.assert_allclose(slope[2:], m * K * d[2:] ** (m - 1), rtol=1e-14)
    np.testing.assert_array_equal(slope[:2], 0.0)


SPHERE, SIZE = (0.3, 0.3), 1e-3
POSE = hertz_pose(1.5e-5)
UNLIKE = (Material(210e9, 0.1), Material(180e9, 0.3))


@pytest.mark.parametrize("law", [Stribeck(0.4, 0.2, 0.5), Softening()], ids=["stribeck", "pressure"])
@pytest.mark.parametrize("exact", [False, True], ids=["penalty", "exact"])
def test_full_and_condensed_agree_for_own_laws(law: FrictionLaw, exact: bool) -> None:
    laws = ContactLaws(friction=law) if exact else ContactLaws(1e15, law, 1e-5)
    both = [make(TETRAHEDRA, SPHERE, size=SIZE, laws=laws, steels=UNLIKE)(POSE, FAST) for make in (full, condensed)]
    assert all(result.ok for result in both)
    first, second = (result.force for result in both)
    np.testing.assert_allclose(first, second, atol=1e-8 * np.abs(second).max())
    coulomb = condensed(TETRAHEDRA, SPHERE, size=SIZE, laws=replace(laws, friction=0.3), steels=UNLIKE)(POSE, FAST)
    assert np.abs(coulomb.force - second).max() > 0.01 * np.abs(second).max()


@pytest.mark.parametrize("friction", [0.0, 0.3])
def test_full_and_condensed_agree_for_a_nonlinear_penalty(friction: float) -> None:
    laws = ContactLaws(PowerPenalty(2e17, 1.5), friction, 1e-5 if friction else 0.0)
    motion = CREEP if friction else AT_REST
    both = [make(TETRAHEDRA, SPHERE, size=SIZE, laws=laws, steels=UNLIKE)(POSE, motion) for make in (full, condensed)]
    assert all(result.ok for result in both), [result.status for result in both]
    first, second = (result.force for result in both)
    np.testing.assert_allclose(first, second, atol=1e-7 * np.abs(second).max())
    fields = both[1].fields
    assert fields is not None
    exact = condensed(TETRAHEDRA, SPHERE, size=SIZE, laws=ContactLaws(friction=0.0), steels=UNLIKE)(POSE, AT_REST)
    assert second[2] < 0.99 * exact.force[2]


def test_tangent_of_a_nonlinear_penalty_is_the_derivative() -> None:
    laws = ContactLaws(PowerPenalty(2e17, 1.5), 0.3, 1e-3)
    model = condensed(TETRAHEDRA, SPHERE, size=SIZE, laws=laws, steels=UNLIKE)
    result = model(POSE, CREEP)
    step = 1e-9
    high, low = (model(hertz_pose(1.5e-5 + k * step), CREEP) for k in (1, -1))
    difference = (high.force - low.force) / (2 * step)
    np.testing.assert_allclose(-result.tangent()[:3, 2], difference, rtol=1e-4, atol=1e-4 * np.abs(difference).max())


def test_linear_power_penalty_is_the_penalty() -> None:
    linear, power = (
        condensed(TETRAHEDRA, SPHERE, size=SIZE, laws=ContactLaws(law, 0.3, 1e-5), steels=UNLIKE)(POSE, CREEP)
        for law in (Penalty(1e15), PowerPenalty(1e15, 1.0))
    )
    np.testing.assert_allclose(power.force, linear.force, atol=1e-9 * linear.force[2])


def test_strips_and_grid_agree_for_an_own_law() -> None:
    """Their tangential over normal force; strips err by 0.3 %, the grid of 12 points across by 2 %."""
    law, steel = Stribeck(0.4, 0.2, 0.5), (Material(), Material())
    ratios = []
    for points, size in (("lattice", 1e-3), ("grid", 0.25e-3)):
        how = Discretisation(size, bodies="waveguide", points=points)  # type: ignore[arg-type]
        result = hertz_pair((SPHERE, FLAT), steel, ContactLaws(friction=law), how, approach=1.5e-5)(POSE, FAST, None)
        assert result.ok
        ratios.append(result.force[0] / result.force[2])
    assert ratios[0] == pytest.approx(ratios[1], rel=0.02)


def test_models_refuse_what_they_cannot_take() -> None:
    how = Discretisation(1e-3, bodies="half-space")
    strips = hertz_pair((SPHERE, FLAT), (Material(), Material()), ContactLaws(), how, approach=1.5e-5)
    with pytest.raises(ValueError, match="exact normal law"):
        replace(strips, laws=ContactLaws(PowerPenalty(2e17, 1.5)))
    for law in (Stribeck(0.4, 0.2, 0.5), Rising()):
        with pytest.raises(ValueError, match="slip velocity"):
            replace(strips, laws=ContactLaws(friction=law), tangential="shift")
    with pytest.raises(ValueError, match="independent of the pressure"):
        StandardContact(None, ContactLaws(friction=Softening()))  # type: ignore[arg-type]
    assert replace(strips, laws=ContactLaws(friction=Coulomb(0.4)), tangential="shift")


@dataclass(frozen=True)
class Branch(Coulomb):
    def coefficient(self, w: ufl.core.expr.Expr, p: ufl.core.expr.Expr) -> ufl.core.expr.Expr:
        return self.mu if w > 1 else 2 * self.mu


@dataclass(frozen=True)
class Mathematical(Coulomb):
    def coefficient(self, w: ufl.core.expr.Expr, p: ufl.core.expr.Expr) -> ufl.core.expr.Expr:
        return self.mu * math.exp(-w)


@dataclass(frozen=True)
class Gradient(Coulomb):
    def coefficient(self, w: ufl.core.expr.Expr, p: ufl.core.expr.Expr) -> ufl.core.expr.Expr:
        from wheelrail.forms.pointwise import Symbols

        return ufl.SpatialCoordinate(Symbols().new().ufl_domain())[0] * w


@dataclass(frozen=True)
class Vector(Coulomb):
    def coefficient(self, w: ufl.core.expr.Expr, p: ufl.core.expr.Expr) -> ufl.core.expr.Expr:
        return ufl.as_vector([w, p])


@dataclass(frozen=True)
class Negative(Coulomb):
    def coefficient(self, w: ufl.core.expr.Expr, p: ufl.core.expr.Expr) -> ufl.core.expr.Expr:
        return self.mu - w


@dataclass(frozen=True)
class Infinite(Coulomb):
    def coefficient(self, w: ufl.core.expr.Expr, p: ufl.core.expr.Expr) -> ufl.core.expr.Expr:
        return self.mu / p


@dataclass
class NotFrozen:
    mu: float = 0.3

    def coefficient(self, w: ufl.core.expr.Expr, p: ufl.core.expr.Expr) -> ufl.core.expr.Expr:
        return ufl.as_ufl(self.mu)


@dataclass(frozen=True)
class WithText:
    name: str = "dry"

    def coefficient(self, w: ufl.core.expr.Expr, p: ufl.core.expr.Expr) -> ufl.core.expr.Expr:
        return ufl.as_ufl(0.3)


@pytest.mark.parametrize(
    ("law", "error", "message"),
    [
        (Branch(), ValueError, "Branch.coefficient must be an expression in UFL"),
        (Mathematical(), ValueError, "ufl.exp"),
        (Gradient(), ValueError, "SpatialCoordinate"),
        (Vector(), ValueError, "Vector.coefficient must be a scalar"),
        (Negative(), ValueError, "finite and not negative"),
        (Infinite(), ValueError, "finite"),
        (WithText(), TypeError, "must be numbers"),
        (NotFrozen(), TypeError, "frozen"),
    ],
    ids=lambda value: type(value).__name__,
)
def test_wrong_laws_are_refused(law: FrictionLaw, error: type[Exception], message: str) -> None:
    with pytest.raises(error, match=message):
        friction_functions(law)


@pytest.mark.parametrize(
    "make",
    [
        lambda: Coulomb(-0.1),
        lambda: FallingFriction(0.3, 1.2, 0.5),
        lambda: FallingFriction(0.3, 0.4, -1.0),
        lambda: Stribeck(0.4, np.nan, 0.5),
        lambda: Stribeck(0.4, 0.2, 0.0),
        lambda: Penalty(0.0),
        lambda: PowerPenalty(np.inf, 1.5),
        lambda: PowerPenalty(1e15, 0.5),
        lambda: ContactLaws(regularisation=-1.0),
        lambda: ContactLaws(friction=np.nan),
    ],
)
def test_constants_out_of_range_are_refused(make: object) -> None:
    with pytest.raises(ValueError, match="must be"):
        make()  # type: ignore[operator]


def test_dependence_is_read_off_the_expression() -> None:
    depends = {name: friction_functions(law) for name, law in LAWS.items()}
    assert {name for name, f in depends.items() if f.depends_on_speed} == set(LAWS) - {"coulomb"}
    assert {name for name, f in depends.items() if f.depends_on_pressure} == {"own, with pressure"}


def test_source_does_not_depend_on_earlier_symbols() -> None:
    from wheelrail.contact.laws.code_generation import friction_source
    from wheelrail.forms.pointwise import Symbols

    first = friction_source(Stribeck(0.4, 0.2, 0.5))
    domain = Symbols().new().ufl_domain()
    for _ in range(12):  # across powers of ten of UFL's own numbers
        for _ in range(137):
            ufl.Constant(domain)
        ufl.Mesh(domain.ufl_coordinate_element())
        assert friction_source(Stribeck(0.5, 0.1, 5.0)) == first  # constants are arguments: one code for all values


@pytest.fixture
def no_modules() -> Iterator[None]:
    before = os.environ.pop(registry.ALLOWED, None)
    yield
    os.environ.pop(registry.ALLOWED, None)
    if before is not None:
        os.environ[registry.ALLOWED] = before


OWN = """
from dataclasses import dataclass
from pathlib import Path
import ufl
Path(__file__).with_name("imported").touch()

@dataclass(frozen=True)
class Wet:
    mu: float = 0.1
    def coefficient(self, w, p):
        return self.mu * ufl.exp(-w)
"""


@pytest.mark.usefixtures("no_modules")
def test_scene_imports_code_only_if_the_command_line_allows_it(tmp_path: Path) -> None:
    (tmp_path / "own_laws_of_a_test.py").write_text(OWN)
    scene = (ROOT / "scenes" / "hertz.toml").read_text().replace("friction = 0.3", "", 1)
    scene += '\n[friction]\nlaw = "own_laws_of_a_test:Wet"\nmu = 0.2\n'
    (tmp_path / "own.toml").write_text(
        scene.replace('model = "condensed"', 'model = "standard"').replace("surface_size", "# ")
    )

    def run(*options: str) -> subprocess.CompletedProcess[str]:
        command = [sys.executable, "-m", "wheelrail.cli", *options, "contact", "own.toml", "--json"]
        env = {**os.environ, "PYTHONPATH": str(ROOT)}
        return subprocess.run(command, cwd=tmp_path, env=env, capture_output=True, text=True, timeout=300, check=False)

    refused = run()
    assert refused.returncode == 2
    assert "friction.law" in refused.stderr
    assert "--laws own_laws_of_a_test" in refused.stderr
    assert not (tmp_path / "imported").exists()
    allowed = run("--laws", "own_laws_of_a_test")
    assert allowed.returncode == 0, allowed.stderr
    assert (tmp_path / "imported").exists()
    assert '"own_laws_of_a_test:Wet"' in allowed.stdout


@pytest.mark.usefixtures("no_modules")
def test_names_of_laws_and_constants_are_checked() -> None:
    assert registry.friction_law("stribeck", {"static": 0.4, "kinetic": 0.2, "speed": 0.5}) == Stribeck(0.4, 0.2, 0.5)
    assert registry.friction_law("polach-wet", {}) == FallingFriction(0.3, 0.4, 0.2)
    assert registry.normal_law("power", {"stiffness": 2e17, "exponent": 1.5}) == PowerPenalty(2e17, 1.5)
    table = registry.law_table(Softening(hard=1e9))
    assert registry.friction_law(str(table.pop("law")), table) == Softening(hard=1e9)
    for name, constants, key in (
        ("stribek", {}, "law"),
        ("stribeck", {"statik": 0.4}, "statik"),
        ("coulomb", {"mu": "0.3"}, "mu"),
        ("polach-dry", {"mu": 0.3}, "mu"),
        ("os:path", {}, "law"),
    ):
        with pytest.raises(registry.InvalidLaw) as error:
            registry.friction_law(name, constants)
        assert error.value.key == key


@pytest.fixture
def own_cache(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """Folder of libraries, of this test only; no law is known yet."""
    monkeypatch.setenv("WHEELRAIL_CACHE", str(tmp_path))
    monkeypatch.setattr(pointwise, "_codes", {})
    return tmp_path / c_library.FOLDER


def code(law: FrictionLaw) -> FrictionCode:
    pointwise._codes.clear()
    return pointwise._code("friction", law, pointwise.friction_source, FrictionCode)


def test_damaged_libraries_are_compiled_again(own_cache: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    code(law := Stribeck(0.4, 0.2, 0.5))
    (path,) = own_cache.iterdir()
    content = path.read_bytes()
    for damaged in (content[:-1], content[:3000] + b"x" + content[3001:], b""):
        path.unlink()  # it is loaded
        path.write_bytes(damaged)
        code(law)
        assert path.read_bytes()[-32:] == hashlib.sha256(path.read_bytes()[:-32]).digest()
    monkeypatch.setattr(pointwise, "friction_source", None)  # not called again
    assert code(law).depends_on_speed


def test_laws_without_a_cache(own_cache: Path) -> None:
    own_cache.touch()  # is no folder
    w = np.array([0.0, 0.5])
    mu = code(Rising()).coefficient(w, w, np.array([0.2, 0.1]))
    np.testing.assert_allclose(mu, 0.2 + 0.1 * np.tanh(w) ** 2, rtol=1e-15)


def test_libraries_that_others_can_write_are_not_loaded(own_cache: Path) -> None:
    code(law := Stribeck(0.4, 0.2, 0.5))
    (path,) = own_cache.iterdir()
    path.unlink()
    path.write_bytes(b"no library" + hashlib.sha256(b"no library").digest())
    own_cache.chmod(0o777)
    assert code(law).depends_on_speed
    assert path.read_bytes().startswith(b"no library")


def test_processes_compile_at_the_same_time(own_cache: Path) -> None:
    command = "from wheelrail.contact.laws.friction import Stribeck; "
    command += "from wheelrail.contact.laws.pointwise import friction_functions as f; f(Stribeck(0.4, 0.2, 0.5))"
    environment = os.environ | {"PYTHONPATH": str(ROOT)}
    processes = [subprocess.Popen([sys.executable, "-c", command], env=environment) for _ in range(3)]
    assert [process.wait(60) for process in processes] == [0, 0, 0]
    assert len(list(own_cache.iterdir())) == 1


def test_without_a_compiler(own_cache: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(c_library, "compiler", cache(c_library.compiler.__wrapped__))
    monkeypatch.setattr(c_library, "compiler_stamp", cache(c_library.compiler_stamp.__wrapped__))
    monkeypatch.setenv("PATH", str(own_cache))
    with pytest.raises(c_library.CompilerFailed, match=r"install gcc, or name one in \$CC"):
        code(Coulomb())


def test_another_version_of_ufl_has_its_own_library(own_cache: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """Versions of UFL order sums differently: last bits must not depend on which one generated a source first."""
    code(law := Stribeck(0.4, 0.2, 0.5))
    other = own_cache / "ufl.py"
    other.touch()
    monkeypatch.setattr(pointwise, "find_spec", lambda _: type("Spec", (), {"origin": str(other)}))
    code(law)
    assert len(list(own_cache.glob("*.so"))) == 2


def test_laws_without_ufl_and_compiler(own_cache: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    pointwise.store_libraries(own_cache.parent)
    monkeypatch.setattr(pointwise, "find_spec", lambda _: None)
    monkeypatch.setattr(pointwise, "friction_source", None)
    monkeypatch.setattr(c_library, "compiler", None)
    assert [code(law).depends_on_speed for law in pointwise.FRICTION_LAWS] == [False, True, True]
