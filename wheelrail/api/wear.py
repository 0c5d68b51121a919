"""Wear of wheel profiles over distance."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from wheelrail.api.stored_dataset import StoredDataset
from wheelrail.scenes.plots.style import panels, styled

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from xarray import Dataset

    from wheelrail.meshes.profiles.profile import Profile
    from wheelrail.scenes.datasets.result_table import TextTable

SAME = 1e-9  # m, differences of places on one profile by rounding


@dataclass(frozen=True, repr=False)
class Wear(StoredDataset):
    """Results of wear.

    Parameters:
        data: Dataset in SI units over step, profile, s (arc length on the new profile) and case.
    """

    @property
    def status(self) -> str:
        """ "completed", or the reason for which the loop ended early."""
        return str(self.data.attrs["status"])

    def profile(self, new: Profile, step: int = -1, name: str | None = None) -> Profile:
        """Worn profile of a wheel or a rail at a step, for `wheelrail.Wheelset`.

        Parameters:
            new: profile that wore; of a rail, as it is inclined in the track.
            step: number; the last one by default.
            name: of the profile or rail in the results; the first wheel by default.

        Raises ValueError for another new profile.
        """
        wheels, rails = (list(self.data[key].values) if key in self.data else [] for key in ("profile", "rail"))
        if name is not None and name not in (*wheels, *rails):
            raise ValueError(f"name = {name!r}: must be one of {', '.join((*wheels, *rails))}")
        prefix = "rail_" if name in rails else ""
        number = 0 if name is None else (rails if prefix else wheels).index(name)
        areas = self.data[f"{prefix}removed_area"].values[step]
        cells = np.isfinite(areas[number])  # one rail has fewer than another
        s, removed = np.broadcast_to(self.data[f"{prefix}s"].values, areas.shape)[number, cells], areas[number, cells]
        bounds = np.linspace(*new.s_range, len(s) + 1)
        points = np.stack([self.data[f"{prefix}new_{key}"].values[number, cells] for key in "yz"], axis=1)
        middle = 0.5 * (bounds[1:] + bounds[:-1])
        if np.abs(middle - s).max() > SAME or np.abs(new.point(s) - points).max() > SAME:
            raise ValueError(f"new: {new.name} is not the profile that wore")
        return new.worn(bounds, removed)

    @property
    def plot(self) -> WearPlots:
        """Figures: `plot()` for all, `plot.profiles(scale=20)`, `plot.depth()`, `plot.measures()`, `plot.duty()`,
        `plot.fatigue()`, `plot.rails()`.
        """
        return WearPlots(self.data)

    @property
    def _tables(self) -> list[TextTable]:
        from wheelrail.scenes.wear.tables import tables

        return [table.as_text for table in tables(self.data)]


@dataclass(frozen=True)
class WearPlots:
    """Figures of wear; each method returns its axes, in a new figure.

    Parameters:
        data: Dataset of the wear.
    """

    data: Dataset

    def __call__(self) -> dict[str, tuple[Axes, ...]]:
        """Draw all figures, by name."""
        from wheelrail.scenes.plots.wear import PICTURES

        return {name: axes for name in PICTURES if (axes := self._drawn(name))}

    def profiles(self, scale: float = 20.0) -> tuple[Axes, ...]:
        """Profiles over the distance; scale: of the depths."""
        return self._drawn("profiles", scale=scale)

    def depth(self) -> tuple[Axes, ...]:
        """Depth over arc length and distance."""
        return self._drawn("depth")

    def measures(self) -> tuple[Axes, ...]:
        """Sh, Sd, qR, hollow, removed section and conicity over the distance."""
        return self._drawn("measures")

    def duty(self) -> tuple[Axes, ...]:
        """Rates of depth by case, new and at the last step."""
        return self._drawn("duty")

    def fatigue(self) -> tuple[Axes, ...]:
        """T-gamma damage by case, new and at the last step."""
        return self._drawn("fatigue")

    def rails(self) -> tuple[Axes, ...]:
        """Depth of the rails that wear; none without."""
        return self._drawn("rails")

    def _drawn(self, name: str, **options: Any) -> tuple[Axes, ...]:
        from wheelrail.scenes.plots.wear import PICTURES

        with styled():
            figure = partial(PICTURES[name], **options)(self.data, None)
            return () if figure is None else panels(figure)


def wear(
    wear: str | Path | Mapping[str, Any],
    out: str | Path | None = None,
    *,
    resume: bool = False,
    progress: bool = False,
    processes: int = 1,
    scheduler: str | None = None,
) -> Wear:
    """Wear the wheel profiles of a vehicle over the distance of a duty.

    Parameters:
        wear: wear file (TOML), or its tables as a dict.
        out: folder for every step, results and figures; nothing is written by default.
        resume: whether to continue from the steps in the folder.
        progress: whether to show a progress bar on standard error.
        processes: that solve the cases of the duty; one: this process, in threads.
        scheduler: address of a Dask cluster, whose workers see the same files.

    A loop that ends early sets the status and raises nothing, unless no step was completed (RunFailed). Raises
    SceneError naming file, key, value and what is allowed, before anything is computed; OSError.
    """
    from rich.console import Console

    from wheelrail.scenes.wear.run import run_wear
    from wheelrail.scenes.wear.schema import check_wear, load_wear
    from wheelrail.support.terminal import progress_console

    table, path = (check_wear(wear), Path("wear")) if isinstance(wear, Mapping) else (load_wear(wear), Path(wear))
    console = progress_console() if progress else Console(quiet=True)
    folder = None if out is None else Path(out)
    outcome = run_wear(table, path, folder, console, resume=resume, processes=processes, scheduler=scheduler)
    return Wear(outcome.data)
