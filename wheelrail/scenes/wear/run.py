"""Wear of a file: loop with progress, results and figures on disk."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING

from wheelrail.scenes.datasets.result_table import Results
from wheelrail.scenes.plots.style import save, styled
from wheelrail.scenes.plots.wear import PICTURES
from wheelrail.scenes.wear.cases import Duty
from wheelrail.scenes.wear.jobs import workers
from wheelrail.scenes.wear.loop import RESULTS, WearLoop
from wheelrail.scenes.wear.schema import WearTable
from wheelrail.scenes.wear.tables import remarks, tables

if TYPE_CHECKING:
    from collections.abc import Callable

    from rich.console import Console
    from xarray import Dataset


@dataclass(frozen=True)
class WearOutcome:
    """Outcome of a wear loop: its Dataset and written files."""

    data: Dataset
    files: tuple[Path, ...]

    @property
    def status(self) -> str:
        return str(self.data.attrs["status"])

    @property
    def results(self) -> Results:
        """Tables of steps and cases, status and files."""
        distance = float(self.data["distance"].values[-1])
        lines = [*remarks(self.data), f"{self.status} at {1e-3 * distance:.0f} km"]
        lines += [f"  {file}" for file in self.files]
        if self.status == "interrupted" and self.files:
            lines.append("  --resume continues from the last step")
        facts = {"status": self.status, "distance": distance, "files": self.files}
        return Results("wear", [*tables(self.data), "\n".join(lines)], facts, {"distance": "m"})


def run_wear(
    table: WearTable,
    path: Path,
    folder: Path | None,
    console: Console,
    *,
    resume: bool = False,
    processes: int = 1,
    scheduler: str | None = None,
) -> WearOutcome:
    """Wear the profiles of a file.

    Parameters:
        table: of the file.
        path: of the file.
        folder: for the steps, results and figures; None: nothing is written.
        console: for progress.
        resume: whether to continue from the steps in the folder.
        processes: that solve the cases; with one, this process does.
        scheduler: address of a Dask cluster, whose workers see the same files.

    Raises SceneError before anything is computed, RunFailed without a first step, OSError.
    """
    duty = Duty(table, path)
    if folder is not None and not resume and (folder / RESULTS).exists():
        console.print(f"{folder} contains the results of earlier wear, which this one overwrites", highlight=False)
    with workers(processes, scheduler) as executor, progress(console, table.until) as report:
        data = WearLoop(duty, folder, report, executor).run(resume=resume)
    return WearOutcome(data, tuple(_written(data, folder)) if folder else ())


def _written(data: Dataset, folder: Path) -> Iterator[Path]:
    """Draw the figures; yields all files."""
    yield folder / RESULTS
    for name, draw in PICTURES.items():
        with styled():
            figure = draw(data, None)
            if figure is not None:
                save(figure, folder / f"{name}.png")
                yield folder / f"{name}.png"


@contextmanager
def progress(console: Console, until: float) -> Iterator[Callable[[float, str], None]]:
    """Progress bar over the distance m with the remaining time; lines without a terminal.

    Yields the function that the loop calls.
    """
    from rich import progress as bars

    columns = (
        bars.BarColumn(bar_width=20),
        bars.TextColumn("{task.completed:.0f}/{task.total:.0f} km,"),
        bars.TimeElapsedColumn(),
        bars.TextColumn("elapsed,"),
        bars.TimeRemainingColumn(),
        bars.TextColumn("left, {task.description}"),
    )
    with bars.Progress(*columns, console=console, speed_estimate_period=600.0) as shown:
        task, printed = shown.add_task("new profiles", total=1e-3 * until), -1

        def report(done: float, words: str) -> None:
            nonlocal printed
            shown.update(task, completed=1e-3 * until * done, description=words)
            if not console.is_terminal and int(10.0 * done) > printed:
                printed, left = int(10.0 * done), shown.tasks[0].time_remaining
                rest = "" if left is None else f", {left:.0f} s left"
                console.print(f"{1e-3 * until * done:.0f}/{1e-3 * until:.0f} km{rest}: {words}")

        yield report
