"""Figures of a run: attitude of the wheelsets, forces of all wheels, motion of the bodies; of the plane wagon those of
Figs. 11 to 20 of the paper.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from functools import partial
from itertools import cycle
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from wheelrail.scenes.datasets.run_file import is_of_wagon
from wheelrail.scenes.plots.style import PRESSURE_MAP, SERIES, SIDES, literal, save, styled
from wheelrail.scenes.quantities import RUN
from wheelrail.support.arrays import Array

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure
    from xarray import DataArray, Dataset

LEAST_RANGE = 1e-3  # mm, kN or N, of axes over distance: below the tolerances of runs
# A body on two bogies at a distance a lies inside the centre line of a curve by a^2 / 8R at its own centre.
CHORD = "in curves y of a long body contains the rise of its chord"
LARGEST_OFFSET, LONGEST_ARROW = 0.3, 1.0  # m in the plan view: displacement of a wheel, force


def draw_figures(data: Dataset, folder: Path) -> Iterator[Path]:
    """Save the figures and yield their files; none for fewer than two samples.

    Parameters:
        data: Dataset of a run.
        folder: for the files.
    """
    if data.sizes["time"] < 2:
        return
    folder.mkdir(parents=True, exist_ok=True)
    for name, draw in pictures_of(data).items():
        with styled():
            save(draw(data), folder / f"{name}.png")
        yield folder / f"{name}.png"


def pictures_of(data: Dataset) -> dict[str, Callable[..., Figure]]:
    """Functions that draw a run, by name: of the plane wagon those of the paper; with speed and creep forces where the
    speed of another vehicle changes or loads are applied, and with forces of check rails where flanges touch any.
    """
    if is_of_wagon(data):
        return PAPER
    changes = float(np.ptp(data["speed"].values)) > 0.0
    loaded = changes or "applied_torque" in data or "applied_force" in data
    checked = {"check_rail": partial(of_wheels, "check_rail_force")} if "check_rail_force" in data else {}
    return PICTURES | checked | ({"traction": traction} if loaded else {})


def displacements(data: Dataset, figure: Figure | None = None) -> Figure:
    """Lateral displacement of the wheelsets and of the first body, Figs. 11 and 12."""
    figure, axes = along_track(data, 2, figure=figure)
    for ax, bodies in zip(axes, (data["wheelset"].values, data["body"].values[:1]), strict=True):
        _lines(ax, data, 1e3 * data["body_y"].sel(body=bodies), "body")
        ax.set_title("Lateral displacement")
        ax.set_ylabel(RUN["body_y"].axis)
        least_range(ax)
    return figure


def of_wheels(name: str, data: Dataset, figure: Figure | None = None) -> Figure:
    """A quantity of all wheels, Figs. 13 to 16: one panel for each wheelset.

    Parameters:
        name: of a variable.
        data: Dataset of a run.
        figure: Matplotlib figure; a new one by default.
    """
    own, names = RUN[name], data["wheelset"].values.tolist()
    figure, axes = along_track(data, len(names), sharey=True, figure=figure)
    for ax, wheelset in zip(axes, names, strict=True):
        for side, style in SIDES.items():
            values = own.scale * data[name].sel(wheelset=wheelset, side=side)
            ax.plot(data["distance"], values, label=named(side, data), **style)
        ax.set_title(own.title + _suffix(wheelset, names))
        ax.set_ylabel(own.axis)
        least_range(ax)
    axes[0].legend(loc="best", ncols=2, frameon=True, framealpha=0.85, edgecolor="none")
    return figure


def attitude(data: Dataset, figure: Figure | None = None) -> Figure:
    """Plan view of the wheelsets and the forces on their wheels at the largest sum of guiding forces."""
    from matplotlib.figure import Figure

    figure = Figure() if figure is None else figure
    figure.set_size_inches(7.2, 3.4)
    figure.set_layout_engine("constrained")
    ax = figure.subplots()
    at = data.isel(time=sample_of_largest_forces(data))
    wheelsets = at.sel(body=at["wheelset"].values)
    x = wheelsets["nominal_x"].values
    y, yaw, half = wheelsets["body_y"].values, wheelsets["body_yaw"].values, float(data.attrs["wheel_y"])
    factor = round_down(LARGEST_OFFSET / max(float(np.max(np.abs(y) + half * np.abs(yaw))), 1e-6))
    sides = np.array([1.0, -1.0])
    centres = np.stack([x[:, None] - half * sides * factor * yaw[:, None], factor * y[:, None] + half * sides], axis=-1)
    for rail in (half, -half):
        ax.axhline(rail, color="0.75", linewidth=3.0, zorder=1)
    _draw_wheelsets(ax, centres, factor * yaw, float(data.attrs["nominal_radius"]))
    force = np.stack([at["longitudinal_force"].values, at["lateral_force"].values], axis=-1)
    largest = round_down(float(np.nanmax(np.linalg.norm(force, axis=-1)))) or 1.0
    _draw_forces(ax, centres, force, largest)
    place = f"{float(at['distance']):.0f} m along the track"
    ax.set_title(f"Attitude of the wheelsets at {place}: displacements and yaw times {factor:g}, track straightened")
    ax.set_xlabel("along the vehicle, forward [m]")
    ax.set_ylabel("to the left [m]")
    ax.set_ylim(-half - LARGEST_OFFSET - LONGEST_ARROW, half + LARGEST_OFFSET + LONGEST_ARROW)
    ax.grid(visible=False)
    return figure


def _draw_wheelsets(ax: Axes, centres: Array, yaw: Array, radius: float) -> None:
    """Axles and wheels in plan view; centres: (w, 2, 2) m of the wheels, yaw: (w,) rad."""
    for pair, angle in zip(centres, yaw, strict=True):
        ax.plot(*pair.T, color="0.15", linewidth=1.5, zorder=2)
        for x, y in pair:
            along = radius * np.array([1.0, angle])
            ax.plot([x - along[0], x + along[0]], [y - along[1], y + along[1]], color="0.15", linewidth=4.0, zorder=3)


def _draw_forces(ax: Axes, centres: Array, force: Array, largest: float) -> None:
    """Arrows of the horizontal forces (w, 2, 2) N on the wheels; largest: N, of the key."""
    arrows = ax.quiver(
        *np.moveaxis(centres, -1, 0),
        *np.moveaxis(np.nan_to_num(force), -1, 0),
        color=SIDES["right"]["color"],
        angles="xy",
        scale_units="xy",
        scale=largest / LONGEST_ARROW,
        width=0.004,
        zorder=4,
    )
    ax.quiverkey(arrows, 0.45, 0.06, largest, f"{1e-3 * largest:g} kN on the wheel", labelpos="E", coordinates="axes")
    ax.margins(x=0.12)


def sample_of_largest_forces(data: Dataset) -> int:
    """Index of the sample with the largest sum of the guiding forces' magnitudes."""
    total = abs(data["guiding_force"]).sum(["wheelset", "side"])
    return int(np.argmax(total.values))


def round_down(value: float) -> float:
    """Largest of 1, 2, 5 times a power of ten that does not exceed a positive value; 0 for 0."""
    if not value > 0.0:
        return 0.0
    power = 10.0 ** np.floor(np.log10(value))
    return float(power * max(digit for digit in (1.0, 2.0, 5.0) if digit <= value / power * (1 + 1e-12)))


def track_shifting_forces(data: Dataset, figure: Figure | None = None) -> Figure:
    """Sums of Y of all wheelsets."""
    figure, (ax,) = along_track(data, 1, figure=figure)
    _lines(ax, data, 1e-3 * data["track_shifting_force"], "wheelset")
    ax.set_title("Lateral force on the track, sum of Y of every wheelset")
    ax.set_ylabel(RUN["track_shifting_force"].axis)
    return figure


def wheelset_motion(data: Dataset, figure: Figure | None = None) -> Figure:
    """Lateral displacement and yaw of all wheelsets."""
    return _motion(data.sel(body=data["wheelset"].values), "of the wheelsets", figure)


def body_motion(data: Dataset, figure: Figure | None = None) -> Figure:
    """Lateral displacement and yaw of all other bodies."""
    bodies = [name for name in data["body"].values if name not in data["wheelset"].values]
    figure = _motion(data.sel(body=bodies), "of the bodies above", figure)
    if np.any(data["curvature"].values):
        figure.axes[0].set_xlabel(CHORD, loc="left", color="0.45", fontsize=8)
    return figure


def traction(data: Dataset, figure: Figure | None = None) -> Figure:
    """Over time: speed of the vehicle and of the rims of its wheels, creep forces, and torques of the wheelsets."""
    from matplotlib.figure import Figure

    figure, torque = Figure() if figure is None else figure, "applied_torque" in data
    figure.set_size_inches(7.2, 7.3 if torque else 5.2)
    figure.set_layout_engine("constrained")
    axes = list(figure.subplots(3 if torque else 2, 1, sharex=True))
    excess = data["body_pitch_rate"].sel(body=data["wheelset"].values).rename(body="wheelset")
    rim = data["speed"] + float(data.attrs["nominal_radius"]) * excess
    _lines(axes[0], data, rim, "wheelset", over="time")
    axes[0].plot(data["time"], data["speed"], color="0.15", linewidth=1.0, linestyle=":", label="vehicle")
    axes[0].set_title("Speed of the vehicle, and of the rims of its wheels")
    axes[0].set_ylabel("speed [m/s]")
    axes[0].legend(loc="best", ncols=2)
    _lines(axes[1], data, 1e-3 * data["longitudinal_force"].sum("side", skipna=False), "wheelset", over="time")
    axes[1].set_title("Longitudinal force of the rails on every wheelset")
    axes[1].set_ylabel("force, forwards [kN]")
    if torque:
        _lines(axes[2], data, 1e-3 * data["applied_torque"], "wheelset", over="time")
        axes[2].set_title("Torque of motors and brakes on every wheelset")
        axes[2].set_ylabel("torque, forwards [kN m]")
    axes[-1].set_xlabel("time [s]")
    return figure


def energy(data: Dataset) -> Figure:
    """Change of the mechanical energy and work by cause, kJ, over distance."""
    figure, (ax,) = along_track(data, 1)
    change = 1e-3 * (data["mechanical_energy"] - data["mechanical_energy"][0])
    ax.plot(data["distance"], change, color="0.15", linewidth=1.6, label="mechanical energy")
    for cause, look in zip(data["cause"].values, cycle(SERIES), strict=False):
        style = {key: value for key, value in look.items() if key != "marker"}
        ax.plot(data["distance"], 1e-3 * data["work"].sel(cause=cause), label=f"work of {cause}", **style)
    ax.set_title("Mechanical energy and work since the start")
    ax.set_ylabel("energy [kJ]")
    ax.legend(loc="best", fontsize=7.5)
    return figure


def _motion(data: Dataset, title: str, figure: Figure | None) -> Figure:
    figure, (top, bottom) = along_track(data, 2, figure=figure)
    _lines(top, data, 1e3 * data["body_y"], "body")
    top.set_title(f"Lateral displacement {title}, from the centre line")
    top.set_ylabel(RUN["body_y"].axis)
    _lines(bottom, data, 1e3 * data["body_yaw"], "body")
    bottom.set_title(f"Yaw {title}")
    bottom.set_ylabel(RUN["body_yaw"].axis)
    return figure


def _lines(ax: Axes, data: Dataset, values: DataArray, dimension: str, over: str = "distance") -> None:
    """One line for each name of a dimension, over distance or time."""
    for name, style in zip(values[dimension].values, cycle(SERIES), strict=False):
        line: dict[str, Any] = {key: style[key] for key in ("color", "linestyle")}
        ax.plot(data[over], values.sel({dimension: name}), label=literal(str(name)), **line)
    ax.legend(loc="best", ncols=2)


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
    figure.set_size_inches(7.2, 3.6 if count == 1 else 1.0 + 2.1 * count)
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


def _suffix(name: str, names: Sequence[str]) -> str:
    """Name of a wheelset in a title, where there are several."""
    return f", {literal(name)}" if len(names) > 1 else ""


def least_range(ax: Axes) -> None:
    """Widen the y axis to the least range, so that round-off errors are a straight line."""
    low, high = ax.get_ylim()
    if high - low < LEAST_RANGE:
        middle = 0.5 * (low + high)
        ax.set_ylim(middle - 0.5 * LEAST_RANGE, middle + 0.5 * LEAST_RANGE)


def patch_bands(body: str, data: Dataset, figure: Figure | None = None) -> Figure:
    """Lateral extent of every patch along the track, coloured by peak pressure, Figs. 17 to 20: a panel for each wheel.

    Parameters:
        body: "wheel" or "rail".
        data: Dataset of a run.
        figure: Matplotlib figure; a new one by default.
    """
    from matplotlib.cm import ScalarMappable
    from matplotlib.collections import PolyCollection
    from matplotlib.colors import Normalize

    names = data["wheelset"].values.tolist()
    wheels = [(name, side) for name in names for side in SIDES]
    figure, axes = along_track(data, len(wheels), sharey=True, figure=figure)
    peak = RUN["patch_max_pressure"]
    band, pressure = RUN[f"{body}_band"].scale * data[f"{body}_band"], peak.scale * data["patch_max_pressure"]
    shade = Normalize(0.0, float(pressure.max(skipna=True).fillna(1.0)))
    for ax, (name, side) in zip(axes, wheels, strict=True):
        at = {"wheelset": name, "side": side}
        shapes, values = _strips(data["distance"].values, band.sel(at), pressure.sel(at))
        strips = PolyCollection(list(shapes), cmap=PRESSURE_MAP, norm=shade, edgecolors="face", linewidths=0.2)
        strips.set_array(values)
        ax.add_collection(strips)
        ax.autoscale_view(scalex=False)
        ax.set_title(f"Contact on the {named(side, data)} {body}{_suffix(name, names)}")
        ax.set_ylabel(RUN[f"{body}_band"].axis.replace(", ", ",\n"))
    bar = figure.colorbar(ScalarMappable(shade, PRESSURE_MAP), ax=axes, pad=0.01, aspect=40)
    bar.set_label(f"{peak.text} [{peak.shown}]")
    return figure


def _strips(distance: Array, band: DataArray, pressure: DataArray) -> tuple[Array, Array]:
    """Rectangles (n, 4, 2), one per patch and sample, and their pressures (n,)."""
    edges = np.concatenate([distance[:1], 0.5 * (distance[1:] + distance[:-1]), distance[-1:]])
    sample, patch = np.nonzero(np.isfinite(pressure.values))
    bottom, top = band.values[sample, patch].T
    start, end = edges[sample], edges[sample + 1]
    corners = [(start, bottom), (end, bottom), (end, top), (start, top)]
    return np.moveaxis(np.array(corners), 2, 0), pressure.values[sample, patch]


PAPER: dict[str, Callable[..., Figure]] = {
    "lateral_displacement": displacements,
    "lateral_force": partial(of_wheels, "lateral_force"),
    "vertical_force": partial(of_wheels, "vertical_force"),
    "contact_on_wheel": partial(patch_bands, "wheel"),
    "contact_on_rail": partial(patch_bands, "rail"),
}
PICTURES: dict[str, Callable[..., Figure]] = {
    "attitude": attitude,
    "guiding_force": partial(of_wheels, "guiding_force"),
    "wheel_load": partial(of_wheels, "vertical_force"),
    "derailment_quotient": partial(of_wheels, "derailment_quotient"),
    "track_shifting_force": track_shifting_forces,
    "t_gamma": partial(of_wheels, "t_gamma"),
    "wheelset_motion": wheelset_motion,
    "body_motion": body_motion,
}
