"""Figures of profiles, convergence and work-precision, in one style."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any

from wheelrail.scenes.plots.style import shown, styled

if TYPE_CHECKING:
    from matplotlib.axes import Axes

    from wheelrail.meshes.profiles.profile import Profile


def plot_profiles(
    wheel: str | Path | Profile = "S1002",
    rail: str | Path | Profile = "UIC60",
    *,
    y: float = 0.0,
    yaw: float = 0.0,
    ax: Axes | None = None,
    **more: Any,
) -> Axes:
    """Plot the rigid left wheel on its rail, in mm, at first contact of the wheelset with both rails.

    Parameters:
        wheel, rail: name, file or profile.
        y: lateral position of the wheelset, m, positive to the left.
        yaw: of the wheelset, rad.
        ax: Matplotlib axes; a new figure by default.
        more: mounting as for `wheelrail.contact_geometry`.
    """
    from wheelrail.api.rigid_pair import outlines_in_contact, rigid_wheelset
    from wheelrail.scenes.plots.profiles import outlines_drawing
    from wheelrail.scenes.plots.render import draw

    wheel_line, rail_line, point, angle = outlines_in_contact(rigid_wheelset(wheel, rail, **more), y, yaw)
    with styled():
        axes = shown(None, (7.2, 4.0)).subplots() if ax is None else ax
        title = f"left wheel and rail, wheelset at y = {1e3 * y:.3g} mm"
        label = f"contact, angle {1e3 * angle:.3g} mrad"
        return draw(outlines_drawing(title, wheel_line, rail_line, [point], [label]), axes)


def plot_convergence(
    size: Sequence[float],
    errors: Mapping[str, Sequence[float]],
    *,
    xlabel: str = "surface size [m]",
    ylabel: str = "relative error [1]",
    ax: Axes | None = None,
) -> Axes:
    """Plot errors over cell size or number of cells on logarithmic axes, with the order fitted to each series.

    Parameters:
        size: (n,) cell sizes or numbers of cells, in the unit of xlabel.
        errors: (n,) errors by label of the series, in the unit of ylabel.
        xlabel, ylabel: labels of the axes.
        ax: Matplotlib axes; a new figure by default.
    """
    from wheelrail.scenes.plots.errors import convergence

    with styled():
        axes = shown(None, (5.2, 4.0)).subplots() if ax is None else ax
        axes = convergence(size, errors, xlabel=xlabel, ylabel=ylabel, ax=axes)
        axes.legend()
        return axes


def plot_work_precision(
    series: Mapping[str, tuple[Sequence[float], Sequence[float]]],
    *,
    xlabel: str = "time of a solve [s]",
    ylabel: str = "relative error [1]",
    ax: Axes | None = None,
) -> Axes:
    """Plot errors over computing time of several series on logarithmic axes (work-precision diagram).

    Parameters:
        series: times (n,), s, and errors (n,), in the unit of ylabel, by label of the series.
        xlabel, ylabel: labels of the axes.
        ax: Matplotlib axes; a new figure by default.
    """
    from wheelrail.scenes.plots.errors import work_precision

    with styled():
        axes = shown(None, (5.2, 4.0)).subplots() if ax is None else ax
        axes = work_precision(series, xlabel=xlabel, ylabel=ylabel, ax=axes)
        axes.legend()
        return axes
