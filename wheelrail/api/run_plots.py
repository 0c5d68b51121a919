"""Pictures of a vehicle run, called in the manner of xarray: `run.plot()`, `run.plot.bands("wheel")`."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import TYPE_CHECKING, Literal

from wheelrail.scenes.plots.style import panels, shown, styled

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure
    from xarray import Dataset


@dataclass(frozen=True)
class RunPlots:
    """Pictures of one run over the distance along the track, m; each returns its axes.

    Without a figure a picture makes its own, which a notebook shows.
    """

    data: Dataset

    def __call__(self) -> dict[str, tuple[Axes, ...]]:
        """All pictures, by name, each a figure of its own: displacements mm, forces kN, bands of contact mm."""
        from wheelrail.scenes.plots.runs import PICTURES

        return {name: self._drawn(draw, None) for name, draw in PICTURES.items()}

    def displacements(self, figure: Figure | None = None) -> tuple[Axes, ...]:
        """Lateral displacement mm of wheelset and car body."""
        from wheelrail.scenes.plots.runs import displacements

        return self._drawn(displacements, figure)

    def lateral_forces(self, figure: Figure | None = None) -> tuple[Axes, ...]:
        """Lateral contact force kN on both wheels."""
        from wheelrail.scenes.plots.runs import lateral_forces

        return self._drawn(lateral_forces, figure)

    def vertical_forces(self, figure: Figure | None = None) -> tuple[Axes, ...]:
        """Vertical contact force kN on both wheels."""
        from wheelrail.scenes.plots.runs import vertical_forces

        return self._drawn(vertical_forces, figure)

    def bands(self, body: Literal["wheel", "rail"] = "wheel", figure: Figure | None = None) -> tuple[Axes, ...]:
        """Lateral extent mm of every patch on both wheels or rails, shaded by its peak pressure MPa."""
        from wheelrail.scenes.plots.runs import rail_sections, wheel_sections

        if body not in ("wheel", "rail"):
            raise ValueError(f'body = {body!r}: must be "wheel" or "rail"')
        return self._drawn(wheel_sections if body == "wheel" else rail_sections, figure)

    def _drawn(self, draw: Callable[..., Figure], figure: Figure | None) -> tuple[Axes, ...]:
        with styled():
            return panels(draw(self.data, shown(figure)))
