"""The command `wheelrail`: a contact solve, or a vehicle and its track, from a scene file."""

from __future__ import annotations

if __name__ == "__main__":  # python -m scenes.cli
    from scenes import command

    command.main()
    raise SystemExit

import os
import sys
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer
from typer.core import TyperGroup

from scenes.command import INTERRUPTED
from scenes.launcher import as_one, first, several
from scenes.terminal import progress_console, result_console, stdout_for_results

if TYPE_CHECKING:
    from contact.result import ContactResult
    from scenes.scene import HertzScene, RunScene, WheelsetScene

PICTURES = (".png", ".svg", ".pdf")
FAILED, BAD_INPUT = 1, 2  # exit codes


class Commands(TyperGroup):
    """All commands: Ctrl-C wherever it comes, and results that nobody takes, are a line and an exit code, too."""

    def invoke(self, ctx: Any) -> Any:
        try:
            done = super().invoke(ctx)
            sys.stdout.flush()
        except KeyboardInterrupt:
            print("interrupted", file=sys.stderr)
            raise typer.Exit(INTERRUPTED) from None
        except OSError as error:
            print(f"standard output: {error.strerror or error}", file=sys.stderr)
            with suppress(OSError, ValueError):  # what is left in the buffer would be tried again at the end
                os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())
            raise typer.Exit(FAILED) from None
        return done


app = typer.Typer(
    cls=Commands,
    help="Detailed wheel-rail contact by finite elements, inside a vehicle simulation.",
    no_args_is_help=True,
    add_completion=False,
    pretty_exceptions_enable=False,
)

SceneFile = Annotated[Path, typer.Argument(metavar="SCENE", help="Scene file (TOML).", show_default=False)]
Speeds = Annotated[
    list[float] | None,
    typer.Option("--speed", metavar="V", min=0.1, max=200.0, help="Speed in m/s, repeatable; the scene's without it."),
]


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
    given = _load(scene)
    if given.kind == "run":
        raise _refused(f'{scene}: kind = "run": this is a vehicle run, use wheelrail run')
    if given.model != "full":
        _refuse_several(f'{scene}: model = "{given.model}"')
    _check_picture(picture)
    results: dict[str, ContactResult] = {}
    report = {"scene": str(scene), **_solved(given, scene, results)}
    from scenes.report import json_text, table

    if json:
        print(json_text(report))
    elif "model" in report:
        result_console().print(table(report))
    if picture is not None and results and first():
        _draw(given, results, picture)
    if report["status"].startswith("failed"):
        print(report["status"], file=sys.stderr)
        raise typer.Exit(FAILED)


@app.command()
def track(
    scene: SceneFile,
    picture: Annotated[
        Path | None,
        typer.Option("--picture", metavar="FILE", help="Save the layout as a picture (.png, .svg, .pdf)."),
    ] = None,
) -> None:
    """Show the track of a vehicle run: its segments, cant deficiency and irregularities."""
    given = _load_run(scene)
    _check_picture(picture)
    from scenes.track_report import segment_table

    result_console().print(segment_table(given))
    if picture is not None:
        from scenes.pictures.track import draw_track

        with _complaints("", f"{picture}: "):
            draw_track(given, picture)


@app.command()
def run(
    scene: SceneFile,
    out: Annotated[
        Path | None,
        typer.Option("--out", metavar="DIR", help="Folder of the results; results/<name of the scene> without it."),
    ] = None,
    resume: Annotated[
        bool, typer.Option("--resume", help="Go on with a run that was stopped or killed, from its last checkpoint.")
    ] = False,
) -> None:
    """Run a vehicle along its track; Ctrl-C keeps everything computed so far, --resume goes on from there."""
    given = _load_run(scene)
    from scenes.resume import ended
    from scenes.run import run_scene

    folder = _folder(out, Path("results", scene.stem))
    with _complaints(f"{scene}: ", f"{folder}: "):
        if resume and ended(given, folder):
            print(f"{folder}: this run is complete, there is nothing to go on with")
            return
        with stdout_for_results():
            text = scene.read_text(encoding="utf-8")
            outcome = run_scene(given, text, folder, progress_console(), resume=resume)
    for part in outcome.summary():
        result_console().print(part, highlight=False, markup=False)
    if outcome.status == "interrupted":
        raise typer.Exit(INTERRUPTED)
    if outcome.status != "completed":
        raise typer.Exit(FAILED)


@app.command()
def compare(
    scene: SceneFile,
    other: Annotated[
        str, typer.Option("--with", metavar="MODEL", help="The contact model to compare the scene's own with.")
    ] = "standard",
    out: Annotated[
        Path | None,
        typer.Option("--out", metavar="DIR", help="Folder of the results; results/<name of the scene>_compare."),
    ] = None,
) -> None:
    """Run a vehicle with two contact models: both in one picture, and a table of their differences."""
    _load_run(scene)
    from scenes.compare import compare_scene

    folder = _folder(out, Path("results", f"{scene.stem}_compare"))
    with _complaints("", f"{folder}: "), stdout_for_results():
        found = compare_scene(scene, scene.read_text(encoding="utf-8"), other, folder, progress_console())
    for part in found.summary():
        result_console().print(part, highlight=False, markup=False)


@app.command()
def study(
    study: Annotated[Path, typer.Argument(metavar="STUDY", help="Study file (TOML).", show_default=False)],
    out: Annotated[
        Path | None,
        typer.Option("--out", metavar="DIR", help="Folder of the results; results/<name of the study> without it."),
    ] = None,
    scheduler: Annotated[
        str | None,
        typer.Option(
            "--scheduler", metavar="ADDRESS", help="Dask scheduler, as in tcp://host:8786; else this machine."
        ),
    ] = None,
    fresh: Annotated[bool, typer.Option("--fresh", help="Compute cases anew that are done already.")] = False,
) -> None:
    """Solve all cases of a study in parallel; started again it computes only what is missing."""
    from scenes.studies.plan import plan
    from scenes.studies.run import run_plan
    from scenes.studies.study import load_study

    folder = _folder(out, Path("results", study.stem))
    with _complaints(""):
        planned = plan(load_study(study), study)
    with _complaints("", f"{folder}: "), stdout_for_results():
        outcome = run_plan(planned, folder, progress_console(), scheduler=scheduler, fresh=fresh)
    for part in outcome.summary():
        result_console().print(part, highlight=False, markup=False)
    if outcome.interrupted:
        raise typer.Exit(INTERRUPTED)
    if outcome.failed:
        raise typer.Exit(FAILED)


@app.command()
def modes(scene: SceneFile, speed: Speeds = None) -> None:
    """Linear modes of a run's wagon on straight track, its contact included: frequency, damping, what moves."""
    given = _load_run(scene)
    from scenes.steady import modes_of, modes_table

    speeds = speed or [given.vehicle.first_speed]
    with _complaints(f"{scene}: "), stdout_for_results(), progress_console().status("contact and equilibrium"):
        found = modes_of(given, speeds)
    for table in map(modes_table, found, speeds):
        result_console().print(table, highlight=False, markup=False)


@app.command()
def curving(scene: SceneFile, speed: Speeds = None) -> None:
    """Steady position in the sharpest curve of a run: wheel loads, Y/Q, deflections, places of contact."""
    given = _load_run(scene)
    from scenes.steady import curving_of, curving_table

    with _complaints(f"{scene}: "), stdout_for_results(), progress_console().status("contact and equilibrium"):
        found = curving_of(given, speed or [given.vehicle.first_speed])
    result_console().print(curving_table(found), highlight=False, markup=False)


@app.command()
def wagon(
    file: Annotated[
        Path | None,
        typer.Argument(metavar="FILE", help="A wagon (TOML); the Manchester wagon without it.", show_default=False),
    ] = None,
) -> None:
    """Print a wagon with all its values as TOML, to start another one from."""
    from scenes.wagon_file import load_wagon, wagon_toml
    from vehicle.wagon import Wagon

    with _complaints(""):
        print(wagon_toml(Wagon() if file is None else load_wagon(file)), end="")


@app.command()
def example(
    name: Annotated[
        str | None,
        typer.Argument(metavar="NAME", help="One of them; a list of all without it.", show_default=False),
    ] = None,
) -> None:
    """Print a scene that comes with the package, to start another one from."""
    from scenes.examples import example as text_of
    from scenes.examples import examples

    with _complaints(""):
        if name is not None:
            print(text_of(name), end="")
            return
    width = max(map(len, examples()))
    for known, heading in examples().items():
        print(f"{known:{width}}  {heading}")


@app.command()
def view(
    scene: SceneFile,
    out: Annotated[Path, typer.Option("--out", metavar="FILE", help="Picture (.png), or page to turn (.html).")],
    scale: Annotated[float | None, typer.Option("--scale", metavar="N", help="Displacements so many times.")] = None,
    body: Annotated[str, typer.Option("--body", help="wheel or rail, upper or lower, or both.")] = "both",
    side: Annotated[str | None, typer.Option("--side", help="left or right; the scene's first without it.")] = None,
) -> None:
    """Draw a contact in three dimensions: bodies deformed, pressure, von Mises stress on cuts below the surface."""
    given = _load(scene)
    if given.kind == "run":
        raise _refused(f'{scene}: kind = "run": this is a vehicle run, use wheelrail animate with its results')
    _check_ending("--out", out, (".png", ".html"))
    if scale is not None and not 0 < scale < float("inf"):
        raise _refused(f"--scale {scale:g}: must be greater than 0")
    from scenes.pictures.html import save_view
    from scenes.view import view_scene

    console = progress_console()
    with _complaints(f"{scene}: "), stdout_for_results(), console.status("reading the scene") as status:
        made = view_scene(given, title=scene.stem, body=body, side=side, scale=scale, say=status.update)
        save_view(made, out)


@app.command()
def animate(
    results: Annotated[Path, typer.Argument(metavar="RUN", help="Results of a run: run.nc, or its folder.")],
    out: Annotated[Path, typer.Option("--out", metavar="FILE", help="Film (.mp4, .gif).")],
    frames: Annotated[int, typer.Option("--frames", metavar="N", min=1, max=100_000)] = 120,
    fps: Annotated[float, typer.Option("--fps", metavar="N", min=0.1, max=240.0, help="Frames a second.")] = 20.0,
    scale: Annotated[
        float, typer.Option("--scale", metavar="N", min=1e-3, max=1e6, help="Displacements so many times above.")
    ] = 20.0,
) -> None:
    """Make a film of a run: the wheelset on its rails, forces, and both contacts close up."""
    _check_ending("--out", out, (".mp4", ".gif"))
    from scenes.view import animate_file

    console = progress_console()
    with _complaints(""), stdout_for_results(), console.status("reading the run") as status:

        def told(done: int, count: int) -> None:
            status.update(f"frame {done} of {count}")

        animate_file(results, out, told, frames=frames, fps=fps, scale=scale)


@app.command()
def report(
    folder: Annotated[
        Path,
        typer.Argument(metavar="DIR", help="Results of a run, a study or a comparison.", show_default=False),
    ],
    out: Annotated[
        Path | None, typer.Option("--out", metavar="FILE", help="The page (.html); DIR/report.html without it.")
    ] = None,
    no_view: Annotated[bool, typer.Option("--no-view", help="Leave the view in three dimensions out.")] = False,
) -> None:
    """Make one HTML page of results: what was run, tables, pictures, a view to turn; it needs nothing besides."""
    if out is not None:
        _check_ending("--out", out, (".html",))
    from scenes.report_page import write_report

    place = folder / "report.html" if out is None else out
    with _complaints("", f"{place}: "), stdout_for_results(), progress_console().status("reading and drawing"):
        write_report(folder, place, view=not no_view)
    print(place)


def _load(scene: Path) -> HertzScene | WheelsetScene | RunScene:
    """The scene, or the end of the command with the complaint on standard error."""
    from scenes.scene import load_scene

    with _complaints(""):
        return load_scene(scene)


def _load_run(scene: Path) -> RunScene:
    given = _load(scene)
    if given.kind != "run":
        raise _refused(
            f'{scene}: kind = "{given.kind}": this is one contact solve and no vehicle run, use wheelrail contact'
        )
    _refuse_several(f'{scene}: kind = "run"')
    return given


def _refuse_several(what: str) -> None:
    """Several processes would all do the same."""
    if several():
        raise _refused(
            f'{what}: of all models only model = "full" of single contacts runs under mpirun, start it without'
        )


@contextmanager
def _complaints(scene: str, place: str | None = None) -> Iterator[None]:
    """What goes wrong is a line on standard error and an exit code: what is wrong with a scene behind its name, what
    went wrong on the way behind the place of the results.
    """
    from scenes.complaint import RunFailed, SceneError

    try:
        yield
    except SceneError as error:
        raise _refused(f"{scene}{error}") from None
    except (OSError, RunFailed) as error:
        print(f"{scene if place is None else place}{error}", file=sys.stderr)
        raise typer.Exit(FAILED) from None


def _check_picture(picture: Path | None) -> None:
    if picture is not None:
        _check_ending("--picture", picture, PICTURES)


def _check_ending(option: str, file: Path, endings: tuple[str, ...]) -> None:
    if file.suffix.lower() not in endings:
        raise _refused(f"{option} {file}: must end in {', '.join(endings)}")
    if file.is_dir() or not file.absolute().parent.is_dir():
        raise _refused(f"{option} {file}: must be a file in a folder that exists")


def _folder(out: Path | None, default: Path) -> Path:
    """The folder of the results, or the end of the command where there cannot be one."""
    chosen = out or default
    there = next(place for place in (chosen, *chosen.absolute().parents) if place.exists())
    if not there.is_dir():
        raise _refused(f"--out {chosen}: {there} is a file, must be a folder, or one to be made in a folder")
    return chosen


def _refused(complaint: str) -> typer.Exit:
    print(complaint, file=sys.stderr)
    return typer.Exit(BAD_INPUT)


def _draw(scene: HertzScene | WheelsetScene, results: dict[str, ContactResult], file: Path) -> None:
    """Save the picture, or end with the reason why not on standard error."""
    from scenes.contact_results import contact_dataset
    from scenes.models import laws
    from scenes.pictures.patches import draw_patches

    try:
        draw_patches(contact_dataset(results, laws(scene)), file)
    except (OSError, ValueError) as error:
        print(f"{file}: {error}", file=sys.stderr)
        raise typer.Exit(FAILED) from None


def _solved(scene: HertzScene | WheelsetScene, name: Path, results: dict[str, ContactResult]) -> dict[str, Any]:
    """The report of the contact; an error on the way is a status too, with its traceback on standard error."""
    from scenes.contact_scene import solve_contact
    from scenes.scene import SceneError

    console = progress_console()
    try:
        with stdout_for_results(), console.status("reading the scene") as status:
            return solve_contact(scene, lambda text: status.update(text), results.__setitem__)
    except SceneError as error:
        raise _refused(f"{name}: {error}") from None
    except Exception as error:
        import traceback

        traceback.print_exc()
        return {"status": f"failed: {type(error).__name__}: {error}"}


def main() -> None:
    """Entry point.

    One BLAS thread unless the environment says otherwise: the dense blocks are small, threads that wait cost more.
    """
    for name in ("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS"):
        os.environ.setdefault(name, "1")
    with as_one():
        app()
