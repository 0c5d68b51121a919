"""A vehicle run of a scene: contact model, simulation with progress, results and pictures on disk."""

from __future__ import annotations

import signal
from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from dataclasses import dataclass
from math import atan
from pathlib import Path
from typing import TYPE_CHECKING

from scenes.models import wheelset_contact
from scenes.scene import RunScene
from scenes.sections import overridden

if TYPE_CHECKING:
    from rich.console import Console, RenderableType

    from vehicle.history import History
    from vehicle.simulate import Progress
    from vehicle.track import Track
    from vehicle.wagon import Wagon

RESULTS = "run.nc"


@dataclass(frozen=True)
class Outcome:
    """A run that ended: its history, and the files that were written."""

    history: History
    files: tuple[Path, ...]

    @property
    def status(self) -> str:
        return self.history.status

    def summary(self) -> list[RenderableType]:
        """What to print at the end: cost by side, how it ended, and where everything is."""
        reached = f" at {self.history.distance[-1]:.1f} m" if len(self.history) else " before the first step"
        lines = [f"{self.status}{reached}", *(f"  {file}" for file in self.files)]
        return [costs(self.history), "\n".join(lines)]


def run_scene(scene: RunScene, text: str, folder: Path, console: Console) -> Outcome:
    """Run a scene and keep what it gives in a folder; text is the scene as written, kept with the results.

    An interrupted or failed run is kept up to where it came. Raises OSError when the folder cannot be written.
    """
    folder.mkdir(parents=True, exist_ok=True)
    with console.status("meshes and stiffness of wheel and rail"):
        contact = wheelset_contact(scene)
    from vehicle.simulate import simulate

    with progress_bar(console, scene.track.length) as progress:
        history = simulate(
            wagon(scene),
            track(scene),
            contact,
            speed=scene.vehicle.speed,
            span=(0.0, scene.track.length / scene.vehicle.speed),
            method=scene.solver.method,
            rtol=scene.solver.rtol,
            atol=scene.solver.atol,
            every=scene.output.interval or None,
            progress=progress,
        )
    if not len(history):
        return Outcome(history, ())
    with console.status("results and pictures"):
        return Outcome(history, tuple(keep(history, text, folder, figures=scene.output.figures)))


def keep(history: History, text: str, folder: Path, *, figures: bool) -> Iterator[Path]:
    """Write results, then pictures; yields the files."""
    from scenes.results import dataset, write

    with _undisturbed():
        data = dataset(history, scene=text)
        write(data, folder / RESULTS)
    yield folder / RESULTS
    if figures:
        from scenes.figures import draw_figures

        try:
            yield from draw_figures(data, folder)
        except KeyboardInterrupt:  # whoever has no time for pictures keeps the results
            return


def track(scene: RunScene) -> Track:
    """The scene's tangent, transition and curve."""
    from vehicle.track import Track

    line = scene.track
    return Track.curve(
        curvature=line.curvature,
        cant=line.cant,
        tangent=line.tangent,
        transition=line.transition_length,
        length=line.curve,
        gradient=atan(line.slope),
        base=line.cant_base,
        shape=line.transition,
        corner=line.corner,
    )


def wagon(scene: RunScene) -> Wagon:
    """The Manchester wagon on the scene's wheels, with the values that the scene replaces."""
    from dataclasses import replace

    from vehicle.wagon import Wagon

    standard = Wagon()
    given = replace(standard, wheelset=replace(standard.wheelset, height=scene.wheelset.radius))
    changed: Wagon = overridden(given, scene.vehicle.model_extra or {})
    return changed


@contextmanager
def progress_bar(console: Console, length: float) -> Iterator[Progress]:
    """A bar over the distance m with the time left, called by `simulate` at each accepted step; ten lines in a log."""
    from rich import progress as bars

    columns = (
        bars.TextColumn("{task.description}"),
        bars.BarColumn(bar_width=20),
        bars.TextColumn("{task.completed:.0f}/{task.total:.0f} m,"),
        bars.TimeElapsedColumn(),
        bars.TextColumn("gone,"),
        bars.TimeRemainingColumn(),
        bars.TextColumn("left, {task.fields[solves]:.0f} solves"),
    )
    with bars.Progress(*columns, console=console, speed_estimate_period=120.0) as shown:
        task, said = shown.add_task("equilibrium", total=length, solves=0), 0

        def progress(share: float, figures: Mapping[str, float]) -> None:
            nonlocal said
            shown.update(task, completed=share * length, description="running", solves=figures["solves"])
            if not console.is_terminal and int(10 * share) > said:
                said = int(10 * share)
                left = shown.tasks[0].time_remaining or 0.0
                console.print(f"{share * length:.0f}/{length:.0f} m, {figures['solves']:.0f} solves, {left:.0f} s left")

        yield progress


def costs(history: History) -> RenderableType:
    """Contact problems, Newton and linear iterations and seconds by side, like Tables 5 to 7 of the paper."""
    from rich.table import Table

    steps = history.cost.steps
    view = Table(title="What the run cost", title_justify="left")
    for name in ("", "contact problems", "failed", "Newton", "Newton per problem", "linear per Newton", "seconds"):
        view.add_column(name, justify="right")
    for side, cost in history.cost.contact.items():
        view.add_row(
            side,
            str(cost.solves),
            str(cost.failed),
            str(cost.newton),
            f"{cost.newton / max(cost.solves, 1):.2f}",
            f"{cost.linear / max(cost.newton, 1):.2f}" if cost.linear else "direct",
            f"{cost.seconds:.1f}",
        )
    view.add_section()
    done = f"{steps.accepted} steps, {steps.rejected} rejected, {steps.failed} failed"
    view.caption = f"{done}, {steps.evaluations} evaluations, {history.cost.seconds:.1f} s in all"
    view.caption_justify = "left"
    return view


@contextmanager
def _undisturbed() -> Iterator[None]:
    """Let no impatient second Ctrl-C spoil what the first one was to keep."""
    try:
        before = signal.signal(signal.SIGINT, signal.SIG_IGN)
    except ValueError:  # not in the main thread, where no Ctrl-C arrives
        yield
        return
    try:
        yield
    finally:
        signal.signal(signal.SIGINT, before)
