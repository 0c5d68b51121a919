"""Figures of a vehicle run: `run.plot()`, `run.plot.bands("wheel")`."""

from __future__ import annotations

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

    Parameters:
        data: Dataset of the run.

    Every method draws into `figure`, a Matplotlib figure; a new one by default, which a notebook displays.
    """

    data: Dataset

    def __call__(self) -> dict[str, tuple[Axes, ...]]:
        """Draw all figures, by name: displacements, mm, forces, kN, contact bands, mm; of a vehicle file the attitude
        of its wheelsets, forces and motion of its bodies.
        """
        from wheelrail.scenes.plots.runs import pictures_of

        with styled():
            return {name: panels(draw(self.data, shown(None))) for name, draw in pictures_of(self.data).items()}

    def displacements(self, figure: Figure | None = None) -> tuple[Axes, ...]:
        """Lateral displacement of the wheelsets and of the first body, mm.

        Parameters:
            figure: Matplotlib figure.
        """
        return self._drawn("lateral_displacement", figure)

    def lateral_forces(self, figure: Figure | None = None) -> tuple[Axes, ...]:
        """Lateral contact force on all wheels, kN.

        Parameters:
            figure: Matplotlib figure.
        """
        return self._drawn("lateral_force", figure)

    def vertical_forces(self, figure: Figure | None = None) -> tuple[Axes, ...]:
        """Vertical contact force on all wheels, kN.

        Parameters:
            figure: Matplotlib figure.
        """
        return self._drawn("vertical_force", figure)

    def bands(self, body: Literal["wheel", "rail"] = "wheel", figure: Figure | None = None) -> tuple[Axes, ...]:
        """Lateral extent of the patches on all wheels or rails, mm, coloured by peak pressure, MPa.

        Parameters:
            body: "wheel" or "rail".
            figure: Matplotlib figure.
        """
        if body not in ("wheel", "rail"):
            raise ValueError(f'body = {body!r}: must be "wheel" or "rail"')
        return self._drawn(f"contact_on_{body}", figure)

    def _drawn(self, name: str, figure: Figure | None) -> tuple[Axes, ...]:
        from wheelrail.scenes.plots.runs import PAPER

        with styled():
            return panels(PAPER[name](self.data, shown(figure)))
