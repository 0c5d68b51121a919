"""Rails on pads, and on ballast without and with mass, on an irregular track: cost, and forces beside a beam on layers.

`python -m benchmarks.irregular_track_models [FIGURE.png]`: straight track of 40 m with irregularities of the spectrum
ERRI B176 low, continued to wavelengths of 1 m, at 10, 30 and 60 m/s, that is up to 10, 30 and 60 Hz. One process. The
wagon, pads and ballast are those of `benchmarks.track_models`.

The mean vertical force of both wheels is compared with that of a linear model in closed form: three masses of the wagon
on two springs, the contact's stiffness, and the receptance of a beam on pads, sleepers and ballast.
"""

from __future__ import annotations

import sys
from collections.abc import Iterator
from dataclasses import dataclass, replace
from functools import cache
from pathlib import Path

import numpy as np

from benchmarks.track_models import cases, euler_beam, timed
from wheelrail.support.arrays import Array
from wheelrail.vehicle.integration.step_control import StepStatistics
from wheelrail.vehicle.multibody.jacobian import VehicleJacobian
from wheelrail.vehicle.simulation.history import History
from wheelrail.vehicle.steady.equilibrium import equilibrium
from wheelrail.vehicle.track.irregularity_spectrum import ERRI
from wheelrail.vehicle.track.track import Track
from wheelrail.vehicle.wagon.wagon import Wagon

LENGTH, FADE, WAVELENGTHS = 40.0, 5.0, (1.0, 30.0)  # m
SPEEDS = (10.0, 30.0, 60.0)  # m/s
SAMPLES = 4096  # of the force over the run
REPEATS = 8  # the run's length in periods of the closed form: free motions decay in between


@dataclass(frozen=True)
class IrregularRun:
    """A run, its processor time s, and the dynamic force (SAMPLES,) N of one wheel, the mean of both."""

    history: History
    seconds: float
    force: Array


@cache
def irregular_track() -> Track:
    """Straight track with random irregularities."""
    return Track(irregularities=ERRI["low"].irregularities(LENGTH, seed=1, wavelengths=WAVELENGTHS, fade=FADE))


@cache
def run(name: str, speed: float) -> IrregularRun:
    """The run of one model at a speed, m/s."""
    dynamics = replace(cases()[name], track=irregular_track(), speed=speed)
    history, seconds = timed(dynamics, LENGTH / speed)
    force = history.force[:, 0, :, 2].mean(axis=1)
    times = LENGTH / speed * np.arange(SAMPLES) / SAMPLES
    return IrregularRun(history, seconds, np.interp(times, history.time, force) - force[0])


def wagon_receptance(omega: Array, wagon: Wagon) -> Array:
    """Height of the wheelset (n,) m/N by an upward force on it, at angular frequencies (n,) 1/s above 0."""
    plane, masses = wagon.plane, np.zeros((3, 3))
    for index, body in enumerate((plane.wheelset, plane.bogie, plane.car_body)):
        masses[index, index] = body.mass
    dynamic = -(omega[:, None, None] ** 2) * masses + 0j
    for index, stage in enumerate((plane.primary, plane.secondary)):  # values of one side
        spring = 2.0 * (stage.vertical_stiffness + 1j * omega * stage.vertical_damping)
        joint = np.zeros(3)
        joint[index], joint[index + 1] = 1.0, -1.0
        dynamic += spring[:, None, None] * np.outer(joint, joint)
    return np.asarray(np.linalg.inv(dynamic)[:, 0, 0])


@cache
def contact_stiffness() -> float:
    """Vertical stiffness of one contact on straight track, N/m."""
    dynamics = replace(cases()["pads"], track=Track())
    rest = equilibrium(dynamics)
    states = dynamics.wheelset_states(0.0, rest.state)
    return -float(VehicleJacobian(dynamics, StepStatistics()).tangents(states, rest.contacts).values[0, 0, 2, 1])


def exact_force(speed: float) -> Array:
    """Dynamic force (SAMPLES,) N of one wheel on a beam on two layers, of an infinite Euler beam at rest and a spring
    in series that gives the static compliance of the rail in the runs; speed: m/s.
    """
    structure = cases()["pads on ballast, with mass"].structures.own[0]
    assert structure is not None
    rail = structure.pairs.flexibility.matrix[13, 13]  # vertical, of the left rail
    stations = LENGTH * np.arange(SAMPLES) / SAMPLES
    level = np.zeros(REPEATS * SAMPLES)
    irregularities = irregular_track().irregularities
    assert irregularities is not None
    level[:SAMPLES] = irregularities.at(stations)[:, 1]
    omega = 2.0 * np.pi * np.fft.rfftfreq(len(level), LENGTH / speed / SAMPLES)
    omega[0] = omega[1]
    beam = np.array([euler_beam(f) for f in omega / (2.0 * np.pi)]) + rail - euler_beam(0.0)
    compliance = 1.0 / contact_stiffness() + beam + 2.0 * wagon_receptance(omega, Wagon())
    spectrum = np.fft.rfft(level) / compliance
    spectrum[0] = 0.0
    force = np.fft.irfft(spectrum, len(level))
    return np.asarray(force[:SAMPLES] - force[0])


def table() -> Iterator[str]:
    """Lines of a Markdown table, one for each speed and model as soon as it is known."""
    columns = (
        *("m/s", "track", "steps (rejected)", "contact solves a side", "processor s"),
        *("dynamic force, N: RMS (largest)", "closed form: RMS (largest)", "difference, RMS"),
    )
    yield f"| {' | '.join(columns)} |"
    yield f"|{'---|' * len(columns)}"
    for speed in SPEEDS:
        exact = exact_force(speed)
        for name in cases():
            own = run(name, speed)
            cost, difference = own.history.cost, float(_rms(own.force - exact) / _rms(exact))
            cells = (
                f"{speed:.0f}",
                name if own.history.status == "completed" else f"{name}: {own.history.status}",
                f"{cost.steps.accepted} ({cost.steps.rejected})",
                f"{cost.contact['left'].solves}",
                f"{own.seconds:.0f}",
                *(f"{_rms(force):.0f} ({np.abs(force).max():.0f})" for force in (own.force, exact)),
                f"{100 * difference:.0f} %",
            )
            yield f"| {' | '.join(cells)} |"


def _rms(force: Array) -> float:
    return float(np.sqrt(np.mean(force**2)))


def figure(file: Path) -> None:
    """Force over distance at each speed, by all models and in closed form."""
    import matplotlib.pyplot as plt

    stations = LENGTH * np.arange(SAMPLES) / SAMPLES
    drawing, panels = plt.subplots(len(SPEEDS), 1, figsize=(11, 9), sharex=True, layout="constrained")
    for axes, speed in zip(panels, SPEEDS, strict=True):
        axes.plot(stations, 1e-3 * exact_force(speed), color="0.3", linewidth=2.5, label="beam on two layers")
        for name, color in zip(cases(), ("C0", "C1", "C3"), strict=True):
            axes.plot(stations, 1e-3 * run(name, speed).force, color=color, linewidth=1.0, label=name)
        axes.set(ylabel="dynamic wheel force, kN", title=f"{speed:.0f} m/s", xlim=(15.0, 25.0))
        axes.grid(alpha=0.3)
    panels[0].legend(ncol=2, fontsize="small")
    panels[-1].set_xlabel("distance, m")
    drawing.savefig(file, dpi=110)


def main(arguments: list[str]) -> None:
    """Print the table, and draw the figure if a file is given."""
    for line in table():
        print(line, flush=True)
    if arguments:
        figure(Path(arguments[0]))


if __name__ == "__main__":
    main(sys.argv[1:])
