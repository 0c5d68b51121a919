"""What a run shows of itself: a bar while it goes on, its cost at the end."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping
from contextlib import contextmanager
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from rich.console import Console, RenderableType

    from wheelrail.vehicle.simulation.history import History
    from wheelrail.vehicle.simulation.simulate import Progress


@contextmanager
def progress_bar(console: Console, length: float, gone: float = 0.0) -> Iterator[Progress]:
    """A bar over the distance m with the time left, called by `simulate` at each accepted step; ten lines in a log.

    gone m, where a run goes on.
    """
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
        task, said = shown.add_task("equilibrium", total=length, completed=int(gone), solves=0), int(10 * gone / length)

        def progress(share: float, figures: Mapping[str, float]) -> None:
            nonlocal said
            shown.update(task, completed=figures["distance"], description="running", solves=figures["solves"])
            if not console.is_terminal and int(10 * share) > said:
                said = int(10 * share)
                left = shown.tasks[0].time_remaining or 0.0
                console.print(
                    f"{figures['distance']:.0f}/{length:.0f} m, {figures['solves']:.0f} solves, {left:.0f} s left"
                )

        yield progress


@contextmanager
def case_bar(console: Console, total: int) -> Iterator[Callable[[bool], None]]:
    """A bar over the cases of a study with the time left, called when a case has ended, well or not; ten lines in a
    log.
    """
    from rich import progress as bars

    columns = (
        bars.TextColumn("{task.completed:.0f}/{task.total:.0f} cases"),
        bars.BarColumn(bar_width=20),
        bars.TimeElapsedColumn(),
        bars.TextColumn("gone,"),
        bars.TimeRemainingColumn(),
        bars.TextColumn("left, {task.fields[failed]:.0f} failed"),
    )
    with bars.Progress(*columns, console=console, speed_estimate_period=600.0) as shown:
        task, said, failed = shown.add_task("cases", total=total, failed=0), 0, 0

        def done(well: bool) -> None:
            nonlocal said, failed
            failed += not well
            shown.update(task, advance=1, failed=failed)
            ended = int(shown.tasks[0].completed)
            if not console.is_terminal and 10 * ended // total > said:
                said, left = 10 * ended // total, shown.tasks[0].time_remaining or 0.0
                console.print(f"{ended}/{total} cases, {failed} failed, {left:.0f} s left")

        yield done


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
    done += f", {steps.evaluations} evaluations"
    if steps.jacobians:
        done += f", {steps.jacobians} Jacobians, {steps.factorisations} factorisations"
    view.caption = f"{done}, {history.cost.seconds:.1f} s in all"
    view.caption_justify = "left"
    return view
