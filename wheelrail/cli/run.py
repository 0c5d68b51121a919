"""Vehicle runs, their tracks, and what is linear or steady about them."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from wheelrail.cli.app import app
from wheelrail.cli.arguments import SceneFile, check_picture, complaints, load_run, results_folder
from wheelrail.cli.exit_codes import FAILED, INTERRUPTED
from wheelrail.support.terminal import progress_console, result_console, stdout_for_results

Speeds = Annotated[
    list[float] | None,
    typer.Option("--speed", metavar="V", min=0.1, max=200.0, help="Speed in m/s, repeatable; the scene's without it."),
]


@app.command()
def track(
    scene: SceneFile,
    picture: Annotated[
        Path | None,
        typer.Option("--picture", metavar="FILE", help="Save the layout as a picture (.png, .svg, .pdf)."),
    ] = None,
) -> None:
    """Show the track of a vehicle run: its segments, cant deficiency and irregularities."""
    given = load_run(scene)
    check_picture(picture)
    from wheelrail.scenes.runs.track_table import segment_table

    result_console().print(segment_table(given))
    if picture is not None:
        from wheelrail.scenes.runs.track_plot import draw_track

        with complaints("", f"{picture}: "):
            draw_track(given, picture)


@app.command()
def run(
    scene: SceneFile,
    out: Annotated[
        Path | None,
        typer.Option("--out", metavar="DIR", help="Folder of the results; results/<name of the scene> without it."),
    ] = None,
    resume: Annotated[
        bool, typer.Option("--resume", help="Go on with a run that was stopped or killed, from its last checkpoint.")
    ] = False,
) -> None:
    """Run a vehicle along its track; Ctrl-C keeps everything computed so far, --resume goes on from there."""
    given = load_run(scene)
    from wheelrail.scenes.runs.resume import ended
    from wheelrail.scenes.runs.run import run_scene

    folder = results_folder(out, Path("results", scene.stem))
    with complaints(f"{scene}: ", f"{folder}: "):
        if resume and ended(given, folder):
            print(f"{folder}: this run is complete, there is nothing to go on with")
            return
        with stdout_for_results():
            text = scene.read_text(encoding="utf-8")
            outcome = run_scene(given, text, folder, progress_console(), resume=resume)
    for part in outcome.summary():
        result_console().print(part, highlight=False, markup=False)
    if outcome.status == "interrupted":
        raise typer.Exit(INTERRUPTED)
    if outcome.status != "completed":
        raise typer.Exit(FAILED)


@app.command()
def compare(
    scene: SceneFile,
    other: Annotated[
        str, typer.Option("--with", metavar="MODEL", help="The contact model to compare the scene's own with.")
    ] = "standard",
    out: Annotated[
        Path | None,
        typer.Option("--out", metavar="DIR", help="Folder of the results; results/<name of the scene>_compare."),
    ] = None,
) -> None:
    """Run a vehicle with two contact models: both in one picture, and a table of their differences."""
    load_run(scene)
    from wheelrail.scenes.runs.compare import compare_scene

    folder = results_folder(out, Path("results", f"{scene.stem}_compare"))
    with complaints("", f"{folder}: "), stdout_for_results():
        found = compare_scene(scene, scene.read_text(encoding="utf-8"), other, folder, progress_console())
    for part in found.summary():
        result_console().print(part, highlight=False, markup=False)


@app.command()
def modes(scene: SceneFile, speed: Speeds = None) -> None:
    """Linear modes of a run's wagon on straight track, its contact included: frequency, damping, what moves."""
    given = load_run(scene)
    from wheelrail.scenes.runs.steady import modes_of, modes_table

    speeds = speed or [given.vehicle.first_speed]
    with complaints(f"{scene}: "), stdout_for_results(), progress_console().status("contact and equilibrium"):
        found = modes_of(given, speeds)
    for table in map(modes_table, found, speeds):
        result_console().print(table, highlight=False, markup=False)


@app.command()
def curving(scene: SceneFile, speed: Speeds = None) -> None:
    """Steady position in the sharpest curve of a run: wheel loads, Y/Q, deflections, places of contact."""
    given = load_run(scene)
    from wheelrail.scenes.runs.steady import curving_of, curving_table

    with complaints(f"{scene}: "), stdout_for_results(), progress_console().status("contact and equilibrium"):
        found = curving_of(given, speed or [given.vehicle.first_speed])
    result_console().print(curving_table(found), highlight=False, markup=False)
