"""Frequency response of a vehicle to irregularities, and its accelerations on the spectra of ERRI."""

from __future__ import annotations

from operator import itemgetter
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from wheelrail.scenes.builders.vehicle import floor_points
from wheelrail.scenes.datasets.result_table import Column, Results, ResultTable
from wheelrail.scenes.plots.style import SERIES, literal, save, styled
from wheelrail.scenes.runs.steady import failures_as_run_failed, vehicle_dynamics
from wheelrail.scenes.schema.errors import RunFailed
from wheelrail.support.arrays import Array
from wheelrail.vehicle.track.irregularity import QUANTITIES
from wheelrail.vehicle.track.irregularity_spectrum import ERRI

if TYPE_CHECKING:
    from wheelrail.scenes.schema.scene import RunScene
    from wheelrail.vehicle.steady.frequency_response import FrequencyResponse

Amplitudes = NDArray[np.complex128]
DIRECTIONS = ("lateral", "vertical")
MAIN = {"lateral": "alignment", "vertical": "level"}  # irregularity that is drawn


def responses_of(
    scene: RunScene, file: Path, speed: float, frequency: Array, floor: float
) -> tuple[FrequencyResponse, dict[str, Amplitudes]]:
    """Response of a vehicle, and accelerations (f, 4, 2) m/s2 by m of points on the floor of its car bodies.

    Parameters:
        scene: of a run.
        file: vehicle file.
        speed: m/s.
        frequency: (f,) Hz.
        floor: height of the points above top of rail, m.

    Raises RunFailed without an equilibrium or a free car body, SceneError.
    """
    from wheelrail.vehicle.steady.frequency_response import frequency_response

    dynamics = vehicle_dynamics(scene, file, speed)
    points = floor_points(dynamics.vehicle, floor)
    if not points:
        raise RunFailed("no car body moves freely in all directions")
    with failures_as_run_failed():
        response = frequency_response(dynamics, frequency)
    return response, {name: response.acceleration(body, point) for name, (body, point) in points.items()}


def response_results(response: FrequencyResponse, points: dict[str, Amplitudes], speed: float) -> Results:
    """Largest response of every point and its accelerations on ERRI's spectra; for programs all amplitudes."""
    frequency, rows = response.frequency, []
    densities = {name: _density(name, frequency, speed) for name in ERRI}
    from wheelrail.vehicle.steady.frequency_response import standard_deviations

    for name, accelerations in points.items():
        for k, direction in enumerate(DIRECTIONS):
            own = np.abs(accelerations[:, QUANTITIES.index(MAIN[direction]), k])
            peak = int(np.argmax(own))
            rows.append(
                {
                    "point": name,
                    "direction": direction,
                    "irregularity": MAIN[direction],
                    "peak": float(own[peak]),
                    "peak_frequency": float(frequency[peak]),
                    **{
                        f"rms_{erri}": standard_deviations(accelerations[..., k], frequency, density)["all"]
                        for erri, density in densities.items()
                    },
                }
            )
    low, high = (f"{value:.3g}" for value in frequency[[0, -1]])
    title = (
        f"Accelerations on the floor at {speed:g} m/s from {low} to {high} Hz: largest by 1 mm, rms on ERRI's tracks"
    )
    facts: dict[str, Any] = {
        "speed": speed,
        "frequency": frequency,
        "amplitudes": [
            {"point": name, "direction": direction, **{q: np.abs(a[:, i, k]) for i, q in enumerate(QUANTITIES)}}
            for name, a in points.items()
            for k, direction in enumerate(DIRECTIONS)
        ],
    }
    units = {"speed": "m/s", "frequency": "Hz", **dict.fromkeys(QUANTITIES, "1/s2")}
    return Results("response", [ResultTable("points", title, COLUMNS, rows)], facts, units)


def _density(name: str, frequency: Array, speed: float) -> Array:
    """One-sided spectral densities (f, 4) m2/Hz at a speed m/s."""
    scale = 2.0 * np.pi / speed  # rad/m by Hz
    return np.asarray(scale * ERRI[name](scale * frequency))  # type: ignore[index]


COLUMNS = (
    Column("point", "point", itemgetter("point")),
    Column("direction", "direction", itemgetter("direction")),
    Column("irregularity", "by", itemgetter("irregularity")),
    Column("", "largest [m/s2 by 1 mm]", lambda row: f"{1e-3 * row['peak']:.3g}"),
    Column("peak", "", itemgetter("peak"), "1/s2"),
    Column("peak_frequency", "at", itemgetter("peak_frequency"), "Hz", 2),
    Column("rms_low", "rms on low", itemgetter("rms_low"), "m/s2", 3),
    Column("rms_high", "rms on high", itemgetter("rms_high"), "m/s2", 3),
)


def draw_response(frequency: Array, points: dict[str, Amplitudes], speed: float, file: Path) -> None:
    """Save the figure of the amplitudes by alignment and level over frequency."""
    from matplotlib.figure import Figure

    with styled():
        figure = Figure(figsize=(7.2, 5.4), layout="constrained")
        for k, (ax, direction) in enumerate(zip(figure.subplots(2, 1, sharex=True), DIRECTIONS, strict=True)):
            for number, (name, accelerations) in enumerate(points.items()):
                own = 1e-3 * np.abs(accelerations[:, QUANTITIES.index(MAIN[direction]), k])
                style = {**SERIES[number % len(SERIES)], "marker": ""}
                ax.loglog(frequency, own, label=literal(name), **style)
            ax.set_title(f"{direction.capitalize()} acceleration by {MAIN[direction]} at {speed:g} m/s [m/s² by 1 mm]")
            ax.grid(which="both")
            ax.legend(loc="upper left")
        ax.set_xlabel("frequency [Hz]")
        save(figure, file)
