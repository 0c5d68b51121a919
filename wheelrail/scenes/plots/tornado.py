"""Tornado diagrams: a quantity when each parameter alone has the lower and the upper end of its range."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING

import numpy as np

from wheelrail.scenes.plots.style import literal
from wheelrail.support.arrays import Array

if TYPE_CHECKING:
    from matplotlib.axes import Axes

LOW, HIGH = "#0072B2", "#D55E00"
MOST = 20  # parameters


def tornado(ax: Axes, labels: Sequence[str], values: Array, nominal: float, label: str) -> None:
    """Bars from the nominal value, the longest on top.

    Parameters:
        ax: axes.
        labels: (p,) parameters with their ranges.
        values: (p, 2) at the lower and the upper end; NaN of failed cases.
        nominal: value without variation.
        label: of the quantity with its unit.
    """
    order = np.argsort(np.nanmax(np.abs(np.nan_to_num(values - nominal)), axis=1))[-MOST:]
    rows = np.arange(len(order))
    for column, (color, name) in enumerate(((LOW, "lower end"), (HIGH, "upper end"))):
        ax.barh(rows, values[order, column] - nominal, 0.7, left=nominal, color=color, alpha=0.85, label=name)
    ax.axvline(nominal, color="0.15", linewidth=1.0)
    ax.set_yticks(rows, [literal(labels[k]) for k in order.tolist()], fontsize=7)
    ax.set(xlabel=label, ylabel="parameter")
    ax.grid(axis="y", visible=False)


def range_label(attributes: Mapping[str, str], ends: Array) -> str:
    """Name of a parameter, by the attributes of its variable, with both ends (2,) of its range and its unit."""
    unit = attributes["units"] if attributes["units"] != "1" else ""
    return f"{attributes['long_name']} {ends[0]:.4g} to {ends[1]:.4g} {unit}".strip()
