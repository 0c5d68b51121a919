"""Creep forces by the standard contact, and by FASTSIM as CONTACT has it: errors against half-spaces."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from functools import partial
from typing import Literal

import numpy as np

from benchmarks.common.models import frictional, hertz_model, loads, rolling, solved
from benchmarks.common.reference_table import TableSection, measure
from benchmarks.error_vs_time.cases import TimedCase, creep_cases
from benchmarks.error_vs_time.sampled import sampled_cases
from wheelrail.contact.analytical.kalker import kalker
from wheelrail.contact.geometry.rigid_surfaces import RigidQuadrics
from wheelrail.contact.loading.hertz import hertz_pose
from wheelrail.contact.models.standard.model import StandardContact
from wheelrail.support.arrays import Array

Bound = Literal["parabolic", "elliptic"]
GRIDS = (44, 220)  # cells along and across: those of CONTACT's own example
SAMPLED, SEED = 44, 0
FINE = {"bodies": "half-space", "strips": 16, "cells": 20}  # of sampled ellipses: within 0.1 % of mu F_n


def flexibilities(case: TimedCase) -> Array:
    """The three flexibilities (3,) m/Pa, which CONTACT blends into one with growing creepage (its `simpflex`)."""
    pair, (xi, eta, phi) = case.pair, case.creep
    a, b = pair.exact.semi_axes
    c11, c22, c23 = (kalker(name, a / b, pair.steel.nu) for name in ("C11", "C22", "C23"))
    own = a / pair.shear * np.array([8 / (3 * c11), 8 / (3 * c22), np.pi * np.sqrt(a / b) / (4 * c23)])
    share = np.array([xi, eta, 3 * np.pi * a / 32 * phi]) ** 2
    saturated = case.bound / (a * b * pair.shear) * np.array([1 / c11, 1 / c22])
    weight = min(1.0, float(np.hypot(xi, eta) / np.hypot(*saturated)) / 3.0)
    return np.asarray((1 - weight) * own + weight * share.sum() / (share / own).sum())


def contact_fastsim(case: TimedCase, bound: Bound, grid: int, scale: float = 1.0) -> Array:
    """Forces (2,) over mu F_n by FASTSIM in CONTACT, of first order in the size of the cells.

    Parameters:
        case: ellipse and creepages.
        bound: of the tractions, with the load of the ellipse.
        grid: cells along and across of a rectangle.
        scale: of its sides over the axes of the ellipse.
    """
    (xi, eta, phi), flexible = case.creep, flexibilities(case)
    axes = np.array(case.pair.exact.semi_axes)
    step = 2 * scale * axes / grid
    x, y = ((np.arange(grid)[:, None] + 0.5) * step - scale * axes).T
    peak = 1.5 * case.bound / (np.pi * axes.prod())
    along, across = flexible[:2] / flexible[2] * phi
    traction, total = np.zeros((2, grid)), np.zeros(2)
    for at in x[::-1]:  # from the leading edge
        height = np.maximum(1 - (at / axes[0]) ** 2 - (y / axes[1]) ** 2, 0.0)
        most = peak * (4 / 3 * height if bound == "parabolic" else np.sqrt(height))
        slip = np.array([xi - along * y, np.full(grid, eta + across * (at + step[0] / 6))])
        traction = np.where(height > 0.0, traction - step[0] * slip / flexible[:2, None], 0.0)
        size = np.hypot(*traction)
        traction *= np.divide(most, size, out=np.ones(grid), where=size > most)
        total += traction.sum(axis=1)
    return np.asarray(total * step.prod() / case.bound)


def standard(case: TimedCase) -> Array:
    """The same of the standard contact."""
    pair, surfaces = case.pair, RigidQuadrics(case.pair.radii, (np.inf, np.inf))
    model = StandardContact(surfaces, frictional(case.friction), pair.steel, pair.steel, normal="hertz")
    return np.asarray(model(hertz_pose(pair.exact.approach), rolling(*case.creep)).force[:2] / case.bound)


def elastic(case: TimedCase) -> Array:
    """The same of half-spaces on fine strips."""
    model = hertz_model(case.pair, frictional(case.friction), case.pair.size(across=16), **FINE)
    return np.asarray(loads(solved(model, case.pair.exact.approach, rolling(*case.creep)))[:2] / case.bound)


METHODS: dict[str, Callable[[TimedCase], Array]] = {"standard": standard} | {
    f"FASTSIM in CONTACT, {bound}, {grid} x {grid}": partial(contact_fastsim, bound=bound, grid=grid)
    for bound in ("parabolic", "elliptic")
    for grid in GRIDS
}


def kind(case: TimedCase) -> str:
    """Direction of the creepage."""
    names = [name for name, own in zip(("long", "lat", "spin"), case.creep, strict=True) if own]
    return names[0] if len(names) == 1 else "mixed"


def errors(method: Callable[[TimedCase], Array], cases: Sequence[TimedCase], right: Sequence[Array]) -> Array:
    """Errors (cases, 2) in % of mu F_n."""
    return 100 * np.array([method(case) - force for case, force in zip(cases, right, strict=True)])


def fastsim_section(quick: bool, say: Callable[[str], None]) -> TableSection:
    """All curves by the standard contact and by FASTSIM in CONTACT with both bounds and on two grids."""
    curves, sampled = creep_cases(6 if quick else 1), sampled_cases(8 if quick else SAMPLED, SEED)
    kinds = [kind(case) for case in curves]
    say("sampled ellipses on fine strips")
    forces = [elastic(case) for case in sampled]
    section = TableSection(
        "fastsim",
        f"FASTSIM: errors in % of mu F_n, RMS / worst; {len(curves)} cases of CONTACT, {len(sampled)} sampled ellipses "
        "against fine strips",
        ("method", *dict.fromkeys(kinds), "all", "each force", "sampled", "each force"),
    )
    for name, method in METHODS.items():
        say(f"creep forces: {name}")
        e = errors(method, curves, [np.array(case.contact_forces) for case in curves])
        other = errors(method, sampled, forces)
        parts = [np.hypot(*e[[own == one for own in kinds]].T) for one in dict.fromkeys(kinds)]
        parts += [np.hypot(*e.T), e.ravel(), np.hypot(*other.T), other.ravel()]
        section.rows.append([name, *(f"{np.sqrt((part**2).mean()):.2f} / {np.abs(part).max():.1f}" for part in parts)])
        section.measures.append(measure(name, "% of mu F_n", np.hypot(*e.T)))
        section.measures.append(measure(f"{name}, sampled", "% of mu F_n", np.hypot(*other.T)))
    section.notes = ["without 'each force': size of the vector of both"]
    return section
