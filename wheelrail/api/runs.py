"""Vehicle runs."""

from __future__ import annotations

from collections.abc import Mapping
from contextlib import nullcontext
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from wheelrail.api.arguments import plain, with_names
from wheelrail.api.run_plots import RunPlots
from wheelrail.api.stored_dataset import StoredDataset

if TYPE_CHECKING:
    from wheelrail.scenes.datasets.result_table import TextTable


@dataclass(frozen=True, repr=False)
class Run(StoredDataset):
    """Results of a vehicle run.

    Parameters:
        data: Dataset in SI units over time, body, wheelset, side (left, right) and patch (padded with NaN).
    """

    @property
    def status(self) -> str:
        """ "completed", or the reason for which the run ended early."""
        return str(self.data.attrs["status"])

    @property
    def remarks(self) -> list[str]:
        """Limits of the results: largest wheel loads that the rows do not resolve."""
        from wheelrail.scenes.runs.safety_table import load_remarks

        return load_remarks(self.data)

    @property
    def plot(self) -> RunPlots:
        """Figures: `plot()`, `plot.displacements()`, `plot.lateral_forces()`, `plot.vertical_forces()`,
        `plot.bands("wheel")` and `plot.bands("rail")`.
        """
        return RunPlots(self.data)

    def view(
        self,
        distance: float | None = None,
        *,
        wheelset: str | None = None,
        scale: float = 1.0,
        file: str | Path | None = None,
    ) -> Any:
        """3D view of one instant: a wheelset on its rails with the contact forces, and close-ups of both contacts.

        Parameters:
            distance: along the track, m; by default that of the largest lateral force.
            wheelset: name; by default that of the largest lateral force.
            scale: displacement magnification factor of the wheelset.
            file: image (.png) or interactive 3D view (.html) to save.

        Returns a PyVista plotter, for `.show()`. Raises SceneError for missing profiles, another file ending and an
        unknown wheelset, OSError.
        """
        from wheelrail.scenes.schema.errors import SceneError
        from wheelrail.scenes.views.animation import Animation, largest_force
        from wheelrail.scenes.views.view import bodies_of_run

        if file is not None and Path(file).suffix.lower() not in (".png", ".html"):
            raise SceneError(f"file = {str(file)!r}: must end in .png or .html")
        names = self.data["wheelset"].values.tolist()
        if wheelset is not None and wheelset not in names:
            raise SceneError(f"wheelset = {wheelset!r}: must be {', '.join(names)}")
        at, most_loaded = largest_force(self.data if wheelset is None else self.data.sel(wheelset=[wheelset]))
        if distance is not None:
            at = int(np.argmin(np.abs(self.data["distance"].values - distance)))
        where = f"{float(self.data['distance'][at]):.1f} m, {float(self.data['time'][at]):.2f} s"
        drawn = Animation(self.data, bodies_of_run(self.data, Path("run.nc")), most_loaded, scale)
        drawn.show(float(self.data["time"][at]))
        plotter = drawn.view
        plotter.title = where
        if file is not None:
            from wheelrail.scenes.views.html import save_view

            save_view(plotter, Path(file))
        return plotter

    def animate(
        self,
        file: str | Path,
        *,
        frames: int = 120,
        fps: float = 20.0,
        scale: float | None = None,
        progress: bool = False,
    ) -> Path:
        """Save an animation of the run: the wheelset on its rails, forces, and close-ups of both contacts to scale.

        Of a vehicle file: all bodies on the track, with wheels coloured by their load.

        Parameters:
            file: .mp4 or .gif.
            frames: number of frames.
            fps: frames per second.
            scale: displacement magnification factor; None: 20 for the wheelset, 10 for a vehicle.
            progress: whether to show progress on standard error.

        A frame takes about a second to draw. Returns the file. Raises OSError, SceneError for another file ending.
        """
        from wheelrail.scenes.schema.errors import SceneError
        from wheelrail.scenes.views.view import animate_data
        from wheelrail.support.terminal import progress_console

        if Path(file).suffix.lower() not in (".mp4", ".gif"):
            raise SceneError(f"file = {str(file)!r}: must end in .mp4 or .gif")
        report_progress = None
        with progress_console().status("drawing") if progress else nullcontext() as status:
            if status is not None:

                def report_progress(done: int, count: int) -> None:
                    status.update(f"frame {done} of {count}")

            animate_data(self.data, Path("run.nc"), Path(file), report_progress, frames=frames, fps=fps, scale=scale)
        return Path(file)

    @property
    def _tables(self) -> list[TextTable]:
        """Ranges of forces, pressure and contact positions by side."""
        from wheelrail.scenes.datasets.result_table import TextTable
        from wheelrail.scenes.quantities import RUN

        sides, rows = [str(side) for side in self.data["side"].values], []
        for name in ("lateral_force", "vertical_force", "patch_max_pressure", "wheel_y"):
            values = (self.data[name].sel(side=side).values for side in sides)
            finite = (own[np.isfinite(own)] for own in values)
            rows.append(
                [
                    RUN[name].axis,
                    *(RUN[name].texts([own.min(), own.max()], " to ") if own.size else "-" for own in finite),
                ]
            )
        return [TextTable(self._heading, ["minimum to maximum", *sides], rows, frozenset((1, 2)))]

    @property
    def _heading(self) -> str:
        """One line: status, distance and time reached, lateral range, computing time."""
        from wheelrail.scenes.quantities import RUN

        data, y = self.data, RUN["body_y"]
        reached, time = float(data["distance"].values[-1]), float(data["time"].values[-1])
        lateral = data["body_y"].sel(body=data["wheelset"].values).values
        bodies = "wheelsets" if data.sizes["wheelset"] > 1 else "wheelset"
        return (
            f"Vehicle run: {data.attrs['status']} at {reached:.1f} m, {time:.2f} s; {data.sizes['time']} samples, "
            f"{bodies} y {y.texts([lateral.min()])} to {y.texts([lateral.max()])} {y.shown}; "
            f"{float(data.attrs['seconds']):.1f} s computing time"
        )


def run(
    scene: str | Path,
    out: str | Path | None = None,
    *,
    vehicle: str | Path | None = None,
    progress: bool = False,
    profiles: Mapping[str, Any] | None = None,
    **changes: Any,
) -> Run:
    """Simulate the vehicle run of a scene file.

    Parameters:
        scene: scene file (TOML) of kind "run".
        out: folder for results, figures and checkpoints, as with the command `wheelrail run`; nothing is written by
            default.
        vehicle: vehicle file (TOML): this vehicle in three dimensions in place of the plane wagon of the scene.
        progress: whether to show a progress bar on standard error.
        profiles: values of keys of [profiles], where wheel and rail may be profiles from `wheelrail.profile`:
            profiles={"wheel": worn, "right": {"wheel": other, "radius": 0.4595}}; other keys of the table remain.
        changes: new values of keys of the scene, in SI units, by dotted name:
            run("scenes/curve.toml", **{"vehicle.speed": 30.0}); None removes a key.

    A run that ends early sets the status and raises nothing, unless no step was completed (RuntimeError). Raises
    SceneError naming file, key, value and what is allowed, OSError for a folder that cannot be written.
    """
    from rich.console import Console

    from wheelrail.scenes.datasets.run_file import RESULTS, read_run
    from wheelrail.scenes.runs.run import run_scene, simulate_scene
    from wheelrail.scenes.schema.edits import changed, without
    from wheelrail.scenes.schema.errors import SceneError
    from wheelrail.scenes.schema.scene import RunScene, checked, warned
    from wheelrail.scenes.schema.toml import parse, read_text
    from wheelrail.support.terminal import messages_on, progress_console

    text = read_text(Path(scene))
    names, given = with_names("run", profiles or {})
    changes = {**{f"profiles.{key}": value for key, value in names.items()}, **changes}
    if changes:
        import tomli_w

        removed = [name for name, value in changes.items() if value is None]
        replaced = {name: plain(value) for name, value in changes.items() if value is not None}
        text = tomli_w.dumps(changed(without(parse(text, scene), removed, scene), replaced, scene))
    run_scene_data = warned(checked(parse(text, scene), scene, given=given), scene)
    if not isinstance(run_scene_data, RunScene):
        raise SceneError(
            f'{scene}: kind = "{run_scene_data.kind}": must be "run"; for a single contact use wheelrail.load'
        )
    console = progress_console() if progress else Console(quiet=True)
    messages = messages_on(console) if progress else nullcontext()
    vehicle_file = None if vehicle is None else Path(vehicle)
    if out is None:
        with messages:
            history, data = simulate_scene(run_scene_data, text, console, vehicle_file)
        if data is None:
            raise RuntimeError(f"{scene}: {history.status} before the first step")
        return Run(data)
    with messages:
        outcome = run_scene(run_scene_data, text, Path(out), console, vehicle=vehicle_file)
    if not outcome.files:
        raise RuntimeError(f"{scene}: {outcome.status} before the first step")
    return Run(read_run(Path(out) / RESULTS))
