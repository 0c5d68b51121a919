"""Cattaneo's sphere: normal load, then a tangential displacement in one step."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from typing import Any

import numpy as np

from benchmarks.common.hertz_cases import block_correction
from benchmarks.common.models import Ellipse, carrying, frictional, hertz_model, pressed, solved
from benchmarks.common.reference_table import TableSection, measure, reference
from wheelrail.contact.analytical.cattaneo import cattaneo
from wheelrail.contact.kinematics.frames import RigidMotion, Twist
from wheelrail.contact.laws.material import Material
from wheelrail.contact.models.lattice.resolution import LatticeResolution
from wheelrail.contact.models.wheelset import ContactModel
from wheelrail.contact.results.result import ContactResult

Say = Callable[[str], None]
POINTS = 285  # of a grid as fine as the lines on the blocks
FINENESS = LatticeResolution(32, 24)
OFFSETS = 0.0, 0.5  # of the strips, in their width: stick areas of few strips scatter with it


def push(distance: float) -> RigidMotion:
    """Tangential displacement [m] of the upper body along x."""
    origin = np.zeros(3)
    return RigidMotion(Twist(np.array([distance, 0.0, 0.0]), origin, origin), Twist(origin, origin, origin))


def pushed(model: ContactModel, depth: float, force: float, start: float) -> tuple[float, ContactResult]:
    """Tangential displacement [m] and result for a tangential force [N], by secant steps from an initial guess [m]."""
    points = [(0.0, 0.0)]
    distance = start
    for _ in range(12):
        result = solved(model, depth, push(distance))
        reached = -float(result.force[0])
        if abs(reached / force - 1) < 1e-6:
            return distance, result
        (d0, f0), points = points[-1], [*points, (distance, reached)]
        distance += (force - reached) * (distance - d0) / (reached - f0)
    raise RuntimeError(f"no tangential displacement for {force:g} N within 12 steps")


def cattaneo_section(quick: bool, say: Say) -> TableSection:
    """The reference's spheres of steel under its forces, and the polyethylene one."""
    section = TableSection(
        "cattaneo",
        "Cattaneo and Mindlin: a sphere under a tangential force, errors relative to the closed form",
        (
            "case",
            "offset",
            "points",
            "stick radius mm",
            "closed",
            "CONTACT",
            "stick area %",
            "traction RMS, % of mu p0",
            "worst",
            "shift %",
            "CONTACT's %",
            "raw shift %",
        ),
    )
    areas, of_patch, tractions, shifts = [], [], [], []
    for case in reference("cattaneo")["cases"][1 if quick else 0 :: 2 if quick else 1]:
        say(f"Cattaneo {case['name']}")
        pair = Ellipse((1e-3 * case["R"], 1e-3 * case["R"]), case["Fn"], Material(1e6 * case["E"], case["nu"]))
        exact = cattaneo(
            pair.exact.semi_axes[0],
            pair.exact.peak,
            friction=case["mu"],
            G=pair.shear,
            nu=case["nu"],
            force=case["force"],
        )
        size = pair.size(points=POINTS)
        depth, _ = pressed(pair, size)
        model = replace(hertz_model(pair, frictional(case["mu"]), size), tangential="shift", resolution=FINENESS)
        correction = 2 * block_correction(case["nu"], 0)[0] * exact.force / (pair.steel.E * pair.half_width(size))
        for offset in OFFSETS:
            distance, result = pushed(replace(model, offset=offset), depth, exact.force, exact.shift)
            section.count(carrying(result))
            fields = result.fields
            assert fields is not None
            area = result.patches[0].stick_area
            r = np.hypot(*fields.point[:, :2].T)
            error = 100 * (-fields.traction[:, 0] - exact.traction(r)) / (case["mu"] * exact.peak)
            inside = r < exact.radius
            rms = float(np.sqrt((error**2 * fields.area)[inside].sum() / fields.area[inside].sum()))
            corrected, raw = (100 * (value / exact.shift - 1) for value in (distance + correction, distance))
            excess = area - np.pi * exact.stick**2
            areas.append(100 * excess / (np.pi * exact.stick**2))
            of_patch.append(100 * excess / (np.pi * exact.radius**2))
            tractions.append(rms)
            shifts.append(corrected)
            finest = case["contact"][-1]
            row: list[Any] = [case["name"], offset, carrying(result), 1e3 * np.sqrt(area / np.pi), 1e3 * exact.stick]
            row += [finest["stick"], areas[-1], rms, float(np.abs(error[inside]).max()), corrected]
            section.rows.append([*map(_plain, row), 100 * (1e-3 * finest["shift"] / exact.shift - 1), raw])
    section.measures = [
        measure("stick area", "%", areas, worst=3.0),
        measure("stick area", "% of the patch", of_patch),
        measure("traction, RMS of a case", "% of mu p0", tractions, worst=2.0),
        measure("shift", "%", shifts),
    ]
    section.notes = [
        "the closed form neglects lateral traction, which changes CONTACT's shift by 0.02 to 0.2 %; the shift is "
        "corrected for finite blocks like the approach"
    ]
    return section


def _plain(value: Any) -> Any:
    return float(value) if isinstance(value, np.floating) else value
