"""Commands for vehicle runs and linear or steady motions of vehicles."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated, Literal

import typer

from wheelrail.cli.app import app
from wheelrail.cli.arguments import (
    SceneFile,
    check_picture,
    computing,
    error_lines,
    folder_option,
    load_run,
    picture_option,
    rejected,
    results_folder,
)
from wheelrail.cli.output import FAILED, INTERRUPTED, print_results
from wheelrail.support.terminal import progress_console, stdout_for_results

Speeds = Annotated[
    list[float] | None,
    typer.Option("--speed", metavar="V", min=0.1, max=200.0, help="Speed in m/s, repeatable; default: of the scene."),
]

VehicleFile = Annotated[
    Path | None,
    typer.Option("--vehicle", metavar="FILE", help="Vehicle file (TOML): this vehicle in three dimensions."),
]
NeededVehicleFile = Annotated[
    Path, typer.Option("--vehicle", metavar="FILE", help="Vehicle file (TOML).", show_default=False)
]


@app.command()
def track(
    scene: SceneFile,
    picture: Annotated[Path | None, picture_option("a figure of the track")] = None,
    vehicle: VehicleFile = None,
) -> None:
    """Print the track of a vehicle run: segments, cant, cant deficiency, standard deviations of irregularities.

    In the figure, irregularities begin at the front wheelset.
    """
    checked = load_run(scene)
    check_picture(picture)
    from wheelrail.scenes.datasets.result_table import Results
    from wheelrail.scenes.runs.track_table import quality_tables, segment_table

    with error_lines(f"{scene}: "):
        print_results(Results("track", [segment_table(checked), *quality_tables(checked)]))
    if picture is not None:
        from wheelrail.scenes.runs.track_plot import draw_track

        with error_lines(f"{scene}: ", f"{picture}: "):
            draw_track(checked, picture, vehicle)


@app.command()
def run(
    scene: SceneFile,
    out: Annotated[Path | None, folder_option("results/<scene>")] = None,
    resume: Annotated[
        bool, typer.Option("--resume", help="Resume an interrupted run from its last checkpoint.")
    ] = False,
    vehicle: VehicleFile = None,
) -> None:
    """Simulate a vehicle run; after Ctrl-C, --resume continues from the last checkpoint.

    Of the plane wagon of the scene, or of a vehicle file.
    """
    checked = load_run(scene)
    from wheelrail.scenes.datasets.result_table import Results
    from wheelrail.scenes.runs.resume import ended
    from wheelrail.scenes.runs.run import run_scene
    from wheelrail.scenes.schema.toml import read_text

    folder = results_folder(out, Path("results", scene.stem))
    with error_lines(f"{scene}: ", f"{folder}: "):
        if resume and ended(checked, folder, vehicle):
            line = f"{folder}: the run is complete; nothing to resume"
            print_results(Results("run", [line], {"status": "completed", "files": []}))
            return
        with stdout_for_results():
            text = read_text(scene)
            outcome = run_scene(checked, text, folder, progress_console(), resume=resume, vehicle=vehicle)
    print_results(outcome.results)
    if outcome.status == "interrupted":
        raise typer.Exit(INTERRUPTED)
    if outcome.status != "completed":
        raise typer.Exit(FAILED)


@app.command()
def compare(
    scene: SceneFile,
    other: Annotated[
        str, typer.Option("--with", metavar="MODEL", help="Contact model to compare with that of the scene.")
    ] = "standard",
    out: Annotated[Path | None, folder_option("results/<scene>_compare")] = None,
) -> None:
    """Simulate a vehicle run with two contact models; figure and table of their differences."""
    load_run(scene)
    from wheelrail.scenes.runs.compare import compare_scene
    from wheelrail.scenes.schema.toml import read_text

    folder = results_folder(out, Path("results", f"{scene.stem}_compare"))
    with error_lines("", f"{folder}: "), stdout_for_results():
        comparison = compare_scene(scene, read_text(scene), other, folder, progress_console())
    print_results(comparison.results)


@app.command()
def modes(scene: SceneFile, speed: Speeds = None, vehicle: VehicleFile = None) -> None:
    """Linear modes on straight track with the contact: frequency, damping ratio, mode shape.

    Of the plane wagon of the scene, or of a vehicle file.
    """
    _print_steady("modes", scene, speed, vehicle)


@app.command()
def curving(scene: SceneFile, speed: Speeds = None, vehicle: VehicleFile = None) -> None:
    """Steady-state curving in the sharpest curve of a run: wheel loads, Y/Q, displacements, contact positions.

    Of the plane wagon of the scene, or of a vehicle file.
    """
    _print_steady("curving", scene, speed, vehicle)


@app.command()
def equilibrium(scene: SceneFile, vehicle: NeededVehicleFile, speed: Speeds = None) -> None:
    """Equilibrium of a vehicle in three dimensions on straight track: wheel loads, attitude of all bodies."""
    _print_steady("equilibrium", scene, speed, vehicle)


def _print_steady(
    what: Literal["modes", "curving", "equilibrium"], scene: Path, speed: list[float] | None, vehicle: Path | None
) -> None:
    """Print the tables of all speeds m/s, by default of the scene's."""
    checked = load_run(scene)
    from wheelrail.scenes.datasets.result_table import Results
    from wheelrail.scenes.runs.steady import curve_of, equilibria_of, equilibrium_tables, modes_of, modes_table

    speeds = speed or [checked.vehicle.first_speed]
    with computing(f"{scene}: ", "contact and equilibrium"):
        if what == "modes":
            tables = list(map(modes_table, modes_of(checked, vehicle, speeds), speeds))
        else:
            curve = curve_of(checked) if what == "curving" else None
            states = equilibria_of(checked, vehicle, speeds, curve)
            tables = [table for at in states for table in equilibrium_tables(at, curve)]
    print_results(Results(what, tables))


@app.command()
def response(
    scene: SceneFile,
    vehicle: NeededVehicleFile,
    speed: Speeds = None,
    picture: Annotated[Path | None, picture_option("a figure of the amplitudes")] = None,
    count: Annotated[
        int, typer.Option("--count", metavar="N", min=2, max=2000, help="Frequencies from 0.3 to 30 Hz.")
    ] = 80,
    floor: Annotated[
        float, typer.Option("--floor", metavar="H", min=0.0, max=5.0, help="Height of the floor above top of rail, m.")
    ] = 1.2,
) -> None:
    """Linear response of the accelerations on the floor to irregularities, and their rms on ERRI's tracks."""
    checked = load_run(scene)
    check_picture(picture)
    import numpy as np

    from wheelrail.scenes.runs.response import draw_response, response_results, responses_of

    at = (speed or [checked.vehicle.first_speed])[0]
    with computing(f"{scene}: ", "contact and response"):
        found, points = responses_of(checked, vehicle, at, np.geomspace(0.3, 30.0, count), floor)
    if picture is not None:
        with error_lines("", f"{picture}: "):
            draw_response(found.frequency, points, at, picture)
    print_results(response_results(found, points, at))


@app.command()
def critical(
    scene: SceneFile,
    vehicle: NeededVehicleFile,
    lowest: Annotated[float, typer.Option("--from", metavar="V", min=1.0, max=200.0, help="Lowest speed, m/s.")] = 20.0,
    highest: Annotated[
        float, typer.Option("--to", metavar="V", min=1.0, max=200.0, help="Highest speed, m/s.")
    ] = 100.0,
    places: Annotated[
        int, typer.Option("--places", metavar="N", min=1, max=64, help="Places of the strips to average over.")
    ] = 4,
) -> None:
    """Linear critical speed of a vehicle in three dimensions on straight track, with frequency and mode.

    With contact on strips the mean of several places of these on the wheel, with its standard error.
    """
    checked = load_run(scene)
    if not lowest < highest:
        raise rejected(f"--from {lowest:g}: must be less than --to {highest:g}")
    from wheelrail.scenes.runs.steady import critical_speed_results, critical_speeds_of

    with computing(f"{scene}: ", "modes over speed"):
        found = critical_speeds_of(checked, vehicle, (lowest, highest), places)
    print_results(critical_speed_results(found, (lowest, highest)))


@app.command()
def hunting(
    scene: SceneFile,
    vehicle: NeededVehicleFile,
    speed: Speeds = None,
    picture: Annotated[Path | None, picture_option("the bifurcation diagram")] = None,
    longest: Annotated[
        float, typer.Option("--longest", metavar="T", min=1.0, max=1000.0, help="Longest motion at a speed, s.")
    ] = 20.0,
    fold: Annotated[
        float | None,
        typer.Option(
            "--fold",
            metavar="DV",
            min=0.01,
            max=50.0,
            help="Enclose the nonlinear critical speed by bisection to this width, m/s.",
            show_default=False,
        ),
    ] = None,
) -> None:
    """Limit cycles of a vehicle in three dimensions on straight track, after the kick of the scene.

    Each speed starts from the motion at the one before: descending speeds follow the cycles down to the speed at which
    they vanish, the nonlinear critical speed, which --fold encloses.
    """
    checked = load_run(scene)
    check_picture(picture)
    from wheelrail.scenes.builders.vehicle_file import load_vehicle
    from wheelrail.scenes.runs.hunting import draw_bifurcation, hunting_of, hunting_results
    from wheelrail.vehicle.simulation.limit_cycle import CycleSearch

    speeds, cycles = speed or [checked.vehicle.first_speed], []
    with computing(f"{scene}: ", "contact and equilibrium") as status:
        for cycle in hunting_of(checked, vehicle, speeds, CycleSearch(longest=longest), fold):
            cycles.append(cycle)
            status.update(f"{cycle.speed:g} m/s: {cycle.status}")
        names = load_vehicle(vehicle).wheelsets
    if picture is not None:
        with error_lines("", f"{picture}: "):
            draw_bifurcation(cycles, names, picture)
    print_results(hunting_results(cycles, names, fold is not None))
