"""Creepage under the patch due to bulk compression of finite bodies, which half-spaces do not have."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from benchmarks.accuracy.contact_frames import state
from benchmarks.accuracy.wheelset import SIZE, seated, track_of
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
    # in fixed axes: those of the points turn with the wheel, and a radial displacement over its radius is slip too
    moved = np.einsum("nk,nkc->nc", fields.displacement, fields.axes)
    lateral = weight @ fields.axes[:, 1] / weight.sum()
    along, across = (np.linalg.lstsq(basis, root * part, rcond=None)[0] for part in (moved[:, 0], moved @ lateral))
    # material flows towards -x: what it gains going there counts as slip; spin turns both, -y and +x
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
    given = data["input"]
    track = track_of(given)
    section = TableSection(
        "bulk",
        "Creepage that bulk compression of the finite bodies makes (zero for half-spaces)",
        ("pair", "points", "longitudinal", "lateral", "spin 1/m", "force it makes, % of mu F_n", "lateral shift um"),
    )
    pair = Ellipse((0.46, 0.46), given["load"])
    size = pair.size(points=285)
    depth, _ = pressed(pair, size)
    blocks = solved(hertz_model(pair, frictional(SLIPPERY), size), depth, rolling(0.0))
    section.rows.append(["blocks", carrying(blocks), *map(float, bulk_creepage(blocks)), 0.0, lateral_shift(blocks)])
    found = []
    for case in data["series"]["normal_only"]:
        if case["y"] > 6.0 or (case["y"] % (3.0 if quick else 1.0)):
            continue
        at = state(case, speed=given["speed"], pitch_rate=given["pitch_rate"])
        for side in SIDES:
            say(f"bulk, y {case['y']:g} mm {side}")
            result = seated(track, SLIPPERY, at, side, given["load"], SIZE)
            section.count(carrying(result))
            creep = bulk_creepage(result)
            a, b = result.patches[0].semi_axes
            ratio = float(np.clip(a / b, 0.1, 10.0))
            G = track.steel.E / (2 + 2 * track.steel.nu)
            makes = -a * b * G * kalker("C11", ratio, track.steel.nu) * creep[0] / (given["mu"] * given["load"])
            found.append(creep[0])
            row = [
                f"{case['y']:g} mm {side}",
                carrying(result),
                *map(float, creep),
                100 * float(makes),
                lateral_shift(result),
            ]
            section.rows.append(row)
    section.measures = [measure("longitudinal", "1e-6", 1e6 * np.array(found))]
    section.notes = [
        "force: what the longitudinal part makes by Kalker's linear theory, an upper bound",
        "lateral shift: in the axes of a left wheel, the bodies' bending under the load included",
    ]
    return section
