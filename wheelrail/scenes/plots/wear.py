"""Figures of wear: worn profiles, depth and measures over the distance, rates and fatigue by case."""

from __future__ import annotations

from collections.abc import Callable
from typing import TYPE_CHECKING

import numpy as np

from wheelrail.scenes.datasets.wear import WEAR
from wheelrail.scenes.plots.style import PRESSURE_MAP, SERIES, literal, shown

if TYPE_CHECKING:
    from matplotlib.figure import Figure
    from xarray import Dataset

MAGNIFIED, CURVES = 20.0, 6  # scale of depths on profiles, and number of these
ALONG = "arc length on the new profile, flange side negative [mm]"
MEASURED = (("Sh", "Sd", "qR"), ("hollow",), ("removed_section",), ("conicity",))


def _some(data: Dataset) -> list[int]:
    """Steps, evenly over the distance."""
    count = data.sizes["step"]
    return sorted({int(k) for k in np.linspace(0, count - 1, min(count, CURVES))})


def _distance(data: Dataset) -> np.ndarray:  # type: ignore[type-arg]
    """Distance of the steps, 1000 km."""
    return np.asarray(1e-6 * data["distance"].values)


def profiles(data: Dataset, figure: Figure | None = None, *, scale: float = MAGNIFIED) -> Figure:
    """Profiles over the distance, depths magnified."""
    from matplotlib import colormaps

    figure = shown(figure, (7.2, 3.4 * data.sizes["profile"]))
    for own, name, ax in zip(
        range(data.sizes["profile"]),
        data["profile"].values,
        np.atleast_1d(figure.subplots(data.sizes["profile"], 1)),
        strict=True,
    ):
        y, z = (1e3 * data[key].values[own] for key in ("new_y", "new_z"))
        slope = np.stack([np.gradient(y), np.gradient(z)])
        normal = np.stack([-slope[1], slope[0]]) / np.hypot(*slope)
        inwards = normal if normal[1].mean() < 0.0 else -normal
        ax.plot(y, z, color="0.2", label="new")
        steps = [step for step in _some(data) if step]
        for k, step in enumerate(steps):
            depth = 1e3 * scale * data["depth"].values[step, own]
            colour = colormaps[PRESSURE_MAP](k / max(len(steps) - 1, 1) * 0.85)
            moved = np.stack([y, z]) + inwards * depth
            ax.plot(*moved, color=colour, label=f"{1e3 * _distance(data)[step]:.0f} km")
        ax.set(
            xlabel="y, positive to the field side [mm]",
            ylabel="z, positive away from the axle [mm]",
            title=f"{literal(str(name))}: depths magnified {scale:g} times",
        )
        ax.set_aspect("equal")
        ax.invert_yaxis()  # as it stands on the rail
        ax.legend()
    return figure


def depth(data: Dataset, figure: Figure | None = None) -> Figure:
    """Depth over arc length and distance."""
    figure = shown(figure, (7.2, 3.2 * data.sizes["profile"]))
    axes = np.atleast_1d(figure.subplots(data.sizes["profile"], 1))
    for own, (name, ax) in enumerate(zip(data["profile"].values, axes, strict=True)):
        s, values = 1e3 * data["s"].values, 1e3 * data["depth"].values[:, own]
        worn = np.flatnonzero(values.max(axis=0) > 0.0)
        part = slice(worn[0], worn[-1] + 1) if worn.size else slice(None)
        mesh = ax.pcolormesh(s[part], 1e3 * _distance(data), values[:, part], shading="gouraud")
        figure.colorbar(mesh, ax=ax, label="depth [mm]")
        ax.set(xlabel=ALONG, ylabel="distance [km]", title=literal(str(name)))
    return figure


def measures(data: Dataset, figure: Figure | None = None) -> Figure:
    """Changes of Sh, Sd and qR, hollow, removed section and conicity over the distance."""
    figure = shown(figure, (7.2, 5.0))
    for names, ax in zip(MEASURED, figure.subplots(2, 2).flat, strict=True):
        for k, name in enumerate(names):
            values = WEAR[name].scale * data[name].values.reshape(data.sizes["step"], -1)
            if len(names) > 1:
                values = values - values[0]
            for own in range(values.shape[1]):
                label = name if values.shape[1] == 1 else f"{name}, {data['profile'].values[own]}"
                ax.plot(1e3 * _distance(data), values[:, own], **SERIES[(k + 3 * own) % len(SERIES)], ms=3, label=label)
        what = "change since new [mm]" if len(names) > 1 else WEAR[names[0]].head
        ax.set(xlabel="distance [km]", ylabel=what)
        if len(names) > 1 or data.sizes["profile"] > 1:
            ax.legend()
    return figure


def duty(data: Dataset, figure: Figure | None = None) -> Figure:
    """Rates of depth by case, new and at the last step."""
    return _by_case(data, figure, "depth_rate", 1e10, "depth [mm in 10 000 km]")


def fatigue(data: Dataset, figure: Figure | None = None) -> Figure:
    """T-gamma damage by case, new and at the last step; never a sum with wear."""
    return _by_case(data, figure, "damage_rate", 1.0, "T-gamma damage [1/m per m]")


def rails(data: Dataset, figure: Figure | None = None) -> Figure | None:
    """Depth of the rails along their profiles at some steps; None without rails that wear."""
    from matplotlib import colormaps

    if "rail" not in data.dims:
        return None
    count = data.sizes["rail"]
    figure = shown(figure, (7.2, 2.6 * ((count + 1) // 2)))
    axes = figure.subplots((count + 1) // 2, 2, squeeze=False, sharex=True, sharey=True)
    steps = [step for step in _some(data) if step] or [0]
    for own, ax in enumerate(axes.flat[:count]):
        for k, step in enumerate(steps):
            ax.plot(
                1e3 * data["rail_s"].values[own],
                1e3 * data["rail_depth"].values[step, own],
                color=colormaps[PRESSURE_MAP](k / max(len(steps) - 1, 1) * 0.85),
                label=f"{data['passages'].values[step]:.3g} wheelsets",
            )
        ax.set(title=literal(str(data["rail"].values[own])), xlabel="arc length, gauge side negative [mm]")
    for row in axes:
        row[0].set_ylabel("depth [mm]")
    axes[0, 0].legend()
    return figure


def _by_case(data: Dataset, figure: Figure | None, name: str, scale: float, label: str) -> Figure:
    figure = shown(figure, (7.2, 2.8 * data.sizes["profile"]))
    rated = np.flatnonzero(np.isfinite(data["t_gamma"].values).all(axis=1))
    axes = figure.subplots(data.sizes["profile"], 2, sharey="row", squeeze=False)
    for own, row in enumerate(axes):
        for ax, step in zip(row, (rated[0], rated[-1]), strict=True):
            for k, case in enumerate(data["case"].values):
                style = {key: value for key, value in SERIES[k % len(SERIES)].items() if key != "marker"}
                ax.plot(
                    1e3 * data["s"].values,
                    scale * data[name].values[step, k, own],
                    label=f"{literal(str(case))}, {100 * float(data['share'].values[k]):g} %",
                    **style,
                )
            title = f"{literal(str(data['profile'].values[own]))}, {1e3 * _distance(data)[step]:.0f} km"
            ax.set(xlabel="arc length [mm]", title=title)
        row[0].set_ylabel(label)
    axes[0, 0].legend()
    return figure


PICTURES: dict[str, Callable[..., Figure | None]] = {
    "profiles": profiles,
    "depth": depth,
    "measures": measures,
    "duty": duty,
    "fatigue": fatigue,
    "rails": rails,
}
