"""Figure of the track of a run: plan view, curvature, cant and cant deficiency, gradient, irregularities."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from wheelrail.scenes.plots.style import save, styled
from wheelrail.scenes.runs.track_table import STATION, cants
from wheelrail.support.arrays import Array

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

    from wheelrail.scenes.schema.scene import RunScene
    from wheelrail.vehicle.multibody.vehicle import Vehicle
    from wheelrail.vehicle.track.irregularity import Irregularities

# Okabe-Ito colours, each with its own dashes.
LINES = (("#0072B2", "-"), ("#D55E00", (0, (5, 1.5))), ("#009E73", (0, (1, 1))), ("0.4", (0, (5, 1, 1, 1))))
POINTS = 1500


def draw_track(scene: RunScene, file: Path, vehicle: Path | None = None) -> None:
    """Save the figure, for a vehicle of a file or the scene's wagon, in the format of the file ending."""
    from wheelrail.scenes.builders.vehicle import vehicle_on

    with styled():
        save(track_figure(scene, vehicle_on(scene, vehicle)), file)


def track_figure(scene: RunScene, vehicle: Vehicle) -> Figure:
    """Plan view, curvature, cant and cant deficiency, gradient and height, irregularities over distance.

    Parameters:
        scene: of a run.
        vehicle: at whose front wheelset irregularities begin.
    """
    from matplotlib.figure import Figure

    from wheelrail.scenes.builders.vehicle import run_track, wagon
    from wheelrail.vehicle.track.speed_profile import SpeedProfile
    from wheelrail.vehicle.track.track import centre_line

    alignment, speed_profile = scene.track, SpeedProfile.of(scene.vehicle.speed_profile)
    track = run_track(scene, vehicle)
    gravity = wagon(scene).gravity
    irregularities = track.irregularities
    s = np.linspace(0.0, alignment.length, POINTS, dtype=np.float64)
    stations_list = s.tolist()
    figure = Figure(figsize=(7.2, 8.6 if irregularities is None else 13.4), layout="constrained")
    count = 4 if irregularities is None else 7
    axes = list(figure.subplots(count, 1))
    stations, points = centre_line(track, alignment.length, spacing=max(1.0, alignment.length / 400))
    plan, curvature, cant, slope = axes[:4]
    plan.plot(points[:, 0], points[:, 1], color="0.15")
    plan.set_aspect("equal", adjustable="datalim")
    plan.set_title("Plan view")
    plan.set_xlabel("x, along the initial tangent [m]")
    plan.set_ylabel("y, positive to the left [m]")
    curvature.plot(s, [1e3 * track.curvature(x)[0] for x in stations_list], color="0.15")
    curvature.set_title("Curvature")
    curvature.set_ylabel("positive to the left [1/km]")
    of_stations = 1e3 * np.array([cants(track, speed_profile, gravity, x) for x in stations_list])
    _lines(cant, s, {"cant": of_stations[:, 0], "cant deficiency": of_stations[:, 1]})
    speeds = [speed_profile(t).speed for t in np.linspace(0.0, speed_profile.time_at(alignment.length), 200).tolist()]
    speed_text = f"{min(speeds):.1f}" if speed_profile.constant else f"{min(speeds):.1f} to {max(speeds):.1f}"
    cant.set_title(f"Cant (positive: outer rail raised) and cant deficiency at {speed_text} m/s")
    cant.set_ylabel("[mm]")
    _lines(
        slope,
        s,
        {
            "gradient [‰]": 1e3 * np.tan([track.gradient(x)[0] for x in stations_list]),
            "height [m]": np.interp(s, stations, points[:, 2]),
        },
    )
    slope.set_title("Gradient and height")
    slope.set_ylabel("[‰], [m]")
    if irregularities is not None:
        values = 1e3 * irregularities.at(s).T
        _spectra(axes.pop(), irregularities, alignment.length)
        for ax, (first, second) in zip(axes[4:], ((0, 3), (1, 2)), strict=True):
            names = ("alignment", "level", "cross level", "gauge")
            _lines(ax, s, {names[first]: values[first], names[second]: values[second]})
            ax.set_ylabel("[mm]")
            ax.set_title(f"Irregularities: {names[first]} and {names[second]}")
    for ax in axes[1:]:
        ax.set_xlim(0.0, alignment.length)
    axes[-1].set_xlabel("distance along the track [m]")
    return figure


def _spectra(ax: Axes, irregularities: Irregularities, length: float) -> None:
    """Spectral densities of level and alignment beside the ones of ERRI B176."""
    from wheelrail.vehicle.track.irregularity_spectrum import ERRI
    from wheelrail.vehicle.track.track_quality import spectral_density

    end = min(length, float(irregularities.stations[-1]))
    s = np.arange(max(0.0, float(irregularities.stations[0])), end, STATION)
    wave_number, density = spectral_density(s, irregularities.at(s))
    for name, column, (color, _) in (("level", 1, LINES[0]), ("alignment", 0, LINES[1])):
        ax.loglog(wave_number, density[:, column], color=color, label=name)
        for label, dashes in (("low", (0, (5, 1.5))), ("high", (0, (1, 1)))):
            erri = ERRI[label](wave_number)[:, column]  # type: ignore[index]
            ax.loglog(wave_number, erri, color=color, linestyle=dashes, linewidth=0.8, label=f"ERRI {label}")
    ax.set_title("Spectral densities, one-sided, and those of ERRI B176")
    ax.set_xlabel("wave number [rad/m]")
    ax.set_ylabel("[m²/(rad/m)]")
    shown = density[:, :2][density[:, :2] > 0.0]
    if len(shown):
        least = max(float(shown.min()), 1e-6 * float(shown.max()))
        decades = 10.0 ** np.arange(np.floor(np.log10(least)), np.ceil(np.log10(10.0 * shown.max())) + 1.0)
        ax.set_ylim(decades[0], decades[-1])
        ax.set_yticks(decades[::2])
    ax.legend(loc="lower left", ncols=2, fontsize=7)


def _lines(ax: Axes, s: Array, curves: dict[str, Array]) -> None:
    for (name, values), (color, dashes) in zip(curves.items(), LINES, strict=False):
        ax.plot(s, values, color=color, linestyle=dashes, label=name)
    ax.legend(loc="best", ncols=2)
