"""Figure of a table of contact forces: height over position, creep forces, and errors off the nodes."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from wheelrail.scenes.plots.style import SERIES, save, styled
from wheelrail.support.arrays import Array

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure
    from xarray import Dataset

LEAST = 1e-3  # % of the load, smallest error that is drawn


def draw_table(data: Dataset, file: Path) -> None:
    """Save the figure of the first side. Raises OSError."""
    with styled():
        save(table_figure(data), file)


def table_figure(data: Dataset) -> Figure:
    """Height of the tread at all loads, creep forces in the middle, and errors over lateral position, of the first
    side.
    """
    from matplotlib.figure import Figure

    figure = Figure(figsize=(7.2, 6.0), layout="constrained")
    axes = figure.subplots(2, 2)
    side = str(data.attrs["sides"]).split()[0]
    _heights(data, side, axes[0, 0])
    _creep_forces(data, side, axes[0, 1])
    _angles(data, side, axes[1, 0])
    _errors(data, side, axes[1, 1])
    return figure


def _middle(data: Dataset, name: str, column: int) -> tuple[Array, Array, Array]:
    """Nodes over y, loads kN, and one column of the values at the middle roll and yaw."""
    values = data[f"{name}_values"].values
    middle = values[:, values.shape[1] // 2, values.shape[2] // 2, :, column]
    return data[f"{name}_y"].values, 1e-3 * data[f"{name}_level"].values ** 1.5, middle


def _heights(data: Dataset, side: str, ax: Axes) -> None:
    y, loads, heights = _middle(data, f"{side}_normal", 0)
    for k, look in zip(np.linspace(0, len(loads) - 1, 4).astype(int), SERIES, strict=False):
        ax.plot(1e3 * y, 1e3 * heights[:, k], **{**look, "marker": "."}, markersize=3, label=f"{loads[k]:.0f} kN")
    ax.set(xlabel="lateral position [mm]", ylabel="height [mm]", title="height of the wheel, nodes")
    ax.legend()


def _angles(data: Dataset, side: str, ax: Axes) -> None:
    y, loads, ratio = _middle(data, f"{side}_normal", 4)
    for k, look in zip(np.linspace(1, len(loads) - 1, 4).astype(int), SERIES, strict=False):
        ax.plot(1e3 * y, ratio[:, k], **{**look, "marker": "."}, markersize=3, label=f"{loads[k]:.0f} kN")
    ax.set(xlabel="lateral position [mm]", ylabel="$F_y / F_z$ [1]", title="direction of the normal force")
    ax.legend()


def _creep_forces(data: Dataset, side: str, ax: Axes) -> None:
    values = data[f"{side}_friction_values"].values
    place = tuple(size // 2 for size in values.shape[:4])
    u, v = (np.sinh(data[f"{side}_friction_{axis}"].values) for axis in ("longitudinal", "lateral"))
    for name, scale, row in (
        ("longitudinal", u, values[place][:, len(v) // 2, 0]),
        ("lateral", v, values[place][len(u) // 2, :, 1]),
    ):
        look = SERIES[("longitudinal", "lateral").index(name)]
        ax.plot(np.arcsinh(scale), row, **look, markersize=3, label=name)
    ax.set(
        xlabel="asinh of creepage over its scale",
        ylabel="force over $\\mu N$ [1]",
        title="friction, middle of the table",
    )
    ax.legend()


def _errors(data: Dataset, side: str, ax: Axes) -> None:
    y, error = 1e3 * data[f"{side}_points"].values[:, 0], 100.0 * np.abs(data[f"{side}_force_error"].values)
    for name, column, look in zip(("$F_x$", "$F_y$", "$F_z$"), error.T, SERIES, strict=False):
        ax.semilogy(y, np.maximum(column, LEAST), **{**look, "linestyle": "none"}, markersize=2.5, label=name)
    ax.set(xlabel="lateral position [mm]", ylabel="error [% of the load]", title="table less model, off the nodes")
    ax.set_ylim(LEAST, 20.0 * np.nanmax(error))  # room for the legend
    ax.legend(loc="upper center", ncols=3)
