"""Contact patches as named variables with units."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING, Any

import numpy as np

if TYPE_CHECKING:
    from wheelrail.contact.results.result import Patch

# Variable: attribute of the patch, index in it or None, unit, meaning.
PATCH_VARIABLES: dict[str, tuple[str, int | None, str, str]] = {
    "patch_area": ("area", None, "m2", "area of the patch"),
    "patch_max_pressure": ("max_pressure", None, "Pa", "peak pressure of the patch"),
    "patch_normal_force": ("normal_force", None, "N", "normal force of the patch"),
    "patch_longitudinal_force": ("tangential_force", 0, "N", "tangential force on the wheel, forward"),
    "patch_lateral_force": (
        "tangential_force",
        1,
        "N",
        "tangential force on the wheel in the contact plane, to the left",
    ),
    "patch_semi_axis_x": ("semi_axes", 0, "m", "semi-axis along the track of the ellipse of the same second moments"),
    "patch_semi_axis_y": ("semi_axes", 1, "m", "semi-axis across"),
    "patch_contact_angle": ("contact_angle", None, "rad", "turn of the contact plane about the track"),
    "patch_stick_area": ("stick_area", None, "m2", "area that sticks"),
    "patch_longitudinal_creepage": ("creepage", 0, "1", "creepage of the wheel, forward, at the patch's resultant"),
    "patch_lateral_creepage": ("creepage", 1, "1", "creepage of the wheel in the contact plane, to the left"),
    "patch_spin": ("creepage", 2, "rad/m", "spin creepage of the wheel, about the patch's upward normal"),
    "patch_frictional_power": ("frictional_power", None, "W", "power of friction that turns into heat"),
    "patch_x": ("x", None, "m", "position of the resultant along the track"),
    "wheel_s": ("wheel_s", None, "m", "arc length on the wheel's profile from the rolling circle, to the field side"),
    "rail_s": ("rail_s", None, "m", "arc length on the rail's profile from its top as laid, to the field side"),
    "wheel_y": ("wheel_y", None, "m", "lateral position on the wheel from the rolling circle, to the field side"),
    "rail_y": ("rail_y", None, "m", "lateral position on the rail from its top as laid, to the field side"),
}
BANDS = {
    "wheel_band": "lateral extent of the patch on the wheel, from the rolling circle, to the field side",
    "rail_band": "lateral extent of the patch on the rail, from its top as laid, to the field side",
}


def means(units: str, long_name: str) -> dict[str, str]:
    """Attributes of a variable."""
    return {"units": units, "long_name": long_name}


def patch_variables(
    lists: Sequence[Sequence[Patch]], dimensions: tuple[str, ...], shape: tuple[int, ...]
) -> dict[str, Any]:
    """Variables over dimensions of a shape, and patch: of lists of patches, one after another as the dimensions run.

    Padded with NaN; a patch keeps its place in the list of its sample only.
    """
    counts = np.array([len(found) for found in lists], dtype=int).reshape(shape)
    present = np.arange(max(1, counts.max(initial=0))) < counts[..., None]
    listed = [patch for found in lists for patch in found]
    by_patch = (*dimensions, "patch")
    variables: dict[str, Any] = {"patches": (dimensions, counts, means("1", "number of contact patches"))}
    for name, (attribute, index, units, text) in PATCH_VARIABLES.items():
        values = [getattr(patch, attribute) for patch in listed]
        filled = np.full(present.shape, np.nan)
        filled[present] = values if index is None else [value[index] for value in values]
        variables[name] = (by_patch, filled, means(units, text))
    for name, text in BANDS.items():
        filled = np.full((*present.shape, 2), np.nan)
        filled[present] = np.array([getattr(patch, name) for patch in listed]).reshape(-1, 2)
        variables[name] = ((*by_patch, "edge"), filled, means("m", text))
    return variables
