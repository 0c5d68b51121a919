"""Runs of Manchester 1 on tables of forces with a border to elastic contact, and with contacts solved once a step.

Each yields rows for `benchmarks.vehicle_complete`: name, value, expected value, largest difference.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import replace
from functools import cache
from pathlib import Path
from time import perf_counter, process_time
from typing import Any

import numpy as np

from wheelrail.contact.kinematics.wheelset_state import WheelsetState
from wheelrail.contact.models.wheelset import WheelsetContact
from wheelrail.contact.results.vehicle_contact import VehicleContact
from wheelrail.scenes.builders.vehicle_file import MANCHESTER
from wheelrail.scenes.builders.wheelset import run_contact
from wheelrail.scenes.runs.run import simulate_on_track, vehicle_for_run
from wheelrail.scenes.schema.scene import RunScene, checked
from wheelrail.scenes.schema.toml import parse, read_text
from wheelrail.support.arrays import Array
from wheelrail.vehicle.evaluation.running_safety import low_pass
from wheelrail.vehicle.multibody.coordinates import Y
from wheelrail.vehicle.simulation.history import History
from wheelrail.vehicle.simulation.parallel_contact import in_threads
from wheelrail.vehicle.simulation.time_run import Recording

Row = tuple[str, float, float, float]
ELASTIC: dict[str, Any] = {"model": "condensed", "laws": "exact", "surface_size": 1e-3, "strips": 4, "cells": 10}
BEGIN = 0.05  # s, of a run whose time is that of the start
EVERY = 4e-3  # s, between rows
LOWERED = WheelsetState(z=-1.2e-4, roll=1e-4, yaw=1e-3, y_rate=0.02, speed=25.0, pitch_rate=25.0 / 0.46 * 1.0005)
KICK = {"front_bogie": 0.9, "rear_bogie": 0.63}  # m/s, by which wheels reach 7 mm
SPACING = 5e-6  # m, of places over which forces are compared


def scene(file: str, tolerance: float = 1.0, **tables: object) -> RunScene:
    """Scene of a run with elastic contact on 4 x 10 strips and cells, at a part of its tolerances."""
    path = MANCHESTER.parent / file
    data = parse(read_text(path), path)
    solver = {**data["solver"], **{key: tolerance * data["solver"][key] for key in ("rtol", "atol")}}
    found = checked({**data, **ELASTIC, "solver": solver, "tabulated": {}, **tables}, Path(path))
    assert isinstance(found, RunScene)
    return found


@cache
def contact(file: str = "vehicle_irregular.toml") -> WheelsetContact:
    """Contact by a table with a border."""
    found, _ = run_contact(scene(file), ())
    assert isinstance(found, WheelsetContact)
    return found


@cache
def elastic() -> WheelsetContact:
    """The same without the table."""
    return contact().changed(lambda model: model.elastic)  # type: ignore[attr-defined]


def run(
    own: RunScene,
    model: VehicleContact,
    seconds: float,
    method: str | None = None,
    every: float = EVERY,
    clock: Callable[[], float] = process_time,
) -> tuple[History, float]:
    """History of a run, and its time s by a clock, the processor time of this process."""
    start = clock()
    if method is not None:
        own = own.model_copy(update={"solver": own.solver.model_copy(update={"method": method})})
    vehicle = vehicle_for_run(own, MANCHESTER)
    history = simulate_on_track(own, vehicle, model, seconds, Recording(every), lambda *_: None)
    return history, clock() - start


def loads(history: History) -> Array:
    """Vertical loads (n, w, 2) N of all wheels every 2 ms, low-passed at 20 Hz."""
    time = np.arange(history.time[0], history.time[-1] - 1e-9, 2e-3)
    flat = history.force[..., 2].reshape(len(history), -1)
    return np.array([low_pass(np.interp(time, history.time, one)) for one in flat.T])


def errors(own: History, reference: History) -> tuple[float, float]:
    """RMS errors: of lateral displacements, mm, and of low-passed loads, % of their mean."""
    names = own.dynamics.vehicle.wheelsets
    lateral = np.array([own.coordinate(name, Y) - reference.coordinate(name, Y) for name in names])
    one, other = loads(own), loads(reference)
    return 1e3 * float(np.sqrt((lateral**2).mean())), 100.0 * float(np.sqrt(((one - other) ** 2).mean()) / other.mean())


def solves(history: History) -> int:
    """Solves of both sides, without those of rows."""
    return sum(side.solves for side in history.cost.contact.values())


def irregular(seconds: float = 1.0) -> Iterator[Row]:
    """Class low at 45 m/s: errors against a tenth of the tolerances, solves, and processor time without rows."""
    own, tight = scene("vehicle_irregular.toml"), scene("vehicle_irregular.toml", 0.1)
    reference, _ = run(tight, elastic(), seconds)
    runs = {
        "elastic": (elastic(), "rosenbrock"),
        "once a step": (elastic(), "rosenbrock_ends"),
        "table": (contact(), "rosenbrock"),
    }
    found = {name: errors(run(own, by, seconds, method)[0], reference) for name, (by, method) in runs.items()}

    def bare(model: VehicleContact, method: str, clock: Callable[[], float] = process_time) -> tuple[History, float]:
        """A run without rows, and its time per second after the start."""
        _, begun = run(own, model, BEGIN, method, BEGIN, clock)
        history, spent = run(own, model, seconds, method, seconds, clock)
        return history, (spent - begun) / (seconds - BEGIN)

    solved = dict[str, int]()
    for name, (lateral, load) in found.items():
        history, rate = bare(*runs[name])
        solved[name] = solves(history)
        yield f"irregular, {name}: RMS error of y, mm", lateral, 0.0, 0.2
        yield f"irregular, {name}: RMS error of loads below 20 Hz, %", load, 0.0, 1.0
        yield f"irregular, {name}: steps", float(history.cost.steps.accepted), 0.0, np.inf
        yield f"irregular, {name}: processor s per s", rate, 0.0, 0.33 if name == "table" else np.inf
    once, plain = found["once a step"], found["elastic"]
    yield "errors of loads, once a step over elastic", once[1] / plain[1], 0.0, 1.1
    yield "solves, once a step over elastic", solved["once a step"] / solved["elastic"], 0.0, 0.55
    with in_threads(elastic(), 2) as parallel:
        _, rate = bare(parallel, "rosenbrock_ends", perf_counter)
    yield "irregular, once a step: wall s per s, two threads", rate, 0.0, 1.5


def border(seconds: float = 0.8) -> Iterator[Row]:
    """Hunting through the border in y, and second differences of the force over it."""
    own = scene("hunting.toml", kick=KICK)
    on_table, _ = run(own, contact("hunting.toml"), seconds, every=seconds)
    solved, _ = run(own, elastic(), seconds, every=seconds)
    steps = on_table.cost.steps.accepted / solved.cost.steps.accepted
    yield "hunting: steps, table with border over elastic", steps, 0.0, 1.0
    force = {True: list[Array](), False: list[Array]()}
    for y in np.arange(4.2e-3, 5.3e-3, SPACING):
        state = replace(LOWERED, y=float(y))
        for on, model in ((True, contact()), (False, elastic())):
            force[on].append(model(state, "left").force)
    own_, solved_ = (np.abs(np.diff(force[on], 2, axis=0)).max() for on in (True, False))
    yield "second differences of the force over 5 um, over those of elastic contact", float(own_ / solved_), 0.0, 1.0
