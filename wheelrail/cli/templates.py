"""Wagons and scenes to start others from."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from wheelrail.cli.app import app
from wheelrail.cli.arguments import complaints


@app.command()
def wagon(
    file: Annotated[
        Path | None,
        typer.Argument(metavar="FILE", help="A wagon (TOML); the Manchester wagon without it.", show_default=False),
    ] = None,
) -> None:
    """Print a wagon with all its values as TOML, to start another one from."""
    from wheelrail.scenes.schema.wagon_file import load_wagon, wagon_toml
    from wheelrail.vehicle.wagon.wagon import Wagon

    with complaints(""):
        print(wagon_toml(Wagon() if file is None else load_wagon(file)), end="")


@app.command()
def example(
    name: Annotated[
        str | None,
        typer.Argument(metavar="NAME", help="One of them; a list of all without it.", show_default=False),
    ] = None,
) -> None:
    """Print a scene that comes with the package, to start another one from."""
    from wheelrail.scenes.schema.examples import example as text_of
    from wheelrail.scenes.schema.examples import examples

    with complaints(""):
        if name is not None:
            print(text_of(name), end="")
            return
    width = max(map(len, examples()))
    for known, heading in examples().items():
        print(f"{known:{width}}  {heading}")
