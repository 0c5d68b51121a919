"""Parameter studies of one scene."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

from wheelrail.api.stored_dataset import StoredDataset
from wheelrail.scenes.plots.style import panels, shown, styled

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from xarray import Dataset

    from wheelrail.scenes.datasets.result_table import TextTable


@dataclass(frozen=True, repr=False)
class Study(StoredDataset):
    """Results of a study.

    Parameters:
        data: Dataset in SI units over the varied parameters, or over sample for a Latin hypercube; NaN for a failed
            case, with its status and error.
    """

    @property
    def plot(self) -> StudyPlots:
        """Figures: `plot()` for all, `plot.study()`, `plot.convergence()`."""
        return StudyPlots(self.data)

    @property
    def _tables(self) -> list[TextTable]:
        from wheelrail.scenes.studies.tables import tables

        return [table.as_text for table in tables(self.data)]


@dataclass(frozen=True)
class StudyPlots:
    """Figures of one study; each method returns its axes, in a new figure.

    Parameters:
        data: Dataset of the study.
    """

    data: Dataset

    def __call__(self) -> dict[str, tuple[Axes, ...]]:
        """Draw all figures, by name: "study", and "convergence" for a convergence study."""
        from wheelrail.scenes.studies.plots import drawings

        return {name: self._drawn(name) for name in drawings(self.data)}

    def study(self) -> tuple[Axes, ...]:
        """Quantities over the varied parameters; rank correlations for a Latin hypercube."""
        return self._drawn("study")

    def convergence(self) -> tuple[Axes, ...]:
        """Relative errors, %, over cell size or number of cells, with their orders, and over computing time.

        Raises ValueError for a study without a reference.
        """
        return self._drawn("convergence")

    def _drawn(self, name: str) -> tuple[Axes, ...]:
        from wheelrail.scenes.studies.plots import drawings

        figures = drawings(self.data)
        if name not in figures:
            raise ValueError(f"{name}: the study has no such figure; its file needs a reference")
        with styled():
            return panels(figures[name](self.data, shown(None)) or shown(None))


def study(
    study: str | Path | Mapping[str, Any],
    out: str | Path | None = None,
    *,
    scheduler: str | None = None,
    fresh: bool = False,
) -> Study:
    """Solve one scene for parameters on a grid or a Latin hypercube, with cases in parallel.

    Parameters:
        study: study file (TOML), or its tables as a dict; the scene may be a dict, too.
        out: folder for every completed case, results and figures; an interrupted study resumes from it. Nothing is
            written by default.
        scheduler: address of a Dask scheduler; by default processes on this machine.
        fresh: whether to recompute completed cases.

    Raises SceneError naming file, key, value and what is allowed, before anything is computed; OSError for a folder
    that cannot be written.
    """
    from wheelrail.scenes.studies.run import run_study

    return Study(run_study(study, out, scheduler=scheduler, fresh=fresh))
