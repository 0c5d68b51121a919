"""Picture of a run's track: from above, curvature, cant and its deficiency, slope, irregularities."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from wheelrail.scenes.plots.style import STYLE, save
from wheelrail.scenes.runs.track_table import cant_deficiency
from wheelrail.support.arrays import Array

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

    from wheelrail.scenes.schema.scene import RunScene

# Okabe and Ito's colours, with dashes of their own.
LINES = (("#0072B2", "-"), ("#D55E00", (0, (5, 1.5))), ("#009E73", (0, (1, 1))), ("0.4", (0, (5, 1, 1, 1))))
POINTS = 1500


def draw_track(scene: RunScene, file: Path) -> None:
    """Write the picture; the ending names its format."""
    from matplotlib import rc_context

    with rc_context(STYLE):
        save(_figure(scene), file)


def _figure(scene: RunScene) -> Figure:
    from matplotlib.figure import Figure

    from wheelrail.scenes.builders.vehicle import wagon
    from wheelrail.vehicle.track.speed_profile import SpeedProfile
    from wheelrail.vehicle.track.track import centre_line

    line, drive = scene.track, SpeedProfile.of(scene.vehicle.drive)
    track, gravity = line.track(), wagon(scene).gravity
    uneven = track.irregularities
    s = np.linspace(0.0, line.length, POINTS, dtype=np.float64)
    at = s.tolist()
    figure = Figure(figsize=(7.2, 8.6 if uneven is None else 11.6), layout="constrained")
    count = 4 if uneven is None else 6
    axes = list(figure.subplots(count, 1))
    stations, points = centre_line(track, line.length, spacing=max(1.0, line.length / 400))
    plan, curvature, cant, slope = axes[:4]
    plan.plot(points[:, 0], points[:, 1], color="0.15")
    plan.set_aspect("equal", adjustable="datalim")
    plan.set_title("From above")
    plan.set_xlabel("x, along the first tangent [m]")
    plan.set_ylabel("y, to the left [m]")
    curvature.plot(s, [1e3 * track.curvature(x)[0] for x in at], color="0.15")
    curvature.set_title("Curvature")
    curvature.set_ylabel("to the left [1/km]")
    lift = np.array([track.lift(x)[0] for x in at])
    _lines(cant, s, {"lift": 1e3 * lift, "cant deficiency": 1e3 * np.array(cant_deficiency(track, drive, gravity, at))})
    speeds = [drive(t).speed for t in np.linspace(0.0, drive.time_at(line.length), 200).tolist()]
    said = f"{min(speeds):.1f}" if drive.constant else f"{min(speeds):.1f} to {max(speeds):.1f}"
    cant.set_title(f"Right rail over left, and what lacks at {said} m/s")
    cant.set_ylabel("[mm]")
    _lines(
        slope,
        s,
        {
            "slope [‰]": 1e3 * np.tan([track.gradient(x)[0] for x in at]),
            "height [m]": np.interp(s, stations, points[:, 2]),
        },
    )
    slope.set_title("Slope and height")
    slope.set_ylabel("[‰], [m]")
    if uneven is not None:
        values = 1e3 * uneven.at(s).T
        for ax, (first, second) in zip(axes[4:], ((0, 3), (1, 2)), strict=True):
            names = ("alignment", "level", "cross level", "gauge")
            _lines(ax, s, {names[first]: values[first], names[second]: values[second]})
            ax.set_ylabel("[mm]")
            ax.set_title(f"Irregularities: {names[first]} and {names[second]}")
    for ax in axes[1:]:
        ax.set_xlim(0.0, line.length)
    axes[-1].set_xlabel("distance along the track [m]")
    return figure


def _lines(ax: Axes, s: Array, curves: dict[str, Array]) -> None:
    for (name, values), (color, dashes) in zip(curves.items(), LINES, strict=False):
        ax.plot(s, values, color=color, linestyle=dashes, label=name)
    ax.legend(loc="best", ncols=2)
