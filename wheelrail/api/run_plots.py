"""Figures of a vehicle run: `run.plot()`, `run.plot.bands("wheel")`."""

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
    """Figures of one run over distance along the track, m; each method returns its axes.

    The methods but the call itself draw runs of the plane wagon; they raise SceneError for a vehicle.

    Parameters:
        data: Dataset of the run.

    Every method draws into `figure`, a Matplotlib figure; a new one by default, which a notebook displays.
    """

    data: Dataset

    def __call__(self) -> dict[str, tuple[Axes, ...]]:
        """Draw all figures, by name: displacements, mm, forces, kN, contact bands, mm; of a vehicle the attitude of its
        wheelsets, forces and motion of its bodies.
        """
        from wheelrail.scenes.plots import runs, vehicle_runs

        pictures = vehicle_runs.pictures_of(self.data) if self._of_vehicle else runs.PICTURES
        with styled():
            return {name: panels(draw(self.data, shown(None))) for name, draw in pictures.items()}

    @property
    def _of_vehicle(self) -> bool:
        return "wheelset" in self.data.dims

    def displacements(self, figure: Figure | None = None) -> tuple[Axes, ...]:
        """Lateral displacement of wheelset and car body, mm.

        Parameters:
            figure: Matplotlib figure.
        """
        from wheelrail.scenes.plots.runs import displacements

        return self._drawn(displacements, figure)

    def lateral_forces(self, figure: Figure | None = None) -> tuple[Axes, ...]:
        """Lateral contact force on both wheels, kN.

        Parameters:
            figure: Matplotlib figure.
        """
        from wheelrail.scenes.plots.runs import lateral_forces

        return self._drawn(lateral_forces, figure)

    def vertical_forces(self, figure: Figure | None = None) -> tuple[Axes, ...]:
        """Vertical contact force on both wheels, kN.

        Parameters:
            figure: Matplotlib figure.
        """
        from wheelrail.scenes.plots.runs import vertical_forces

        return self._drawn(vertical_forces, figure)

    def bands(self, body: Literal["wheel", "rail"] = "wheel", figure: Figure | None = None) -> tuple[Axes, ...]:
        """Lateral extent of the patches on both wheels or rails, mm, coloured by peak pressure, MPa.

        Parameters:
            body: "wheel" or "rail".
            figure: Matplotlib figure.
        """
        from wheelrail.scenes.plots.runs import rail_sections, wheel_sections

        if body not in ("wheel", "rail"):
            raise ValueError(f'body = {body!r}: must be "wheel" or "rail"')
        return self._drawn(wheel_sections if body == "wheel" else rail_sections, figure)

    def _drawn(self, draw: Callable[..., Figure], figure: Figure | None) -> tuple[Axes, ...]:
        from wheelrail.scenes.schema.errors import SceneError

        if self._of_vehicle:
            raise SceneError("figure of a run of the plane wagon; plot() draws the figures of a vehicle")
        with styled():
            return panels(draw(self.data, shown(figure)))
