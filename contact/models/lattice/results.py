"""Result of a contact on a lattice in the frame of the rail, on the cells of its strips.

Between two levels fields are those of both side by side, cells with their share of the area: sums over areas are those
of the force.
"""

from __future__ import annotations

from dataclasses import fields, replace

import numpy as np

from wheelrail.bindings._contact import LatticeOutcome, LatticeResult
from wheelrail.contact.results.patch_sums import patches_of
from wheelrail.contact.results.result import ContactResult, Fields, LazyFields, LazyPatches, Statistics
from wheelrail.contact.solvers.tangent import ContactTangent


def contact_result(done: LatticeResult) -> ContactResult:
    """Forces, patches, fields and tangent of a solution; all but the forces are computed when first needed."""
    if not done.ok:
        return replace(ContactResult.failed(done.failure, done.approach), warm_start=done.start)
    if done.separated:
        return replace(ContactResult.separated(done.approach), warm_start=done.start)
    load = done.load
    return ContactResult(
        force=load[:3],
        moment=load[3:],
        patches=LazyPatches(lambda: patches_of(done.patches())),
        fields=LazyFields(lambda: _fields(done)),
        approach=done.approach,
        status="converged",
        statistics=Statistics(
            newton=done.newton,
            linear=done.evaluations,
            points=done.points,
            residual=done.residual,
            seconds={"solve": done.seconds},
        ),
        force_tangent=ContactTangent(done),
        warm_start=done.start,
    )


def _fields(done: LatticeResult) -> Fields:
    """Fields at the cells of all levels. Raises OutsideSurface."""
    parts = []
    shares = done.share, 1.0 - done.share
    for level, numbers, share in zip(done.levels, done.patch_numbers(), shares, strict=False):
        if level.solution is None:
            continue
        own = _of_level(level)
        if len(done.levels) > 1:
            patch, part = np.array(numbers, dtype=int)[own.patch], np.full(len(own.area), share)
            own = replace(own, patch=patch, area=share * own.area, share=part)
        parts.append(own)
    if len(done.levels) == 1:
        return parts[0]
    whole = {
        part.name: np.concatenate([getattr(own, part.name) for own in parts])
        for part in fields(Fields)
        if part.name not in ("node", "sticks")
    }
    return Fields(node=np.arange(len(whole["area"])), **whole)


def _of_level(at: LatticeOutcome) -> Fields:
    """Fields at the cells of one level. Raises OutsideSurface."""
    cells = at.cells()
    points = cells.points
    return Fields(
        node=np.arange(len(points.area)),
        patch=np.repeat(cells.patch, len(points.area) // len(cells.patch)),
        point=points.point,
        axes=points.axes,
        area=points.area,
        step=points.step,
        penetration=cells.penetration,
        pressure=points.pressure,
        traction=points.traction,
        slip=cells.slip,
        displacement=cells.displacement,
        wheel_s=points.on_wheel[:, 0],
        rail_s=points.on_rail[:, 0],
    )
