"""Commands for 3D views, animations, HTML reports, running safety and assessments."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from wheelrail.cli.app import app
from wheelrail.cli.arguments import SceneFile, check_ending, computing, error_lines, load, rejected, results_folder
from wheelrail.cli.output import print_files, print_results
from wheelrail.support.terminal import stdout_for_results


@app.command()
def view(
    scene: SceneFile,
    out: Annotated[Path, typer.Option("--out", metavar="FILE", help="Image (.png) or interactive 3D view (.html).")],
    scale: Annotated[
        float | None, typer.Option("--scale", metavar="N", help="Displacement magnification factor.")
    ] = None,
    body: Annotated[str, typer.Option("--body", help="wheel or rail; upper or lower; both.")] = "both",
    side: Annotated[str | None, typer.Option("--side", help="left or right; default: first side of the scene.")] = None,
) -> None:
    """Save a 3D view of a contact: deformed bodies, pressure, von Mises stress on cut planes."""
    checked = load(scene)
    if checked.kind == "run":
        raise rejected(f'{scene}: kind = "run": must be "hertz" or "wheelset"; for a run use wheelrail animate')
    check_ending("--out", out, (".png", ".html"))
    if scale is not None and not 0 < scale < float("inf"):
        raise rejected(f"--scale {scale:g}: must be greater than 0")
    from wheelrail.scenes.views.html import save_view
    from wheelrail.scenes.views.view import view_scene

    with computing(f"{scene}: ", "reading the scene") as status:
        plotter = view_scene(
            checked, title=scene.stem, body=body, side=side, scale=scale, report_progress=status.update
        )
        save_view(plotter, out)
    print_files("view", out)


@app.command()
def animate(
    results: Annotated[Path, typer.Argument(metavar="RUN", help="Results of a run: run.nc or its folder.")],
    out: Annotated[Path, typer.Option("--out", metavar="FILE", help="Animation file (.mp4, .gif).")],
    frames: Annotated[int, typer.Option("--frames", metavar="N", min=1, max=100_000, help="Number of frames.")] = 120,
    fps: Annotated[float, typer.Option("--fps", metavar="N", min=0.1, max=240.0, help="Frames per second.")] = 20.0,
    scale: Annotated[
        float | None,
        typer.Option(
            "--scale",
            metavar="N",
            min=1e-3,
            max=1e6,
            help="Displacement magnification factor; default: 20, with a vehicle file 10.",
            show_default=False,
        ),
    ] = None,
) -> None:
    """Save an animation of a run: the wheelset on its rails, forces, and close-ups of both contacts.

    Of a vehicle file: all bodies on the track, with wheels coloured by their load.
    """
    check_ending("--out", out, (".mp4", ".gif"))
    from wheelrail.scenes.views.view import animate_file

    with computing("", "reading the run") as status:

        def report_progress(done: int, count: int) -> None:
            status.update(f"frame {done} of {count}")

        animate_file(results, out, report_progress, frames=frames, fps=fps, scale=scale)
    print_files("animate", out)


@app.command()
def report(
    folder: Annotated[
        Path,
        typer.Argument(
            metavar="DIR", help="Folder with results of a run, a study, wear or a comparison.", show_default=False
        ),
    ],
    out: Annotated[
        Path | None, typer.Option("--out", metavar="FILE", help="HTML file to write; default: DIR/report.html.")
    ] = None,
    no_view: Annotated[bool, typer.Option("--no-view", help="Omit the interactive 3D view.")] = False,
) -> None:
    """Write a self-contained HTML report of results: input, tables, figures, interactive 3D view."""
    if out is not None:
        check_ending("--out", out, (".html",))
    from wheelrail.scenes.html_report.write import write_report

    place = folder / "report.html" if out is None else out
    with computing("", "reading and drawing", f"{place}: "):
        write_report(folder, place, view=not no_view)
    print_files("report", place)


@app.command()
def evaluate(
    results: Annotated[Path, typer.Argument(metavar="RUN", help="Results of a run: run.nc or its folder.")],
    start: Annotated[float, typer.Option("--from", metavar="S", help="Start of the section of track, m.")] = 0.0,
    end: Annotated[float, typer.Option("--to", metavar="S", help="End of the section, m.")] = float("inf"),
    alpha: Annotated[
        float,
        typer.Option("--alpha", metavar="A", min=0.1, max=1.0, help="Factor of the limit of the sum of Y."),
    ] = 1.0,
) -> None:
    """Running safety of a run after EN 14363: sum of Y, Y/Q, Q, instability."""
    from wheelrail.scenes.runs.safety_table import safety_of, safety_results

    with error_lines(""), stdout_for_results():
        safety = safety_of(results, start, end, alpha)
    print_results(safety_results(safety))


@app.command()
def assess(
    results: Annotated[
        list[Path], typer.Argument(metavar="RUN...", help="Results of runs of one vehicle: run.nc or its folder.")
    ],
    out: Annotated[
        Path | None,
        typer.Option("--out", metavar="DIR", help="Folder for assessment.html, .json and .csv; default: print only."),
    ] = None,
    alpha: Annotated[
        float, typer.Option("--alpha", metavar="A", help="Factor of the limit of the sum of Y; freight wagons 0.85.")
    ] = 1.0,
    length: Annotated[
        float | None,
        typer.Option("--length", metavar="L", help="Length of all sections, m; default: by zone.", show_default=False),
    ] = None,
    deficiency: Annotated[
        float | None,
        typer.Option(
            "--deficiency",
            metavar="I",
            help="Cant deficiency of the two-dimensional estimates, m; default: none.",
            show_default=False,
        ),
    ] = None,
    floor: Annotated[
        float, typer.Option("--floor", metavar="H", help="Height of the floor above top of rail, m.")
    ] = 1.2,
) -> None:
    """Assess runs after EN 14363 and EN 12299: zones, estimates, limits with sources, verdict, comfort."""
    from wheelrail.scenes.assessment.assess import Options, assessment_of
    from wheelrail.scenes.assessment.tables import assessment_results

    folder = None if out is None else results_folder(out, out)
    with computing("", "reading", "" if folder is None else f"{folder}: "):
        found = assessment_of(results, Options(alpha, length, deficiency, floor))
        files = []
        if folder is not None:
            from wheelrail.scenes.html_report.assessment_page import write_assessment

            files = write_assessment(found, folder)
    print_results(assessment_results(found, files))
