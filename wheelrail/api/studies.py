"""Studies: one scene with its parameters varied."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from html import escape
from io import StringIO
from pathlib import Path
from typing import TYPE_CHECKING, Any

from wheelrail.api.stored_dataset import StoredDataset
from wheelrail.scenes.plots.style import panels, shown, styled

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from xarray import Dataset


@dataclass(frozen=True, repr=False)
class Study(StoredDataset):
    """Results of a study: data is a Dataset in SI units over what was varied, or over sample for a Latin hypercube.

    A failed case is NaN, with its status and error.
    """

    @property
    def plot(self) -> StudyPlots:
        """Pictures: `plot()` of all there is to see, or `plot.study()` and `plot.convergence()` alone."""
        return StudyPlots(self.data)

    def __repr__(self) -> str:
        from rich.console import Console

        from wheelrail.scenes.studies.tables import tables

        page = Console(file=StringIO(), width=120, color_system=None)
        for table in tables(self.data):
            page.print(table)
        assert isinstance(page.file, StringIO)
        return page.file.getvalue()

    def _repr_html_(self) -> str:
        return (
            f"<div><pre>{escape(repr(self))}</pre>"
            f"<details><summary>data</summary>{self.data._repr_html_()}</details></div>"
        )


@dataclass(frozen=True)
class StudyPlots:
    """Pictures of one study; each returns its axes, in a figure of its own that a notebook shows."""

    data: Dataset

    def __call__(self) -> dict[str, tuple[Axes, ...]]:
        """All pictures by name: "study", and "convergence" for a study of convergence."""
        from wheelrail.scenes.studies.plots import drawings

        return {name: self._drawn(name) for name in drawings(self.data)}

    def study(self) -> tuple[Axes, ...]:
        """Quantities over what was varied; rank correlations with the parameters of a Latin hypercube."""
        return self._drawn("study")

    def convergence(self) -> tuple[Axes, ...]:
        """Relative errors % over size or number of cells, with their orders, and over seconds.

        Raises ValueError for a study without a reference.
        """
        return self._drawn("convergence")

    def _drawn(self, name: str) -> tuple[Axes, ...]:
        from wheelrail.scenes.studies.plots import drawings

        known = drawings(self.data)
        if name not in known:
            raise ValueError(f"the study has no picture of its {name}: its file names no reference for it")
        with styled():
            return panels(known[name](self.data, shown(None)) or shown(None))


def study(
    study: str | Path | Mapping[str, Any],
    out: str | Path | None = None,
    *,
    scheduler: str | None = None,
    fresh: bool = False,
) -> Study:
    """Solve or run one scene many times, its parameters over a grid or a Latin hypercube, several cases at a time.

    study: a file (TOML), or tables like one, whose scene may be tables, too. out: folder that keeps every case as it
    finishes, so that a study that was stopped goes on, with results and pictures; nothing is kept without it.
    scheduler: address of a Dask cluster, instead of processes on this machine. fresh: compute all cases anew.

    Raises SceneError naming file, key, value and what is allowed, before anything is computed; OSError for a folder
    that cannot be written.
    """
    from wheelrail.scenes.studies.run import run_study

    return Study(run_study(study, out, scheduler=scheduler, fresh=fresh))
