"""Track without mass and with mass: receptance against a beam in closed form, and cost of a curve.

`python -m benchmarks.track_models`: pads of 100 and 40 kN/mm every 0.6 m, ballast of 80 and 40 kN/mm under half a
sleeper of 150 kg. 10 s of `scenes/curve.toml` at 45 m/s in one process.
"""

from __future__ import annotations

from functools import cache
from pathlib import Path
from time import process_time

import numpy as np

from wheelrail.contact.loading.quasi_static_structure import QuasiStaticStructure
from wheelrail.contact.structure.ballast import Ballast, CoRunningTrack, Layers, co_running
from wheelrail.contact.structure.pads import RailCompliance, RailPads, wavenumber_samples
from wheelrail.scenes.builders.vehicle import wagon
from wheelrail.scenes.builders.wheelset import run_contact
from wheelrail.scenes.schema.scene import RunScene, parse_scene
from wheelrail.vehicle.integration.integrate import StepSettings
from wheelrail.vehicle.multibody.equations import VehicleDynamics
from wheelrail.vehicle.multibody.plane_wagon import wagon_dynamics
from wheelrail.vehicle.simulation.energy_balance import energy_balance
from wheelrail.vehicle.simulation.history import History
from wheelrail.vehicle.simulation.simulate import simulate

SCENE = Path(__file__).parents[1] / "scenes" / "curve.toml"
BENDING, RAIL = 2.1e11 * 3038.3e-8, 7850 * 76.70e-4  # N m2, kg/m: 60E1
FREQUENCIES = (0.0, 10.0, 20.0, 50.0, 70.0, 100.0, 150.0, 200.0)  # Hz
STEPS = StepSettings("rosenbrock", 1e-3, 1e-6)
SECONDS = 10.0
PADS, BALLAST = "\n[track.pads]\n", "\n[track.ballast]\n"


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
        np.full(2, sleepers),
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


def equations(keys: str, *, massless: bool = False) -> VehicleDynamics:
    """Equations of motion of the scene with further keys; massless: a track on ballast without its masses."""
    scene = parse_scene(SCENE.read_text(encoding="utf-8") + keys, SCENE)
    assert isinstance(scene, RunScene)
    contact, structures = run_contact(scene, ["wheelset"])
    (structure,) = structures or (None,)
    if massless and structure is not None:
        structure = QuasiStaticStructure(structure.pairs)
    return wagon_dynamics(wagon(scene), scene.track.track(), contact, scene.vehicle.speed_profile, structure)


@cache
def cases() -> dict[str, VehicleDynamics]:
    """Equations of motion by name of the track."""
    return {
        "pads": equations(PADS),
        "pads on ballast, without mass": equations(PADS + BALLAST, massless=True),
        "pads on ballast, with mass": equations(PADS + BALLAST),
    }


def timed(dynamics: VehicleDynamics, seconds: float) -> tuple[History, float]:
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
        history, seconds = timed(dynamics, SECONDS)
        cost, error = history.cost, energy_balance(history).error
        cells = (
            name if history.status == "completed" else f"{name}: {history.status}",
            f"{cost.steps.accepted} ({cost.steps.rejected})",
            f"{cost.contact['left'].solves}",
            f"{seconds:.1f}",
            f"{error:.1e}",
            f"{1e3 * history.state[-1, 6]:.2f}",
            f"{1e-3 * history.force[-1, 0, 1, 2]:.1f}",
        )
        rows.append(f"| {' | '.join(cells)} |")
    return "\n".join(rows)


def main() -> None:
    """Print the tables."""
    for table in (receptance_table, curve_table):
        print(table(), end="\n\n", flush=True)


if __name__ == "__main__":
    main()
