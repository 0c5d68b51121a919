"""Contact patches as named variables with units."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING, Any

import numpy as np

from wheelrail.contact.results.packed_patches import WIDTH, PackedPatches

if TYPE_CHECKING:
    from wheelrail.contact.results.result import Patch

# Variable: attribute of the patch, index in it or None, unit, meaning.
PATCH_VARIABLES: dict[str, tuple[str, int | None, str, str]] = {
    "patch_area": ("area", None, "m2", "area of the patch"),
    "patch_max_pressure": ("max_pressure", None, "Pa", "peak pressure of the patch"),
    "patch_normal_force": ("normal_force", None, "N", "normal force of the patch"),
    "patch_longitudinal_force": ("tangential_force", 0, "N", "tangential force on the wheel, positive forward"),
    "patch_lateral_force": (
        "tangential_force",
        1,
        "N",
        "tangential force on the wheel in the contact plane, positive to the left",
    ),
    "patch_semi_axis_x": ("semi_axes", 0, "m", "longitudinal semi-axis of the ellipse with equal second moments"),
    "patch_semi_axis_y": ("semi_axes", 1, "m", "lateral semi-axis of the same ellipse"),
    "patch_contact_angle": (
        "contact_angle",
        None,
        "rad",
        "contact angle, rotation of the contact plane about the track direction",
    ),
    "patch_stick_area": ("stick_area", None, "m2", "stick area"),
    "patch_longitudinal_creepage": (
        "creepage",
        0,
        "1",
        "longitudinal creepage of the wheel at the resultant of the patch, positive forward",
    ),
    "patch_lateral_creepage": (
        "creepage",
        1,
        "1",
        "lateral creepage of the wheel in the contact plane, positive to the left",
    ),
    "patch_spin": ("creepage", 2, "rad/m", "spin creepage of the wheel about the upward normal of the patch"),
    "patch_frictional_power": ("frictional_power", None, "W", "frictional power"),
    "patch_strips": (
        "strips",
        None,
        "1",
        "strips, or points of a grid, across the patch, 0 for models without; with less than 5 it is rough",
    ),
    "patch_x": ("x", None, "m", "position of the resultant along the track"),
    "wheel_s": (
        "wheel_s",
        None,
        "m",
        "arc length on the wheel profile from the rolling circle, positive to the field side",
    ),
    "rail_s": (
        "rail_s",
        None,
        "m",
        "arc length on the rail profile from the top of the inclined rail, positive to the field side",
    ),
    "wheel_y": (
        "wheel_y",
        None,
        "m",
        "lateral position on the wheel from the rolling circle, positive to the field side",
    ),
    "rail_y": (
        "rail_y",
        None,
        "m",
        "lateral position on the rail from the top of the inclined rail, positive to the field side",
    ),
}
BANDS = {
    "wheel_band": "lateral extent of the patch on the wheel from the rolling circle, positive to the field side",
    "rail_band": "lateral extent of the patch on the inclined rail from its top, positive to the field side",
}


def means(units: str, long_name: str) -> dict[str, str]:
    """Attributes of a variable."""
    return {"units": units, "long_name": long_name}


def patch_variables(
    lists: Sequence[Sequence[Patch]], dimensions: tuple[str, ...], shape: tuple[int, ...]
) -> dict[str, Any]:
    """Variables over the given dimensions and patch, padded with NaN.

    Parameters:
        lists: patches of every sample, in C order of the dimensions.
        dimensions: their names.
        shape: their sizes.

    The index of a patch is its place in the list of its sample.
    """
    packed = [PackedPatches.of(patches) for patches in lists]
    counts = np.array([len(patches) for patches in packed], dtype=int).reshape(shape)
    present = np.arange(max(1, counts.max(initial=0))) < counts[..., None]
    listed = PackedPatches(np.concatenate([np.empty((0, WIDTH)), *(patches.values for patches in packed)]))
    by_patch = (*dimensions, "patch")
    variables: dict[str, Any] = {"patches": (dimensions, counts, means("1", "number of contact patches"))}
    for name, (attribute, index, units, text) in PATCH_VARIABLES.items():
        values = listed.column(attribute)
        filled = np.full(present.shape, np.nan)
        filled[present] = values if index is None else values[:, index]
        variables[name] = (by_patch, filled, means(units, text))
    for name, text in BANDS.items():
        filled = np.full((*present.shape, 2), np.nan)
        filled[present] = listed.column(name)
        variables[name] = ((*by_patch, "edge"), filled, means("m", text))
    return variables
