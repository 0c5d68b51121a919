"""Cost of a vehicle in three dimensions: bodies, contacts of all wheels, Jacobian, linear algebra; and of a run.

python -m benchmarks.vehicle [SCENE] [--vehicle FILE] [--seconds T]

Parts are medians of the processor time at the steady state of the scene's sharpest curve, in one process. The run is
that of the scene, or its first T seconds, in one process as well; its errors are differences to a run with a tenth of
its tolerances, RMS / maximum over all wheelsets and steps. In two processes, one for the left and one for the right
wheels, contacts take half the time.
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
from wheelrail.scenes.builders.vehicle import track
from wheelrail.scenes.builders.vehicle_file import MANCHESTER, load_vehicle
from wheelrail.scenes.builders.wheelset import wheelset_contact
from wheelrail.scenes.runs.steady import curve_of
from wheelrail.scenes.schema.scene import RunScene, load_scene
from wheelrail.vehicle.integration.integrate import StepSettings
from wheelrail.vehicle.integration.step_control import StepStatistics
from wheelrail.vehicle.multibody.coordinates import YAW, Y
from wheelrail.vehicle.multibody.equations import VehicleDynamics, VehicleEvaluation, wheelset_wrenches
from wheelrail.vehicle.multibody.jacobian import VehicleJacobian
from wheelrail.vehicle.simulation.history import History
from wheelrail.vehicle.simulation.simulate import simulate
from wheelrail.vehicle.steady.equilibrium import equilibrium
from wheelrail.vehicle.track.speed_profile import SpeedProfile

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


def run_row(scene: RunScene, dynamics: VehicleDynamics, seconds: float | None) -> list[str]:
    """Status, steps, contact solves, and processor time of a run per simulated second; its errors."""
    end, solver = seconds or SpeedProfile.of(scene.vehicle.speed_profile).time_at(scene.track.length), scene.solver
    start = process_time()
    history = simulate(dynamics, (0.0, end), steps=StepSettings(solver.method, solver.rtol, solver.atol))
    spent, cost = process_time() - start, history.cost
    tight = simulate(dynamics, (0.0, end), steps=StepSettings(solver.method, 0.1 * solver.rtol, 0.1 * solver.atol))
    solves = sum(side.solves for side in cost.contact.values())
    contact = sum(side.seconds for side in cost.contact.values())
    span = float(history.time[-1])
    return [
        history.status,
        f"{span:.2f}",
        str(cost.steps.accepted),
        str(solves),
        f"{spent / span:.2f}",
        f"{contact / cost.seconds:.2f}",
        *(difference(history, tight, coordinate) for coordinate in (Y, YAW)),
        str(tight.cost.steps.accepted),
    ]


def difference(history: History, reference: History, coordinate: int) -> str:
    """RMS / maximum over the wheelsets and steps of a run, in mm or mrad, to a run with more steps."""
    values = [
        run.coordinate(name, coordinate) for name in history.dynamics.vehicle.wheelsets for run in (history, reference)
    ]
    errors = [
        own - np.interp(history.time, reference.time, other)
        for own, other in zip(values[::2], values[1::2], strict=True)
    ]
    return f"{1e3 * np.sqrt(np.mean(np.square(errors))):.3f} / {1e3 * np.abs(errors).max():.3f}"


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("scene", nargs="?", type=Path, default=SCENE)
    parser.add_argument("--vehicle", type=Path, default=MANCHESTER)
    parser.add_argument("--seconds", type=float, default=None)
    arguments = parser.parse_args()
    scene = load_scene(arguments.scene)
    assert isinstance(scene, RunScene)
    contact, speed = wheelset_contact(scene), scene.vehicle.speed_profile
    dynamics = VehicleDynamics(load_vehicle(arguments.vehicle), track(scene), contact, speed)
    print(machine_description(), "\n")
    print(markdown("part|ms", [[name, f"{value:.2f}"] for name, value in parts(scene, dynamics).items()]), "\n")
    head = "run|simulated s|steps|contact solves|processor s per s|contacts, part of the time"
    head += "|error of y, mm|error of yaw, mrad|steps of the tight run"
    print(markdown(head, [run_row(scene, dynamics, arguments.seconds)]))


if __name__ == "__main__":
    main()
