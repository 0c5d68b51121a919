"""Commands that print templates: wagon, example."""

from __future__ import annotations

from operator import itemgetter
from pathlib import Path
from typing import Annotated

import typer

from wheelrail.cli.app import app
from wheelrail.cli.arguments import error_lines
from wheelrail.cli.output import print_results


@app.command()
def wagon(
    file: Annotated[
        Path | None,
        typer.Argument(metavar="FILE", help="Wagon file (TOML); default: the Manchester wagon.", show_default=False),
    ] = None,
) -> None:
    """Print a wagon with all its values as a TOML template."""
    from wheelrail.scenes.datasets.result_table import Results
    from wheelrail.scenes.schema.wagon_file import load_wagon, wagon_toml
    from wheelrail.vehicle.wagon.wagon import Wagon

    with error_lines(""):
        text = wagon_toml(Wagon() if file is None else load_wagon(file))
    print_results(Results("wagon", [text.rstrip("\n")], {"toml": text}))


@app.command()
def example(
    name: Annotated[
        str | None,
        typer.Argument(metavar="NAME", help="Name of the example; without it, list all.", show_default=False),
    ] = None,
) -> None:
    """Print an example scene as a template, or list the examples."""
    from wheelrail.scenes.datasets.result_table import Column, Results, ResultTable
    from wheelrail.scenes.example_scenes import example as text_of
    from wheelrail.scenes.example_scenes import examples

    with error_lines(""):
        if name is not None:
            text = text_of(name)
            print_results(Results("example", [text.rstrip("\n")], {"toml": text}))
            return
    columns = [Column("name", "name", itemgetter(0)), Column("contents", "contents", itemgetter(1))]
    table = ResultTable("examples", "", columns, list(examples().items()))
    print_results(Results("example", [table]))
