"""A population of Hertz pairs: radii, bodies, loads, creepages, shifts and models at random, each result judged by
Hertz's closed form, the laws of contact and friction, its mirror image, and itself at twice the size.

python -m benchmarks.population.pairs [--count N] [--seed S] [--only SEED ...] [--failures FILE]

Pair k of seed S is drawn from the integer S + k.
"""

from __future__ import annotations

import argparse
import logging
import re
import warnings
from collections.abc import Iterator
from dataclasses import dataclass, replace
from pathlib import Path
from time import process_time
from typing import Any

import numpy as np
from scipy.optimize import brentq
from scipy.special import elliprd, elliprf

from benchmarks.common.machine import machine_description
from benchmarks.ellipses.sample import YOUNG, rolling_ellipse
from benchmarks.population.checks import LOAD, finite, laws, sums
from benchmarks.population.judge import MIRROR, Kind, Verdict
from benchmarks.population.report import details, reproduction, show
from benchmarks.population.results import SideResult, side_result
from wheelrail.contact.laws.friction import FallingFriction

HEADER = """import wheelrail as wr
from numpy import inf
from wheelrail.contact.laws.friction import Coulomb, FallingFriction
"""
SIZE = 2.0  # of the pair that is scaled
STRIPS, CELLS = 1.44, 0.5  # over n^2: 1 % of the peak on 12 strips; of the boundary, in cells
ELASTIC = 5e-3  # of force and approach on strips
BLOCK = (
    40.0  # semi-axes, half width of blocks: a force displaces what is farther by 1 / (0.75 pi BLOCK) of the approach
)
VIRTUAL = 0.55  # of the approach, penetration of Kik and Piotrowski
SUMMED = 1e-2  # of forces and areas, by the cells of the standard contact
SCALED = 1e-4  # of the load: a last step of 1e-5 of the tractions
SMALLEST = 5e-5  # m, of the cells of a grid
LARGEST = 0.19  # of E*: peak pressures beyond it are no contact of half-spaces
OVERLOADED = re.compile(r"too deep for half-spaces: \S+ GPa are above")


@dataclass(frozen=True)
class Pair:
    """Arguments of `wheelrail.Hertz` and of its `solve`."""

    seed: int
    pair: dict[str, Any]
    solve: dict[str, Any]

    def __str__(self) -> str:
        own, solve = (", ".join(f"{k}={v!r}" for k, v in part.items()) for part in (self.pair, self.solve))
        return f"wr.Hertz({own}).solve({solve})"

    @property
    def kind(self) -> str:
        """Contact model in short."""
        own = self.pair
        if own.get("model") == "standard":
            return "standard, hertz" if own.get("normal") == "hertz" else "standard, virtual penetration"
        return f"{own['bodies']} {own.get('points', 'lattice')}"

    @property
    def friction(self) -> float:
        """Largest coefficient of friction."""
        law = self.pair["friction"]
        return float(getattr(law, "mu", law))

    @property
    def modulus(self) -> float:
        """Contact modulus E*, Pa."""
        return float(
            1.0 / sum((1.0 - body["nu"] ** 2) / body["E"] for body in (self.pair["upper"], self.pair["lower"]))
        )

    @property
    def ellipse(self) -> Ellipse:
        """Hertz's closed form, or that of a virtual penetration: a semi-ellipsoid on an ellipse of the same shape."""
        bodies, modulus = (self.pair["upper"], self.pair["lower"]), self.modulus
        A, B = (0.5 * sum(1.0 / body["radii"][k] for body in bodies) for k in range(2))
        load, approach = self.solve.get("load"), self.solve.get("approach")
        exact = Ellipse.of(A, B, modulus, load, approach)
        if "virtual" not in self.kind:
            return exact
        size = float(np.sqrt(VIRTUAL * exact.approach / np.sqrt(A * B) / np.prod(exact.axes)))
        exact = exact if load is None else Ellipse.of(A, B, modulus, load / size, None)
        a, b = exact.axes
        return Ellipse((size * a, size * b), exact.peak / size, exact.approach, size * exact.force)

    def mirrored(self) -> Pair:
        """The mirror image in y = 0."""
        solve = dict(self.solve)
        for key, signs in (("creepage", (1.0, -1.0, -1.0)), ("shift", (1.0, -1.0))):
            if key in solve:
                solve[key] = tuple((np.array(signs) * solve[key]).tolist())
        return replace(self, solve=solve)

    def scaled(self) -> Pair:
        """The pair SIZE times as large, with the same pressures."""
        own, solve = dict(self.pair), dict(self.solve)
        for name in ("upper", "lower"):
            own[name] = {**own[name], "radii": tuple(SIZE * r for r in own[name]["radii"])}
        if "surface_size" in own:
            own["surface_size"] *= SIZE
        for key, power in (("load", 2), ("approach", 1)):
            if key in solve:
                solve[key] *= SIZE**power
        if "creepage" in solve:
            solve["creepage"] = tuple((np.array(solve["creepage"]) / (1.0, 1.0, SIZE)).tolist())
        if "shift" in solve:
            solve["shift"] = tuple((SIZE * np.array(solve["shift"])).tolist())
        return replace(self, pair=own, solve=solve)

    def solved(self) -> SideResult:
        """Result by the public class. Raises what it raises."""
        import wheelrail as wr

        return side_result(wr.Hertz(**self.pair).solve(**self.solve).data, "contact")


@dataclass(frozen=True)
class Ellipse:
    """Contact of two half-spaces with the gap A x^2 + B y^2: semi-axes m, peak pressure Pa, approach m, force N.

    The pressure p0 sqrt(1 - x^2/a^2 - y^2/b^2) displaces both surfaces by
    p0 a b / 2E* int_0^inf (1 - x^2/(a^2 + w) - y^2/(b^2 + w)) / sqrt((a^2 + w) (b^2 + w) w) dw,
    integrals of Carlson.
    """

    axes: tuple[float, float]
    peak: float
    approach: float
    force: float

    @classmethod
    def of(cls, A: float, B: float, modulus: float, load: float | None, approach: float | None) -> Ellipse:
        """The contact under a load N, or at an approach m."""

        def excess(logarithm: float) -> float:
            k = np.exp(2.0 * logarithm)  # (b / a)^2
            return float(np.log(elliprd(0.0, k, 1.0) / elliprd(0.0, 1.0, k) * B / A))

        b = float(np.exp(brentq(excess, -12.0, 12.0, xtol=1e-14)))  # of a = 1, as p0 = modulus: gap and force scale
        unit_A, unit_approach, unit_force = b / 3.0 * elliprd(0.0, b * b, 1.0), b * elliprf(0.0, 1.0, b * b), b
        # lengths L, pressures P modulus: A = P unit_A / L, approach = P L unit_approach, force = P L^2 2/3 pi b modulus
        if load is not None:
            L = (load * unit_A / (A * 2.0 / 3.0 * np.pi * unit_force * modulus)) ** (1.0 / 3.0)
        else:
            assert approach is not None
            L = (approach * unit_A / (A * unit_approach)) ** 0.5
        P = A * L / unit_A
        force = P * L * L * 2.0 / 3.0 * np.pi * b * modulus
        return cls((float(L), float(L * b)), float(P * modulus), float(P * L * unit_approach), float(force))


def drawn(seed: int) -> Pair:
    """Pair of a seed."""
    case, random = rolling_ellipse(seed, 0), np.random.default_rng((seed, 1))
    chance = random.random

    upper, lower = [], []
    for radius in case.pair.radii:
        share = random.choice([0.0, random.uniform(0.05, 0.95), random.uniform(-1.0, -0.05)])  # on the lower body
        upper.append(_short(radius / (1.0 - share)))
        lower.append(_short(radius / share) if share else np.inf)
    nu = [_short(case.pair.steel.nu)] * 2
    young = [YOUNG] * 2
    if chance() < 0.3:  # other bodies of which none pushes the other aside: (1 - 2 nu) (1 + nu) / E are equal
        nu[1] = _short(random.uniform(0.2, 0.4))
        young[1] = YOUNG * (1.0 - 2.0 * nu[1]) * (1.0 + nu[1]) / (1.0 - 2.0 * nu[0]) / (1.0 + nu[0])
    bodies = [{"radii": tuple(r), "E": E, "nu": n} for r, E, n in zip((upper, lower), young, nu, strict=True)]
    arguments: dict[str, Any] = {"upper": bodies[0], "lower": bodies[1]}
    frictionless = chance() < 0.2
    arguments["friction"] = 0.0 if frictionless else case.friction
    solve: dict[str, Any] = {"load": _short(case.pair.load)}
    exact = Pair(seed, arguments | {"bodies": "half-space"}, solve).ellipse
    if chance() < 0.3:
        solve = {"approach": _short(exact.approach)}
    kind = random.choice(["half-space", "standard", "waveguide", "grid"], p=[0.5, 0.38, 0.08, 0.04])
    size = _short(2.0 * min(exact.axes) / random.uniform(8.0, 16.0))
    if kind == "grid" and size < SMALLEST:
        kind = "half-space"
    if kind == "standard":
        choices = (("normal", "hertz", "kik-piotrowski"), ("tangential", "fastsim", "polach"))
        picked = {name: str(random.choice([*own, ""])) for name, *own in choices}
        arguments |= {"model": "standard", **{name: value for name, value in picked.items() if value}}
    elif kind == "grid":
        arguments |= {"bodies": "waveguide", "points": "grid", "surface_size": size}
    else:
        arguments["bodies"] = str(kind)
        if chance() < 0.65:
            arguments |= {"strips": int(random.integers(4, 15)), "cells": int(random.integers(6, 15))}
    if kind != "standard" and not isinstance(arguments["friction"], FallingFriction) and chance() < 0.15:
        most, angle = exact.approach * Pair(seed, arguments, solve).friction, random.uniform(0.0, 2.0 * np.pi)
        shift = random.uniform(0.0, 2.0) * most * np.array([np.cos(angle), np.sin(angle)])
        return Pair(seed, arguments, solve | {"shift": tuple(_short(value) for value in shift)})
    creepage = tuple(_short(value) for value in case.creepages)
    return Pair(seed, arguments, solve | {"creepage": creepage, "speed": _short(case.speed)})


def _short(value: float) -> float:
    """Six digits."""
    return float(f"{value:.6g}")


def faults(own: Pair, result: SideResult) -> Iterator[str]:
    """What of a converged result is wrong."""
    exact, model, allowed = own.ellipse, own.pair.get("model"), bands(own, result)
    if found := [*finite(result)]:
        yield from found
        return
    yield from sums(result)
    polach = own.pair.get("tangential") == "polach"
    yield from laws(result, own.friction, model == "standard" and not polach, dissipates=not polach)
    if "load" in own.solve and abs(result.force[2] - exact.force) > LOAD * exact.force:
        yield f"vertical force {result.force[2]:.6g} N where {exact.force:g} N is asked for"
    for name, (value, right) in figures(own, result).items():
        off = abs(value / right - 1.0)
        if off > allowed[name]:
            yield f"{name} {value:.6g} where Hertz has {right:.6g}, {100 * off:.2f} % off"


def figures(own: Pair, result: SideResult) -> dict[str, tuple[float, float]]:
    """Force N, approach m, peak Pa and area m2 of a result and of Hertz."""
    exact = own.ellipse
    area = float(result.area[result.pressure > 0.0].sum())
    return {
        "force": (float(result.force[2]), exact.force),
        "approach": (result.approach, exact.approach),
        "peak": (float(result.peak.max()), exact.peak),
        "area": (area, float(np.pi * exact.axes[0] * exact.axes[1])),
    }


def bands(own: Pair, result: SideResult) -> dict[str, float]:
    """Differences to the closed form that the discretisation explains."""
    names = ("force", "approach", "peak", "area")
    if own.pair.get("model") == "standard":
        return dict.fromkeys(names, SUMMED)
    if own.pair.get("points") == "grid":
        n = 2.0 * min(own.ellipse.axes) / own.pair["surface_size"]
        square, area = STRIPS / n**2, (1.0 + 2.0 * CELLS / n) ** 2 - 1.0
        elastic = ELASTIC + square
    else:
        n = float(result.strips.max())
        square, area, elastic = STRIPS / n**2, 1.7 / n**1.5, ELASTIC  # of an ellipse, that of its outermost strip
    far = 1.0 / (0.75 * np.pi * BLOCK) if own.pair["bodies"] == "waveguide" else 0.0
    return {"force": elastic + 1.5 * far, "approach": elastic + far, "peak": square + far, "area": area + far}


def different(own: Pair, result: SideResult) -> Iterator[str]:
    """Differences to the mirror image and to the pair at another size."""
    flipped, larger = own.mirrored().solved(), own.scaled().solved()
    for name, other, size, sign in (
        ("its mirror image", flipped, 1.0, -1.0),
        ("itself at twice the size", larger, SIZE**2, 1.0),
    ):
        if other.status != "converged":
            yield f"{name}: {other.status}"
            continue
        off = float(np.abs(other.force / size * (1.0, sign, 1.0) - result.force).max()) / result.load
        meshed = own.pair.get("bodies") == "waveguide"  # by triangles, which are no mirror images
        if off > (SCALED if meshed or size > 1.0 else MIRROR):
            yield f"the force differs by {off:.1e} from that of {name}"


def judged(seed: int) -> Verdict:
    """Verdict on the pair of a seed."""
    own, began = drawn(seed), process_time()
    sides = {}
    try:
        result = own.solved()
        seconds = process_time() - began
        sides["contact"] = f"{result.status}; {figures(own, result) if result.status == 'converged' else ''}"
        if result.status != "converged":
            explained = OVERLOADED.search(result.status) and own.ellipse.peak > LARGEST * own.modulus
            kind: Kind = "explained failure" if explained else "unexplained failure"
            reason = "beyond the pressure of half-spaces" if explained else result.status
        else:
            reason = "; ".join([*faults(own, result), *different(own, result)])
            kind = "wrong" if reason else "right"
    except Exception as error:
        seconds = process_time() - began
        clear = isinstance(error, ValueError) and "\n" not in str(error)
        kind, reason = "unexplained failure" if clear else "wrong", f"{type(error).__name__}: {error}"
    return Verdict(seed, str(own), kind, reason, (seconds, process_time() - began), own.kind, sides)


def main() -> None:
    """Judges and prints."""
    parser = argparse.ArgumentParser(prog="python -m benchmarks.population.pairs", description=__doc__)
    parser.add_argument("--count", type=int, default=500, metavar="N", help="pairs (500)")
    parser.add_argument("--seed", type=int, default=0, metavar="S", help="of the first pair (0)")
    parser.add_argument("--only", type=int, nargs="+", default=[], metavar="SEED", help="these pairs, with details")
    parser.add_argument("--failures", type=Path, default=Path("population_pairs.txt"), metavar="FILE")
    arguments = parser.parse_args()
    logging.disable(logging.WARNING)
    warnings.simplefilter("ignore")
    seeds = arguments.only or range(arguments.seed, arguments.seed + arguments.count)
    found: list[Verdict] = []
    with arguments.failures.open("w", encoding="utf-8", buffering=1) as file:
        file.write(HEADER)
        for seed in seeds:
            found.append(judged(seed))
            print(reproduction(found[-1]), end="", file=file)
            if arguments.only:
                print(details(found[-1]), flush=True)
    print(f"{machine_description()}; {len(found)} pairs from seed {seeds[0]}\n\n{show(found)}")


if __name__ == "__main__":
    main()
