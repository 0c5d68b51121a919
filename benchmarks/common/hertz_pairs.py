"""Hertz pairs of the benchmarks, their reference solutions, and one timed solve of a pair under its load."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from functools import cached_property
from statistics import median
from time import perf_counter
from typing import TypeVar

import numpy as np

from wheelrail.contact.analytical.hertz import Hertz, hertz, modulus
from wheelrail.contact.geometry.quadric_pair import curvature
from wheelrail.contact.kinematics.frames import RigidMotion, Twist
from wheelrail.contact.laws.material import Material
from wheelrail.contact.laws.parameters import ContactLaws
from wheelrail.contact.loading.hertz import hertz_pose, hertz_under_load
from wheelrail.contact.models.builders import hertz_pair
from wheelrail.contact.models.discretisation import Bodies, Discretisation, Model
from wheelrail.contact.models.wheelset import ContactModel
from wheelrail.contact.results.result import ContactResult, Patch
from wheelrail.support.arrays import Array
from wheelrail.support.cache import cache_folder

STEEL = Material(2.1e11, 0.3)
REPEATS = 9

# Creep force of a circular patch over mu F_n, by creepage in units of mu F_n / (a b G C11) with C11 = 4.300 (nu = 0.3):
# steady rolling computed with CONTACT (E. Vollebregt, revision 2707 of 2025-07-23), extrapolated, within 0.0016
CREEP_CURVE = ((0.5, 0.42831), (0.75, 0.59085), (1.0, 0.72184), (1.5, 0.89888))
C11 = 4.300

T = TypeVar("T")


@dataclass(frozen=True)
class Pair:
    """Principal radii (x, y) [m] of both bodies and the load [N]."""

    name: str
    upper: tuple[float, float]
    lower: tuple[float, float]
    load: float

    @cached_property
    def exact(self) -> Hertz:
        """Hertz's solution on half-spaces."""
        A, B = curvature(self.upper) + curvature(self.lower)
        return hertz(A, B, modulus((STEEL.E, STEEL.nu), (STEEL.E, STEEL.nu)), force=self.load)

    def size(self, across: float) -> float:
        """Surface size [m] for a number of points across the short axis."""
        return 2 * min(self.exact.semi_axes) / across

    def model(
        self, across: float, laws: ContactLaws, *, model: Model = "condensed", bodies: Bodies = "solid"
    ) -> ContactModel:
        """Contact model of the meshed pair."""
        how = Discretisation(self.size(across), model=model, bodies=bodies, points="grid")
        return hertz_pair((self.upper, self.lower), (STEEL, STEEL), laws, how, load=self.load)


CIRCULAR = Pair("circular, 10 kN", (0.3, 0.3), (np.inf, np.inf), 10e3)
ELLIPTIC = Pair("elliptic, 50 kN", (0.46, 0.3), (np.inf, 0.3), 50e3)
HEAVY = Pair("elliptic, 60 kN", (0.46, 0.3), (np.inf, 0.3), 60e3)


def rolling(creepage: float, speed: float = 10.0) -> RigidMotion:
    """Both materials move backwards at the speed [m/s], the upper one slower by the longitudinal creepage."""
    forward, zero = np.array([speed, 0.0, 0.0]), np.zeros(3)
    upper, lower = (Twist((-1 + part) * forward, zero, zero) for part in (0.5 * creepage, -0.5 * creepage))
    return RigidMotion(upper, lower)


def creep_force(pair: Pair, creepage: float, friction: float) -> float:
    """Reference creep force [N] of a circular pair in the middle of the curve."""
    a, b = pair.exact.semi_axes
    s = creepage * a * b * STEEL.E / (2 + 2 * STEEL.nu) * C11 / (friction * pair.load)

    # Vermeulen and Johnson's curve is within 0.03 of CONTACT's: only the difference is interpolated
    def rough(s: Array | float) -> Array:
        return np.asarray(1 - (1 - s / 3) ** 3)

    creepages, force = np.array(CREEP_CURVE).T
    if not creepages[0] <= s <= creepages[-1]:
        raise ValueError(f"creepage {s:g} in units of the linear law, tabulated from {creepages[0]} to {creepages[-1]}")
    return float(friction * pair.load * (rough(s) + np.interp(s, creepages, force - rough(creepages))))


@dataclass(frozen=True)
class Timed:
    """A pair under its load: result, approach m, seconds cold (None when everything was in the cache already), from the
    cache, and per solve without initial guess.
    """

    result: ContactResult
    approach: float
    cold: float | None
    cached: float
    solve: float

    @property
    def patch(self) -> Patch:
        return self.result.patches[0]

    @property
    def points(self) -> int:
        """Number of points under pressure."""
        fields = self.result.fields
        return 0 if fields is None else int((fields.pressure > 0).sum())


def timed(pair: Pair, across: float, laws: ContactLaws, motion: RigidMotion, bodies: Bodies = "solid") -> Timed:
    """The condensed model of a pair, solved under its load."""

    def start() -> ContactModel:
        model = pair.model(across, laws, bodies=bodies)
        model(hertz_pose(pair.exact.approach), motion, None)
        return model

    before = stored()
    cold, model = clocked(start)
    computed = stored() > before
    cached, _ = clocked(start)
    solution = hertz_under_load(model, motion, pair.load, expected=pair.exact.approach)
    solves = [clocked(lambda: model(hertz_pose(solution.depth), motion, None)) for _ in range(REPEATS)]
    solve = median(seconds for seconds, _ in solves)
    return Timed(solves[-1][1], solution.depth, cold if computed else None, cached, solve)


def stored() -> int:
    """Number of files in the cache."""
    return sum(path.is_file() for path in cache_folder().rglob("*"))


def clocked(call: Callable[[], T]) -> tuple[float, T]:
    """Seconds of a call, and its result."""
    start = perf_counter()
    value = call()
    return perf_counter() - start, value


def errors(pair: Pair, timed_pair: Timed) -> Array:
    """Relative errors of peak pressure, semi-axes along x and y, and approach, relative to Hertz."""
    exact, patch = pair.exact, timed_pair.patch
    measured = np.array([patch.max_pressure, *patch.semi_axes, timed_pair.approach])
    return np.asarray(measured / np.array([exact.peak, *exact.semi_axes, exact.approach]) - 1)
