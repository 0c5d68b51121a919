"""Results of a contact solve as variables with units: totals by side, patches, values at the contact points."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from wheelrail.contact.kinematics.frames import MIRROR
from wheelrail.contact.results.result import ContactResult, Fields
from wheelrail.scenes.datasets.declared import Declared, Schema, check, filled
from wheelrail.scenes.datasets.patches import patch_variables
from wheelrail.scenes.datasets.run_schema import AXES, TURNS, wheel_schema
from wheelrail.scenes.schema.errors import SceneError
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
BY_SIDE, BY_POINT = ("side",), ("point",)
CONTACT: Schema = {
    "side": Declared(BY_SIDE, "", ""),
    "status": Declared(BY_SIDE, "", "status of the solve"),
    **{name: of_wheel for name, of_wheel in wheel_schema(BY_SIDE).items() if of_wheel.needed and name != "in_contact"},
    "patch_force": Declared(("side", "patch", "axis"), "N", "force of the patch on the wheel"),
    **{f"{name}_error": Declared(BY_SIDE, units, text, False) for name, (units, text) in ERRORS.items()},
    **{
        f"{name}_count": Declared(BY_SIDE, "1", f"{text} of the last solve")
        for name, text in (
            ("newton", "Newton iterations"),
            ("linear", "linear iterations"),
            ("points", "contact points"),
        )
    },
    "residual": Declared(BY_SIDE, "1", "relative residual of the last solve"),
    "phase": Declared(("phase",), "", "", False),
    "phase_seconds": Declared(("side", "phase"), "s", "time for a phase of the last solve", False),
    "share": Declared(
        BY_POINT, "1", "share of the strips of the point in the result, between two widths of strips", False
    ),
    "point_side": Declared(BY_POINT, "", "side of the point"),
    "point_patch": Declared(BY_POINT, "1", "patch of the point, -1 for none"),
    "position": Declared(("point", "axis"), "m", "position in the frame of the rail of the side: forward, left, up"),
    "axes": Declared(
        ("point", "direction", "axis"), "1", "longitudinal, lateral and outward normal axis of the wheel surface"
    ),
    "area": Declared(BY_POINT, "m2", "area of the cell of the point, times its share"),
    "step": Declared(BY_POINT, "m", "length of the cell of the point in rolling direction"),
    "penetration": Declared(BY_POINT, "m", "penetration of the undeformed bodies"),
    "pressure": Declared(BY_POINT, "Pa", "contact pressure"),
    "traction": Declared(("point", "tangent"), "Pa", "tangential traction on the wheel"),
    "slip": Declared(("point", "tangent"), "1", "slip velocity of the wheel against the rail over the rolling speed"),
    "displacement": Declared(("point", "direction"), "m", "elastic displacement, wheel minus rail"),
    "sticks": Declared(BY_POINT, "1", "whether the surfaces stick"),
}
ATTRIBUTES: dict[str, type] = {"status": str, "model": str, "contact_modulus": float}


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
    every = {
        "status": [result.status for result in results.values()],
        **_totals(results),
        "patch_force": _patch_forces(results),
        **_points(results, laws),
    }
    patches = patch_variables([result.patches for result in results.values()], BY_SIDE, (len(sides),))
    coordinates = {
        "side": ("side", sides),
        "edge": ("edge", ["low", "high"]),
        "axis": ("axis", ["x", "y", "z"]),
        "direction": ("direction", list(LOCAL)),
        "tangent": ("tangent", list(LOCAL[:2])),
    }
    data = Dataset(filled(CONTACT, every) | patches, coords=coordinates)
    return data.set_coords(["point_side", "point_patch"])


def check_contact(data: Dataset, file: Path) -> None:
    """Raise SceneError unless a Dataset has what a contact solution writes, naming what is missing or differs.

    Parameters:
        data: Dataset of the file.
        file: for messages.
    """
    check(data, file, CONTACT, ATTRIBUTES)
    patches = data["patches"].values
    if not ((patches >= 0) & (patches <= data.sizes["patch"]) & (patches == np.round(patches))).all():
        raise SceneError(f"{file}: patches: must be whole numbers from 0 to {data.sizes['patch']}, the length of patch")


def _totals(results: Mapping[str, ContactResult]) -> dict[str, Any]:
    """Forces, moments, approach, error estimates, and statistics of the last solve, by side."""
    listed = list(results.values())
    force, moment = (
        np.array([value if result.ok else np.full(3, np.nan) for result, value in pairs])
        for pairs in ([(r, r.force) for r in listed], [(r, r.moment) for r in listed])
    )
    variables: dict[str, Any] = {f"{axis}_force": force[:, k] for k, axis in enumerate(AXES)}
    variables |= {f"{turn}_moment": moment[:, k] for k, turn in enumerate(TURNS)}
    variables["approach"] = [result.approach for result in listed]
    if any(result.error_estimate is not None for result in listed):
        for name in ERRORS:
            variables[f"{name}_error"] = [getattr(result.error_estimate, name, np.nan) for result in listed]
    for name in ("newton", "linear", "points"):
        variables[f"{name}_count"] = [getattr(result.statistics, name) for result in listed]
    variables["residual"] = [result.statistics.residual for result in listed]
    phases = list(dict.fromkeys(phase for result in listed for phase in result.statistics.seconds))
    if phases:
        variables["phase"] = phases
        variables["phase_seconds"] = [
            [result.statistics.seconds.get(phase, np.nan) for phase in phases] for result in listed
        ]
    return variables


def _patch_forces(results: Mapping[str, ContactResult]) -> Array:
    """Resultants (side, patch, axis) of the patches, padded with NaN."""
    lists = [result.patches for result in results.values()]
    force = np.full((len(lists), max([1, *map(len, lists)]), 3), np.nan)
    for row, patches in enumerate(lists):
        for k, patch in enumerate(patches):
            force[row, k] = patch.force
    return force


def _points(results: Mapping[str, ContactResult], laws: Mapping[str, ContactLaws]) -> dict[str, Any]:
    """Values at the contact points of all sides; fields of a right-hand pair are mirrored back."""
    parts = [
        (side, _unmirrored(result.fields, side == "right"), sticks(result.fields, laws[side]))
        for side, result in results.items()
        if result.ok and result.fields is not None
    ]
    own = [part for _, part, _ in parts]

    def joined(name: str, *shape: int) -> Array:
        return np.concatenate([np.empty((0, *shape)), *(getattr(part, name) for part in own)])

    sides = np.repeat([side for side, _, _ in parts] or [""], [len(part.area) for part in own] or [0])
    variables: dict[str, Any] = {}
    if any(part.share is not None for part in own):
        shares = [np.ones(len(part.area)) if part.share is None else part.share for part in own]
        variables["share"] = np.concatenate(shares)
    return variables | {
        "point_side": sides.astype(str),
        "point_patch": np.concatenate([np.empty(0, dtype=int), *(part.patch for part in own)]),
        "position": joined("point", 3),
        "axes": joined("axes", 3, 3),
        **{name: joined(name) for name in ("area", "step", "penetration", "pressure")},
        **{name: joined(name, 2) for name in ("traction", "slip")},
        "displacement": joined("displacement", 3),
        "sticks": np.concatenate([np.empty(0, dtype=bool), *(part for _, _, part in parts)]),
    }


def _unmirrored(own: Fields, mirrored: bool) -> Fields:
    """Fields in the frame of their own rail."""
    if not mirrored:
        return own
    return replace(
        own,
        point=own.point * MIRROR,
        axes=own.axes * MIRROR_LOCAL[:, None] * MIRROR,
        traction=own.traction * MIRROR_LOCAL[:2],
        slip=own.slip * MIRROR_LOCAL[:2],
        displacement=own.displacement * MIRROR_LOCAL,
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
