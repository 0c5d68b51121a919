"""Laws as compiled loops over points, generated from their UFL expressions.

UFL is imported only where no generated source is cached: sources of the laws of this package are stored beside the
machine code, with a hash of what generates them; those of other laws are generated once in each process.
"""

from __future__ import annotations

import hashlib
import sys
from collections.abc import Callable
from contextlib import suppress
from dataclasses import dataclass, field
from functools import cache, cached_property
from importlib.util import find_spec
from pathlib import Path
from types import ModuleType
from typing import Any

import numpy as np
from numba import types

from wheelrail.contact.laws.code_generation import friction_source, pressure_source
from wheelrail.contact.laws.friction import Coulomb, FallingFriction, FrictionLaw, Stribeck, parameters
from wheelrail.contact.laws.normal import NormalLaw, Penalty, PowerPenalty
from wheelrail.support.arrays import Array, Nodes
from wheelrail.support.atomic_file import atomic_file
from wheelrail.support.cache import source_digest
from wheelrail.support.compiled import address, compiled
from wheelrail.support.machine_code import folder

NUMBERS = types.CPointer(types.float64)
COUNTS = types.CPointer(types.int64)
AT_POINTS = types.void(*[NUMBERS] * 4, COUNTS, *[NUMBERS] * 3)
BOUNDS_AT_POINTS = types.void(*[NUMBERS] * 2, COUNTS, *[NUMBERS] * 3)
GENERATORS = Path(__file__).parent, Path(__file__).parents[2] / "forms"  # folders of what generates sources
WITHOUT_UFL = "none"  # in place of UFL's stamp
# A law of each class, with any constants: they are arguments of the generated functions.
FRICTION_LAWS: tuple[FrictionLaw, ...] = Coulomb(), FallingFriction.polach(), Stribeck(0.3, 0.2, 1.0)
NORMAL_LAWS: tuple[NormalLaw, ...] = Penalty(), PowerPenalty(1e12, 2.0)
FRICTION = (
    *("coefficient", "residual", "bounded_residual", "slopes", "bounded_slopes"),
    *("mean_residual", "mean_slopes", "bounds"),
)
VELOCITIES = np.array([0.0, 1e-9, 1e-6, 1e-3, 0.1, 1.0, 10.0, 100.0])  # m/s, at which laws are checked
PRESSURES = np.array([0.0, 1.0, 1e6, 1e9, 5e9])  # Pa, likewise


@dataclass(frozen=True, eq=False)
class FrictionFunctions:
    """Friction law at n points: F = q - b y / max(|y|, b rho + eps), y = rho q - s, b = mu(|s| V, p) p, and its slopes.

    Arguments are q (2, n) Pa, s (2, n) over the rolling speed V = speed m/s, p (n,) Pa, rho (n,) 1/Pa, the regularising
    creepage eps, given bounds b (n,) Pa, and indices (k,) of points.
    """

    code: ModuleType = field(repr=False)
    parameters: Array
    depends_on_speed: bool
    depends_on_pressure: bool

    def coefficient(self, w: Array, p: Array) -> Array:
        """Friction coefficient (n,) at slip velocities w (n,) m/s and pressures p (n,) Pa."""
        return np.asarray(self.code.coefficient(w, p, self.parameters))

    def residual(
        self, q: Array, s: Array, p: Array, rho: Array, speed: float, eps: float
    ) -> tuple[Array, Array, float]:
        """Bounds (n,) Pa, F (2, n) Pa and its norm."""
        bound, F, norm = self.code.residual(q, s, p, rho, speed, eps, self.parameters)
        return bound, F, norm

    @cached_property
    def residual_address(self) -> int:
        """Address of the mean residual of cells for `wheelrail.contact.laws.residual_call`."""
        return address(self.code.mean_residual_at, AT_POINTS)

    @cached_property
    def slopes_address(self) -> int:
        """Address of its slopes, likewise."""
        return address(self.code.mean_slopes_at, AT_POINTS)

    @cached_property
    def bounds_address(self) -> int:
        """Address of the bounds, likewise."""
        return address(self.code.bounds_at, BOUNDS_AT_POINTS)

    def bounded_residual(self, q: Array, s: Array, b: Array, rho: Array, eps: float) -> tuple[Array, float]:
        """F (2, n) Pa and its norm for given bounds."""
        F, norm = self.code.bounded_residual(q, s, b, rho, eps)
        return F, norm

    def slopes(self, index: Nodes, q: Array, s: Array, p: Array, rho: Array, speed: float, eps: float) -> Array:
        """dF/dq, dF/ds (2, 2 each), dF/dp and dF/dV (2 each) in rows (k, 12)."""
        return np.asarray(self.code.slopes(index, q, s, p, rho, speed, eps, self.parameters))

    def bounded_slopes(self, index: Nodes, q: Array, s: Array, b: Array, rho: Array, eps: float) -> Array:
        """As `slopes`, for given bounds: dF/dp = dF/dV = 0."""
        return np.asarray(self.code.bounded_slopes(index, q, s, b, rho, eps))


@dataclass(frozen=True, eq=False)
class PressureFunction:
    """Normal law at n points: pressures (n,) Pa and their slopes (n,) Pa/m from penetrations (n,) m."""

    code: ModuleType = field(repr=False)
    parameters: Array

    def __call__(self, penetration: Array) -> tuple[Array, Array]:
        p, slope = self.code.pressure(penetration, self.parameters)
        return p, slope


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
    code = _code("friction", law, friction_source, FRICTION)
    functions = FrictionFunctions(code, values, code.DEPENDS_ON_SPEED, code.DEPENDS_ON_PRESSURE)
    if not is_shipped(law):
        _check_friction(law, functions)
    return functions


def pressure_function(law: NormalLaw) -> PressureFunction:
    """Compiled functions of a normal law; raises as `friction_functions`."""
    parameters(law)  # raises TypeError
    return _pressure(law)


@cache
def _pressure(law: NormalLaw) -> PressureFunction:
    values = np.array(list(parameters(law).values()))
    function = PressureFunction(_code("normal", law, pressure_source, ("pressure",)), values)
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
    """Whether a law belongs to this package, whose tests check it."""
    return type(law).__module__.startswith("wheelrail.contact.laws.")


_codes: dict[tuple[str, type], ModuleType] = {}


def _code(kind: str, law: Any, source: Callable[[Any], str], functions: tuple[str, ...]) -> ModuleType:
    """Compiled functions of a law's class; parameters are their arguments, so that one code serves all values."""
    key = kind, type(law)
    if key not in _codes:
        text, path = _source(kind, law, source)
        code = ModuleType(f"wheelrail_law_{path.stem}")
        sys.modules[code.__name__] = code  # machine code is loaded by the name of its module
        exec(compile(text, path.name, "exec"), code.__dict__)
        for name in functions:
            setattr(code, name, compiled(getattr(code, name), error_model="numpy"))
        _codes[key] = code
    return _codes[key]


def _source(kind: str, law: Any, source: Callable[[Any], str]) -> tuple[str, Path]:
    """Source of a law's class, from the cache if possible, and its file."""
    place = folder()
    if is_shipped(law):
        path = (place or Path()) / _file_name(f"{kind}_{type(law).__name__}", _ufl_stamp())
        text = _stored(path)
        if text is not None:
            return text, path
        text = _with_checksum(source(law))
    else:
        text = _with_checksum(source(law))
        path = (place or Path()) / f"{kind}_{hashlib.sha256(text.encode()).hexdigest()[:16]}.generated"
    if place is not None and _stored(path) is None:
        with suppress(OSError), atomic_file(path) as part:
            part.write_text(text, encoding="utf-8")
    return text, path


def _file_name(law: str, stamp: str) -> str:
    return f"{law}_{source_digest(*GENERATORS)}_{stamp}.generated"


def store_sources(place: Path) -> None:
    """Write the sources of all laws of this package into a folder of machine code, for processes without UFL.

    Parameters:
        place: becomes `wheelrail.support.compiled.folder` of these processes.

    Raises OSError.
    """
    sources = {f"friction_{type(law).__name__}": friction_source(law) for law in FRICTION_LAWS}
    sources |= {f"normal_{type(law).__name__}": pressure_source(law) for law in NORMAL_LAWS}
    for name, source in sources.items():
        (place / _file_name(name, WITHOUT_UFL)).write_text(_with_checksum(source), encoding="utf-8")


def _ufl_stamp() -> str:
    """Hash that changes with the installed version of UFL, which orders sums; UFL is not imported."""
    spec = find_spec("ufl")
    if spec is None or spec.origin is None:
        return WITHOUT_UFL
    return hashlib.sha256(f"{spec.origin} {Path(spec.origin).stat().st_mtime_ns}".encode()).hexdigest()[:8]


def _with_checksum(text: str) -> str:
    return f"# {hashlib.sha256(text.encode()).hexdigest()}\n{text}"


def _stored(path: Path) -> str | None:
    """Source in a file, which begins with its checksum; None if missing or damaged."""
    with suppress(OSError, ValueError):
        text = path.read_text(encoding="utf-8")
        if text == _with_checksum(text.partition("\n")[2]):
            return text
    return None
