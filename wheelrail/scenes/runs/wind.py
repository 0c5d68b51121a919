"""Critical wind curves of a vehicle, from a scene of a run and a file of aerodynamic coefficients."""

from __future__ import annotations

import csv
from collections.abc import Iterator, Sequence
from itertools import product
from operator import attrgetter
from pathlib import Path
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from wheelrail.scenes.builders.vehicle import car_bodies
from wheelrail.scenes.datasets.result_table import Column, Results, ResultTable
from wheelrail.scenes.plots.style import SERIES, save, styled
from wheelrail.scenes.runs.steady import failures_as_run_failed, vehicle_dynamics
from wheelrail.scenes.schema.errors import SceneError
from wheelrail.support.atomic_file import atomic_file
from wheelrail.vehicle.crosswind.critical_wind import LIMIT, CriticalWind, WindyVehicle
from wheelrail.vehicle.crosswind.wind import Crosswind, WindCoefficients, relative_wind

if TYPE_CHECKING:
    from matplotlib.axes import Axes

    from wheelrail.scenes.schema.scene import RunScene
    from wheelrail.vehicle.crosswind.gust_run import GustRun
    from wheelrail.vehicle.multibody.vehicle import Vehicle


class WindOrder(NamedTuple):
    """Points of critical wind curves.

    Parameters:
        speeds: of the vehicle, m/s.
        angles: between track and wind, rad.
        accelerations: unbalanced lateral ones, m/s2.
        from_left: whether the left side is windward.
        body: in the wind; None: the only car body.
        width: m, over which a gust acts as its mean; None: from the first to the last wheelset.
        gust: whether runs in time through gusts are made, too.
    """

    speeds: Sequence[float]
    angles: Sequence[float]
    accelerations: Sequence[float]
    from_left: bool
    body: str | None
    width: float | None
    gust: bool


class WindPoint(NamedTuple):
    """Point of a critical wind curve; winds are None where even 120 m/s do not unload the wheels so much.

    Parameters:
        speed: of the vehicle, m/s.
        angle: between track and wind, rad.
        acceleration: unbalanced lateral one, m/s2.
        steady: wind.
        gust: peak of the gust.
        run: through that gust.
        width: m, over which it acts as its mean.
    """

    speed: float
    angle: float
    acceleration: float
    steady: CriticalWind | None
    gust: CriticalWind | None
    run: GustRun | None
    width: float


def wind_points(scene: RunScene, file: Path, coefficients: WindCoefficients, order: WindOrder) -> Iterator[WindPoint]:
    """Points one after another.

    Parameters:
        scene: of a run.
        file: vehicle file.
        coefficients: of the body in the wind.
        order: of the points.

    Raises RunFailed without an equilibrium in no wind, SceneError, WindTableError.
    """
    from wheelrail.vehicle.crosswind.gust_run import critical_gust, gust_run

    dynamics = vehicle_dynamics(scene, file, order.speeds[0])
    vehicle = dynamics.vehicle
    name = _body(vehicle, order.body)
    places = [vehicle.bodies[own].x for own in vehicle.wheelsets]
    width = max(places) - min(places) if order.width is None else order.width
    first = 20.0
    for angle, acceleration, speed in product(order.angles, order.accelerations, order.speeds):
        crosswind = Crosswind(coefficients, name, vehicle.bodies[name].x, angle, order.from_left)
        windy = WindyVehicle(dynamics, crosswind, speed, acceleration)
        with failures_as_run_failed():
            steady = windy.critical(first)
            first = first if steady is None else steady.wind
            gust = critical_gust(windy, width, first) if order.gust else None
            run = None if gust is None else gust_run(windy, gust.wind, width)
        yield WindPoint(speed, angle, acceleration, steady, gust, run, width)


def _body(vehicle: Vehicle, name: str | None) -> str:
    names = list(car_bodies(vehicle))
    if name is None and len(names) == 1:
        return names[0]
    if name not in vehicle.bodies or name in vehicle.wheelsets:
        allowed = [own for own in vehicle.names if own not in vehicle.wheelsets]
        raise SceneError(f"--body{'' if name is None else f' {name}'}: must be one of {', '.join(allowed)}")
    return name


def _table(points: Sequence[WindPoint]) -> ResultTable:
    columns = [
        Column("speed", "speed", attrgetter("speed"), "m/s", 1),
        Column("angle", "", attrgetter("angle"), "rad"),
        Column("", "angle of wind [deg]", lambda point: float(np.degrees(point.angle)), digits=0),
        Column("acceleration", "lateral acceleration", attrgetter("acceleration"), "m/s2", 2),
        *_columns("steady", "steady wind"),
        *(_columns("gust", "peak of gust") if any(point.gust for point in points) else ()),
        Column("yaw", "", _yaw, "rad"),
        Column("width", "", attrgetter("width"), "m"),
        Column("", "yaw of relative wind [deg]", lambda point: float(np.degrees(_yaw(point))), digits=1),
    ]
    title = f"Critical wind: {100 * LIMIT:g} % unloading of the windward wheels of a running gear"
    note = "after EN 14067-6, whose text was not available: limit, gust and filter are not confirmed"
    if any(own is not None and not own.reached for point in points for own in (point.steady, point.gust)):
        note = f"{note}; less unloading: stronger wind has no equilibrium or ends the run"
    return ResultTable("points", title, columns, points, note=note)


def _columns(kind: str, label: str) -> Iterator[Column]:
    """Columns of the critical wind "steady" or "gust"."""
    found = attrgetter(kind)
    yield Column(f"{kind}_wind", label, lambda point: found(point) and found(point).wind, "m/s", 2)
    yield Column(f"{kind}_unloading", "unloading", lambda point: found(point) and found(point).unloading, "%", 1)
    yield Column(f"{kind}_gear", "running gear", lambda point: found(point) and str(found(point).gear + 1))


def _yaw(point: WindPoint) -> float:
    """Yaw angle of the relative wind, rad, in the critical steady wind; NaN without one."""
    return relative_wind(point.speed, point.steady.wind, point.angle)[1] if point.steady else float("nan")


def wind_results(points: Sequence[WindPoint], coefficients: WindCoefficients) -> Results:
    """Table of critical winds; for programs with the data of the coefficients."""
    facts = {
        "limit": LIMIT,
        "area": coefficients.area,
        "length": coefficients.length,
        "density": coefficients.density,
    }
    units = {"limit": "1", "area": "m2", "length": "m", "density": "kg/m3"}
    return Results("wind", [_table(points)], facts, units)


def write_points(points: Sequence[WindPoint], file: Path) -> None:
    """Write the table as CSV, in SI units. Raises OSError."""
    table = _table(points)
    with atomic_file(file) as part, part.open("w", encoding="utf-8", newline="") as stream:
        writer = csv.writer(stream, lineterminator="\n")
        writer.writerow([f"{c.name} [{c.si_unit}]" if c.unit else c.name for c in table.columns if c.name])
        writer.writerows(["" if value is None else value for value in row.values()] for row in table.records)


AXES = {"speed": "speed [m/s]", "angle": "angle of wind [deg]", "acceleration": "lateral acceleration [m/s²]"}


def draw_wind(points: Sequence[WindPoint], file: Path) -> None:
    """Save the figure of the curves and, with gusts, of the last run."""
    from matplotlib.figure import Figure

    over = max(AXES, key=lambda name: len({_of(point, name) for point in points}))
    others = [name for name in AXES if name != over]
    curves = dict[tuple[float, ...], list[WindPoint]]()
    for point in points:
        curves.setdefault(tuple(_of(point, name) for name in others), []).append(point)
    run = next((point.run for point in reversed(points) if point.run is not None), None)
    with styled():
        figure = Figure(figsize=(9.0 if run else 5.2, 3.6), layout="constrained")
        axes = figure.subplots(1, 2 if run else 1, squeeze=False)[0]
        for number, (key, own) in enumerate(curves.items()):
            label = ", ".join(f"{AXES[name].split(' [')[0]} {at:.3g}" for name, at in zip(others, key, strict=True))
            for kind, what, change in (
                ("steady", "steady wind", {}),
                ("gust", "peak of gust", {"mfc": "none", "linestyle": ":"}),
            ):
                known = sorted((_of(p, over), w.wind) for p in own if (w := getattr(p, kind)) is not None)
                style = {**SERIES[number % len(SERIES)], **change, "label": f"{what}, {label}"}
                if known:
                    axes[0].plot(*zip(*known, strict=True), **style)
        axes[0].set(
            xlabel=AXES[over], ylabel="critical wind [m/s]", title=f"Critical wind: {100 * LIMIT:g} % unloading"
        )
        axes[0].set_ylim(0.0, 1.1 * axes[0].get_ylim()[1])
        axes[0].legend(fontsize="small")
        if run is not None:
            _draw_run(axes[1], run)
        save(figure, file)


def _of(point: WindPoint, axis: str) -> float:
    """Value of a point as on an axis."""
    return float(np.degrees(point.angle)) if axis == "angle" else float(getattr(point, axis))


def _draw_run(ax: Axes, run: GustRun) -> None:
    twin = ax.twinx()
    lines = ax.plot(run.time, run.wind, color="0.5", label="wind, mean over the vehicle")
    for number, column in enumerate(100.0 * run.unloading.T):
        style = {**SERIES[number % len(SERIES)], "marker": "", "label": f"unloading, running gear {number + 1}"}
        lines += twin.plot(run.time, column, **style)
    twin.axhline(100 * LIMIT, color="0.2", linewidth=0.6)
    twin.set(ylabel="unloading [%]", ylim=(0.0, 105.0))
    twin.grid(False)
    ax.set(xlabel="time [s]", ylabel="wind [m/s]", title="Run through the last gust")
    ax.set_ylim(bottom=0.0)
    ax.legend(handles=lines, fontsize="small", loc="lower right")
