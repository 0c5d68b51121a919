"""Progress bars of runs and studies, and the solver statistics of a run."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping
from contextlib import contextmanager
from typing import TYPE_CHECKING

from wheelrail.scenes.datasets.result_table import Column, ResultTable

if TYPE_CHECKING:
    from rich.console import Console

    from wheelrail.vehicle.simulation.contact_cost import ContactCost
    from wheelrail.vehicle.simulation.history import History
    from wheelrail.vehicle.simulation.time_run import Progress


@contextmanager
def progress_bar(console: Console, length: float, start_distance: float = 0.0) -> Iterator[Progress]:
    """Progress bar over distance with the remaining time; ten lines without a terminal.

    Parameters:
        console: to print to.
        length: of the track, m.
        start_distance: distance at which a resumed run starts, m.

    Yields the function that `simulate` calls at each accepted step.
    """
    from rich import progress as bars

    columns = (
        bars.TextColumn("{task.description}"),
        bars.BarColumn(bar_width=20),
        bars.TextColumn("{task.completed:.0f}/{task.total:.0f} m,"),
        bars.TimeElapsedColumn(),
        bars.TextColumn("elapsed,"),
        bars.TimeRemainingColumn(),
        bars.TextColumn("left, {task.fields[solves]:.0f} solves"),
    )
    with bars.Progress(*columns, console=console, speed_estimate_period=120.0) as shown:
        task = shown.add_task("equilibrium", total=length, completed=int(start_distance), solves=0)
        printed = int(10 * start_distance / length)

        def progress(fraction: float, figures: Mapping[str, float]) -> None:
            nonlocal printed
            shown.update(task, completed=figures["distance"], description="running", solves=figures["solves"])
            if not console.is_terminal and int(10 * fraction) > printed:
                printed = int(10 * fraction)
                remaining = shown.tasks[0].time_remaining or 0.0
                console.print(
                    f"{figures['distance']:.0f}/{length:.0f} m, {figures['solves']:.0f} solves, {remaining:.0f} s left"
                )

        yield progress


@contextmanager
def case_bar(console: Console, cases: int) -> Iterator[Callable[[bool], None]]:
    """Progress bar over the cases of a study with the remaining time; ten lines without a terminal.

    Parameters:
        console: to print to.
        cases: their number.

    Yields the function to call when a case has ended, with whether it succeeded.
    """
    from rich import progress as bars

    columns = (
        bars.TextColumn("{task.completed:.0f}/{task.total:.0f} cases"),
        bars.BarColumn(bar_width=20),
        bars.TimeElapsedColumn(),
        bars.TextColumn("elapsed,"),
        bars.TimeRemainingColumn(),
        bars.TextColumn("left, {task.fields[failed]:.0f} failed"),
    )
    with bars.Progress(*columns, console=console, speed_estimate_period=600.0) as shown:
        task, printed, failed = shown.add_task("cases", total=cases, failed=0), 0, 0

        def done(succeeded: bool) -> None:
            nonlocal printed, failed
            failed += not succeeded
            shown.update(task, advance=1, failed=failed)
            ended = int(shown.tasks[0].completed)
            if not console.is_terminal and 10 * ended // cases > printed:
                printed, remaining = 10 * ended // cases, shown.tasks[0].time_remaining or 0.0
                console.print(f"{ended}/{cases} cases, {failed} failed, {remaining:.0f} s left")

        yield done


def costs(history: History) -> ResultTable:
    """Solver statistics by side, as in Tables 5 to 7 of the paper."""
    steps = history.cost.steps
    done = f"{steps.accepted} steps, {steps.rejected} rejected, {steps.failed} failed"
    done += f", {steps.evaluations} evaluations"
    if steps.jacobians:
        done += f", {steps.jacobians} Jacobians, {steps.factorisations} factorisations"
    note = f"{done}, {history.cost.seconds:.1f} s in total"
    return ResultTable("contacts", "Statistics of the solver", _COSTS, list(history.cost.contact.items()), note=note)


_COSTS = (
    Column("side", "side", lambda row: row[0]),
    Column("solves", "contact problems", lambda row: row[1].solves, "1"),
    Column("failed", "failed", lambda row: row[1].failed, "1"),
    Column("newton", "Newton", lambda row: row[1].newton, "1"),
    Column("linear", "", lambda row: row[1].linear, "1"),
    Column("", "Newton per problem", lambda row: f"{row[1].newton / max(row[1].solves, 1):.2f}"),
    Column("", "linear per Newton", lambda row: _linear(row[1])),
    Column("seconds", "seconds", lambda row: row[1].seconds, "s", 1),
)


def _linear(cost: ContactCost) -> str:
    return f"{cost.linear / max(cost.newton, 1):.2f}" if cost.linear else "direct"
