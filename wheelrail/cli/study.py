"""Commands `study` and `wear`: series of scenes."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from wheelrail.cli.app import app
from wheelrail.cli.arguments import error_lines, folder_option, results_folder
from wheelrail.cli.output import FAILED, INTERRUPTED, print_results
from wheelrail.support.terminal import progress_console, stdout_for_results

Scheduler = Annotated[
    str | None,
    typer.Option("--scheduler", metavar="ADDRESS", help="Dask scheduler, tcp://host:8786; default: this machine."),
]


@app.command()
def study(
    study: Annotated[Path, typer.Argument(metavar="STUDY", help="Study file (TOML).", show_default=False)],
    out: Annotated[Path | None, folder_option("results/<study>")] = None,
    scheduler: Scheduler = None,
    fresh: Annotated[bool, typer.Option("--fresh", help="Recompute completed cases.")] = False,
) -> None:
    """Solve all cases of a study in parallel; a restart computes only missing cases."""
    from wheelrail.scenes.studies.plan import plan
    from wheelrail.scenes.studies.run import run_plan
    from wheelrail.scenes.studies.schema import load_study

    folder = results_folder(out, Path("results", study.stem))
    with error_lines(""), progress_console().status("checking the cases"):
        planned = plan(load_study(study), study)
    with error_lines("", f"{folder}: "), stdout_for_results():
        outcome = run_plan(planned, folder, progress_console(), scheduler=scheduler, fresh=fresh)
    print_results(outcome.results)
    if outcome.interrupted:
        raise typer.Exit(INTERRUPTED)
    if outcome.failed:
        raise typer.Exit(FAILED)


@app.command()
def wear(
    wear: Annotated[Path, typer.Argument(metavar="WEAR", help="Wear file (TOML).", show_default=False)],
    out: Annotated[Path | None, folder_option("results/<wear>")] = None,
    resume: Annotated[bool, typer.Option("--resume", help="Continue from the last whole step.")] = False,
    processes: Annotated[
        int, typer.Option("--processes", min=1, help="Processes for the cases; 1: this one, in threads.")
    ] = 1,
    scheduler: Scheduler = None,
) -> None:
    """Wear the wheel profiles of a vehicle over a distance; after Ctrl-C, --resume continues from the last step."""
    from wheelrail.scenes.wear.run import run_wear
    from wheelrail.scenes.wear.schema import load_wear

    folder = results_folder(out, Path("results", wear.stem))
    with error_lines(""):
        table = load_wear(wear)
    with error_lines("", f"{folder}: "), stdout_for_results():
        outcome = run_wear(
            table, wear, folder, progress_console(), resume=resume, processes=processes, scheduler=scheduler
        )
    print_results(outcome.results)
    if outcome.status == "interrupted":
        raise typer.Exit(INTERRUPTED)
    if outcome.status != "completed":
        raise typer.Exit(FAILED)
