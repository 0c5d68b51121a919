"""Contact models to compare, in groups, each with its rolling cases."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace

from benchmarks.common.measurement import Row
from benchmarks.common.models import EXACT
from benchmarks.error_vs_time.cases import ModelVariant, TimedCase
from benchmarks.error_vs_time.measure import normal_row, rolling_row
from benchmarks.error_vs_time.reference import Reference, Say
from wheelrail.contact.models.discretisation import Bodies, Model
from wheelrail.contact.models.lattice.resolution import LatticeResolution

FINENESSES = ((8, 6), (8, 8), (8, 10), (10, 12), (12, 14), (14, 12), (24, 16))
QUICK_FINENESSES = ((8, 6), (8, 10), (14, 12))
SIZES, QUICK_SIZES = (50, 100, 200, 400, 800), (50, 200)
SOFT = 200  # points, where laws are compared
FULL = 25  # points
STIFFNESSES, REGULARISATIONS = (1e14, 1e15, 1e16), (1e-4, 1e-5, 1e-6)  # N/m3, creepage
PAPER = (1e15, 1e-5)
BODIES: tuple[Bodies, Bodies] = ("half-space", "waveguide")
MODELS: tuple[Model, Model] = ("condensed", "full")
PATIENCE = 1.0  # s that a solve may take to be tried on all cases


def lattices(quick: bool) -> Iterator[ModelVariant]:
    """Strips of a lattice, cold and warm."""
    for bodies in BODIES:
        for warm in (False, True):
            for n in QUICK_FINENESSES if quick else FINENESSES:
                name = f"lattice, {bodies}" + (", warm" if warm else "")
                yield ModelVariant(name, bodies, LatticeResolution(*n), warm=warm)


def grids(quick: bool) -> Iterator[ModelVariant]:
    """Grids with exact laws, by surface size and order of the slip formula."""
    for order in (1, 2):
        for points in QUICK_SIZES if quick else SIZES:
            yield ModelVariant(f"grid, order {order}", "waveguide", points=points, order=order)


def laws(quick: bool) -> Iterator[ModelVariant]:
    """Regularised laws: normal, tangential and both."""
    exact = ModelVariant("grid, soft laws", "waveguide", points=SOFT)
    pairs = [(K, 0.0) for K in STIFFNESSES] + [(EXACT, eps) for eps in REGULARISATIONS] + [PAPER]
    for K, eps in pairs[1::2] if quick else pairs:
        yield replace(exact, stiffness=K, regularisation=eps)


def solids() -> Iterator[ModelVariant]:
    """`full` compared with `condensed` on the same tetrahedral mesh with the paper's laws."""
    for model in MODELS:
        K, eps = PAPER
        yield ModelVariant(f"{model}, solid", "solid", points=FULL, stiffness=K, regularisation=eps, model=model)


def measured(quick: bool, against: Reference, say: Say, *, strips: bool = False) -> Iterator[Row]:
    """Rows of all models, or of strips on half-spaces alone; a row that fails holds `failed` with the reason."""
    every = against.cases[1:]
    known = tuple(case for case in every if case.contact_forces is not None)
    plan = [(lattices(quick), every), (grids(quick), known), (laws(quick), known)]
    if strips:
        plan = [((variant for variant in lattices(quick) if variant.bodies == "half-space"), every)]
    elif not quick:
        plan.append((solids(), ()))
    for variants, cases in plan:
        for variant in variants:
            say(f"{variant.family}, {variant.division}, {variant.laws}")
            yield from rows(variant, against, cases)


def rows(variant: ModelVariant, against: Reference, cases: tuple[TimedCase, ...]) -> Iterator[Row]:
    """Normal contact alone, and rolling."""
    description: Row = {
        "family": variant.family,
        "division": variant.division,
        "laws": variant.laws,
        "order": variant.order,
    }
    try:
        # without friction the order of the slip formula and the regularisation have no effect
        if variant.order == 2 and not (variant.regularisation and variant.stiffness == EXACT):
            yield normal_row(variant)
        yield rolling_row(variant, against, cases, patience=PATIENCE)
    except RuntimeError as error:
        yield {**description, "task": "rolling", "failed": str(error)}
