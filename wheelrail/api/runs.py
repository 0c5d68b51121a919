"""Vehicle runs."""

from __future__ import annotations

from contextlib import nullcontext
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from wheelrail.api.arguments import plain
from wheelrail.api.run_plots import RunPlots
from wheelrail.api.stored_dataset import StoredDataset


@dataclass(frozen=True, repr=False)
class Run(StoredDataset):
    """A vehicle run: data is a Dataset with units in SI over time, side (left, right) and patch (padded with NaN)."""

    @property
    def status(self) -> str:
        """ "completed", or how it ended before its time."""
        return str(self.data.attrs["status"])

    @property
    def plot(self) -> RunPlots:
        """Pictures: `plot()`, `plot.displacements()`, `plot.lateral_forces()`, `plot.vertical_forces()`,
        `plot.bands("wheel")` and `plot.bands("rail")`.
        """
        return RunPlots(self.data)

    def view(self, distance: float | None = None, *, scale: float = 1.0, file: str | Path | None = None) -> Any:
        """A pyvista plotter of one moment in three dimensions: the wheelset on its rails with the contact forces, and
        both contacts close up.

        distance m along the track, that of the largest lateral force unless given; scale of the wheelset's
        displacements. `.show()` it, or give a file, a picture (.png) or a page to turn (.html). Raises SceneError where
        the scene's profiles are gone and for another ending, OSError.
        """
        from wheelrail.scenes.schema.errors import SceneError
        from wheelrail.scenes.views.run_snapshot import hardest, moment_view
        from wheelrail.scenes.views.view import bodies_of_run

        if file is not None and Path(file).suffix.lower() not in (".png", ".html"):
            raise SceneError(f"file = {str(file)!r}: must end in .png or .html")
        at = hardest(self.data) if distance is None else int(np.argmin(np.abs(self.data["distance"].values - distance)))
        where = f"{float(self.data['distance'][at]):.1f} m, {float(self.data['time'][at]):.2f} s"
        drawn = moment_view(self.data, at, **bodies_of_run(self.data, Path("run.nc")), title=where, scale=scale)
        if file is not None:
            from wheelrail.scenes.views.html import save_view

            save_view(drawn, Path(file))
        return drawn

    def animate(
        self, file: str | Path, *, frames: int = 120, fps: float = 20.0, scale: float = 20.0, progress: bool = False
    ) -> Path:
        """Make a film (.mp4, .gif) of the run: the wheelset on its rails, its displacements so many times; forces, and
        both contacts close up, true to scale. Seconds a frame. Raises OSError, SceneError for another ending.
        """
        from wheelrail.scenes.schema.errors import SceneError
        from wheelrail.scenes.views.animation import animate_run
        from wheelrail.scenes.views.view import bodies_of_run
        from wheelrail.support.terminal import progress_console

        if Path(file).suffix.lower() not in (".mp4", ".gif"):
            raise SceneError(f"file = {str(file)!r}: must end in .mp4 or .gif")
        told = None
        with progress_console().status("drawing") if progress else nullcontext() as status:
            if status is not None:

                def told(done: int, count: int) -> None:
                    status.update(f"frame {done} of {count}")

            bodies = bodies_of_run(self.data, Path("run.nc"))
            animate_run(self.data, Path(file), **bodies, frames=frames, fps=fps, scale=scale, progress=told)
        return Path(file)

    def __repr__(self) -> str:
        from wheelrail.api.run_tables import text

        return text(self.data)

    def _repr_html_(self) -> str:
        from wheelrail.api.run_tables import html

        return html(self.data)


def run(scene: str | Path, out: str | Path | None = None, *, progress: bool = False, **changes: Any) -> Run:
    """Run the vehicle of a scene file (TOML) along its track.

    out: folder for results, pictures and checkpoints, as the command `wheelrail run` fills it; nothing is written
    without it. progress: a bar on standard error. changes: other values for keys of the scene, in SI units, with dots
    between tables and keys: run("scenes/curve.toml", **{"vehicle.speed": 30.0}); None takes a key away.

    A run that ends early is a status and no error, but one without a single step raises RuntimeError. Raises SceneError
    naming file, key, value and what is allowed, OSError for a folder that cannot be written.
    """
    from rich.console import Console

    from wheelrail.scenes.datasets.netcdf import read
    from wheelrail.scenes.runs.files import RESULTS
    from wheelrail.scenes.runs.run import run_scene, simulate_scene
    from wheelrail.scenes.schema.edits import changed, without
    from wheelrail.scenes.schema.errors import SceneError
    from wheelrail.scenes.schema.scene import RunScene, checked
    from wheelrail.scenes.schema.toml import parse, read_text
    from wheelrail.support.terminal import messages_on, progress_console

    text = read_text(Path(scene))
    if changes:
        import tomli_w

        gone = [name for name, value in changes.items() if value is None]
        kept = {name: plain(value) for name, value in changes.items() if value is not None}
        text = tomli_w.dumps(changed(without(parse(text, scene), gone, scene), kept, scene))
    given = checked(parse(text, scene), scene)
    if not isinstance(given, RunScene):
        raise SceneError(f'{scene}: kind = "{given.kind}": this is one contact solve, use wheelrail.load')
    console = progress_console() if progress else Console(quiet=True)
    messages = messages_on(console) if progress else nullcontext()
    if out is None:
        with messages:
            history, data = simulate_scene(given, text, console)
        if data is None:
            raise RuntimeError(f"{scene}: {history.status} before the first step")
        return Run(data)
    with messages:
        outcome = run_scene(given, text, Path(out), console)
    if not outcome.files:
        raise RuntimeError(f"{scene}: {outcome.status} before the first step")
    return Run(read(Path(out) / RESULTS))
