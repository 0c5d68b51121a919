"""Commands for tests of vehicles: on twisted and canted track, in wind."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from wheelrail.cli.app import app
from wheelrail.cli.arguments import (
    SceneFile,
    check_ending,
    check_picture,
    computing,
    error_lines,
    load_run,
    picture_option,
    rejected,
)
from wheelrail.cli.output import print_results
from wheelrail.cli.run import NeededVehicleFile, Speeds


@app.command()
def twist(
    scene: SceneFile,
    vehicle: NeededVehicleFile,
    body: Annotated[
        float | None, typer.Option("--body", metavar="G", help="Twist between the bogies; default: of EN 14363.")
    ] = None,
    bogie: Annotated[
        float | None, typer.Option("--bogie", metavar="G", help="Twist of the first bogie; default: of EN 14363.")
    ] = None,
) -> None:
    """Wheel unloading of a vehicle at walking pace on track with twisted body, twisted bogie, and both."""
    checked = load_run(scene)
    for name, value in (("--body", body), ("--bogie", bogie)):
        if value is not None and not -0.02 <= value <= 0.02:
            raise rejected(f"{name} {value:g}: must be -0.02 to 0.02 (3 per mille is 0.003)")
    from wheelrail.scenes.runs.quasistatic import twist_results, twists_of

    with computing(f"{scene}: ", "equilibria on twisted track"):
        found = twists_of(checked, vehicle, body, bogie)
    print_results(twist_results(found))


@app.command()
def sway(
    scene: SceneFile,
    vehicle: NeededVehicleFile,
    cant: Annotated[
        list[float] | None,
        typer.Option("--cant", metavar="U", min=1e-3, max=0.3, help="Cant in m, repeatable; default: 0.05, 0.1, 0.15."),
    ] = None,
) -> None:
    """Coefficient of flexibility: roll of the bodies of a standing vehicle relative to canted track over its angle."""
    checked = load_run(scene)
    from wheelrail.scenes.runs.quasistatic import sway_results, sways_of

    with computing(f"{scene}: ", "equilibria on canted track"):
        found = sways_of(checked, vehicle, sorted(cant or (0.05, 0.1, 0.15)))
    print_results(sway_results(found))


@app.command()
def wind(
    scene: SceneFile,
    vehicle: NeededVehicleFile,
    coefficients: Annotated[
        Path,
        typer.Option("--coefficients", metavar="FILE", help="Aerodynamic coefficients over the yaw angle (CSV)."),
    ],
    speed: Speeds = None,
    angle: Annotated[
        list[float] | None,
        typer.Option(
            "--angle", metavar="A", min=1.0, max=179.0, help="Of wind to track, deg, repeatable; default: 90."
        ),
    ] = None,
    acceleration: Annotated[
        list[float] | None,
        typer.Option("--acceleration", metavar="A", min=0.0, max=2.0, help="Unbalanced, m/s2, repeatable; default: 0."),
    ] = None,
    gust: Annotated[bool, typer.Option("--gust", help="Run in time through gusts, too.")] = False,
    area: Annotated[
        float, typer.Option("--area", metavar="A", min=0.1, max=100.0, help="Of the coefficients, m2.")
    ] = 10.0,
    length: Annotated[
        float, typer.Option("--length", metavar="D", min=0.1, max=100.0, help="Of the coefficients, m.")
    ] = 3.0,
    width: Annotated[
        float | None,
        typer.Option(
            "--width",
            metavar="L",
            min=0.0,
            max=100.0,
            help="Gusts act by their mean over L m; default: from the first to the last wheelset.",
        ),
    ] = None,
    body: Annotated[
        str | None, typer.Option("--body", metavar="NAME", help="In the wind; default: the car body.")
    ] = None,
    left: Annotated[bool, typer.Option("--left", help="Wind from the left; default: from the right.")] = False,
    picture: Annotated[Path | None, picture_option("a figure of the curves")] = None,
    csv: Annotated[Path | None, typer.Option("--csv", metavar="FILE", help="Save the table (.csv).")] = None,
) -> None:
    """Critical wind of a vehicle: speed of steady wind, and of gusts, that unload the windward wheels by 90 %.

    One point for each speed, angle and acceleration.
    """
    checked = load_run(scene)
    check_picture(picture)
    if csv is not None:
        check_ending("--csv", csv, (".csv",))
    from math import radians

    from wheelrail.scenes.runs.wind import WindOrder, draw_wind, wind_points, wind_results, write_points
    from wheelrail.vehicle.crosswind.wind import read_coefficients

    with error_lines(""):
        table = read_coefficients(coefficients, area, length)
    angles = [radians(own) for own in angle or [90.0]]
    speeds = speed or [checked.vehicle.first_speed]
    order = WindOrder(speeds, angles, acceleration or [0.0], left, body, width, gust)
    points = []
    with computing("", "equilibria in wind") as status:
        for point in wind_points(checked, vehicle, table, order):
            points.append(point)
            status.update(f"{len(points)} of {len(speeds) * len(angles) * len(order.accelerations)} points")
    for file, save in ((picture, draw_wind), (csv, write_points)):
        if file is not None:
            with error_lines("", f"{file}: "):
                save(points, file)
    print_results(wind_results(points, table))
