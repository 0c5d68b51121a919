"""What commands are given: scenes, files and folders, checked before any work; and what they end with."""

from __future__ import annotations

import sys
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from wheelrail.cli.exit_codes import BAD_INPUT, FAILED
from wheelrail.cli.mpi_launcher import several

if TYPE_CHECKING:
    from wheelrail.scenes.schema.scene import HertzScene, RunScene, WheelsetScene


PICTURES = (".png", ".svg", ".pdf")


SceneFile = Annotated[Path, typer.Argument(metavar="SCENE", help="Scene file (TOML).", show_default=False)]


def load(scene: Path) -> HertzScene | WheelsetScene | RunScene:
    """The scene, or the end of the command with the complaint on standard error."""
    from wheelrail.scenes.schema.scene import load_scene

    with complaints(""):
        return load_scene(scene)


def load_run(scene: Path) -> RunScene:
    given = load(scene)
    if given.kind != "run":
        raise refused(
            f'{scene}: kind = "{given.kind}": this is one contact solve and no vehicle run, use wheelrail contact'
        )
    refuse_several(f'{scene}: kind = "run"')
    return given


def refuse_several(what: str) -> None:
    """Several processes would all do the same."""
    if several():
        raise refused(
            f'{what}: of all models only model = "full" of single contacts runs under mpirun, start it without'
        )


@contextmanager
def complaints(scene: str, place: str | None = None) -> Iterator[None]:
    """What goes wrong is a line on standard error and an exit code: what is wrong with a scene behind its name, what
    went wrong on the way behind the place of the results.
    """
    from wheelrail.scenes.schema.errors import RunFailed, SceneError

    try:
        yield
    except SceneError as error:
        raise refused(f"{scene}{error}") from None
    except (OSError, RunFailed) as error:
        print(f"{scene if place is None else place}{error}", file=sys.stderr)
        raise typer.Exit(FAILED) from None


def check_picture(picture: Path | None) -> None:
    if picture is not None:
        check_ending("--picture", picture, PICTURES)


def check_ending(option: str, file: Path, endings: tuple[str, ...]) -> None:
    if file.suffix.lower() not in endings:
        raise refused(f"{option} {file}: must end in {', '.join(endings)}")
    if file.is_dir() or not file.absolute().parent.is_dir():
        raise refused(f"{option} {file}: must be a file in a folder that exists")


def results_folder(out: Path | None, default: Path) -> Path:
    """The folder of the results, or the end of the command where there cannot be one."""
    chosen = out or default
    there = next(place for place in (chosen, *chosen.absolute().parents) if place.exists())
    if not there.is_dir():
        raise refused(f"--out {chosen}: {there} is a file, must be a folder, or one to be made in a folder")
    return chosen


def refused(complaint: str) -> typer.Exit:
    print(complaint, file=sys.stderr)
    return typer.Exit(BAD_INPUT)
