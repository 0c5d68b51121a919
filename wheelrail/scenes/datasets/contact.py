"""Results of a contact solve as variables with units: totals by side, patches, values at the contact points."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from wheelrail.contact.kinematics.frames import MIRROR
from wheelrail.contact.results.result import ContactResult, Fields
from wheelrail.scenes.datasets.declared import check
from wheelrail.scenes.datasets.patches import patch_variables
from wheelrail.scenes.quantities import AXES, CONTACT, ERRORS, SOLUTION, TURNS
from wheelrail.scenes.quantity import filled
from wheelrail.scenes.schema.errors import SceneError
from wheelrail.support.arrays import Array, Mask

if TYPE_CHECKING:
    from xarray import Dataset, Variable

    from wheelrail.contact.laws.parameters import ContactLaws

LOCAL = ("longitudinal", "lateral", "normal")
MIRROR_LOCAL = np.array([1.0, -1.0, 1.0])  # mirror image of local components
ATTRIBUTES: dict[str, type] = {"status": str, "model": str, "contact_modulus": float}


def contact_dataset(
    results: Mapping[str, ContactResult],
    laws: Mapping[str, ContactLaws],
    more: Mapping[str, Variable] | None = None,
    attributes: Mapping[str, Any] | None = None,
) -> Dataset:
    """Dataset over side, patch (by decreasing load, padded with NaN) and point (of all sides in sequence).

    Parameters:
        results: by side: "left" and "right", each in the frame of its rail parallel to the track frame, or "contact".
        laws: of the interface by side, for the stick area.
        more: further variables.
        attributes: of the Dataset.

    point_side and point_patch are coordinates of the points; point_patch is -1 outside contact. A failed side has a
    status and no force.
    """
    from xarray import Dataset

    sides = list(results)
    every = {
        "status": [result.status for result in results.values()],
        **_totals(results),
        **_points(results, laws),
    }
    patches = patch_variables([result.patches for result in results.values()], CONTACT, (len(sides),))
    coordinates: dict[str, Any] = {
        "side": ("side", sides),
        "edge": ("edge", ["low", "high"]),
        "axis": ("axis", ["x", "y", "z"]),
        "direction": ("direction", list(LOCAL)),
        "tangent": ("tangent", list(LOCAL[:2])),
    }
    variables = filled(CONTACT, every) | patches | dict(more or {})
    coordinates |= {name: variables.pop(name) for name in ("point_side", "point_patch")}
    return Dataset(variables, coordinates, attributes)


def check_contact(data: Dataset, file: Path) -> None:
    """Raise SceneError unless a Dataset has the variables and attributes of a contact solution, naming the difference.

    Parameters:
        data: Dataset of the file.
        file: for messages.
    """
    check(data, file, CONTACT | SOLUTION, ATTRIBUTES)
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
    for name in ("wheel_s", "rail_s"):
        places = [getattr(part, name) for part in own]
        if places and all(place is not None for place in places):
            variables[f"point_{name}"] = np.concatenate(places)
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
