"""Figures of a contact solution: `solution.plot()`, `solution.plot.pressure()`."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, Literal

from wheelrail.scenes.plots.style import panels, shown, styled

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure
    from xarray import Dataset


@dataclass(frozen=True)
class SolutionPlots:
    """Figures of one contact solution.

    Parameters:
        data: Dataset of the solution.

    Parameters of the methods:
        side: "left", "right" or "contact"; by default the first side in contact.
        patch: index by decreasing load; 0 carries most.
        ax: Matplotlib axes; a new figure by default, which a notebook displays.

    All raise ValueError for a solution without contact.
    """

    data: Dataset

    def __call__(self, figure: Figure | None = None) -> tuple[Axes, ...]:
        """All patches of all sides: pressure, MPa, traction arrows, stick-slip boundary; lengths in mm.

        Parameters:
            figure: Matplotlib figure.
        """
        from wheelrail.scenes.plots.patches import patches_figure

        with styled():
            return panels(patches_figure(self.data, shown(figure)))

    def pressure(self, side: str | None = None, patch: int = 0, ax: Axes | None = None) -> Axes:
        """Pressure over one patch, MPa; lengths in mm."""
        from wheelrail.scenes.plots.patches import pressure_map

        with styled():
            return pressure_map(self.data, side, patch, _axes(ax))

    def tractions(self, side: str | None = None, patch: int = 0, ax: Axes | None = None, *, slip: bool = True) -> Axes:
        """Stick and slip areas of one patch with traction arrows; lengths in mm.

        Parameters:
            slip: whether to draw arrows of the slip velocity.
        """
        from wheelrail.scenes.plots.patches import traction_map

        with styled():
            return traction_map(self.data, side, patch, _axes(ax), slip=slip)

    def section(
        self,
        along: Literal["x", "y"] = "x",
        *,
        side: str | None = None,
        patch: int = 0,
        hertz: bool = True,
        ax: Axes | None = None,
    ) -> Axes:
        """Pressure and traction along x or y through the centre of one patch, MPa over mm.

        Parameters:
            along: "x" or "y".
            hertz: whether to add the Hertz pressure for the same load and curvatures.
        """
        from wheelrail.scenes.plots.sections import section

        with styled():
            return section(self.data, along, side=side, patch=patch, hertz=hertz, ax=_axes(ax, (5.6, 4.0)))

    def profiles(self, side: str | None = None, ax: Axes | None = None) -> Axes:
        """Profiles of wheel and rail in their computed position, with contact points; mm."""
        from wheelrail.scenes.plots.profiles import profiles_in_contact

        with styled():
            return profiles_in_contact(self.data, side, _axes(ax, (7.2, 4.2)))


def _axes(ax: Axes | None, size: tuple[float, float] = (5.2, 4.2)) -> Any:
    """The axes, or new ones in a figure of the given size, inches."""
    return shown(None, size).subplots() if ax is None else ax
