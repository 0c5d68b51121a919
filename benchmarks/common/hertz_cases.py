"""Hertz's contacts: peak pressure, semi-axes by second moments, area and approach, 20 cases."""

from __future__ import annotations

from functools import cache

import numpy as np

from benchmarks.common.models import Ellipse, carrying, pressed
from benchmarks.common.reference_table import TableSection, measure, reference
from wheelrail.contact.elasticity.waveguide.bodies import block_waveguide
from wheelrail.contact.laws.material import Material

ACROSS = 20.0
WIDTHS = (80.0, 160.0, 320.0)  # half widths in surface sizes, for the correction of finite blocks
RING = (6.0, 7.5)  # distances in surface sizes from a loaded cell: far from it, near for the block


def pair_of(case: dict[str, float], steel: Material) -> Ellipse:
    """The pair of a case: curvatures in 1/mm."""
    return Ellipse((5e-4 / case["A"], 5e-4 / case["B"]), case["Fn"], steel)


def reference_steel() -> Material:
    """Material of the cases, whose file is in mm and MPa."""
    material = reference("hertz")["material"]
    return Material(1e6 * material["E"], material["nu"])


@cache
def block_correction(nu: float, direction: int = 2) -> tuple[float, float]:
    """kappa: a block of half width and depth D, clamped at its bottom, moves kappa F / (E D) less than a half-space
    along a direction (0 along x, 2 normal); and the relative difference between two pairs of widths.

    The near field of a load is that of the half-space; the effect of the far faces is smooth and proportional to 1 / D.
    Two blocks with the same surface mesh differ by kappa / E (1 / D1 - 1 / D2), evaluated on a ring around a loaded
    cell, where the mesh of the cell has no influence; a third block verifies the law. No Hertz contact is used.
    """

    def mean_displacement(width: float) -> float:
        body, grid = block_waveguide((8, 8), Material(1.0, nu), size=1.0, half_width=width)
        distance = np.hypot(*grid.position.reshape(-1, 3)[:, :2].T)
        ring = np.flatnonzero((distance >= RING[0]) & (distance < RING[1]))
        column = body.block(np.append(ring, int(np.argmin(distance))), (direction,))[:-1, -1]
        return float(column.mean())

    c = [mean_displacement(width) for width in WIDTHS]
    coefficients = [(c[i + 1] - c[i]) / (1 / WIDTHS[i] - 1 / WIDTHS[i + 1]) for i in (0, 1)]
    return coefficients[0], coefficients[1] / coefficients[0] - 1


def hertz_section(quick: bool) -> TableSection:
    """All cases at 20 points across the short axis."""
    data = reference("hertz")
    steel = reference_steel()
    kappa, spread = block_correction(steel.nu)
    section = TableSection(
        "hertz",
        f"Hertz, frictionless, {ACROSS:g} points across the short axis: errors in % (CONTACT's in parentheses)",
        ("case", "points", "p0", "(CONTACT)", "a", "b", "(a)", "(b)", "area", "(area)", "approach", "raw approach"),
    )
    errors = []
    for case in data["cases"][:: 4 if quick else 1]:
        pair = pair_of(case, steel)
        size = pair.size(across=ACROSS)
        depth, result = pressed(pair, size)
        patch, exact = result.patches[0], pair.exact
        correction = 2 * kappa * pair.load / (steel.E * pair.half_width(size))
        values = np.array([patch.max_pressure, *patch.semi_axes, patch.area, depth + correction, depth])
        a, b = exact.semi_axes
        e = 100 * (values / np.array([exact.peak, a, b, np.pi * a * b, exact.approach, exact.approach]) - 1)
        errors.append(e)
        contact_errors = {
            name: 100 * value for name, value in case["contact"].items() if name not in ("across", "points")
        }
        section.count(carrying(result))
        cells = [
            e[0],
            contact_errors["p0"],
            e[1],
            e[2],
            contact_errors["a"],
            contact_errors["b"],
            e[3],
            contact_errors["area"],
            e[4],
            e[5],
        ]
        section.rows.append([case["name"], carrying(result), *map(float, cells)])
    e = np.array(errors)
    section.measures = [
        measure("peak pressure", "%", e[:, 0], worst=0.5),
        measure("semi-axes", "%", e[:, 1:3].ravel(), worst=1.0),
        measure("area", "%", e[:, 3]),
        measure("approach", "%", e[:, 4], worst=1.0),
        measure("approach, uncorrected", "%", e[:, 5]),
    ]
    section.notes = [
        f"approach: smaller by kappa F / (E D) for each block, kappa = {kappa:.4f} for nu = {steel.nu:g} from blocks "
        f"of {WIDTHS[0]:g} and {WIDTHS[1]:g} sizes ({100 * spread:+.2f} % from {WIDTHS[1]:g} and {WIDTHS[2]:g})"
    ]
    return section
