"""Common style of all figures."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from pathlib import Path
from typing import TYPE_CHECKING, Any

from wheelrail.support.atomic_file import atomic_file

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

STYLE = {
    "font.size": 9.0,
    "axes.titlesize": 9.0,
    "axes.titlelocation": "left",
    "axes.spines.top": False,
    "axes.spines.right": False,
    "axes.grid": True,
    "grid.color": "0.9",
    "axes.axisbelow": True,
    "legend.frameon": False,
    "lines.linewidth": 1.1,
    "savefig.dpi": 150,
}
# Okabe-Ito colours, safe for colour-blind readers; dashes distinguish the lines in black and white.
SIDES: dict[str, dict[str, Any]] = {
    "left": {"color": "#0072B2", "linestyle": "-"},
    "right": {"color": "#D55E00", "linestyle": (0, (5, 1.5))},
}
PRESSURE_MAP = "viridis"
REGIONS = {"stick": "#CFE5F2", "slip": "#FBE3CC"}  # light blue and light red, below arrows
SERIES: tuple[dict[str, Any], ...] = (
    {"color": "#0072B2", "marker": "o", "linestyle": "-"},
    {"color": "#D55E00", "marker": "s", "linestyle": (0, (5, 1.5))},
    {"color": "#009E73", "marker": "^", "linestyle": (0, (1, 1))},
    {"color": "#CC79A7", "marker": "D", "linestyle": (0, (5, 1.5, 1, 1.5))},
    {"color": "#E69F00", "marker": "v", "linestyle": (0, (3, 1, 1, 1, 1, 1))},
    {"color": "#56B4E9", "marker": "P", "linestyle": "-"},
    {"color": "0.2", "marker": "x", "linestyle": (0, (5, 1.5))},
)


def literal(text: str) -> str:
    """Text of a user, such as the name of a body, without the mathematics that Matplotlib sees between dollar signs."""
    return text.replace("$", r"\$")


def axes_of(ax: Axes | None, size: tuple[float, float] = (5.2, 4.2)) -> Axes:
    """The axes, or new ones in a figure of the given size, inches."""
    if ax is not None:
        return ax
    from matplotlib.figure import Figure

    return Figure(figsize=size, layout="constrained").subplots()


@contextmanager
def styled(more: Mapping[str, Any] | None = None) -> Iterator[None]:
    """Apply the style of all figures inside the block.

    Parameters:
        more: further rcParams.

    Only these parameters are reset at the end: a backend that is first used inside the block sets "interactive" for the
    whole session, which `matplotlib.rc_context` would undo.
    """
    from matplotlib import rcParams

    parameters = {**STYLE, **(more or {})}
    before = {name: rcParams[name] for name in parameters}
    rcParams.update(parameters)
    try:
        yield
    finally:
        rcParams.update(before)


def shown(figure: Figure | None, size: tuple[float, float] | None = None) -> Figure:
    """The figure, or a new one of pyplot (size in inches), which a notebook displays."""
    if figure is not None:
        return figure
    from matplotlib import pyplot

    new: Figure = pyplot.figure(figsize=size, layout="constrained")
    return new


def panels(figure: Figure) -> tuple[Axes, ...]:
    """Axes of a figure without colour bars."""
    return tuple(ax for ax in figure.axes if ax.get_label() != "<colorbar>")


def save(figure: Figure, file: Path) -> None:
    """Save a figure atomically in the format of the file ending."""
    with atomic_file(file) as part:
        figure.savefig(part)
