"""Command `contact`: single contact solves."""

from __future__ import annotations

import sys
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from wheelrail.cli.app import app
from wheelrail.cli.arguments import SceneFile, check_picture, load, picture_option, reject_mpi, rejected
from wheelrail.cli.mpi_launcher import first
from wheelrail.cli.output import FAILED, print_results
from wheelrail.support.terminal import progress_console, stdout_for_results

if TYPE_CHECKING:
    from xarray import Dataset

    from wheelrail.scenes.schema.scene import HertzScene, WheelsetScene


@app.command()
def contact(
    scene: SceneFile,
    picture: Annotated[Path | None, picture_option("a figure of the patches")] = None,
) -> None:
    """Solve the contact of a Hertz pair or of a wheelset."""
    checked = load(scene)
    if checked.kind == "run":
        raise rejected(f'{scene}: kind = "run": must be "hertz" or "wheelset"; for a vehicle run use wheelrail run')
    if checked.model != "full":
        reject_mpi(f'{scene}: model = "{checked.model}"')
    check_picture(picture)
    status, data = _solved(checked, scene)
    from wheelrail.scenes.contacts.report import UNITS, contact_report
    from wheelrail.scenes.contacts.table import table
    from wheelrail.scenes.datasets.result_table import Results

    facts = {"scene": str(scene), **({"status": status} if data is None else contact_report(data))}
    print_results(Results("contact", [] if data is None else [table(data)], facts, UNITS))
    if picture is not None and data is not None and data["z"].notnull().any() and first():
        _draw(data, picture)
    if status.startswith("failed"):
        print(status, file=sys.stderr)
        raise typer.Exit(FAILED)


def _draw(data: Dataset, file: Path) -> None:
    """Save the figure; exits with the error on standard error."""
    from wheelrail.scenes.plots.patches import draw_patches

    try:
        draw_patches(data, file)
    except (OSError, ValueError) as error:
        print(f"{file}: {error}", file=sys.stderr)
        raise typer.Exit(FAILED) from None


def _solved(scene: HertzScene | WheelsetScene, name: Path) -> tuple[str, Dataset | None]:
    """Status and solution; an exception gives status "failed: ..." alone, with its traceback on standard error."""
    from wheelrail.scenes.contacts.solve import solve_contact
    from wheelrail.scenes.schema.errors import SceneError
    from wheelrail.support.c_library import CompilerFailed
    from wheelrail.support.memory import TooLarge

    console = progress_console()
    try:
        with stdout_for_results(), console.status("reading the scene") as status:
            data = solve_contact(scene, lambda text: status.update(text))
        return str(data.attrs["status"]), data
    except (SceneError, TooLarge, CompilerFailed) as error:
        raise rejected(f"{name}: {error}") from None
    except Exception as error:
        import traceback

        traceback.print_exc()
        return f"failed: {type(error).__name__}: {error}", None
