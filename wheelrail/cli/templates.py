"""Commands that print templates: wagon, example."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from wheelrail.cli.app import app
from wheelrail.cli.arguments import error_lines


@app.command()
def wagon(
    file: Annotated[
        Path | None,
        typer.Argument(metavar="FILE", help="Wagon file (TOML); default: the Manchester wagon.", show_default=False),
    ] = None,
) -> None:
    """Print a wagon with all its values as a TOML template."""
    from wheelrail.scenes.schema.wagon_file import load_wagon, wagon_toml
    from wheelrail.vehicle.wagon.wagon import Wagon

    with error_lines(""):
        print(wagon_toml(Wagon() if file is None else load_wagon(file)), end="")


@app.command()
def example(
    name: Annotated[
        str | None,
        typer.Argument(metavar="NAME", help="Name of the example; without it, list all.", show_default=False),
    ] = None,
) -> None:
    """Print an example scene as a template, or list the examples."""
    from wheelrail.scenes.example_scenes import example as text_of
    from wheelrail.scenes.example_scenes import examples

    with error_lines(""):
        if name is not None:
            print(text_of(name), end="")
            return
    width = max(map(len, examples()))
    for example_name, heading in examples().items():
        print(f"{example_name:{width}}  {heading}")
