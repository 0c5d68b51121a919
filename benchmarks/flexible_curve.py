"""The curve of `scenes/curve.toml` with clamped bodies, with an elastic axle, with rails on pads, and with both.

Table of cost, stiffness and positions, and a figure if a file is named.

`python -m benchmarks.flexible_curve [FIGURE.png]`: 10 s of the run in one process, an axle of 160 mm with journals 2 m
apart, pads of 100 kN/mm vertically and 40 kN/mm laterally every 0.6 m.
"""

from __future__ import annotations

import sys
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from time import process_time

import numpy as np

from wheelrail.scenes.builders.vehicle import wagon
from wheelrail.scenes.builders.wheelset import run_contact
from wheelrail.scenes.schema.scene import RunScene, parse_scene
from wheelrail.vehicle.integration.integrate import StepSettings
from wheelrail.vehicle.integration.step_control import StepStatistics
from wheelrail.vehicle.multibody.equations import VehicleDynamics, all_side_wrenches
from wheelrail.vehicle.multibody.jacobian import VehicleJacobian
from wheelrail.vehicle.multibody.plane_wagon import WHEELSET, wagon_dynamics
from wheelrail.vehicle.simulation.energy_balance import energy_balance
from wheelrail.vehicle.simulation.history import History
from wheelrail.vehicle.simulation.simulate import simulate
from wheelrail.vehicle.steady.equilibrium import equilibrium

SCENE = Path(__file__).parents[1] / "scenes" / "curve.toml"
AXLE, PADS = "\n[wheelset.axle]\n", "\n[track.pads]\n"
CASES = {"clamped": "", "axle": AXLE, "pads": PADS, "axle and pads": AXLE + PADS}
SECONDS = 10.0


@dataclass(frozen=True)
class FlexibleRun:
    """A run, its processor time s, vertical stiffness N/m of a wheel, and relative error of the energy balance."""

    history: History
    seconds: float
    stiffness: float
    energy_error: float


def run(keys: str) -> FlexibleRun:
    """The run with further keys."""
    scene = parse_scene(SCENE.read_text(encoding="utf-8") + keys, SCENE)
    assert isinstance(scene, RunScene)
    contact, structures = run_contact(scene, [WHEELSET])
    dynamics = wagon_dynamics(wagon(scene), scene.track.track(), contact, scene.vehicle.speed_profile, structures)
    simulate(dynamics, (0.0, 0.02), steps=StepSettings("rosenbrock", 3e-3, 3e-6))  # compilation and compliance
    began = process_time()
    history = simulate(dynamics, (0.0, SECONDS), steps=StepSettings("rosenbrock", 3e-3, 3e-6))
    seconds = process_time() - began
    return FlexibleRun(history, seconds, stiffness(dynamics), energy_balance(history).error)


def stiffness(dynamics: VehicleDynamics) -> float:
    """Vertical stiffness N/m of one wheel on straight track, as the motions of axle and rails follow the loads."""
    rest = equilibrium(dynamics)
    states = dynamics.wheelset_states(0.0, rest.state)
    tangents = VehicleJacobian(dynamics, StepStatistics()).tangents(states, rest.contacts).values[..., :-1]
    by_z, by_motions = tangents[0, 0, 2, 1], tangents[0, 0, 2, 9:]
    (structure,) = dynamics.structures.own
    if structure is None:
        return -float(by_z)
    wrenches = all_side_wrenches(rest.contacts)
    slopes = dynamics.structures.load_slopes(list(states.values()), wrenches, tangents)[0].sum(axis=0)
    slopes = structure.compliance[: len(by_motions)] @ slopes
    return -float(by_z + by_motions @ np.linalg.solve(np.eye(len(by_motions)) - slopes[:, 9:], slopes[:, 1]))


def table(runs: Mapping[str, FlexibleRun]) -> str:
    """Markdown: one row for each run."""
    columns = (
        *("bodies", "steps (rejected)", "contact solves a side", "processor s", "stiffness of a wheel, N/m"),
        *("energy balance", "y in the curve, mm", "patches of the outer wheel: place mm (kN, MPa)"),
    )
    rows = [f"| {' | '.join(columns)} |", f"|{'---|' * len(columns)}"]
    for name, flexible in runs.items():
        history = flexible.history
        cost, patches = history.cost, history.rows[-1].patches[0][1]
        places = (f"{1e3 * p.rail_y:.2f} ({1e-3 * p.normal_force:.1f}, {1e-6 * p.max_pressure:.0f})" for p in patches)
        cells = (
            name if history.status == "completed" else f"{name}: {history.status}",
            f"{cost.steps.accepted} ({cost.steps.rejected})",
            f"{cost.contact['left'].solves}",
            f"{flexible.seconds:.1f}",
            f"{flexible.stiffness:.2e}",
            f"{flexible.energy_error:.1e}",
            f"{1e3 * history.state[-1, 6]:.2f}",
            ", ".join(places),
        )
        rows.append(f"| {' | '.join(cells)} |")
    return "\n".join(rows)


def figure(runs: Mapping[str, FlexibleRun], file: Path) -> None:
    """Lateral displacement, and place of the patch with the largest load of the inner and of the outer wheel."""
    import matplotlib.pyplot as plt

    drawing, (displacement, inner, outer_wheel) = plt.subplots(1, 3, figsize=(14, 4), layout="constrained")
    for (name, flexible), color in zip(runs.items(), ("0.5", "C0", "C1", "C3"), strict=True):
        history = flexible.history
        displacement.plot(history.distance, 1e3 * history.state[:, 6], color=color, label=name)
        for side, axes in enumerate((inner, outer_wheel)):
            largest = [
                max(patches[side], key=lambda patch: patch.normal_force)
                for patches in (row.patches[0] for row in history.rows)
            ]
            axes.plot(history.distance, [1e3 * patch.rail_y for patch in largest], color=color)
    for axes, text in (
        (displacement, "lateral displacement of the wheelset, mm"),
        (inner, "place on the inner rail, mm"),
        (outer_wheel, "place of the larger load on the outer rail, mm"),
    ):
        axes.set(xlabel="distance, m", ylabel=text)
        axes.grid(alpha=0.3)
    displacement.legend()
    drawing.savefig(file, dpi=120)


def main(arguments: list[str]) -> None:
    """Print the table, and draw the figure if a file is given."""
    runs = {name: run(keys) for name, keys in CASES.items()}
    print(table(runs))
    if arguments:
        figure(runs, Path(arguments[0]))


if __name__ == "__main__":
    main(sys.argv[1:])
