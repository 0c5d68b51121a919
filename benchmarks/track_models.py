"""Track without mass, on discrete sleepers, and with mass: receptance against a beam in closed form, forces and cost.

`python -m benchmarks.track_models`: pads of 100 and 40 kN/mm every 0.6 m, ballast of 80 and 40 kN/mm under half a
sleeper of 150 kg. Runs of `scenes/curve.toml` at 45 m/s in one process: its curve, and straight track with ERRI
irregularities of two ranges of wavelengths, in which the forces on the track without and with mass are compared.
"""

from __future__ import annotations

from dataclasses import replace
from functools import cache
from pathlib import Path
from time import process_time

import numpy as np

from wheelrail.contact.loading.quasi_static_structure import QuasiStaticStructure
from wheelrail.contact.structure.ballast import Ballast, CoRunningTrack, Layers, co_running
from wheelrail.contact.structure.pads import RailCompliance, RailPads, wavenumber_samples
from wheelrail.scenes.builders.vehicle import track, wagon
from wheelrail.scenes.builders.wheelset import run_contact
from wheelrail.scenes.schema.scene import RunScene, parse_scene
from wheelrail.support.arrays import Array
from wheelrail.vehicle.dynamics.equations import Dynamics
from wheelrail.vehicle.integration.integrate import StepSettings
from wheelrail.vehicle.simulation.energy_balance import energy_balance
from wheelrail.vehicle.simulation.history import History
from wheelrail.vehicle.simulation.simulate import simulate
from wheelrail.vehicle.track.irregularity_spectrum import ERRI
from wheelrail.vehicle.track.track import Track

SCENE = Path(__file__).parents[1] / "scenes" / "curve.toml"
BENDING, RAIL = 2.1e11 * 3038.3e-8, 7850 * 76.70e-4  # N m2, kg/m: 60E1
FREQUENCIES = (0.0, 10.0, 20.0, 50.0, 70.0, 100.0, 150.0, 200.0)  # Hz
STEPS = StepSettings("rosenbrock", 1e-3, 1e-6)
CURVE_SECONDS, STRAIGHT_SECONDS = 10.0, 1.2
RANGES = {"3 to 100 m": (3.0, 100.0), "1 to 3 m": (1.0, 3.0)}
PADS, SLEEPERS, BALLAST = "\n[track.pads]\n", "\n[track.sleepers]\n", "\n[track.ballast]\n"


def per_length() -> tuple[float, float, float]:
    """Stiffness of pads and of ballast, N/m2, and mass of half the sleepers, kg/m."""
    pads, ballast = RailPads(), Ballast()
    return pads.vertical / pads.spacing, ballast.vertical / pads.spacing, ballast.sleeper_mass / pads.spacing


def times() -> tuple[float, float]:
    """Damping over stiffness of pads and ballast, s."""
    pads, ballast = RailPads(), Ballast()
    return ballast.pad_damping / pads.vertical, ballast.damping / ballast.vertical


def euler_beam(frequency: float) -> complex:
    """Receptance m/N of an infinite Euler beam on two layers in closed form; frequency: Hz."""
    omega, (pads, ballast, sleepers), (pad_time, ballast_time) = 2 * np.pi * frequency, per_length(), times()
    upper, lower = pads * (1 + 1j * omega * pad_time), ballast * (1 + 1j * omega * ballast_time) - omega**2 * sleepers
    foundation = upper * lower / (upper + lower) - omega**2 * RAIL
    return complex(1 / (2 * np.sqrt(2) * BENDING**0.25 * foundation**0.75))


def reduced_beam() -> CoRunningTrack:
    """The same beam as a track that moves along."""
    k, (pads, ballast, sleepers) = wavenumber_samples(), per_length()
    compliance = (1 / (BENDING * k**4 + pads * ballast / (pads + ballast)))[:, None, None] * np.eye(3)
    layers = Layers(
        k,
        np.full(2, pads),
        np.full(2, ballast),
        sleepers,
        compliance,
        RAIL * compliance**2,
        pads * compliance**2,
        compliance[:, :2],
    )
    return co_running(layers, RailCompliance(layers.along(compliance), np.zeros(2), 0.0), times())


def receptance_table() -> str:
    """Markdown: receptance of a beam and its errors."""
    beam, tau = reduced_beam(), QuasiStaticStructure.time_constant
    rows = ["| Hz | beam on two layers, 1e-9 m/N | with mass: error | without mass, 1 ms: error |", "|---|---|---|---|"]
    for frequency in FREQUENCIES:
        exact, omega = euler_beam(frequency), 2 * np.pi * frequency
        massless = beam.rail.matrix[1, 1] / (1 + 1j * omega * tau)
        errors = (abs(value - exact) / abs(exact) for value in (beam.receptance(frequency)[1, 1], massless))
        rows.append(f"| {frequency:.0f} | {1e9 * abs(exact):.2f} | {' | '.join(f'{100 * e:.2g} %' for e in errors)} |")
    return "\n".join(rows)


def equations(keys: str, *, massless: bool = False) -> Dynamics:
    """Equations of motion of the scene with further keys; massless: a track on ballast without its masses."""
    scene = parse_scene(SCENE.read_text(encoding="utf-8") + keys, SCENE)
    assert isinstance(scene, RunScene)
    contact, structure = run_contact(scene)
    if massless and structure is not None:
        structure = QuasiStaticStructure(structure.pairs)
    return Dynamics(wagon(scene), track(scene), contact, scene.vehicle.speed_profile, structure)


@cache
def cases() -> dict[str, Dynamics]:
    """Equations of motion by name of the track."""
    return {
        "pads": equations(PADS),
        "pads on ballast, without mass": equations(PADS + BALLAST, massless=True),
        "pads on ballast, with mass": equations(PADS + BALLAST),
    }


def timed(dynamics: Dynamics, seconds: float) -> tuple[History, float]:
    """A run and its processor time, s."""
    simulate(dynamics, (0.0, 0.01), steps=STEPS)  # compilation and compliance
    began = process_time()
    history = simulate(dynamics, (0.0, seconds), steps=STEPS)
    return history, process_time() - began


def curve_table() -> str:
    """Markdown: cost of the curve."""
    columns = ("track", "steps (rejected)", "contact solves a side", "processor s", "energy balance", "y mm", "Q kN")
    rows = [f"| {' | '.join(columns)} |", f"|{'---|' * len(columns)}"]
    for name, dynamics in cases().items():
        history, seconds = timed(dynamics, CURVE_SECONDS)
        cost, error = history.cost, energy_balance(history, dynamics.wagon, dynamics.track).error
        cells = (
            name if history.status == "completed" else f"{name}: {history.status}",
            f"{cost.steps.accepted} ({cost.steps.rejected})",
            f"{cost.contact['left'].solves}",
            f"{seconds:.1f}",
            f"{error:.1e}",
            f"{1e3 * history.state[-1, 6]:.2f}",
            f"{1e-3 * history.outputs.force[-1, 1, 2]:.1f}",
        )
        rows.append(f"| {' | '.join(cells)} |")
    return "\n".join(rows)


def forces(history: History, times: Array) -> Array:
    """Vertical force N of the left wheel at times s."""
    return np.interp(times, history.time, history.outputs.force[:, 0, 2])


def irregular_table() -> str:
    """Markdown: dynamic forces on straight irregular track, and what the mass of the track changes."""
    columns = ("wavelengths", "dynamic force without mass, kN RMS", "with mass", "difference", "steps", "processor s")
    rows = [f"| {' | '.join(columns)} |", f"|{'---|' * len(columns)}"]
    samples = np.linspace(0.4, STRAIGHT_SECONDS, 2000)
    for name, wavelengths in RANGES.items():
        irregularities = ERRI["low"].irregularities(80.0, seed=1, wavelengths=wavelengths, fade=5.0)
        values, costs = [], []
        for case in list(cases())[1:]:
            history, seconds = timed(
                replace(cases()[case], track=Track(irregularities=irregularities)), STRAIGHT_SECONDS
            )
            values.append(forces(history, samples))
            costs.append((history.cost.steps.accepted, seconds))
        (massless, with_mass), (steps, seconds_each) = values, zip(*costs, strict=True)
        kilonewtons = (1e-3 * float(np.std(v)) for v in (massless, with_mass, with_mass - massless))
        cells = (
            *(f"{v:.2f}" for v in kilonewtons),
            ", ".join(map(str, steps)),
            ", ".join(f"{s:.1f}" for s in seconds_each),
        )
        rows.append(f"| {name} | {' | '.join(cells)} |")
    return "\n".join(rows)


def sleeper_table() -> str:
    """Markdown: force and height at the sleeper passing frequency on smooth straight track, by speed."""
    rows = ["| m/s | Hz | force, kN | height, um | steps a span |", "|---|---|---|---|---|"]
    for speed in (5.0, 20.0, 30.0, 45.0, 60.0, 80.0):
        dynamics = replace(equations(PADS + SLEEPERS), track=Track(), speed=speed)
        spans, last = max(6, int(0.12 * speed / 0.6) + 4), 4
        history = simulate(dynamics, (0.0, spans * 0.6 / speed), steps=STEPS)
        place = spans - last + last * np.arange(256) / 256
        amplitudes = []
        for values in (history.outputs.force[:, 0, 2], history.state[:, 7]):
            sampled = np.interp(place, history.distance / 0.6, values)
            amplitudes.append(2 * np.abs(np.fft.rfft(sampled))[last] / len(place))
        steps = len(history) / spans
        force, height = 1e-3 * amplitudes[0], 1e6 * amplitudes[1]
        rows.append(f"| {speed:.0f} | {speed / 0.6:.0f} | {force:.2f} | {height:.1f} | {steps:.0f} |")
    return "\n".join(rows)


def main() -> None:
    """Print the tables."""
    for table in (receptance_table, curve_table, irregular_table, sleeper_table):
        print(table(), end="\n\n", flush=True)


if __name__ == "__main__":
    main()
