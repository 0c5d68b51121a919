"""Command `explore`: a contact or a run in the browser."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from wheelrail.cli.app import app
from wheelrail.cli.arguments import error_lines, reject_mpi
from wheelrail.support.terminal import progress_console

if TYPE_CHECKING:
    from wheelrail.explorer.server import Served


@app.command()
def explore(
    what: Annotated[
        Path | None,
        typer.Argument(
            metavar="[SCENE|RUN]",
            help="Scene of a contact (TOML), or results of a run: run.nc or its folder; default: a standard wheelset.",
            show_default=False,
        ),
    ] = None,
    port: Annotated[
        int, typer.Option("--port", min=0, max=65535, help="Port to listen on, on this machine only; 0: a free one.")
    ] = 0,
    no_browser: Annotated[bool, typer.Option("--no-browser", help="Only print the address.")] = False,
) -> None:
    """Move a contact by sliders, or play a run, in the browser."""
    reject_mpi("explore")
    from wheelrail.explorer.server import serve
    from wheelrail.explorer.start import subject

    def ready(served: Served) -> None:
        print(served.url, flush=True)
        progress_console().print("Ctrl-C ends it; the address has a token: give it to nobody", highlight=False)
        if not no_browser:
            import webbrowser

            webbrowser.open(served.url)

    with error_lines(""):
        serve(subject(what), port, ready)
