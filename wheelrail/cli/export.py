"""Command `export`: fields for ParaView, runs as CSV, the contact as a C library or a functional mock-up unit."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from wheelrail.cli.app import app
from wheelrail.cli.arguments import check_ending, computing, error_lines, load, rejected, results_folder
from wheelrail.cli.output import print_files
from wheelrail.support.terminal import progress_console, stdout_for_results

Scene = Annotated[
    Path | None,
    typer.Argument(
        metavar="SCENE",
        help="Scene file (TOML); without one --c is a library that opens scenes by Python; "
        "with --csv results of a run: run.nc or its folder.",
        show_default=False,
    ),
]


@app.command()
def export(
    scene: Scene = None,
    out: Annotated[
        Path | None, typer.Option("--out", metavar="DIR", help="Folder for fields as VTK files (.vtu, .vtp) and XDMF.")
    ] = None,
    fmu: Annotated[
        Path | None,
        typer.Option("--fmu", metavar="FILE", help="Functional mock-up unit (.fmu) of a wheelset."),
    ] = None,
    c: Annotated[
        Path | None,
        typer.Option("--c", metavar="DIR", help="Folder for a C library with header, Fortran module and examples."),
    ] = None,
    csv: Annotated[
        Path | None,
        typer.Option("--csv", metavar="FILE", help="Results of a run as comma-separated values (.csv)."),
    ] = None,
    fmi: Annotated[str, typer.Option("--fmi", metavar="VERSION", help="Version of the unit: 2.0 or 3.0.")] = "2.0",
    runtime: Annotated[
        bool,
        typer.Option("--runtime", help="Library or unit with this package and compliances, which starts Python."),
    ] = False,
) -> None:
    """Write fields of all contacts of a scene for ParaView, a run as CSV, or a contact element for other programs."""
    if sum(target is not None for target in (out, fmu, c, csv)) != 1:
        raise rejected("export: exactly one of --out DIR, --fmu FILE, --c DIR and --csv FILE is required")
    if runtime and fmu is None and c is None:
        raise rejected("export: --runtime: allowed only with --fmu and --c")
    if scene is None and (c is None or runtime):
        raise rejected("export: SCENE is required")
    if c is not None:
        _library(c, scene, runtime)
    elif scene is not None and fmu is not None:
        _unit(scene, fmu, fmi, runtime)
    elif scene is not None and csv is not None:
        _csv(scene, csv)
    elif scene is not None and out is not None:
        _fields(scene, out)


def _csv(results: Path, file: Path) -> None:
    check_ending("--csv", file, (".csv",))
    from wheelrail.scenes.datasets.run_csv import write_csv
    from wheelrail.scenes.datasets.run_file import RESULTS, read_run

    with error_lines("", f"{file}: "), progress_console().status("writing"):
        write_csv(read_run(results / RESULTS if results.is_dir() else results), file)
    print_files("export", file)


def _library(folder: Path, scene: Path | None, runtime: bool) -> None:
    if scene is not None:
        _check_wheelset(scene)
    from wheelrail.export.library import export_library

    results_folder(folder, folder)
    with error_lines(f"{scene}: " if scene is not None else "", f"{folder}: "), stdout_for_results():
        made = export_library(folder, scene, runtime=runtime)
    print_files("export", made)


def _unit(scene: Path, file: Path, fmi: str, runtime: bool) -> None:
    _check_wheelset(scene)
    check_ending("--fmu", file, (".fmu",))
    if fmi not in ("2.0", "3.0"):
        raise rejected(f"--fmi {fmi}: must be 2.0 or 3.0")
    from wheelrail.export.unit import export_unit

    with error_lines(f"{scene}: ", f"{file}: "), stdout_for_results():
        export_unit(scene, file, "2.0" if fmi == "2.0" else "3.0", runtime=runtime)
    print_files("export", file)


def _check_wheelset(scene: Path) -> None:
    checked = load(scene)
    if checked.kind != "wheelset":
        raise rejected(f'{scene}: kind = "{checked.kind}": must be "wheelset"')


def _fields(scene: Path, out: Path) -> None:
    checked = load(scene)
    if checked.kind == "run":
        raise rejected(f'{scene}: kind = "run": must be "hertz" or "wheelset"')
    folder = results_folder(out, out)
    from wheelrail.scenes.contacts.solve import built_model, solve_sides
    from wheelrail.scenes.views.export import export_side
    from wheelrail.scenes.views.plotter import pyvista

    with computing(f"{scene}: ", "fields", f"{folder}: "):
        pyvista()  # if it is missing, it is missed before the scene is solved
        model = built_model(checked)
        files = [
            file
            for side, solution in dict(solve_sides(checked, model=model)).items()
            for file in export_side(checked, side, solution, folder, model)
        ]
    print_files("export", *files)
