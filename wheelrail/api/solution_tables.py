"""Tables of a contact solution, as text and HTML."""

from __future__ import annotations

from html import escape
from typing import TYPE_CHECKING

import numpy as np

from wheelrail.contact.results.result import FEWEST_STRIPS
from wheelrail.scenes.contacts.shapes import WIDEST
from wheelrail.scenes.contacts.side_values import SideValues
from wheelrail.scenes.datasets.number_text import fixed, significant
from wheelrail.scenes.datasets.run_schema import AXES

if TYPE_CHECKING:
    from pandas import DataFrame
    from xarray import Dataset

# Column: variable, its unit in SI units, digits.
COLUMNS: dict[str, tuple[str, float, int]] = {
    "N [kN]": ("patch_normal_force", 1e3, 3),
    "p max [MPa]": ("patch_max_pressure", 1e6, 1),
    "area [mm²]": ("patch_area", 1e-6, 2),
    "stick [mm²]": ("patch_stick_area", 1e-6, 2),
    "a, x [mm]": ("patch_semi_axis_x", 1e-3, 3),
    "b, y [mm]": ("patch_semi_axis_y", 1e-3, 3),
    "Tx [kN]": ("patch_longitudinal_force", 1e3, 3),
    "Ty [kN]": ("patch_lateral_force", 1e3, 3),
    "wheel y [mm]": ("wheel_y", 1e-3, 3),
    "rail y [mm]": ("rail_y", 1e-3, 3),
}
NAMES = (
    *("patch_normal_force", "patch_max_pressure", "patch_area", "patch_stick_area"),
    *("patch_semi_axis_x", "patch_semi_axis_y", "patch_longitudinal_force", "patch_lateral_force"),
    *("patch_longitudinal_creepage", "patch_lateral_creepage", "patch_spin", "patch_frictional_power"),
    *("patch_contact_angle", "patch_x", "wheel_s", "rail_s", "wheel_y", "rail_y"),
)


def patch_table(data: Dataset) -> DataFrame:
    """Table with one row per patch, in SI units; columns are the variables without the prefix "patch_"."""
    from pandas import DataFrame

    indices = _patch_indices(data)
    columns = {name.removeprefix("patch_"): [float(data[name].values[index]) for index in indices] for name in NAMES}
    sides = data["side"].values
    return DataFrame({"side": [str(sides[row]) for row, _ in indices], "patch": [k for _, k in indices], **columns})


def text(data: Dataset) -> str:
    """Status, one line per patch, and forces by side."""
    heads, rows = _cells(data)
    widths = [max(len(row[i]) for row in (heads, *rows)) for i in range(len(heads))]
    lines = ["  ".join(cell.rjust(width) for cell, width in zip(row, widths, strict=True)) for row in (heads, *rows)]
    return "\n".join([heading(data), *(lines if rows else ["no patch"]), *_sides(data)])


def html(data: Dataset) -> str:
    """The same in HTML, with the Dataset in a collapsed section below."""
    heads, rows = _cells(data)
    table = "".join(
        "<tr>" + "".join(f"<{tag} style='text-align:right'>{escape(cell)}</{tag}>" for cell in row) + "</tr>"
        for row, tag in ((heads, "th"), *((row, "td") for row in rows))
    )
    sides = "".join(f"<div>{escape(line)}</div>" for line in _sides(data))
    return (
        f"<div><b>{escape(heading(data))}</b><table>{table}</table>{sides}"
        f"<details><summary>data</summary>{data._repr_html_()}</details></div>"
    )


def heading(data: Dataset) -> str:
    """One line: kind of contact, model, and status."""
    attributes = data.attrs
    words = [str(attributes["title"]), f"{attributes['model']} model", f"friction {attributes['friction']}"]
    words += [f"{attributes[key]} {key}" for key in ("laws", "bodies", "points") if key in attributes]
    return f"{', '.join(words)}: {attributes['status']}"


def _patch_indices(data: Dataset) -> list[tuple[int, int]]:
    """Side and patch index of every patch."""
    return [(row, k) for row, count in enumerate(data["patches"].values) for k in range(int(count))]


def _cells(data: Dataset) -> tuple[list[str], list[list[str]]]:
    sides = data["side"].values
    rows = [
        [f"{sides[row]} {k + 1}"]
        + [fixed(float(data[name].values[row, k]) / unit, digits) for name, unit, digits in COLUMNS.values()]
        for row, k in _patch_indices(data)
    ]
    return ["patch", *COLUMNS], rows


def _sides(data: Dataset) -> list[str]:
    """One line per side: force and its estimated error."""
    lines = []
    for side in data["side"].values:
        own = data.sel(side=side)
        name = "upper body" if side == "contact" else f"{side} wheel"
        if str(own["status"].item()) != "converged":
            lines.append(f"{name}: {own['status'].item()}")
            continue
        force = ", ".join(fixed(float(own[f"{axis}_force"]) / 1e3, 3) for axis in AXES)
        line = f"{name}: force {force} kN (forward, left, up)"
        if "force_error" in own and np.isfinite(own["force_error"]):
            line += f", estimated error {significant(float(own['force_error']), 2)} N"
        strips = own["patch_strips"].values if "patch_strips" in own else np.zeros(0)
        few = [f"{k + 1}" for k, count in enumerate(strips) if 0 < count < FEWEST_STRIPS]
        if few:
            kind = "points" if data.attrs.get("points") == "grid" else "strips"
            line += f"; fewer than {FEWEST_STRIPS} {kind} across patch {', '.join(few)}: rough, use more"
        turns = own["patch_turn"].values if "patch_turn" in own else np.zeros(0)
        wide = [f"{k + 1}" for k, angle in enumerate(turns) if angle > WIDEST]
        if wide:
            line += f"; the surfaces turn by {np.nanmax(turns):.2f} rad across half of patch {', '.join(wide)}: "
            line += "too wide for half-spaces"
        if unsolved := SideValues(data, str(side)).unsolved:
            line += f"; {unsolved}: use strips"
        lines.append(f"{line}; {significant(float(own['contact_seconds']), 2)} s")
    return lines
