"""Pictures of a contact solution, called in the manner of xarray: `solution.plot()`, `solution.plot.pressure()`."""

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
    """Pictures of one contact solution.

    side: "left", "right" or "contact", the first that touches unless given; patch: 0 for the one that carries most.
    Without axes a picture makes its own, which a notebook shows. All raise ValueError where nothing touches.
    """

    data: Dataset

    def __call__(self, figure: Figure | None = None) -> tuple[Axes, ...]:
        """All patches of all sides: pressure MPa, arrows of traction, edge between stick and slip; lengths in mm."""
        from wheelrail.scenes.plots.patches import patches_figure

        with styled():
            return panels(patches_figure(self.data, shown(figure)))

    def pressure(self, side: str | None = None, patch: int = 0, ax: Axes | None = None) -> Axes:
        """Pressure MPa over one patch, lengths in mm."""
        from wheelrail.scenes.plots.patches import pressure_map

        with styled():
            return pressure_map(self.data, side, patch, _axes(ax))

    def tractions(self, side: str | None = None, patch: int = 0, ax: Axes | None = None, *, slip: bool = True) -> Axes:
        """Where one patch sticks and slips; arrows of traction, and of slip unless that is False; lengths in mm."""
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
        """Pressure and traction MPa along x or y, mm, through the middle of one patch.

        hertz: with Hertz's pressure of the same load between bodies of the same curvature.
        """
        from wheelrail.scenes.plots.sections import section

        with styled():
            return section(self.data, along, side=side, patch=patch, hertz=hertz, ax=_axes(ax, (5.6, 4.0)))

    def profiles(self, side: str | None = None, ax: Axes | None = None) -> Axes:
        """Wheel over rail where they stand, contact points marked; mm."""
        from wheelrail.scenes.plots.profiles import profiles_in_contact

        with styled():
            return profiles_in_contact(self.data, side, _axes(ax, (7.2, 4.2)))


def _axes(ax: Axes | None, size: tuple[float, float] = (5.2, 4.2)) -> Any:
    """The axes, or those of a new figure of a size in inches."""
    return shown(None, size).subplots() if ax is None else ax
