"""Table 5 of the paper with today's means: the run of scenes/full_curve.toml by eq. (12) and by eq. (15), whole.

python -m benchmarks.full_curve [--seconds T] [--size m] [--states N] [--json FILE]

Both models have the same meshes, laws and integrator; Newton's method of eq. (15) has the tolerance 1e-12, so that the
differences are those of eq. (12). Seconds are of the processor, of one process: a run without set-up (meshes,
stiffness, factors), which has its own column, but with the compliance of surfaces that it reaches for the first time,
unless an earlier run has stored it. Then contact solves of eq. (12) at states of the run, cold and warm.
"""

from __future__ import annotations

import argparse
import json
from dataclasses import asdict, dataclass, replace
from pathlib import Path
from time import process_time
from typing import Any

import numpy as np

from benchmarks.common.machine import machine_description
from benchmarks.paper.published import SOURCE, TABLES
from benchmarks.paper.tables import markdown
from wheelrail.contact.kinematics.frames import SIDES
from wheelrail.contact.models.full.model import FullContact
from wheelrail.contact.models.wheelset import WheelsetContact
from wheelrail.scenes.builders.vehicle import wagon
from wheelrail.scenes.builders.wheelset import wheelset_contact
from wheelrail.scenes.schema.scene import RunScene, load_scene
from wheelrail.vehicle.integration.integrate import StepSettings
from wheelrail.vehicle.multibody.equations import VehicleDynamics
from wheelrail.vehicle.multibody.plane_wagon import COORDINATES, COUNT, WHEELSET, wagon_dynamics
from wheelrail.vehicle.simulation.history import History
from wheelrail.vehicle.simulation.simulate import simulate
from wheelrail.vehicle.simulation.time_run import Recording
from wheelrail.vehicle.steady.equilibrium import equilibrium
from wheelrail.vehicle.track.speed_profile import SpeedProfile

SCENE = Path(__file__).parents[1] / "scenes" / "full_curve.toml"
SPIN = 1e-4  # rad/s in excess of equilibrium: rates at its round-off would decide about the first step
SAME_TIME = 1e-7  # of the duration: steps follow from rates, of which the models agree within some 1e-8
TIGHT = 1e-12  # of the condensed model


@dataclass(frozen=True)
class ModelRun:
    """A run by one model: its contact, history, and processor time s of set-up and run."""

    contact: WheelsetContact
    history: History
    set_up: float
    seconds: float


@dataclass(frozen=True)
class SolveCost:
    """Cost of a contact solve, medians over states: seconds, Newton and BiCGStab iterations, products with K^-1."""

    seconds: float
    newton: float
    linear: float
    products: float


def scene_of(size: float | None) -> RunScene:
    """The scene, with another spacing m of the surface nodes if given."""
    scene = load_scene(SCENE)
    assert isinstance(scene, RunScene)
    return scene if size is None else scene.model_copy(update={"surface_size": size})


def dynamics(scene: RunScene, contact: WheelsetContact) -> VehicleDynamics:
    return wagon_dynamics(wagon(scene), scene.track.track(), contact, scene.vehicle.speed_profile)


def ran(scene: RunScene, model: str, seconds: float | None) -> ModelRun:
    """The scene's run by a model, "full" or "condensed", to its end or for so many seconds."""
    began = process_time()
    contact = wheelset_contact(scene.model_copy(update={"model": model}))
    solver: Any = contact.model
    if isinstance(solver, FullContact):
        _ = solver.solver, solver.law
    else:
        contact = replace(contact, model=replace(solver, options=replace(solver.options, tolerance=TIGHT)))
    ready = process_time()
    end = seconds or SpeedProfile.of(scene.vehicle.speed_profile).time_at(scene.track.length)
    settings = StepSettings(scene.solver.method, scene.solver.rtol, scene.solver.atol)
    recording = Recording(scene.output.interval or None)
    condensed = wheelset_contact(scene.model_copy(update={"model": "condensed"}))
    start = equilibrium(dynamics(scene, condensed)).state
    start[COUNT + COORDINATES.index("wheelset_pitch")] += SPIN
    history = simulate(dynamics(scene, contact), (0.0, end), initial=start, steps=settings, recording=recording)
    return ModelRun(contact, history, ready - began, process_time() - ready)


def differences(run: History, other: History) -> tuple[float, float]:
    """Largest difference of the states and of the contact forces at equal times.

    States are relative to the largest of the same kind (displacements, rotations, their rates, deflections of springs),
    forces to the largest of the same component. Raises ValueError for runs with rows at different times: lengths of
    steps follow from the errors, which differ by round-off.
    """
    if len(run.time) != len(other.time) or np.abs(run.time - other.time).max() > SAME_TIME * run.time[-1]:
        raise ValueError("the runs have rows at different times")
    rotates = np.array([name.endswith(("roll", "pitch")) for name in COORDINATES])
    kinds = np.concatenate([rotates, 2 + rotates, np.full(run.state.shape[1] - 2 * COUNT, 4)])
    states = (run.state, other.state, kinds)
    forces = (run.force[:, 0].reshape(-1, 6), other.force[:, 0].reshape(-1, 6), np.arange(6) % 3)
    state, force = (
        max(
            float(np.abs(one - two)[:, kind == k].max()) / float(np.abs(two[:, kind == k]).max())
            for k in np.unique(kind)
        )
        for one, two, kind in (states, forces)
    )
    return state, force


def solve_costs(scene: RunScene, run: ModelRun, count: int) -> dict[str, SolveCost]:
    """Cost of solves by eq. (12) at states of a run: from zero, and from the result one step earlier."""
    model: Any = run.contact.model
    equations, history = dynamics(scene, run.contact), run.history
    costs: dict[str, list[tuple[float, int, int, int]]] = {"cold": [], "warm": []}
    for row in np.unique(np.linspace(1, len(history) - 1, count).astype(int)):
        before, state = (
            equations.wheelset_states(float(history.time[k]), history.state[k])[WHEELSET] for k in (row - 1, row)
        )
        for side in SIDES:
            earlier = run.contact(before, side)
            for name, guess in (("cold", None), ("warm", earlier)):
                products, began = model.solver.preconditioner.solves, process_time()
                result = run.contact(state, side, guess)
                seconds = process_time() - began
                products = model.solver.preconditioner.solves - products
                costs[name].append((seconds, result.statistics.newton, result.statistics.linear, products))
    return {name: SolveCost(*np.median(np.array(rows, dtype=float), axis=0).tolist()) for name, rows in costs.items()}


def row(name: str, run: ModelRun) -> list[Any]:
    """A run as a row of the table."""
    sides = [run.history.cost.contact[side] for side in ("right", "left")]
    newton, linear = (sum(getattr(side, key) for side in sides) for key in ("newton", "linear"))
    return [
        name,
        run.history.cost.steps.accepted,
        *(side.solves for side in sides),
        *(side.newton for side in sides),
        f"{newton / sum(side.solves for side in sides):.2f}",
        f"{linear / newton:.2f}" if linear else "LU",
        f"{run.set_up:.1f}",
        f"{run.seconds:.1f}",
        f"{1e3 * run.seconds / sum(side.solves for side in sides):.3g}",
    ]


def published() -> list[list[Any]]:
    """The paper's Table 5, as rows of the table."""
    rows: list[list[Any]] = []
    for line in TABLES["5"]:
        problems = ["not legible" if number is None else number for number in line.problems]
        known = [(n, p) for n, p in zip(line.newton, line.problems, strict=True) if p is not None]
        newton = sum(n for n, _ in known) / sum(p for _, p in known)
        linear = "" if line.linear is None else " / ".join(f"{value:g}" for value in line.linear)
        rows.append(
            [f"the paper: {line.name}", "", *problems, *line.newton, f"{newton:.2f}", linear, "", line.seconds, ""]
        )
    return rows


def main() -> None:
    """Run and print."""
    given = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    given.add_argument("--seconds", type=float, help="length of the run (the whole)")
    given.add_argument("--size", type=float, help="spacing of the surface nodes, m (the scene's)")
    given.add_argument("--states", type=int, default=8, help="at which solves are timed")
    given.add_argument("--json", type=Path)
    args = given.parse_args()
    print(machine_description())
    scene = scene_of(args.size)
    runs = {model: ran(scene, model, args.seconds) for model in ("full", "condensed")}
    for model, run in runs.items():
        if run.history.status != "completed":
            raise SystemExit(f"{model}: {run.history.status}")
    whole: Any = runs["full"].contact.model
    unknowns = [body.stiffness.getSize()[0] for body in (whole.wheel, whole.rail)]
    entries = [int(body.factor.getInfo()["nz_used"]) for body in (whole.wheel, whole.rail)]
    names = {"full": "Eq. (12), rosenbrock, BiCGStab", "condensed": "Eq. (15), rosenbrock, LU"}
    head = "run|steps|#cps R|#cps L|#New R|#New L|New/cp|BiCGStab/New|set-up s|run s|ms/cp"
    rows = [row(names[model], run) for model, run in runs.items()]
    print(
        f"\n{runs['full'].history.time[-1]:.3f} s of {SCENE.name}, {1e3 * scene.discretisation.surface_size:g} mm: "
        f"{sum(unknowns)} unknowns, {sum(entries)} entries in the factors\n\n{markdown(head, [*rows, *published()])}"
        f"\n\n{SOURCE}; 10 s of the curve"
    )
    state, force = differences(runs["full"].history, runs["condensed"].history)
    print(f"\nLargest relative difference of both runs: states {state:.1e}, forces {force:.1e}")
    costs = solve_costs(scene, runs["full"], args.states)
    lines = [[f"{name} solve", *(f"{value:.3g}" for value in asdict(cost).values())] for name, cost in costs.items()]
    print(f"\n{markdown('eq. (12)|s|Newton|BiCGStab|products with K^-1', lines)}")
    if args.json:
        data = {
            "machine": machine_description(),
            "unknowns": unknowns,
            "factor entries": entries,
            "columns": head.split("|"),
            "rows": rows,
            "difference": {"state": state, "force": force},
            "solve": {name: asdict(cost) for name, cost in costs.items()},
        }
        args.json.write_text(json.dumps(data, indent=1) + "\n", encoding="utf-8")


if __name__ == "__main__":
    main()
