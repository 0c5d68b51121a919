"""Creepage under the patch due to bulk compression of finite bodies, which half-spaces do not have."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from benchmarks.accuracy.contact_frames import state
from benchmarks.accuracy.wheelset import SIZE, loaded_wheel, track_of
from benchmarks.common.models import Ellipse, carrying, frictional, hertz_model, pressed, rolling, solved
from benchmarks.common.reference_table import TableSection, measure, reference
from wheelrail.contact.analytical.kalker import kalker
from wheelrail.contact.kinematics.frames import SIDES
from wheelrail.contact.results.result import ContactResult
from wheelrail.support.arrays import Array

Say = Callable[[str], None]
SLIPPERY = 1e-6  # friction coefficient: displacements are computed, tractions negligible


def bulk_creepage(result: ContactResult) -> Array:
    """Elastic creepages (longitudinal, lateral) and spin [rad/m] due to the normal pressure: slope along x of the
    tangential displacement, wheel minus rail, against the rolling direction, weighted by the pressure.

    Exactly zero for half-spaces of the same material, whose displacements agree: it measures the shape of the bodies.
    """
    fields = result.fields
    assert fields is not None
    weight = fields.pressure * fields.area
    x, y = ((fields.point - weight @ fields.point / weight.sum())[:, :2]).T
    root = np.sqrt(weight)
    basis = np.stack([np.ones_like(x), x, y, x * x, x * y], axis=1) * root[:, None]
    # fixed axes: in the points' axes, which rotate with the wheel, a radial displacement over the radius is slip, too
    displacement = np.einsum("nk,nkc->nc", fields.displacement, fields.axes)
    lateral = weight @ fields.axes[:, 1] / weight.sum()
    along, across = (
        np.linalg.lstsq(basis, root * part, rcond=None)[0] for part in (displacement[:, 0], displacement @ lateral)
    )
    # material flows towards -x: the increase of its displacement along -x is slip; spin rotates it
    return np.array([-along[1], -across[1], 0.5 * (along[4] - 2 * across[3])])


def lateral_shift(result: ContactResult) -> float:
    """Mean lateral displacement of the wheel's surface to the left relative to the rail's due to the pressure, um; zero
    for half-spaces.
    """
    fields = result.fields
    assert fields is not None
    weight = fields.pressure * fields.area
    return float(1e6 * weight @ fields.displacement[:, 1] / weight.sum())


def bulk_section(quick: bool, say: Say) -> TableSection:
    """Bulk creepage of wheel and rail, frictionless otherwise, and of the blocks of the Hertz pairs."""
    data = reference("wheelset")
    inputs = data["input"]
    track = track_of(inputs)
    section = TableSection(
        "bulk",
        "Creepage due to bulk compression of the finite bodies (zero for half-spaces)",
        (
            "pair",
            "points",
            "longitudinal",
            "lateral",
            "spin 1/m",
            "longitudinal force, % of mu F_n",
            "lateral shift um",
        ),
    )
    pair = Ellipse((0.46, 0.46), inputs["load"])
    size = pair.size(points=285)
    depth, _ = pressed(pair, size)
    blocks = solved(hertz_model(pair, frictional(SLIPPERY), size), depth, rolling(0.0))
    section.rows.append(["blocks", carrying(blocks), *map(float, bulk_creepage(blocks)), 0.0, lateral_shift(blocks)])
    creepages = []
    for case in data["series"]["normal_only"]:
        if case["y"] > 6.0 or (case["y"] % (3.0 if quick else 1.0)):
            continue
        wheelset = state(case, speed=inputs["speed"], pitch_rate=inputs["pitch_rate"])
        for side in SIDES:
            say(f"bulk, y {case['y']:g} mm {side}")
            result = loaded_wheel(track, SLIPPERY, wheelset, side, inputs["load"], SIZE)
            section.count(carrying(result))
            creepage = bulk_creepage(result)
            a, b = result.patches[0].semi_axes
            ratio = float(np.clip(a / b, 0.1, 10.0))
            G = track.steel.E / (2 + 2 * track.steel.nu)
            force_fraction = (
                -a * b * G * kalker("C11", ratio, track.steel.nu) * creepage[0] / (inputs["mu"] * inputs["load"])
            )
            creepages.append(creepage[0])
            row = [
                f"{case['y']:g} mm {side}",
                carrying(result),
                *map(float, creepage),
                100 * float(force_fraction),
                lateral_shift(result),
            ]
            section.rows.append(row)
    section.measures = [measure("longitudinal", "1e-6", 1e6 * np.array(creepages))]
    section.notes = [
        "force: of the longitudinal creepage by Kalker's linear theory, an upper bound",
        "lateral shift: in the axes of a left wheel, including bending of the bodies under the load",
    ]
    return section
