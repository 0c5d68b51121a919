"""Cost of a contact law in UFL: nanoseconds per point, and time until the compiled functions are ready.

    python -m benchmarks.law

A residual and its 12 slopes per point for every law, and the Jacobian of the friction problem assembled from them;
times of fresh processes with an empty cache (UFL, code generation, compiler) and from the cache.
"""

from __future__ import annotations

import os
import subprocess
import sys
import tempfile
from collections.abc import Callable
from time import perf_counter

import numpy as np

from wheelrail.contact.laws.friction import Coulomb, FallingFriction, FrictionLaw, Stribeck
from wheelrail.contact.laws.linearised_friction import assembled
from wheelrail.contact.laws.pointwise import FrictionFunctions, friction_functions
from wheelrail.support.arrays import Array

LAWS: tuple[FrictionLaw, ...] = (Coulomb(0.3), FallingFriction.polach(), Stribeck(0.4, 0.2, 0.5))
POINTS = (72, 192)
SPEED, EPS = 20.0, 1e-5
READY = """
from time import process_time
import numpy as np
from wheelrail.contact.laws.friction import Coulomb, FallingFriction, Stribeck
from wheelrail.contact.laws.pointwise import friction_functions
ready = process_time()
law = friction_functions({law!r})
q, p, i = np.ones((2, 4)), np.ones(4), np.arange(4)
law.residual(q, q, p, p, 1.0, 0.0)
law.slopes(i, q, q, p, p, 1.0, 0.0)
print(process_time() - ready)
"""


def best(function: Callable[[], object], duration: float = 0.3) -> float:
    """Shortest time s of a call, of as many as take the duration s."""
    function()
    shortest, end = np.inf, perf_counter() + duration
    while perf_counter() < end:
        start = perf_counter()
        function()
        shortest = min(shortest, perf_counter() - start)
    return float(shortest)


def points(n: int) -> tuple[Array, Array, Array, Array]:
    """Tractions (2, n) Pa, slips (2, n), pressures (n,) Pa and rho (n,) 1/Pa."""
    rng = np.random.default_rng(0)
    slip = rng.normal(size=(2, n)) * 10.0 ** rng.uniform(-5, -2, n)
    return rng.normal(size=(2, n)) * 2e8, slip, rng.uniform(0, 1e9, n), np.full(n, 1e-12)


def formula_error(law: FrictionFunctions, n: int) -> float:
    """Largest deviation of F from NumPy's evaluation of the projection, relative to the largest traction."""
    q, s, p, rho = points(n)
    y, b = rho * q - s, law.coefficient(np.hypot(*s) * SPEED, p) * p
    expected = q - b * y / np.maximum(np.hypot(*y), b * rho + EPS)
    return float(np.abs(law.residual(q, s, p, rho, SPEED, EPS)[1] - expected).max() / np.abs(q).max())


def row(law: FrictionLaw, n: int) -> str:
    functions, (q, s, p, rho), index = friction_functions(law), points(n), np.arange(n)
    rng = np.random.default_rng(1)
    slip, slope = rng.normal(size=(2 * n, 2 * n)), rng.normal(size=(n, 2 * n))
    slopes = functions.slopes(index, q, s, p, rho, SPEED, EPS)
    residual = best(lambda: functions.residual(q, s, p, rho, SPEED, EPS)) / n
    derivatives = best(lambda: functions.slopes(index, q, s, p, rho, SPEED, EPS)) / n
    jacobian = best(lambda: assembled(slopes, slip, slope))
    name = type(law).__name__
    error = formula_error(functions, n)
    return f"| {name} | {n} | {1e9 * residual:.0f} | {1e9 * derivatives:.0f} | {1e6 * jacobian:.0f} | {error:.0e} |"


def ready(law: FrictionLaw, folder: str) -> float:
    """Processor time s until residual and slopes of a law have been called in a fresh process.

    Imports are excluded.
    """
    env = {**os.environ, "WHEELRAIL_CACHE": folder}
    done = subprocess.run(
        [sys.executable, "-c", READY.format(law=law)], env=env, capture_output=True, text=True, check=True
    )
    return float(done.stdout)


def main() -> None:
    print("| law | points | residual ns/point | slopes ns/point | Jacobian µs | deviation of F from the formula |")
    print("|---|---|---|---|---|---|")
    for law in LAWS:
        for n in POINTS:
            print(row(law, n))
    print("\n| law | ready with an empty cache s | from the cache ms |\n|---|---|---|")
    for law in LAWS:
        with tempfile.TemporaryDirectory() as folder:
            cold = ready(law, folder)
            warm = min(ready(law, folder) for _ in range(3))
        print(f"| {type(law).__name__} | {cold:.1f} | {1e3 * warm:.0f} |")


if __name__ == "__main__":
    main()
