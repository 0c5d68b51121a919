"""Results of a contact solve as named variables with units: totals by side, patches, values at the contact points."""

from __future__ import annotations

from collections.abc import Mapping
from typing import TYPE_CHECKING, Any

import numpy as np

from wheelrail.contact.kinematics.frames import MIRROR
from wheelrail.contact.results.result import ContactResult, Fields
from wheelrail.scenes.datasets.patches import means, patch_variables
from wheelrail.scenes.datasets.run import AXES, TURNS
from wheelrail.support.arrays import Array, Mask

if TYPE_CHECKING:
    from xarray import Dataset

    from wheelrail.contact.laws.parameters import ContactLaws

LOCAL = ("longitudinal", "lateral", "normal")
SIDEWAYS = np.array([1.0, -1.0, 1.0])  # of local components in a mirror, where the lateral axis turns round
# Attribute of the result's error estimate: unit, meaning.
ERRORS = {
    "force": ("N", "estimated error of the force, length of a vector"),
    "moment": ("N m", "estimated error of the moment, length of a vector"),
    "max_pressure": ("Pa", "estimated error of the peak pressure"),
    "area": ("m2", "estimated error of the contact area"),
}


def contact_dataset(results: Mapping[str, ContactResult], laws: ContactLaws) -> Dataset:
    """A Dataset over side, patch (by falling load, padded with NaN) and point (those of all sides, one after another).

    Sides are left and right, each in a frame of its own rail, parallel to the track's, or "contact" for a Hertz pair.
    Point fields are found by point_side and by point_patch, which is -1 where nothing touches. A side that failed has a
    status and no force.
    """
    from xarray import Dataset

    sides = list(results)
    every: dict[str, Any] = {
        "status": ("side", [result.status for result in results.values()], means("1", "how the solve ended")),
        **_totals(results),
        **patch_variables([result.patches for result in results.values()], ("side",), (len(sides),)),
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
    """Forces, moments, approach, estimates of their errors, and what the last solve cost, by side."""
    found: dict[str, Any] = {}
    listed = list(results.values())
    force, moment = (
        np.array([value if result.ok else np.full(3, np.nan) for result, value in pairs])
        for pairs in ([(r, r.force) for r in listed], [(r, r.moment) for r in listed])
    )
    for index, (axis, turn) in enumerate(zip(AXES, TURNS, strict=True)):
        found[f"{axis}_force"] = ("side", force[:, index], means("N", f"{axis} contact force on the wheel"))
        text = f"{turn} moment of the contact force about the wheelset's centre"
        found[f"{turn}_moment"] = ("side", moment[:, index], means("N m", text))
    approach = means("m", "largest undeformed overlap; negative is a gap")
    found["approach"] = ("side", [result.approach for result in listed], approach)
    if any(result.error_estimate is not None for result in listed):
        for name, (units, text) in ERRORS.items():
            values = [getattr(result.error_estimate, name, np.nan) for result in listed]
            found[f"{name}_error"] = ("side", values, means(units, text))
    for name, text in (("newton", "Newton iterations"), ("linear", "linear iterations"), ("points", "contact points")):
        counts = [getattr(result.statistics, name) for result in listed]
        found[f"{name}_count"] = ("side", counts, means("1", f"{text} of the last solve"))
    settled = means("1", "whether the ends of fitted cells came to rest")
    found["settled"] = ("side", [result.statistics.settled for result in listed], settled)
    return found


def _points(results: Mapping[str, ContactResult], laws: ContactLaws) -> dict[str, Any]:
    """Values at the contact points of all sides; a right-hand pair's fields, solved as a left one's, turned back."""
    parts = [
        (side, _in_place(result.fields, side == "right"), sticks(result.fields, laws))
        for side, result in results.items()
        if result.ok and result.fields is not None
    ]
    fields = [part for _, part, _ in parts]

    def joined(name: str, *shape: int) -> Array:
        return np.concatenate([np.empty((0, *shape)), *(getattr(part, name) for part in fields)])

    own = np.repeat([side for side, _, _ in parts] or [""], [len(part.area) for part in fields] or [0])
    patch = np.concatenate([np.empty(0, dtype=int), *(part.patch for part in fields)])
    stick = np.concatenate([np.empty(0, dtype=bool), *(part for _, _, part in parts)])
    position = means("m", "position in the frame of the side's rail: forward, left, up")
    axes = means("1", "longitudinal, lateral and outward normal axis of the wheel's surface")
    slip = means("1", "slip of the wheel against the rail over the rolling speed")
    step = means("m", "length along the rolling direction that the point stands for")
    return {
        "point_side": ("point", own.astype(str), means("1", "side that the point belongs to")),
        "point_patch": ("point", patch, means("1", "patch that the point belongs to, -1 for none")),
        "position": (("point", "axis"), joined("point", 3), position),
        "axes": (("point", "direction", "axis"), joined("axes", 3, 3), axes),
        "area": ("point", joined("area"), means("m2", "area that the point stands for")),
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


def _in_place(fields: Fields, mirrored: bool) -> Fields:
    """Fields in the frame of their own rail: those of a right-hand pair are solved as its mirror image."""
    from dataclasses import replace

    if not mirrored:
        return fields
    return replace(
        fields,
        point=fields.point * MIRROR,
        axes=fields.axes * SIDEWAYS[:, None] * MIRROR,
        traction=fields.traction * SIDEWAYS[:2],
        slip=fields.slip * SIDEWAYS[:2],
        displacement=fields.displacement * SIDEWAYS,
    )


def sticks(fields: Fields | None, laws: ContactLaws) -> Mask:
    """Where loaded surfaces stick (n,): traction below its bound, or no slip where that falls, unless the model knows.

    Without friction nothing does.
    """
    assert fields is not None
    if fields.sticks is not None:
        return fields.sticks
    loaded = fields.pressure > 0.0
    if laws.falling is None:
        below = np.hypot(*fields.traction.T) < (1 - 1e-6) * laws.friction * fields.pressure
        return np.asarray(loaded & below)
    slip = np.hypot(*fields.slip.T)
    found = np.zeros(len(slip), dtype=bool)
    for patch in range(int(fields.patch.max(initial=-1)) + 1):
        own = fields.patch == patch
        found[own] = slip[own] <= max(laws.regularisation, 1e-6 * float(slip[own].max(initial=0.0)))
    return np.asarray(loaded & found)
