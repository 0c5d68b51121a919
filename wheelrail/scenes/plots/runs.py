"""Figures of a vehicle run, as Figs. 11 to 20 of the paper: displacements, forces, contact positions."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from wheelrail.scenes.plots.style import PRESSURE_MAP, SIDES, save, styled
from wheelrail.support.arrays import Array

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure
    from xarray import DataArray, Dataset

LEAST_RANGE = 1e-3  # mm, kN or N, of axes over distance: below the tolerances of runs


def draw_figures(
    data: Dataset, folder: Path, pictures: Mapping[str, Callable[..., Figure]] | None = None
) -> Iterator[Path]:
    """Save the figures and yield their files; none for fewer than two samples.

    Parameters:
        data: Dataset of a run.
        folder: for the files.
        pictures: functions that draw, by name; by default those of the plane wagon.
    """
    if data.sizes["time"] < 2:
        return
    folder.mkdir(parents=True, exist_ok=True)
    for name, draw in (PICTURES if pictures is None else pictures).items():
        with styled():
            save(draw(data), folder / f"{name}.png")
        yield folder / f"{name}.png"


def displacements(data: Dataset, figure: Figure | None = None) -> Figure:
    """Lateral displacement of wheelset and car body, Figs. 11 and 12."""
    figure, axes = along_track(data, 2, figure=figure)
    for ax, name, title in zip(axes, ("wheelset_y", "car_body_y"), ("wheelset", "car body"), strict=True):
        ax.plot(data["distance"], 1e3 * data[name], color="0.15")
        ax.set_title(f"Lateral displacement of the {title}")
        ax.set_ylabel("y, positive to the left [mm]")
        least_range(ax)
    return figure


def lateral_forces(data: Dataset, figure: Figure | None = None) -> Figure:
    """Lateral contact forces on both wheels, Figs. 13 and 15."""
    return _by_side(
        data, "lateral_force", 1e-3, "Lateral contact force on the wheels", "Y, positive to the left [kN]", figure
    )


def vertical_forces(data: Dataset, figure: Figure | None = None) -> Figure:
    """Vertical contact forces on both wheels, Figs. 14 and 16."""
    return _by_side(
        data, "vertical_force", 1e-3, "Vertical contact force on the wheels", "Q, positive upwards [kN]", figure
    )


def t_gamma(data: Dataset, figure: Figure | None = None) -> Figure:
    """Frictional energy per metre of track, both wheels."""
    return _by_side(data, "t_gamma", 1.0, "T-gamma of the wheels", "frictional energy per metre [N]", figure)


def wheel_sections(data: Dataset, figure: Figure | None = None) -> Figure:
    """Sections of the contact areas on the wheels, Figs. 17 and 18."""
    return patch_bands(data, "wheel", "from the rolling circle,\npositive to the field side [mm]", figure)[0]


def rail_sections(data: Dataset, figure: Figure | None = None) -> Figure:
    """Sections of the contact areas on the rails, Figs. 19 and 20."""
    return patch_bands(data, "rail", "from the top of the rail,\npositive to the field side [mm]", figure)[0]


PICTURES: dict[str, Callable[..., Figure]] = {
    "lateral_displacement": displacements,
    "lateral_force": lateral_forces,
    "vertical_force": vertical_forces,
    "contact_on_wheel": wheel_sections,
    "contact_on_rail": rail_sections,
}


def named(side: str, data: Dataset) -> str:
    """Side with "inner" or "outer" if all curves have the same direction."""
    curvature = data["curvature"].values
    extreme = float(curvature[np.argmax(np.abs(curvature))])
    if extreme == 0.0 or curvature.min() * curvature.max() < 0.0:
        return side
    return f"{side} ({'inner' if (extreme > 0.0) == (side == 'left') else 'outer'})"


def along_track(
    data: Dataset, count: int, *, sharey: bool = False, figure: Figure | None = None
) -> tuple[Figure, list[Axes]]:
    """Panels over distance, with curves of the track shaded in grey.

    Parameters:
        data: Dataset of a run.
        count: number of panels.
        sharey: whether they share the y axis.
        figure: Matplotlib figure; a new one by default.
    """
    from matplotlib.figure import Figure

    figure = Figure() if figure is None else figure
    figure.set_size_inches(7.2, 1.0 + 2.1 * count)
    figure.set_layout_engine("constrained")
    axes = list(np.atleast_1d(figure.subplots(count, 1, sharex=True, sharey=sharey)))
    distance, curvature = data["distance"].values, data["curvature"].values
    for ax in axes:
        _shade(ax, distance, curvature)
        ax.set_xlim(distance[0], distance[-1])
    largest = np.abs(curvature).max()
    if largest > 0.0:
        directions = [
            direction
            for direction, extreme in (("left", curvature.max()), ("right", -curvature.min()))
            if extreme > 0.0
        ]
        text = f"grey: {' and '.join(directions)}-hand curve, darkest at R = {1.0 / largest:.0f} m"
        axes[0].set_title(text, loc="right", color="0.45", fontsize=8)
    axes[-1].set_xlabel("distance along the track [m]")
    return figure, axes


def _shade(ax: Axes, distance: Array, curvature: Array) -> None:
    """Grey background in curves, darker at the full curvature."""
    largest = np.abs(curvature).max()
    if largest == 0.0:
        return
    fraction = np.abs(curvature) / largest
    for level, grey in ((1e-9, "0.965"), (1.0 - 1e-6, "0.92")):
        ax.fill_between(
            distance,
            0,
            1,
            where=fraction >= level,
            transform=ax.get_xaxis_transform(),
            color=grey,
            linewidth=0,
            zorder=0,
        )


def _by_side(data: Dataset, name: str, scale: float, title: str, label: str, figure: Figure | None) -> Figure:
    figure, (ax,) = along_track(data, 1, figure=figure)
    figure.set_size_inches(7.2, 3.6)
    for side, style in SIDES.items():
        ax.plot(data["distance"], scale * data[name].sel(side=side), label=named(side, data), **style)
    ax.set_title(title)
    ax.set_ylabel(label)
    least_range(ax)
    ax.legend(loc="best", ncols=2, frameon=True, framealpha=0.85, edgecolor="none")
    return figure


def least_range(ax: Axes) -> None:
    """Widen the y axis to the least range, so that round-off errors are a straight line."""
    low, high = ax.get_ylim()
    if high - low < LEAST_RANGE:
        middle = 0.5 * (low + high)
        ax.set_ylim(middle - 0.5 * LEAST_RANGE, middle + 0.5 * LEAST_RANGE)


def patch_bands(data: Dataset, body: str, label: str, figure: Figure | None = None) -> tuple[Figure, list[Axes]]:
    """Lateral extent of every patch along the track, coloured by peak pressure.

    Parameters:
        data: Dataset of a run.
        body: "wheel" or "rail".
        label: of the y axes.
        figure: Matplotlib figure; a new one by default.
    """
    from matplotlib.cm import ScalarMappable
    from matplotlib.collections import PolyCollection
    from matplotlib.colors import Normalize

    figure, axes = along_track(data, 2, sharey=True, figure=figure)
    band, pressure = 1e3 * data[f"{body}_band"], 1e-6 * data["patch_max_pressure"]
    shade = Normalize(0.0, float(pressure.max(skipna=True).fillna(1.0)))
    for ax, side in zip(axes, SIDES, strict=True):
        shapes, values = _strips(data["distance"].values, band.sel(side=side), pressure.sel(side=side))
        strips = PolyCollection(list(shapes), cmap=PRESSURE_MAP, norm=shade, edgecolors="face", linewidths=0.2)
        strips.set_array(values)
        ax.add_collection(strips)
        ax.autoscale_view(scalex=False)
        ax.set_title(f"Contact on the {named(side, data)} {body}")
        ax.set_ylabel(label)
    bar = figure.colorbar(ScalarMappable(shade, PRESSURE_MAP), ax=axes, pad=0.01, aspect=40)
    bar.set_label("peak pressure of the patch [MPa]")
    return figure, axes


def _strips(distance: Array, band: DataArray, pressure: DataArray) -> tuple[Array, Array]:
    """Rectangles (n, 4, 2), one per patch and sample, and their pressures (n,)."""
    edges = np.concatenate([distance[:1], 0.5 * (distance[1:] + distance[:-1]), distance[-1:]])
    sample, patch = np.nonzero(np.isfinite(pressure.values))
    bottom, top = band.values[sample, patch].T
    start, end = edges[sample], edges[sample + 1]
    corners = [(start, bottom), (end, bottom), (end, top), (start, top)]
    return np.moveaxis(np.array(corners), 2, 0), pressure.values[sample, patch]
