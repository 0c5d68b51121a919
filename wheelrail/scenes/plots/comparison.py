"""Figures that compare two runs, as Figs. 11 to 20 of the paper, T-gamma, numerical noise, shakedown map."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from wheelrail.scenes.datasets.run_differences import full_curve, rms, scatter, wheels
from wheelrail.scenes.plots.runs import along_track, named, patch_bands
from wheelrail.scenes.plots.style import save, styled
from wheelrail.scenes.quantities import RUN
from wheelrail.scenes.quantity import significant

if TYPE_CHECKING:
    from matplotlib.figure import Figure
    from xarray import Dataset

Runs = Sequence["Dataset"]  # two; one for the shakedown map
Names = Sequence[str]

LOOKS: tuple[dict[str, Any], dict[str, Any]] = (
    {"color": "#0072B2", "linestyle": "-", "linewidth": 1.4},
    {"color": "#D55E00", "linestyle": (0, (4, 1.5)), "linewidth": 1.0},
)
DOTS = "#D55E00"


def draw_comparison(runs: Runs, names: Names, folder: Path) -> Iterator[Path]:
    """Save the figures and yield their files."""
    folder.mkdir(parents=True, exist_ok=True)
    for name, draw in PICTURES.items():
        with styled():
            save(draw(runs, names), folder / f"{name}.png")
        yield folder / f"{name}.png"


def displacements(runs: Runs, names: Names) -> Figure:
    """Lateral displacement of wheelset and car body, Figs. 11 and 12."""
    figure, axes = along_track(runs[0], 2)
    y, first = RUN["body_y"], runs[0]
    for ax, body in zip(axes, (first["wheelset"].values[0], first["body"].values[0]), strict=True):
        for data, label, look in zip(runs, names, LOOKS, strict=True):
            ax.plot(data["distance"], y.scale * data["body_y"].sel(body=body), label=label, **look)
        ax.set_title(f"Lateral displacement of the {body.replace('_', ' ')}")
        ax.set_ylabel(y.axis)
    axes[0].legend(loc="best", ncols=2)
    return figure


def of_wheels(name: str, runs: Runs, names: Names) -> Figure:
    """A quantity of each wheel, Figs. 13 to 16; name: of a variable."""
    own, places = RUN[name], wheels(runs[0])
    figure, axes = along_track(runs[0], len(places))
    for ax, (wheel, place) in zip(axes, places.items(), strict=True):
        for data, run, look in zip(runs, names, LOOKS, strict=True):
            ax.plot(data["distance"], own.scale * data[name].sel(place), label=run, **look)
        ax.set_title(f"{own.title}, {named(wheel, runs[0])}")
        ax.set_ylabel(own.axis)
    axes[0].legend(loc="best", ncols=2)
    return figure


def sections(body: str, runs: Runs, names: Names) -> Figure:
    """Patches of the first model on the wheels or rails as bands, contact points of the second, Figs. 17 to 20."""
    figure, points = patch_bands(body, runs[0]), runs[1]
    for ax, place in zip(figure.axes, wheels(points).values(), strict=False):  # the last axes are the colour bar
        position = 1e3 * points[f"{body}_y"].sel(place).values
        distance = np.broadcast_to(points["distance"].values[:, None], position.shape)
        ax.plot(distance.ravel(), position.ravel(), ".", ms=2.2, color=DOTS, label=f"contact points, {names[1]}")
    figure.axes[0].legend(loc="lower left", title=f"bands: patches, {names[0]}", alignment="left")
    return figure


def force_scatter(runs: Runs, names: Names) -> Figure:
    """Residuals of vertical and lateral forces from local parabolas over 0.1 s: numerical noise in steady motion."""
    panels = [(name, *wheel) for name in ("vertical_force", "lateral_force") for wheel in wheels(runs[0]).items()]
    figure, axes = along_track(runs[0], len(panels))
    for ax, (variable, wheel, place) in zip(axes, panels, strict=True):
        for data, label, look in zip(runs, names, LOOKS, strict=True):
            residual = scatter(data["time"].values, data[variable].sel(place).values)
            style = {"color": look["color"], "linewidth": 0.6}
            noise = rms(residual[full_curve(data)])
            text = f"{label}, RMS {significant(rms(residual), 2)} N, {significant(noise, 2)} N in the full curve"
            ax.plot(data["distance"], residual, label=text, **style)
        ax.set_title(f"Residual noise of the {RUN[variable].label} on the {named(wheel, runs[0])} wheel")
        ax.set_ylabel("[N]")
        ax.legend(loc="lower right", fontsize=7.5)
    return figure


def shakedown_map(runs: Runs, names: Names) -> Figure:
    """Load factor over utilisation of every patch and sample, with the limit for line contact."""
    from matplotlib.figure import Figure

    from wheelrail.contact.stress.shakedown import shakedown_limit

    figure = Figure(figsize=(8.2, 4.2), layout="constrained")
    axes = figure.subplots(1, 2, sharex=True, sharey=True)
    largest = 0.1
    for ax, side in zip(axes, runs[0]["side"].values, strict=True):
        for data, label, look, marker in zip(runs, names, LOOKS, ("o", "x"), strict=False):
            utilisation = data["patch_utilisation"].sel(side=side).values.ravel()
            load_factor = data["patch_load_factor"].sel(side=side).values.ravel()
            largest = max(largest, float(np.nanmax(utilisation, initial=0.0)))
            ax.plot(utilisation, load_factor, marker, ms=3, color=look["color"], alpha=0.5, mfc="none", label=label)
        ax.set_title(f"{named(str(side), runs[0])} wheel")
        ax.set_xlabel("utilisation T / N")
    friction = np.linspace(0.0, 1.3 * largest, 60)
    for ax in axes:
        ax.plot(
            friction, [shakedown_limit(float(f)) for f in friction], color="0.2", label="shakedown limit, line contact"
        )
        ax.set_xlim(0.0, friction[-1])
    axes[0].set_ylabel("load factor, peak pressure over shear yield stress")
    axes[0].legend(loc="best")
    return figure


PICTURES: dict[str, Callable[[Runs, Names], Figure]] = {
    "compare_displacement": displacements,
    "compare_lateral_force": partial(of_wheels, "lateral_force"),
    "compare_vertical_force": partial(of_wheels, "vertical_force"),
    "compare_longitudinal_force": partial(of_wheels, "longitudinal_force"),
    "compare_on_wheel": partial(sections, "wheel"),
    "compare_on_rail": partial(sections, "rail"),
    "compare_t_gamma": partial(of_wheels, "t_gamma"),
    "compare_scatter": force_scatter,
    "compare_shakedown": shakedown_map,
}
