"""Pictures from profiles and from errors measured in a study; one style for all."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from contextlib import contextmanager
from pathlib import Path
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

    from meshes.profiles import Profile


@contextmanager
def styled() -> Iterator[None]:
    """The style of all pictures, inside the block."""
    from matplotlib import rc_context

    from scenes.pictures.style import STYLE

    with rc_context(STYLE):
        yield


def shown(figure: Figure | None, size: tuple[float, float] | None = None) -> Figure:
    """The figure, or a new one (size in inches) that pyplot knows of, so that a notebook shows it."""
    if figure is not None:
        return figure
    from matplotlib import pyplot

    made: Figure = pyplot.figure(figsize=size, layout="constrained")
    return made


def panels(figure: Figure) -> tuple[Axes, ...]:
    """The axes of a figure but for its colour bars."""
    return tuple(ax for ax in figure.axes if ax.get_label() != "<colorbar>")


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
    from scenes.pictures.profiles import draw_profiles
    from wheelrail.geometry import outlines_in_contact, placed_pair

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
    from scenes.pictures.errors import convergence

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
    from scenes.pictures.errors import work_precision

    with styled():
        axes = shown(None, (5.2, 4.0)).subplots() if ax is None else ax
        axes = work_precision(series, xlabel=xlabel, ylabel=ylabel, ax=axes)
        axes.legend()
        return axes
