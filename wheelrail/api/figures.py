"""Pictures from profiles and from errors measured in a study; one style for all."""

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
    """Left wheel over left rail in mm, rigid, where a wheelset y m to the left and with a yaw rad just touches both
    rails, contact points marked.

    wheel, rail: a name, a file or a profile; further arguments place them, as for `wheelrail.contact_geometry`.
    """
    from wheelrail.api.rigid_pair import outlines_in_contact, placed_pair
    from wheelrail.scenes.plots.profiles import draw_profiles

    wheel_line, rail_line, point, angle = outlines_in_contact(placed_pair(wheel, rail, **more), y, yaw)
    with styled():
        axes = shown(None, (7.2, 4.0)).subplots() if ax is None else ax
        title = f"left wheel on its rail, y = {1e3 * y:.3g} mm"
        return draw_profiles(wheel_line, rail_line, [point], [f"contact, {1e3 * angle:.3g} mrad"], title=title, ax=axes)


def plot_convergence(
    size: Sequence[float],
    errors: Mapping[str, Sequence[float]],
    *,
    xlabel: str = "surface size [m]",
    ylabel: str = "relative error [1]",
    ax: Axes | None = None,
) -> Axes:
    """Errors (by label) over size or number of cells, both on logarithmic scales, with the slope fitted to each series.

    size (n,) and errors (n,) in the units that the labels of the axes say.
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
    """Error over time of several series, {label: (seconds (n,), errors (n,))}, both on logarithmic scales: lower and
    further left is better.
    """
    from wheelrail.scenes.plots.errors import work_precision

    with styled():
        axes = shown(None, (5.2, 4.0)).subplots() if ax is None else ax
        axes = work_precision(series, xlabel=xlabel, ylabel=ylabel, ax=axes)
        axes.legend()
        return axes
