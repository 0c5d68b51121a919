"""Arguments of the commands (scenes, files, folders), validated before any computation, and exit codes."""

from __future__ import annotations

import sys
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from wheelrail.cli.mpi_launcher import several
from wheelrail.cli.output import BAD_INPUT, FAILED
from wheelrail.support.terminal import progress_console, stdout_for_results

if TYPE_CHECKING:
    from rich.status import Status

    from wheelrail.scenes.schema.scene import HertzScene, RunScene, WheelsetScene


PICTURES = (".png", ".svg", ".pdf")


SceneFile = Annotated[Path, typer.Argument(metavar="SCENE", help="Scene file (TOML).", show_default=False)]


def picture_option(what: str) -> Any:
    """The option --picture; what: that is saved."""
    return typer.Option("--picture", metavar="FILE", help=f"Save {what} ({', '.join(PICTURES)}).")


def folder_option(default: str) -> Any:
    """The option --out of a folder; default: its name for readers."""
    return typer.Option("--out", metavar="DIR", help=f"Folder for the results; default: {default}.")


def load(scene: Path) -> HertzScene | WheelsetScene | RunScene:
    """The validated scene; exits with the validation error on standard error."""
    from wheelrail.scenes.schema.scene import load_scene

    with error_lines(""):
        return load_scene(scene)


def load_run(scene: Path) -> RunScene:
    """The validated scene of a vehicle run."""
    checked = load(scene)
    if checked.kind != "run":
        raise rejected(f'{scene}: kind = "{checked.kind}": must be "run"; for a single contact use wheelrail contact')
    reject_mpi(f'{scene}: kind = "run"')
    return checked


def reject_mpi(place: str) -> None:
    """Exit under `mpirun` with several processes, which would all compute the same."""
    if several():
        raise rejected(f'{place}: mpirun is allowed only for single contacts with model = "full"; start without it')


@contextmanager
def error_lines(scene: str, place: str | None = None) -> Iterator[None]:
    """Print errors as one line on standard error and exit.

    Parameters:
        scene: prefix of validation errors.
        place: prefix of errors while computing or writing; that of the scene by default.
    """
    from wheelrail.scenes.schema.errors import RunFailed, SceneError
    from wheelrail.support.memory import TooLarge
    from wheelrail.support.text_file import FileRefused, abridged

    try:
        yield
    except (SceneError, TooLarge, FileRefused) as error:
        raise rejected(f"{scene}{error}") from None
    except ImportError as error:  # of an extra that is not installed
        print(error, file=sys.stderr)
        raise typer.Exit(FAILED) from None
    except (OSError, RunFailed) as error:
        print(abridged(f"{scene if place is None else place}{error}"), file=sys.stderr)
        raise typer.Exit(FAILED) from None


@contextmanager
def computing(scene: str, what: str, place: str | None = None) -> Iterator[Status]:
    """Errors as by `error_lines`, standard output for results only, the name of the computation on standard error."""
    with error_lines(scene, place), stdout_for_results(), progress_console().status(what) as status:
        yield status


def check_picture(picture: Path | None) -> None:
    if picture is not None:
        check_ending("--picture", picture, PICTURES)


def check_ending(option: str, file: Path, endings: tuple[str, ...]) -> None:
    if file.suffix.lower() not in endings:
        raise rejected(f"{option} {file}: must end in {', '.join(endings)}")
    if file.is_dir() or not file.absolute().parent.is_dir():
        raise rejected(f"{option} {file}: must be a file in an existing folder")


def results_folder(out: Path | None, default: Path) -> Path:
    """Folder of the results; exits if it cannot be created."""
    folder = out or default
    existing = next(path for path in (folder, *folder.absolute().parents) if path.exists())
    if not existing.is_dir():
        raise rejected(f"--out {folder}: {existing} is a file; must be a folder or a path to a new one")
    return folder


def rejected(message: str) -> typer.Exit:
    """Print a validation error; returns the exception to raise."""
    from wheelrail.support.text_file import abridged

    print(abridged(message), file=sys.stderr)
    return typer.Exit(BAD_INPUT)
