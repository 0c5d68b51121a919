"""Command `contact`: single contact solves."""

from __future__ import annotations

import sys
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from wheelrail.cli.app import app
from wheelrail.cli.arguments import SceneFile, check_picture, load, reject_mpi, rejected
from wheelrail.cli.exit_codes import FAILED
from wheelrail.cli.mpi_launcher import first
from wheelrail.support.terminal import progress_console, result_console, stdout_for_results

if TYPE_CHECKING:
    from wheelrail.contact.results.result import ContactResult
    from wheelrail.scenes.schema.scene import HertzScene, WheelsetScene


@app.command()
def contact(
    scene: SceneFile,
    json: Annotated[bool, typer.Option("--json", help="Print one JSON object to standard output.")] = False,
    picture: Annotated[
        Path | None,
        typer.Option("--picture", metavar="FILE", help="Save a figure of the patches (.png, .svg, .pdf)."),
    ] = None,
) -> None:
    """Solve the contact of a Hertz pair or of a wheelset."""
    checked = load(scene)
    if checked.kind == "run":
        raise rejected(f'{scene}: kind = "run": must be "hertz" or "wheelset"; for a vehicle run use wheelrail run')
    if checked.model != "full":
        reject_mpi(f'{scene}: model = "{checked.model}"')
    check_picture(picture)
    results: dict[str, ContactResult] = {}
    report = {"scene": str(scene), **_solved(checked, scene, results)}
    from wheelrail.scenes.contacts.report import json_text, table

    if json:
        print(json_text(report))
    elif "model" in report:
        result_console().print(table(report))
    if picture is not None and results and first():
        _draw(checked, results, picture)
    if report["status"].startswith("failed"):
        print(report["status"], file=sys.stderr)
        raise typer.Exit(FAILED)


def _draw(scene: HertzScene | WheelsetScene, results: dict[str, ContactResult], file: Path) -> None:
    """Save the figure; exits with the error on standard error."""
    from wheelrail.scenes.builders.laws import laws
    from wheelrail.scenes.datasets.contact import contact_dataset
    from wheelrail.scenes.plots.patches import draw_patches

    try:
        draw_patches(contact_dataset(results, laws(scene)), file)
    except (OSError, ValueError) as error:
        print(f"{file}: {error}", file=sys.stderr)
        raise typer.Exit(FAILED) from None


def _solved(scene: HertzScene | WheelsetScene, name: Path, results: dict[str, ContactResult]) -> dict[str, Any]:
    """Report of the contact; an exception gives status "failed: ...", with its traceback on standard error."""
    from wheelrail.scenes.contacts.solve import solve_contact
    from wheelrail.scenes.schema.errors import SceneError

    console = progress_console()
    try:
        with stdout_for_results(), console.status("reading the scene") as status:
            return solve_contact(scene, lambda text: status.update(text), results.__setitem__)
    except SceneError as error:
        raise rejected(f"{name}: {error}") from None
    except Exception as error:
        import traceback

        traceback.print_exc()
        return {"status": f"failed: {type(error).__name__}: {error}"}
