"""Results of a contact solve as variables with units: totals by side, patches, values at the contact points."""

from __future__ import annotations

from collections.abc import Mapping
from typing import TYPE_CHECKING, Any

import numpy as np

from wheelrail.contact.kinematics.frames import MIRROR
from wheelrail.contact.results.result import ContactResult, Fields
from wheelrail.scenes.datasets.patches import means, patch_variables
from wheelrail.scenes.datasets.run_schema import AXES, TURNS
from wheelrail.support.arrays import Array, Mask

if TYPE_CHECKING:
    from xarray import Dataset

    from wheelrail.contact.laws.parameters import ContactLaws

LOCAL = ("longitudinal", "lateral", "normal")
MIRROR_LOCAL = np.array([1.0, -1.0, 1.0])  # mirror image of local components
# Attribute of the result's error estimate: unit, meaning.
ERRORS = {
    "force": ("N", "estimated error of the force, magnitude"),
    "moment": ("N m", "estimated error of the moment, magnitude"),
    "max_pressure": ("Pa", "estimated error of the peak pressure"),
    "area": ("m2", "estimated error of the contact area"),
}


def contact_dataset(results: Mapping[str, ContactResult], laws: Mapping[str, ContactLaws]) -> Dataset:
    """Dataset over side, patch (by decreasing load, padded with NaN) and point (of all sides in sequence).

    Parameters:
        results: by side: "left" and "right", each in the frame of its rail parallel to the track frame, or "contact".
        laws: of the interface by side, for the stick area.

    point_side and point_patch are coordinates of the points; point_patch is -1 outside contact. A failed side has a
    status and no force.
    """
    from xarray import Dataset

    sides = list(results)
    every: dict[str, Any] = {
        "status": ("side", [result.status for result in results.values()], means("1", "status of the solve")),
        **_totals(results),
        **patch_variables([result.patches for result in results.values()], ("side",), (len(sides),)),
        "patch_force": (("side", "patch", "axis"), *_patch_forces(results)),
        **_points(results, laws),
    }
    coordinates = {
        "side": ("side", sides),
        "edge": ("edge", ["low", "high"]),
        "axis": ("axis", ["x", "y", "z"]),
        "direction": ("direction", list(LOCAL)),
        "tangent": ("tangent", list(LOCAL[:2])),
    }
    data = Dataset(every, coords=coordinates)
    return data.set_coords(["point_side", "point_patch"])


def _totals(results: Mapping[str, ContactResult]) -> dict[str, Any]:
    """Forces, moments, approach, error estimates, and statistics of the last solve, by side."""
    variables: dict[str, Any] = {}
    listed = list(results.values())
    force, moment = (
        np.array([value if result.ok else np.full(3, np.nan) for result, value in pairs])
        for pairs in ([(r, r.force) for r in listed], [(r, r.moment) for r in listed])
    )
    for index, (axis, turn) in enumerate(zip(AXES, TURNS, strict=True)):
        variables[f"{axis}_force"] = ("side", force[:, index], means("N", f"{axis} contact force on the wheel"))
        text = f"{turn} moment of the contact force about the centre of the wheelset"
        variables[f"{turn}_moment"] = ("side", moment[:, index], means("N m", text))
    approach = means("m", "largest penetration of the undeformed bodies; negative is a gap")
    variables["approach"] = ("side", [result.approach for result in listed], approach)
    if any(result.error_estimate is not None for result in listed):
        for name, (units, text) in ERRORS.items():
            values = [getattr(result.error_estimate, name, np.nan) for result in listed]
            variables[f"{name}_error"] = ("side", values, means(units, text))
    for name, text in (("newton", "Newton iterations"), ("linear", "linear iterations"), ("points", "contact points")):
        counts = [getattr(result.statistics, name) for result in listed]
        variables[f"{name}_count"] = ("side", counts, means("1", f"{text} of the last solve"))
    residual = means("1", "relative residual of the last solve")
    variables["residual"] = ("side", [result.statistics.residual for result in listed], residual)
    phases = list(dict.fromkeys(phase for result in listed for phase in result.statistics.seconds))
    if phases:
        seconds = [[result.statistics.seconds.get(phase, np.nan) for phase in phases] for result in listed]
        variables["phase"] = ("phase", phases)
        variables["phase_seconds"] = (("side", "phase"), seconds, means("s", "time for a phase of the last solve"))
    return variables


def _patch_forces(results: Mapping[str, ContactResult]) -> tuple[Array, dict[str, str]]:
    """Resultants (side, patch, axis) of the patches, padded with NaN, and their attributes."""
    lists = [result.patches for result in results.values()]
    force = np.full((len(lists), max([1, *map(len, lists)]), 3), np.nan)
    for row, patches in enumerate(lists):
        for k, patch in enumerate(patches):
            force[row, k] = patch.force
    return force, means("N", "force of the patch on the wheel")


def _points(results: Mapping[str, ContactResult], laws: Mapping[str, ContactLaws]) -> dict[str, Any]:
    """Values at the contact points of all sides; fields of a right-hand pair are mirrored back."""
    parts = [
        (side, _unmirrored(result.fields, side == "right"), sticks(result.fields, laws[side]))
        for side, result in results.items()
        if result.ok and result.fields is not None
    ]
    fields = [part for _, part, _ in parts]

    def joined(name: str, *shape: int) -> Array:
        return np.concatenate([np.empty((0, *shape)), *(getattr(part, name) for part in fields)])

    own = np.repeat([side for side, _, _ in parts] or [""], [len(part.area) for part in fields] or [0])
    patch = np.concatenate([np.empty(0, dtype=int), *(part.patch for part in fields)])
    stick = np.concatenate([np.empty(0, dtype=bool), *(part for _, _, part in parts)])
    position = means("m", "position in the frame of the rail of the side: forward, left, up")
    axes = means("1", "longitudinal, lateral and outward normal axis of the wheel surface")
    slip = means("1", "slip velocity of the wheel against the rail over the rolling speed")
    step = means("m", "length of the cell of the point in rolling direction")
    variables: dict[str, Any] = {}
    if any(part.share is not None for part in fields):
        shares = [np.ones(len(part.area)) if part.share is None else part.share for part in fields]
        text = "share of the strips of the point in the result, between two widths of strips"
        variables["share"] = ("point", np.concatenate(shares), means("1", text))
    return variables | {
        "point_side": ("point", own.astype(str), means("1", "side of the point")),
        "point_patch": ("point", patch, means("1", "patch of the point, -1 for none")),
        "position": (("point", "axis"), joined("point", 3), position),
        "axes": (("point", "direction", "axis"), joined("axes", 3, 3), axes),
        "area": ("point", joined("area"), means("m2", "area of the cell of the point, times its share")),
        "step": ("point", joined("step"), step),
        "penetration": ("point", joined("penetration"), means("m", "penetration of the undeformed bodies")),
        "pressure": ("point", joined("pressure"), means("Pa", "contact pressure")),
        "traction": (("point", "tangent"), joined("traction", 2), means("Pa", "tangential traction on the wheel")),
        "slip": (("point", "tangent"), joined("slip", 2), slip),
        "displacement": (
            ("point", "direction"),
            joined("displacement", 3),
            means("m", "elastic displacement, wheel minus rail"),
        ),
        "sticks": ("point", stick, means("1", "whether the surfaces stick")),
    }


def _unmirrored(fields: Fields, mirrored: bool) -> Fields:
    """Fields in the frame of their own rail."""
    from dataclasses import replace

    if not mirrored:
        return fields
    return replace(
        fields,
        point=fields.point * MIRROR,
        axes=fields.axes * MIRROR_LOCAL[:, None] * MIRROR,
        traction=fields.traction * MIRROR_LOCAL[:2],
        slip=fields.slip * MIRROR_LOCAL[:2],
        displacement=fields.displacement * MIRROR_LOCAL,
    )


def sticks(fields: Fields | None, laws: ContactLaws) -> Mask:
    """Mask (n,) of loaded points that stick; none without friction.

    Parameters:
        fields: at the contact points, with the mask of the model if it provides one.
        laws: the traction must be below the friction bound; the slip must vanish if friction depends on its velocity.
    """
    assert fields is not None
    if fields.sticks is not None:
        return fields.sticks
    loaded = fields.pressure > 0.0
    if not laws.pointwise_friction.depends_on_speed:
        bound = laws.friction_bound(fields.pressure, np.zeros(len(loaded)), 0.0)
        return np.asarray(loaded & (np.hypot(*fields.traction.T) < (1 - 1e-6) * bound))
    slip = np.hypot(*fields.slip.T)
    sticking = np.zeros(len(slip), dtype=bool)
    for patch in range(int(fields.patch.max(initial=-1)) + 1):
        own = fields.patch == patch
        sticking[own] = slip[own] <= max(laws.regularisation, 1e-6 * float(slip[own].max(initial=0.0)))
    return np.asarray(loaded & sticking)
