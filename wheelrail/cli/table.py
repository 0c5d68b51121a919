"""Command `table`: contact forces on a grid of positions, loads and creepages."""

from __future__ import annotations

import sys
from pathlib import Path
from typing import Annotated

import typer

from wheelrail.cli.app import app
from wheelrail.cli.arguments import check_ending, check_picture, error_lines, load, picture_option, reject_mpi, rejected
from wheelrail.cli.output import FAILED, INTERRUPTED, print_results
from wheelrail.support.terminal import stdout_for_results

Range = tuple[float, float]


@app.command()
def table(
    scene: Annotated[
        Path, typer.Argument(metavar="SCENE", help="Scene file (TOML) of a wheelset or a run.", show_default=False)
    ],
    out: Annotated[Path, typer.Option("--out", metavar="FILE", help="File of the table (NetCDF, .nc).")] = Path(
        "table.nc"
    ),
    tolerance: Annotated[
        float,
        typer.Option(
            "--tolerance", metavar="SHARE", help="RMS error of the force off the nodes, of the vertical load."
        ),
    ] = 0.01,
    y: Annotated[
        Range, typer.Option("--y", metavar="LOW HIGH", help="Lateral position of a left-hand wheel on its rail, m.")
    ] = (-7e-3, 7e-3),
    roll: Annotated[Range, typer.Option("--roll", metavar="LOW HIGH", help="Roll, rad.")] = (-5e-3, 5e-3),
    yaw: Annotated[Range, typer.Option("--yaw", metavar="LOW HIGH", help="Yaw, rad.")] = (-5e-3, 5e-3),
    wheel_load: Annotated[
        Range, typer.Option("--load", metavar="LOW HIGH", help="Vertical load of a wheel without friction, N.")
    ] = (10e3, 200e3),
    workers: Annotated[int, typer.Option("--workers", min=1, help="Number of processes.")] = 2,
    picture: Annotated[Path | None, picture_option("a figure of the table")] = None,
) -> None:
    """Tabulate contact forces for model = "table"; the same command continues after an interruption."""
    from wheelrail.contact.tables.table_range import TableRange
    from wheelrail.scenes.tables.make import TableOrder, make_table, table_results

    checked = load(scene)
    if checked.kind == "hertz":
        raise rejected(f'{scene}: kind = "hertz": must be "wheelset" or "run"')
    reject_mpi(f"{scene}: table")
    check_ending("--out", out, (".nc",))
    check_picture(picture)
    if not 0.0 < tolerance < 1.0:
        raise rejected(f"--tolerance {tolerance:g}: must be greater than 0 and less than 1")
    try:
        ranges = TableRange(y, roll, yaw, wheel_load)
    except ValueError as error:
        raise rejected(f"--{error}") from None
    try:
        with error_lines("", f"{out}: "), stdout_for_results():
            data = make_table(TableOrder(checked, scene, ranges, tolerance, workers), out)
    except KeyboardInterrupt:
        print("interrupted; solves are stored, the same command continues", file=sys.stderr)
        raise typer.Exit(INTERRUPTED) from None
    print_results(table_results(data, out))
    if picture is not None:
        from wheelrail.scenes.plots.force_table import draw_table

        with error_lines(f"{picture}: "):
            draw_table(data, picture)
    if not data.attrs["reached"]:
        print(f"{out}: the tolerance of {tolerance:g} is not reached", file=sys.stderr)
        raise typer.Exit(FAILED)
