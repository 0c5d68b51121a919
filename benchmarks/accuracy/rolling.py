"""Rolling ellipses: Kalker's coefficients, creep curves, and convergence with the number of points."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np

from benchmarks.common.models import Ellipse, carrying, frictional, hertz_model, loads, pressed, rolling, solved
from benchmarks.common.reference_table import TableSection, measure, reference
from wheelrail.contact.analytical.kalker import Name, kalker
from wheelrail.contact.laws.material import Material
from wheelrail.contact.models.lattice.resolution import LatticeResolution
from wheelrail.support.arrays import Array

Say = Callable[[str], None]
POINTS = 285  # of a grid as fine as the lines on the blocks
FINENESS = LatticeResolution()
ROUGHER = tuple(LatticeResolution(*n) for n in ((7, 6), (9, 8), (11, 9), (12, 10)))  # for the slope of the error
RATIOS = (0.3, 0.5, 0.7, 1.0, 1 / 0.7, 2.0, 1 / 0.3)
NAMES: tuple[Name, ...] = ("C11", "C22", "C23", "C33")
STICKING = 1e3  # friction coefficient for full stick


def coefficients(pair: Ellipse, size: float) -> tuple[Array, int]:
    """C11, C22, C23 by spin and by lateral creepage, C33, and the number of points, at full stick, where the law is
    linear and independent of the magnitude of the creepage.
    """
    depth, _ = pressed(pair, size)
    a, b = pair.exact.semi_axes
    # at most 288 points: 24 cells along, as traction is singular where the contact ends, on at most 12 strips
    model = hertz_model(pair, frictional(STICKING), size, strips=12, cells=24)
    c, small = np.sqrt(a * b), 1e-4
    results = [solved(model, depth, rolling(*creep)) for creep in np.diag([small, small, small / c])]
    (fx, *_), (_, fy, mz, _), (_, fy_spin, mz_spin, _) = (
        loads(result) / (pair.shear * c**2 * small) * np.array([1, 1, 1 / c, 1]) for result in results
    )
    return np.array([-fx, -fy, -fy_spin, mz, -mz_spin]), carrying(results[0])


def kalker_section(quick: bool, say: Say) -> TableSection:
    """Ratios from 0.3 to 1 / 0.3."""
    contact = {(k["ratio"], k["nu"]): k for k in reference("creep_curves")["kalker"]}
    section = TableSection(
        "kalker",
        "Kalker's coefficients, full stick: errors in % of Table E.3 (of CONTACT, extrapolated)",
        (
            "a/b",
            "nu",
            "points",
            "C11",
            "C22",
            "C23 spin",
            "C23 lateral",
            "C33",
            "C11 E.3",
            "C22 E.3",
            "C23 E.3",
            "(C11)",
            "(C22)",
            "(C23 spin)",
            "(C33)",
        ),
    )
    errors, contact_deviations = [], []
    cases = [(ratio, 0.25) for ratio in (RATIOS[1::2] if quick else RATIOS)]
    if not quick:
        cases += [(ratio, nu) for nu in (0.0, 0.3) for ratio in (0.5, 1.0, 2.0)]
    for ratio, nu in cases:
        say(f"Kalker a/b {ratio:.2f}, nu {nu:g}")
        pair = Ellipse.of_ratio(ratio, 0.46, 57e3, Material(2.1e11, nu))
        C, points = coefficients(pair, pair.size(points=POINTS))
        section.count(points)
        table = [kalker(name, ratio, nu) for name in NAMES[:3]]
        error = 100 * (C[:4] / np.array([table[0], table[1], table[2], table[2]]) - 1)
        errors.append(error)
        row: list[Any] = [round(ratio, 4), nu, points, *map(float, C), *(float(value) for value in error[:3])]
        if (ratio, nu) in contact:
            contact_values = contact[ratio, nu]
            deviations = 100 * (C[[0, 1, 2, 4]] / np.array([contact_values[name] for name in NAMES]) - 1)
            contact_deviations.append(deviations)
            row += [float(value) for value in deviations]
        section.rows.append(row + [""] * (len(section.columns) - len(row)))
    error = np.array(errors)
    section.measures = [
        measure("C11", "%", error[:, 0], worst=1.0),
        measure("C22", "%", error[:, 1], worst=1.0),
        measure("C23 by spin", "%", error[:, 2], worst=1.0),
        measure("C23 by lateral creepage", "%", error[:, 3], worst=1.0),
        measure("C11, C22, C23 against CONTACT", "%", np.array(contact_deviations)[:, :3].ravel()),
        measure("C33 against CONTACT", "%", np.array(contact_deviations)[:, 3]),
    ]
    section.notes = ["the table is rounded to three digits; CONTACT, extrapolated, is within 1 % of it"]
    return section


def curve_errors(curve: dict[str, Any], fineness: LatticeResolution, every: int = 1) -> tuple[Array, int]:
    """Errors (cases, 3) of Fx, Fy in mu F_n and Mz in mu F_n sqrt(a b), and the number of points under pressure."""
    pair = Ellipse((curve["Rx"] * 1e-3, curve["Ry"] * 1e-3), curve["Fn"], Material(curve["E"] * 1e6, curve["nu"]))
    size = pair.size(points=POINTS)
    depth, _ = pressed(pair, size)
    model = hertz_model(pair, frictional(curve["mu"]), size, strips=fineness.strips, cells=fineness.cells)
    unit = curve["mu"] * pair.load * np.array([1, 1, np.sqrt(np.prod(pair.exact.semi_axes))])
    errors, count = [], 0
    for _, xi, eta, phi, *reference_values in curve["cases"][::every]:
        result = solved(model, depth, rolling(xi, eta, 1e3 * phi))
        count = carrying(result)
        errors.append(loads(result)[:3] / unit - reference_values[:3])
    return np.array(errors), count


def creep_section(quick: bool, say: Say) -> TableSection:
    """All curves at fewer than 300 points, and the order of convergence from coarser ones."""
    curves, every = reference("creep_curves")["curves"], 6 if quick else 1
    section = TableSection(
        "creep",
        f"Creep curves, {'every sixth' if quick else 'all'} of 132 cases: errors in % of mu F_n (moment: "
        "of the largest moment of its ratio)",
        (
            "a/b",
            "points",
            "Fx RMS",
            "Fx worst",
            "Fy RMS",
            "Fy worst",
            "Mz RMS",
            "Mz worst",
            "CONTACT 50 x 40 grid: forces RMS",
            "worst",
            "worst at",
        ),
    )
    force, moment, grid, convergence = [], [], [], []
    for fineness in (*ROUGHER, FINENESS):
        at_points, point_counts = [], []
        for curve in curves:
            say(f"creep curves a/b {curve['ratio']:g}, {fineness.strips} x {fineness.cells} cells")
            e, count = curve_errors(curve, fineness, every if fineness == FINENESS else max(every, 3))
            point_counts.append(count)
            at_points.append(e[:, :2])
            if fineness != FINENESS:
                continue
            cases = curve["cases"][::every]
            reference_values = np.array([case[4:7] for case in cases])
            largest = np.abs([case[6] for case in curve["cases"]]).max()
            contact_errors = np.array([case[8:11] for case in cases]) - reference_values
            e = 100 * e
            e[:, 2] /= largest
            force.append(e[:, :2])
            moment.append(e[:, 2])
            grid.append(100 * contact_errors[:, :2])
            section.count(count)
            case = cases[int(np.abs(e[:, :2]).max(axis=1).argmax())]
            row: list[Any] = [curve["ratio"], count]
            row += [float(f(e[:, k])) for k in range(3) for f in (_rms, _worst)]
            at = f"{case[0]} {case[1]:.1e} {case[2]:.1e} {case[3]:.1e}"
            section.rows.append([*row, _rms(100 * contact_errors[:, :2]), _worst(100 * contact_errors[:, :2]), at])
        all_errors = np.concatenate(at_points)
        convergence.append((float(np.mean(point_counts)), 100 * _rms(all_errors), 100 * _worst(all_errors)))
    e, m = np.concatenate(force), np.concatenate(moment)
    section.measures = [
        measure("Fx", "% of mu F_n", e[:, 0], rms=0.4, worst=1.0),
        measure("Fy", "% of mu F_n", e[:, 1], rms=0.4, worst=1.0),
        measure("both forces", "% of mu F_n", e.ravel(), rms=0.4, worst=1.0),
        measure("spin moment", "% of its largest", m, worst=2.0),
        measure("CONTACT on 50 x 40", "% of mu F_n", np.concatenate(grid).ravel()),
    ]
    n, rms, worst = np.array(convergence).T
    slopes = [float(np.polyfit(np.log(n), np.log(err), 1)[0]) for err in (rms, worst)]
    section.notes = [
        "error by points (RMS / worst, both forces): "
        + ", ".join(f"{p:.0f}: {r:.2f} / {w:.2f}" for p, r, w in convergence)
        + f" %; fitted slopes of the error over the number of points {slopes[0]:.2f} and {slopes[1]:.2f}",
        f"mean of the error, its bias: Fx {e[:, 0].mean():+.3f}, Fy {e[:, 1].mean():+.3f} %; of |F|: "
        f"{_magnitude(curves, every, e):+.3f} % (positive: too large)",
    ]
    return section


def _magnitude(curves: list[dict[str, Any]], every: int, e: Array) -> float:
    """Mean error in the direction of the reference force."""
    forces = np.array([case[4:6] for curve in curves for case in curve["cases"][::every]])
    return float(((e * forces).sum(axis=1) / np.maximum(np.hypot(*forces.T), 1e-9)).mean())


def _rms(e: Array) -> float:
    return float(np.sqrt(np.mean(np.square(e))))


def _worst(e: Array) -> float:
    return float(np.abs(e).max())
