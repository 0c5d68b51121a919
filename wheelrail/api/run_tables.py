"""Summary table of a vehicle run, as text and HTML."""

from __future__ import annotations

from html import escape
from typing import TYPE_CHECKING

import numpy as np

from wheelrail.scenes.datasets.number_text import fixed

if TYPE_CHECKING:
    from xarray import Dataset

# Row: variable, its unit in SI units, digits.
ROWS: dict[str, tuple[str, float, int]] = {
    "Y, positive to the left [kN]": ("lateral_force", 1e3, 2),
    "Q, positive upwards [kN]": ("vertical_force", 1e3, 2),
    "peak pressure [MPa]": ("patch_max_pressure", 1e6, 0),
    "wheel y [mm]": ("wheel_y", 1e-3, 2),
}


def text(data: Dataset) -> str:
    """Status, and ranges of forces, pressure and contact positions by side."""
    rows = _rows(data)
    width = [max(len(row[i]) for row in rows) for i in range(len(rows[0]))]
    lines = [
        "  ".join([row[0].ljust(width[0]), *(cell.rjust(w) for cell, w in zip(row[1:], width[1:], strict=True))])
        for row in rows
    ]
    return "\n".join([_heading(data), *lines])


def html(data: Dataset) -> str:
    """The same in HTML, with the Dataset in a collapsed section below."""
    table = "".join("<tr>" + "".join(f"<td>{escape(cell)}</td>" for cell in row) + "</tr>" for row in _rows(data))
    return (
        f"<div><b>{escape(_heading(data))}</b><table>{table}</table>"
        f"<details><summary>data</summary>{data._repr_html_()}</details></div>"
    )


def _heading(data: Dataset) -> str:
    """One line: status, distance and time reached, lateral range, computing time."""
    reached, time = float(data["distance"].values[-1]), float(data["time"].values[-1])
    y = 1e3 * data["body_y"].sel(body=data["wheelset"].values).values
    bodies = "wheelsets" if data.sizes["wheelset"] > 1 else "wheelset"
    return (
        f"Vehicle run: {data.attrs['status']} at {reached:.1f} m, {time:.2f} s; {data.sizes['time']} samples, "
        f"{bodies} y {fixed(y.min(), 2)} to {fixed(y.max(), 2)} mm; {float(data.attrs['seconds']):.1f} s computing time"
    )


def _rows(data: Dataset) -> list[list[str]]:
    sides = [str(side) for side in data["side"].values]
    rows = [["minimum to maximum", *sides]]
    for label, (name, unit, digits) in ROWS.items():
        cells = []
        for side in sides:
            values = data[name].sel(side=side).values
            finite = values[np.isfinite(values)] / unit
            cells.append(f"{fixed(finite.min(), digits)} to {fixed(finite.max(), digits)}" if finite.size else "-")
        rows.append([label, *cells])
    return rows
