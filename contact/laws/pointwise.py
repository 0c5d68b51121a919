"""Laws as functions in C over points, generated from their UFL expressions.

UFL and the compiler are needed only where no library is cached: those of the laws of this package are stored with a
hash of what generates them; sources of other laws are generated in each process.
"""

from __future__ import annotations

import hashlib
from collections.abc import Callable
from dataclasses import dataclass, field
from functools import cache
from importlib.util import find_spec
from pathlib import Path
from typing import Any, TypeVar

import numpy as np

from wheelrail.bindings._contact import FrictionCode, PressureCode
from wheelrail.contact.laws.code_generation import friction_source, pressure_source
from wheelrail.contact.laws.friction import Coulomb, FallingFriction, FrictionLaw, Stribeck, parameters
from wheelrail.contact.laws.normal import NormalLaw, Penalty, PowerPenalty
from wheelrail.support import c_library
from wheelrail.support.arrays import Array, Nodes
from wheelrail.support.cache import source_digest

Code = TypeVar("Code", FrictionCode, PressureCode)

GENERATORS = Path(__file__).parent, Path(__file__).parents[2] / "forms"  # folders of what generates sources
WITHOUT_UFL = "none"  # in place of the stamp of UFL and the compiler
# A law of each class, with any constants: they are arguments of the generated functions.
FRICTION_LAWS: tuple[FrictionLaw, ...] = Coulomb(), FallingFriction.polach(), Stribeck(0.3, 0.2, 1.0)
NORMAL_LAWS: tuple[NormalLaw, ...] = Penalty(), PowerPenalty(1e12, 2.0)
VELOCITIES = np.array([0.0, 1e-9, 1e-6, 1e-3, 0.1, 1.0, 10.0, 100.0])  # m/s, at which laws are checked
PRESSURES = np.array([0.0, 1.0, 1e6, 1e9, 5e9])  # Pa, likewise


@dataclass(frozen=True, eq=False)
class FrictionFunctions:
    """Friction law at n points: F = q - b y / max(|y|, b rho + eps), y = rho q - s, b = mu(|s| V, p) p, and its slopes.

    Arguments are q (2, n) Pa, s (2, n) over the rolling speed V = speed m/s, p (n,) Pa, rho (n,) 1/Pa, the regularising
    creepage eps, given bounds b (n,) Pa, and indices (k,) of points; arrays of two dimensions in C order.
    """

    code: FrictionCode = field(repr=False)
    parameters: Array

    @property
    def depends_on_speed(self) -> bool:
        return self.code.depends_on_speed

    @property
    def depends_on_pressure(self) -> bool:
        return self.code.depends_on_pressure

    def coefficient(self, w: Array, p: Array) -> Array:
        """Friction coefficient (n,) at slip velocities w (n,) m/s and pressures p (n,) Pa."""
        w, p = np.ascontiguousarray(w, dtype=float), np.ascontiguousarray(p, dtype=float)
        return np.asarray(self.code.coefficient(w, p, self.parameters))

    def residual(
        self, q: Array, s: Array, p: Array, rho: Array, speed: float, eps: float
    ) -> tuple[Array, Array, float]:
        """Bounds (n,) Pa, F (2, n) Pa and its norm."""
        return self.code.residual(q, s, p, rho, speed, eps, self.parameters)

    def bounded_residual(self, q: Array, s: Array, b: Array, rho: Array, eps: float) -> tuple[Array, float]:
        """F (2, n) Pa and its norm for given bounds."""
        return self.code.bounded_residual(q, s, b, rho, eps)

    def slopes(self, index: Nodes, q: Array, s: Array, p: Array, rho: Array, speed: float, eps: float) -> Array:
        """dF/dq, dF/ds (2, 2 each), dF/dp and dF/dV (2 each) in rows (k, 12)."""
        return np.asarray(self.code.slopes(index, q, s, p, rho, speed, eps, self.parameters))

    def bounded_slopes(self, index: Nodes, q: Array, s: Array, b: Array, rho: Array, eps: float) -> Array:
        """As `slopes`, for given bounds: dF/dp = dF/dV = 0."""
        return np.asarray(self.code.bounded_slopes(index, q, s, b, rho, eps))


@dataclass(frozen=True, eq=False)
class PressureFunction:
    """Normal law at n points: pressures (n,) Pa and their slopes (n,) Pa/m from penetrations (n,) m."""

    code: PressureCode = field(repr=False)
    parameters: Array

    def __call__(self, penetration: Array) -> tuple[Array, Array]:
        return self.code.pressure(np.ascontiguousarray(penetration), self.parameters)


def friction_functions(law: FrictionLaw) -> FrictionFunctions:
    """Compiled functions of a friction law.

    Raises TypeError and ValueError for a law that is no dataclass of numbers, cannot be expressed in UFL, is not
    pointwise, or has values or slopes that are not finite, or negative values.
    """
    parameters(law)  # raises TypeError
    return _friction(law)


@cache
def _friction(law: FrictionLaw) -> FrictionFunctions:
    values = np.array(list(parameters(law).values()))
    functions = FrictionFunctions(_code("friction", law, friction_source, FrictionCode), values)
    if not is_shipped(law):
        _check_friction(law, functions)
    return functions


def friction_library(law: FrictionLaw) -> bytes:
    """The library with the functions of a law's class; raises as `friction_functions`."""
    name, text = _named("friction", law, friction_source)
    return c_library.loaded(name, text, lambda path: Path(path).read_bytes())


def pressure_function(law: NormalLaw) -> PressureFunction:
    """Compiled functions of a normal law; raises as `friction_functions`."""
    parameters(law)  # raises TypeError
    return _pressure(law)


@cache
def _pressure(law: NormalLaw) -> PressureFunction:
    values = np.array(list(parameters(law).values()))
    function = PressureFunction(_code("normal", law, pressure_source, PressureCode), values)
    if not is_shipped(law):
        depth = np.array([-1e-3, -1e-9, 0.0, 1e-9, 1e-6, 1e-4])
        p, slope = function(depth)
        if not (np.isfinite(p).all() and np.isfinite(slope).all()):
            raise ValueError(f"{law}: pressure or its slope is not finite at {depth[~np.isfinite(p + slope)][0]:g} m")
        if (p[depth <= 0] != 0).any() or (slope < 0).any():
            raise ValueError(f"{law}: pressure must be zero without penetration and must not decrease with it")
    return function


def _check_friction(law: FrictionLaw, functions: FrictionFunctions) -> None:
    w, p = (part.ravel() for part in np.meshgrid(VELOCITIES, PRESSURES))
    mu = functions.coefficient(w, p)
    wrong = ~(np.isfinite(mu) & (mu >= 0))
    if wrong.any():
        raise ValueError(
            f"{law}: coefficient {mu[wrong][0]:g} at {w[wrong][0]:g} m/s and {p[wrong][0]:g} Pa, "
            "must be finite and not negative"
        )
    zero, n = np.zeros((2, len(w))), len(w)
    s = np.vstack([w, np.zeros(n)])
    slopes = functions.slopes(np.arange(n), zero, s, p, np.full(n, 1e-12), 1.0, 0.0)
    wrong = ~np.isfinite(slopes).all(axis=1)
    if wrong.any():
        raise ValueError(
            f"{law}: slope by slip velocity or pressure not finite at {w[wrong][0]:g} m/s and {p[wrong][0]:g} Pa"
        )


def is_shipped(law: object) -> bool:
    """Whether a law belongs to this package and its tests."""
    return type(law).__module__.startswith("wheelrail.contact.laws.")


_codes: dict[tuple[str, type], Any] = {}


def _code(kind: str, law: Any, source: Callable[[Any], str], load: Callable[[str], Code]) -> Code:
    """Functions of a law's class; constants are their arguments, so that one code serves all values."""
    key = kind, type(law)
    if key not in _codes:
        name, text = _named(kind, law, source)
        _codes[key] = c_library.loaded(name, text, load)
    code: Code = _codes[key]
    return code


def _named(kind: str, law: Any, source: Callable[[Any], str]) -> tuple[str, Callable[[], str]]:
    """Name of the library of a law's class, and its source, which is called if the library is not stored."""
    if is_shipped(law):
        return _name_of(kind, law, _stamp()), lambda: source(law)
    text = source(law)
    return f"{kind}_{hashlib.sha256(text.encode()).hexdigest()[:16]}_{c_library.compiler_stamp()}", lambda: text


def _name_of(kind: str, law: object, stamp: str) -> str:
    return f"{kind}_{type(law).__name__}_{source_digest(*GENERATORS, suffixes=('.py',))}_{stamp}"


def store_libraries(cache_folder: Path) -> None:
    """Put the libraries of all laws of this package into a cache, for processes without UFL and a compiler.

    Raises OSError, CompilerFailed.
    """
    sources: list[tuple[str, object, str]] = [("friction", law, friction_source(law)) for law in FRICTION_LAWS]
    sources += [("normal", law, pressure_source(law)) for law in NORMAL_LAWS]
    for kind, law, text in sources:
        c_library.write(_name_of(kind, law, WITHOUT_UFL), text, cache_folder)


def _stamp() -> str:
    """Hash that changes with the compiler and the version of UFL, which orders sums; UFL is not imported."""
    spec = find_spec("ufl")
    if spec is None or spec.origin is None:
        return WITHOUT_UFL
    ufl = f"{spec.origin} {Path(spec.origin).stat().st_mtime_ns}"
    return f"{hashlib.sha256(ufl.encode()).hexdigest()[:8]}_{c_library.compiler_stamp()}"
