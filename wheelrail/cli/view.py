"""Pictures in three dimensions, films, and pages."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from wheelrail.cli.app import app
from wheelrail.cli.arguments import SceneFile, check_ending, complaints, load, refused
from wheelrail.support.terminal import progress_console, stdout_for_results


@app.command()
def view(
    scene: SceneFile,
    out: Annotated[Path, typer.Option("--out", metavar="FILE", help="Picture (.png), or page to turn (.html).")],
    scale: Annotated[float | None, typer.Option("--scale", metavar="N", help="Displacements so many times.")] = None,
    body: Annotated[str, typer.Option("--body", help="wheel or rail, upper or lower, or both.")] = "both",
    side: Annotated[str | None, typer.Option("--side", help="left or right; the scene's first without it.")] = None,
) -> None:
    """Draw a contact in three dimensions: bodies deformed, pressure, von Mises stress on cuts below the surface."""
    given = load(scene)
    if given.kind == "run":
        raise refused(f'{scene}: kind = "run": this is a vehicle run, use wheelrail animate with its results')
    check_ending("--out", out, (".png", ".html"))
    if scale is not None and not 0 < scale < float("inf"):
        raise refused(f"--scale {scale:g}: must be greater than 0")
    from wheelrail.scenes.views.html import save_view
    from wheelrail.scenes.views.view import view_scene

    console = progress_console()
    with complaints(f"{scene}: "), stdout_for_results(), console.status("reading the scene") as status:
        made = view_scene(given, title=scene.stem, body=body, side=side, scale=scale, say=status.update)
        save_view(made, out)


@app.command()
def animate(
    results: Annotated[Path, typer.Argument(metavar="RUN", help="Results of a run: run.nc, or its folder.")],
    out: Annotated[Path, typer.Option("--out", metavar="FILE", help="Film (.mp4, .gif).")],
    frames: Annotated[int, typer.Option("--frames", metavar="N", min=1, max=100_000)] = 120,
    fps: Annotated[float, typer.Option("--fps", metavar="N", min=0.1, max=240.0, help="Frames a second.")] = 20.0,
    scale: Annotated[
        float, typer.Option("--scale", metavar="N", min=1e-3, max=1e6, help="Displacements so many times above.")
    ] = 20.0,
) -> None:
    """Make a film of a run: the wheelset on its rails, forces, and both contacts close up."""
    check_ending("--out", out, (".mp4", ".gif"))
    from wheelrail.scenes.views.view import animate_file

    console = progress_console()
    with complaints(""), stdout_for_results(), console.status("reading the run") as status:

        def told(done: int, count: int) -> None:
            status.update(f"frame {done} of {count}")

        animate_file(results, out, told, frames=frames, fps=fps, scale=scale)


@app.command()
def report(
    folder: Annotated[
        Path,
        typer.Argument(metavar="DIR", help="Results of a run, a study or a comparison.", show_default=False),
    ],
    out: Annotated[
        Path | None, typer.Option("--out", metavar="FILE", help="The page (.html); DIR/report.html without it.")
    ] = None,
    no_view: Annotated[bool, typer.Option("--no-view", help="Leave the view in three dimensions out.")] = False,
) -> None:
    """Make one HTML page of results: what was run, tables, pictures, a view to turn; it needs nothing besides."""
    if out is not None:
        check_ending("--out", out, (".html",))
    from wheelrail.scenes.html_report.write import write_report

    place = folder / "report.html" if out is None else out
    with complaints("", f"{place}: "), stdout_for_results(), progress_console().status("reading and drawing"):
        write_report(folder, place, view=not no_view)
    print(place)
