"""Cost of the parts of a vehicle in three dimensions: bodies, contacts of all wheels, Jacobian, linear algebra.

python -m benchmarks.vehicle [SCENE] [--vehicle FILE]

Parts are medians of the processor time at the steady state of the scene's sharpest curve, in one process. In two
processes, one for the left and one for the right wheels, contacts take half the time. Whole runs:
`benchmarks.vehicle_runs`.
"""

from __future__ import annotations

import argparse
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path
from statistics import median
from time import process_time

import numpy as np

from benchmarks.common.machine import machine_description
from benchmarks.paper.tables import markdown
from wheelrail.scenes.builders.vehicle_file import MANCHESTER, load_vehicle
from wheelrail.scenes.builders.wheelset import wheelset_contact
from wheelrail.scenes.runs.steady import curve_of
from wheelrail.scenes.schema.scene import RunScene, load_scene
from wheelrail.vehicle.integration.step_control import StepStatistics
from wheelrail.vehicle.multibody.equations import VehicleDynamics, VehicleEvaluation, wheelset_wrenches
from wheelrail.vehicle.multibody.jacobian import VehicleJacobian
from wheelrail.vehicle.steady.equilibrium import equilibrium

SCENE = Path(__file__).parents[1] / "scenes" / "vehicle.toml"
REPEATS = 15


def milliseconds(call: Callable[[], object]) -> float:
    """Median processor time of a call, ms, after a first one."""
    call()
    times = []
    for _ in range(REPEATS):
        start = process_time()
        call()
        times.append(process_time() - start)
    return 1e3 * median(times)


def parts(scene: RunScene, dynamics: VehicleDynamics) -> dict[str, float]:
    """Processor time, ms, of the parts of a step, at the steady state of the sharpest curve."""
    from scipy.linalg import lu_factor

    at = equilibrium(replace(dynamics, track=curve_of(scene).track))
    d, state = at.dynamics, at.state
    evaluation = VehicleEvaluation(np.zeros_like(state), at.contacts)
    jacobian = VehicleJacobian(d, StepStatistics())
    matrix = jacobian(0.0, state, evaluation).by_state
    wrenches, states = wheelset_wrenches(at.contacts), d.wheelset_states(0.0, state)
    travel = d.speed_profile(0.0)
    return {
        "equations of all bodies": milliseconds(lambda: d.accelerations(0.0, state, wrenches)),
        "of these, sections of the track": milliseconds(lambda: d.bodies.sections(travel, state)),
        "Jacobian of the bodies": milliseconds(lambda: d.bodies.derivatives(travel, 0.0, state, wrenches)),
        "contacts of all wheels, from their results": milliseconds(lambda: d.solve_contacts(0.0, state, at.contacts)),
        "the same, and their tangents": milliseconds(
            lambda: VehicleJacobian(d, StepStatistics()).tangents(states, d.solve_contacts(0.0, state, at.contacts)),
        ),
        "Jacobian from tangents or differences of the contacts": milliseconds(lambda: jacobian(0.0, state, evaluation)),
        "factors of the matrix of a step": milliseconds(lambda: lu_factor(np.eye(len(matrix)) / 1e-3 - matrix)),
    }


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("scene", nargs="?", type=Path, default=SCENE)
    parser.add_argument("--vehicle", type=Path, default=MANCHESTER)
    arguments = parser.parse_args()
    scene = load_scene(arguments.scene)
    assert isinstance(scene, RunScene)
    contact, speed = wheelset_contact(scene), scene.vehicle.speed_profile
    dynamics = VehicleDynamics(load_vehicle(arguments.vehicle), scene.track.track(), contact, speed)
    print(machine_description(), "\n")
    print(markdown("part|ms", [[name, f"{value:.2f}"] for name, value in parts(scene, dynamics).items()]))


if __name__ == "__main__":
    main()
