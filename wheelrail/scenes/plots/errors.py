"""Figures of errors over cell size (convergence) and over computing time (work-precision)."""

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
    fitted: Sequence[bool] | None = None,
    ax: Axes | None = None,
) -> Axes:
    """Plot errors over size on logarithmic axes, with a straight line of fitted slope for each series.

    Parameters:
        size: (n,) sizes.
        errors: (n,) errors by label.
        xlabel, ylabel: labels of the axes.
        fitted: (n,) whether a size is used in the fit; all by default.
        ax: Matplotlib axes; new ones by default.

    Zeros and NaN are omitted. Raises ValueError for different numbers of errors and sizes.
    """
    ax = axes_of(ax)
    for (label, values), look in zip(errors.items(), cycle(SERIES), strict=False):
        x, error = _positive(size, values, label)
        (line,) = ax.plot(x, error, markersize=4.5, **{**look, "linestyle": "none"})
        if fitted is not None:
            x, error = _positive(np.where(fitted, size, np.nan).tolist(), values, label)
        order = slope(x, error)
        line.set_label(label if np.isnan(order) else f"{label}, slope {order:.2f}")
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
    """Plot errors over computing time on logarithmic axes.

    Parameters:
        series: times (n,), s, and errors (n,) by label.
        xlabel, ylabel: labels of the axes.
        ax: Matplotlib axes; new ones by default.

    Raises ValueError for different numbers of errors and times.
    """
    ax = axes_of(ax)
    for (label, (seconds, values)), look in zip(series.items(), cycle(SERIES), strict=False):
        ax.plot(*_positive(seconds, values, label), label=label, markersize=4.5, **look)
    return _finish(ax, xlabel, ylabel)


def _positive(size: Sequence[float], error: Sequence[float], label: str) -> tuple[Array, Array]:
    """Finite positive sizes and magnitudes of errors."""
    x, y = np.asarray(size, dtype=float), np.abs(np.asarray(error, dtype=float))
    if x.shape != y.shape or x.ndim != 1:
        raise ValueError(f"{label}: {y.size} errors for {x.size} sizes or times; must be equally many")
    keep = (x > 0.0) & (y > 0.0) & np.isfinite(x + y)
    return x[keep], y[keep]


def _finish(ax: Axes, xlabel: str, ylabel: str) -> Axes:
    ax.set_xscale("log")
    ax.set_yscale("log")
    ax.set_xlabel(xlabel)
    ax.set_ylabel(ylabel)
    ax.grid(True, which="major")
    return ax
