"""Figure of the energy balance of a run."""

from __future__ import annotations

from itertools import cycle
from typing import TYPE_CHECKING

from wheelrail.scenes.plots.runs import along_track
from wheelrail.scenes.plots.style import SERIES

if TYPE_CHECKING:
    from matplotlib.figure import Figure
    from xarray import Dataset


def energy_figure(data: Dataset) -> Figure:
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
