"""Single contacts."""

from __future__ import annotations

import sys
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from wheelrail.cli.app import app
from wheelrail.cli.arguments import SceneFile, check_picture, load, refuse_several, refused
from wheelrail.cli.exit_codes import FAILED
from wheelrail.cli.mpi_launcher import first
from wheelrail.support.terminal import progress_console, result_console, stdout_for_results

if TYPE_CHECKING:
    from wheelrail.contact.results.result import ContactResult
    from wheelrail.scenes.schema.scene import HertzScene, WheelsetScene


@app.command()
def contact(
    scene: SceneFile,
    json: Annotated[bool, typer.Option("--json", help="One JSON object on standard output.")] = False,
    picture: Annotated[
        Path | None,
        typer.Option("--picture", metavar="FILE", help="Save the patches as a picture (.png, .svg, .pdf)."),
    ] = None,
) -> None:
    """Solve the contact of a Hertz pair or of a wheelset, once."""
    given = load(scene)
    if given.kind == "run":
        raise refused(f'{scene}: kind = "run": this is a vehicle run, use wheelrail run')
    if given.model != "full":
        refuse_several(f'{scene}: model = "{given.model}"')
    check_picture(picture)
    results: dict[str, ContactResult] = {}
    report = {"scene": str(scene), **_solved(given, scene, results)}
    from wheelrail.scenes.contacts.report import json_text, table

    if json:
        print(json_text(report))
    elif "model" in report:
        result_console().print(table(report))
    if picture is not None and results and first():
        _draw(given, results, picture)
    if report["status"].startswith("failed"):
        print(report["status"], file=sys.stderr)
        raise typer.Exit(FAILED)


def _draw(scene: HertzScene | WheelsetScene, results: dict[str, ContactResult], file: Path) -> None:
    """Save the picture, or end with the reason why not on standard error."""
    from wheelrail.scenes.builders.laws import laws
    from wheelrail.scenes.datasets.contact import contact_dataset
    from wheelrail.scenes.plots.patches import draw_patches

    try:
        draw_patches(contact_dataset(results, laws(scene)), file)
    except (OSError, ValueError) as error:
        print(f"{file}: {error}", file=sys.stderr)
        raise typer.Exit(FAILED) from None


def _solved(scene: HertzScene | WheelsetScene, name: Path, results: dict[str, ContactResult]) -> dict[str, Any]:
    """The report of the contact; an error on the way is a status too, with its traceback on standard error."""
    from wheelrail.scenes.contacts.solve import solve_contact
    from wheelrail.scenes.schema.errors import SceneError

    console = progress_console()
    try:
        with stdout_for_results(), console.status("reading the scene") as status:
            return solve_contact(scene, lambda text: status.update(text), results.__setitem__)
    except SceneError as error:
        raise refused(f"{name}: {error}") from None
    except Exception as error:
        import traceback

        traceback.print_exc()
        return {"status": f"failed: {type(error).__name__}: {error}"}
