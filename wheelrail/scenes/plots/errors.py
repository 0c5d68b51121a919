"""Pictures of errors: over the size of cells, and over the time that they cost."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from itertools import cycle
from typing import TYPE_CHECKING

import numpy as np

from wheelrail.scenes.plots.fits import slope
from wheelrail.scenes.plots.style import SERIES, axes_of
from wheelrail.support.arrays import Array

if TYPE_CHECKING:
    from matplotlib.axes import Axes


def convergence(
    size: Sequence[float],
    errors: Mapping[str, Sequence[float]],
    *,
    xlabel: str = "surface size [m]",
    ylabel: str = "relative error [1]",
    ax: Axes | None = None,
) -> Axes:
    """Magnitude of errors (n,) by label over size (n,), logarithmic, with a straight line of the fitted slope each.

    Zero and unknown errors are left out. Raises ValueError for another number of errors than of sizes.
    """
    ax = axes_of(ax)
    for (label, values), look in zip(errors.items(), cycle(SERIES), strict=False):
        x, error = _known(size, values, label)
        order = slope(x, error)
        said = label if np.isnan(order) else f"{label}, slope {order:.2f}"
        (line,) = ax.plot(x, error, label=said, markersize=4.5, **{**look, "linestyle": "none"})
        if not np.isnan(order):
            ends = np.array([x.min(), x.max()])
            level = np.exp(np.mean(np.log(error)) + order * (np.log(ends) - np.mean(np.log(x))))
            ax.plot(ends, level, color=line.get_color(), linestyle=look["linestyle"], linewidth=0.9)
    return _finish(ax, xlabel, ylabel)


def work_precision(
    series: Mapping[str, tuple[Sequence[float], Sequence[float]]],
    *,
    xlabel: str = "time of a solve [s]",
    ylabel: str = "relative error [1]",
    ax: Axes | None = None,
) -> Axes:
    """Magnitude of errors (n,) over seconds (n,), by label, logarithmic.

    Raises ValueError for another number of errors than of times.
    """
    ax = axes_of(ax)
    for (label, (seconds, values)), look in zip(series.items(), cycle(SERIES), strict=False):
        ax.plot(*_known(seconds, values, label), label=label, markersize=4.5, **look)
    return _finish(ax, xlabel, ylabel)


def _known(size: Sequence[float], error: Sequence[float], label: str) -> tuple[Array, Array]:
    """Those that a logarithmic scale can show."""
    x, y = np.asarray(size, dtype=float), np.abs(np.asarray(error, dtype=float))
    if x.shape != y.shape or x.ndim != 1:
        raise ValueError(f"{label}: {y.size} errors for {x.size} places; one is needed for each")
    keep = (x > 0.0) & (y > 0.0) & np.isfinite(x + y)
    return x[keep], y[keep]


def _finish(ax: Axes, xlabel: str, ylabel: str) -> Axes:
    ax.set_xscale("log")
    ax.set_yscale("log")
    ax.set_xlabel(xlabel)
    ax.set_ylabel(ylabel)
    ax.grid(True, which="major")
    return ax
