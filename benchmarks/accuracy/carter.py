"""Carter's rolling cylinder, approximated by the strips of a long ellipse."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np

from benchmarks.common.models import Ellipse, carrying, frictional, hertz_model, pressed, rolling, solved
from benchmarks.common.reference_table import TableSection, measure, reference
from wheelrail.bindings._contact import stick_lengths
from wheelrail.contact.analytical.carter import carter
from wheelrail.contact.laws.material import Material
from wheelrail.contact.results.result import ContactResult
from wheelrail.support.arrays import Array

Say = Callable[[str], None]
RATIO = 0.2  # a / b: remaining three-dimensional effect, see `carter_section`
ACROSS = 16.0  # points along the rolling direction
BAND = 0.3  # fraction of b on either side of the centre line that is compared


def strips(pair: Ellipse, friction: float, stick: float) -> tuple[float, Callable[[Array, Array], tuple[Array, Array]]]:
    """Creepage for a stick length (fraction of a) on the centre line, and Carter's traction [Pa] and stick mask at x, y
    [m], with every strip as a cylinder of its own length and pressure.

    The relative radius of a strip is that of a cylinder with the same pressure, R = a E* / (2 p0), the same for all.
    """
    a, b = pair.exact.semi_axes
    E_star = pair.steel.E / (2 - 2 * pair.steel.nu**2)
    radius = 0.5 * a * E_star / pair.exact.peak
    creepage = -friction * a * (1 - stick) / radius

    def at(x: Array, y: Array) -> tuple[Array, Array]:
        width_ratio = np.sqrt(1 - (y / b) ** 2)
        traction, sticks = np.empty_like(x), np.empty(len(x), dtype=bool)
        for s in np.unique(width_ratio):
            of_strip = width_ratio == s
            cylinder = carter(a * s, pair.exact.peak * s, friction=friction, creepage=creepage, radius=radius)
            traction[of_strip] = cylinder.traction(x[of_strip])
            sticks[of_strip] = np.abs(x[of_strip] - cylinder.centre) < cylinder.stick
        return traction, sticks

    return creepage, at


def band(result: ContactResult, b: float) -> tuple[Array, ...]:
    """x, y, area, pressure, longitudinal traction and total traction of the points near the centre line."""
    fields = result.fields
    assert fields is not None
    near = (np.abs(fields.point[:, 1]) < BAND * b) & (fields.pressure > 0)
    along = fields.traction[near, 0]
    return (
        *fields.point[near, :2].T,
        fields.area[near],
        fields.pressure[near],
        along,
        np.hypot(*fields.traction[near].T),
    )


def carter_section(quick: bool, say: Say) -> TableSection:
    """The stick lengths of the reference, on one ellipse."""
    section = TableSection(
        "carter",
        f"Carter: strips within {BAND:g} b of the centre line of an ellipse a / b = {RATIO:g}, {ACROSS:g} points along",
        (
            "stick / a",
            "points",
            "force / mu N",
            "Carter",
            "CONTACT 2D, 50 across",
            "stick area / Carter's",
            "traction RMS",
            "worst, % of mu p0",
        ),
    )
    forces, areas, tractions = [], [], []
    data = reference("carter2d")["cases"]
    friction = 0.3
    pair = Ellipse.of_ratio(RATIO, 0.46, 57e3, Material(2.1e11, 0.3))
    size = pair.size(across=ACROSS)
    depth, _ = pressed(pair, size)
    model = hertz_model(pair, frictional(friction), size)
    unit = friction * pair.exact.peak
    for case in data[1:3] if quick else data:
        stick = case["closed"]["stick"] / case["closed"]["a"]
        say(f"Carter, stick {stick:g} of a")
        creepage, exact = strips(pair, friction, stick)
        result = solved(model, depth, rolling(creepage))
        section.count(carrying(result))
        x, y, area, pressure, along, total = band(result, pair.exact.semi_axes[1])
        expected, _ = exact(x, y)
        force_ratio = float((along @ area) / (friction * pressure @ area))
        exact_means = _mean_over_band(pair, exact, friction)
        shape = -1, model.cells  # of strips in the band
        margin = np.where(total < friction * pressure * (1 - 1e-6), friction * pressure - total, 0.0)
        stick_fraction = float(stick_lengths(margin.reshape(shape), area.reshape(shape)).sum() / area.sum())
        error = 100 * (along - expected) / unit
        rms = float(np.sqrt(error**2 @ area / area.sum()))
        forces.append(100 * (force_ratio - exact_means[0]))
        areas.append(100 * (stick_fraction - exact_means[1]))
        tractions.append(rms)
        row: list[Any] = [
            stick,
            carrying(result),
            force_ratio,
            exact_means[0],
            case["contact"][0]["force"],
            stick_fraction / exact_means[1],
            rms,
        ]
        section.rows.append([*row, float(np.abs(error).max())])
    section.measures = [
        measure("creep force", "% of mu N", forces),
        measure("stick area", "% of the band", areas, worst=3.0),
        measure("traction, RMS of a case", "% of mu p0", tractions, worst=2.0),
    ]
    section.notes = [
        f"not two-dimensional: at a / b = {RATIO:g} the strips interact, by the order of (a / b)^2 = "
        f"{100 * RATIO**2:.0f} % of the compliance; the number of points is proportional to b"
    ]
    return section


def _mean_over_band(
    pair: Ellipse, exact: Callable[[Array, Array], tuple[Array, Array]], friction: float
) -> tuple[float, float]:
    """Carter's force over mu N, and stick area as a fraction of the area of the band."""
    a, b = pair.exact.semi_axes
    y = BAND * b * (np.arange(40) + 0.5) / 40
    t = (np.arange(2000) + 0.5) / 1000 - 1
    x = np.concatenate([a * np.sqrt(1 - (v / b) ** 2) * t for v in y])
    width = np.repeat(np.sqrt(1 - (y / b) ** 2), len(t))
    traction, sticks = exact(x, np.repeat(y, len(t)))
    pressure = pair.exact.pressure(x, np.repeat(y, len(t)))
    return float(traction @ width / (friction * pressure @ width)), float(sticks @ width / width.sum())
