"""A population of vehicle runs: vehicles, tracks, profiles, loads, methods, speeds and starts at random, each result
judged by oracles of its own: momentum of the whole vehicle, a run with short steps, the mirror image, an honest status.

python -m benchmarks.population.runs [--count N] [--seed S] [--processes P] [--only SEED ...] [--limit S]
                                     [--failures FILE]

Run k of seed S is drawn from the integer S + k.
"""

from __future__ import annotations

import argparse
import logging
import multiprocessing
import re
from collections.abc import Iterator
from dataclasses import dataclass, replace
from functools import cached_property, partial
from pathlib import Path
from time import process_time

import numpy as np

import wheelrail as wr
from benchmarks.common.machine import machine_description
from benchmarks.population.judge import Verdict
from benchmarks.population.profiles import Shape, rail, wheel
from benchmarks.population.report import reproduction, show
from wheelrail.scenes.builders.vehicle_file import load_vehicle
from wheelrail.support.arrays import Array
from wheelrail.vehicle.integration.integrate import StepSettings
from wheelrail.vehicle.loads import AppliedLoads, BodyForce, LoadTable, WheelsetTorque
from wheelrail.vehicle.multibody.coordinates import Y, Z
from wheelrail.vehicle.multibody.equations import VehicleDynamics
from wheelrail.vehicle.multibody.plane_wagon import wagon_dynamics
from wheelrail.vehicle.multibody.vehicle import Vehicle
from wheelrail.vehicle.simulation.history import History
from wheelrail.vehicle.simulation.simulate import simulate
from wheelrail.vehicle.steady.start_state import start_state
from wheelrail.vehicle.track.alignment import Segment
from wheelrail.vehicle.track.irregularity import Irregularities
from wheelrail.vehicle.track.irregularity_spectrum import ERRI
from wheelrail.vehicle.track.speed_profile import SpeedProfile
from wheelrail.vehicle.track.track import Track
from wheelrail.vehicle.wagon.wagon import Wagon

HEADER = "from benchmarks.population.runs import judged\n"
BASE, GRAVITY = 1.5, 9.81  # m, m/s2
MIRROR = np.array([-1.0, 1.0, -1.0, 1.0])  # of alignment, level, cross level, gauge
MOMENTUM = 0.01  # of the weight: means of forces over a run, by rows at all steps
SHORT = 0.25  # m, steps of the comparison
Y_BAND, Q_BAND = (3e-4, 0.1), (0.05, 0.15)  # m and part of the largest |y|; of the mean wheel load and of the largest Q
DERAILED = re.compile(r"has left the rails|overturns|turned off the track|is lifted|too deep|beside the rail")


@dataclass(frozen=True)
class Run:
    """A run of a vehicle, all of it from one integer.

    Parameters:
        seed: of the random numbers.
        mirrored: as its mirror image in y = 0.
    """

    seed: int
    mirrored: bool = False

    @property
    def sign(self) -> float:
        return -1.0 if self.mirrored else 1.0

    @cached_property
    def drawn(self) -> dict[str, float]:
        """Uniform numbers from 0 to 1, by name: each is independent of what else is drawn."""
        names = (
            "plane mass spring damper wheel rail friction radius hand cant length speed joint rough depth at load pull"
        )
        more = "brake free method start tolerance elastic profile"
        random = np.random.default_rng(self.seed)
        return {name: float(random.random()) for name in f"{names} {more}".split()}

    def between(self, name: str, low: float, high: float) -> float:
        """Number of a name, uniform in the logarithm."""
        return float(low * (high / low) ** self.drawn[name])

    @property
    def plane(self) -> bool:
        return self.drawn["plane"] < 0.2

    @property
    def radius(self) -> float:
        """Of the curve, m; infinite on straight track."""
        return self.between("radius", 250.0, 3000.0) if self.drawn["hand"] < 0.7 else np.inf

    @property
    def cant(self) -> float:
        return 0.15 * self.drawn["cant"] if np.isfinite(self.radius) else 0.0

    @property
    def speed(self) -> float:
        """m/s, with at most 1 m/s2 of cant deficiency."""
        fastest = np.sqrt(self.radius * (1.0 + GRAVITY * self.cant / BASE))
        return float(min(self.between("speed", 4.0, 60.0), fastest))

    @cached_property
    def track(self) -> Track:
        track = Track()
        if np.isfinite(self.radius):
            side = 1.0 if self.drawn["hand"] < 0.35 else -1.0
            arc = Segment("arc", 30.0, self.sign * side / self.radius, self.cant)
            ramp = Segment("transition", 15.0 + 45.0 * self.drawn["length"])
            track = Track.of([Segment("tangent", 25.0 + 50.0 * self.drawn["at"]), ramp, arc, ramp], base=BASE)
        return replace(track, irregularities=self.irregularities)

    @property
    def irregularities(self) -> Irregularities | None:
        """A dip of one or both rails, a realisation of a spectrum, or none."""
        if self.drawn["rough"] < 0.25:
            made = ERRI["low"].irregularities(200.0, seed=self.seed, start=20.0)
            return replace(made, values=made.values * (MIRROR if self.mirrored else 1.0))
        if self.drawn["rough"] > 0.6:
            return None
        half = 0.5 + 2.0 * self.drawn["length"]
        x, depth = np.linspace(-half, half, 101), 1e-3 * min(half, 1.0) * self.between("depth", 0.1, 1.0)
        dip = -depth * (1.0 - np.abs(x) / half) ** 2
        one = self.sign * (self.drawn["joint"] - 0.5) if self.drawn["joint"] > 0.3 else 0.0
        values = np.stack([0.0 * x, dip, 2.0 * one * dip, 0.0 * x], axis=1)
        values[[0, -1]] = 0.0
        return Irregularities(35.0 + 40.0 * self.drawn["at"] + x, values)

    @cached_property
    def vehicle(self) -> Vehicle:
        """Manchester vehicle of another load, springs and dampers."""
        vehicle = load_vehicle()
        body, spring, damper = (
            vehicle.bodies["car_body"],
            self.between("spring", 0.6, 1.6),
            self.between("damper", 0.7, 2),
        )
        bodies = {**vehicle.bodies, "car_body": replace(body, mass=body.mass * self.between("mass", 0.5, 1.4))}

        def scaled(values: tuple[object, ...], factor: float) -> tuple[object, ...]:
            return tuple(factor * v if isinstance(v, float | int) else v for v in values)

        elements = {
            name: replace(own, stiffness=scaled(own.stiffness, spring), damping=scaled(own.damping, damper))
            for name, own in vehicle.elements.items()
        }
        hold = None if self.drawn["free"] < 0.25 else vehicle.speed_hold
        return replace(vehicle, bodies=bodies, elements=elements, speed_hold=hold)

    @property
    def loads(self) -> AppliedLoads:
        """Wind or a drawbar over distance, and brakes over time."""
        forces, torques = (), ()
        if self.drawn["load"] < 0.3:
            wind = self.sign * 3e4 * (self.drawn["pull"] - 0.5)
            table = LoadTable(((40.0, 0.0), (42.0, wind), (50.0, wind), (52.0, 0.0)), by_distance=True)
            forces = (BodyForce("car_body", (0.0, 0.0, 2.0), lateral=table),)
        if self.drawn["brake"] < 0.2:
            torque = LoadTable(((0.5, 0.0), (0.8, 2e3)))
            torques = tuple(WheelsetTorque(name, torque, brake=True) for name in self.vehicle.wheelsets)
        return AppliedLoads(torques, forces)

    @property
    def pair(self) -> tuple[Shape, Shape]:
        wheels = (wheel("S1002"), wheel("S1002", tread=2e-3), wheel("S1002", hollow=1e-3), wheel("cone", slope=0.05))
        rails = (rail("60E1"), rail("60E1", corner=1e-3), rail("arcs", crown=0.254))
        return wheels[int(4 * self.drawn["wheel"] ** 2)], rails[int(3 * self.drawn["rail"] ** 2)]

    @cached_property
    def dynamics(self) -> VehicleDynamics:
        of_wheel, of_rail = self.pair
        more = {"model": "standard"}
        if self.drawn["elastic"] < 0.06:
            more = {"bodies": "half-space", "strips": 6, "cells": 6}
        friction = self.between("friction", 0.05, 0.6)
        pair = wr.Wheelset(of_wheel.profile, of_rail.profile, laying_angle=0.025, friction=friction, **more)
        contact = pair.element().contact
        if self.plane:
            return wagon_dynamics(Wagon(), replace(self.track, irregularities=None), contact, self.speed)
        speed: float | SpeedProfile = self.speed
        if self.drawn["profile"] < 0.15 and self.vehicle.speed_hold is not None:
            speed = SpeedProfile.through((0.0, 1.0, 1.5, 99.0), (speed, speed, 0.97 * speed, 0.97 * speed))
        return VehicleDynamics(self.vehicle, self.track, contact, speed, loads=self.loads)

    @property
    def method(self) -> str:
        explicit = self.plane and self.drawn["method"] > 0.8
        return "ode23" if explicit else "rosenbrock4" if self.drawn["method"] < 0.2 else "rosenbrock"

    @property
    def span(self) -> tuple[float, float]:
        return 0.0, float(min(110.0 / self.speed, 1.5 if self.method == "ode23" else np.inf))

    def initial(self) -> Array | None:
        """The equilibrium, for a third of the runs with wheelsets up to 3 mm beside it."""
        if self.drawn["start"] > 0.33:
            return None
        state, coordinates = start_state(self.dynamics), self.dynamics.coordinates
        for name in self.dynamics.vehicle.wheelsets:
            state[coordinates.index(name, Y)] += self.sign * 6e-3 * (self.drawn["start"] / 0.33 - 0.5)
        return state

    def history(self, limit: float, longest: float | None = None) -> History:
        """The run, interrupted after a processor time s; or with short steps and a fifth of the tolerance."""
        part, end = (1.0, np.inf) if longest is None else (0.2, longest)
        tolerance = part * self.between("tolerance", 1e-3, 5e-3)
        until = process_time() + limit

        def within_limit(done: float, figures: object) -> None:
            if process_time() > until:
                raise KeyboardInterrupt

        settings = StepSettings(self.method, tolerance, 1e-2 * tolerance, max_step=end)
        return simulate(self.dynamics, self.span, initial=self.initial(), steps=settings, progress=within_limit)


def momentum(history: History) -> tuple[float, float]:
    """Mean lateral and vertical force of all wheels that is not that of the masses, over the weight.

    Newton's law for the whole vehicle by its masses, the curvature and cant under each body, and the change of
    momentum: of what the equations of motion do, neither suspension nor rotations enter.
    """
    d, time = history.dynamics, history.time
    bodies, rate = d.vehicle.bodies, d.coordinates.split(history.state).rate
    mass, place = np.array([b.mass for b in bodies.values()]), np.array([b.x for b in bodies.values()])
    speeds, distances = history.speeds, history.distance
    at = distances[:, None] + place
    curvature = np.array([[d.track.curvature(s)[0] for s in row] for row in at.tolist()])
    cant = np.array([[np.arcsin(d.track.superelevation(s)[0] / d.track.base) for s in row] for row in at.tolist()])
    outwards = speeds[:, None] ** 2 * curvature
    lateral = (mass * (outwards * np.cos(cant) - GRAVITY * np.sin(cant))).sum(axis=1)
    vertical = (mass * (GRAVITY * np.cos(cant) + outwards * np.sin(cant))).sum(axis=1)
    _, applied = history.applied()
    force = history.force.sum(axis=(1, 2)) + applied.sum(axis=1)
    result = []
    for k, axis, needed in ((Y, 1, lateral), (Z, 2, vertical)):
        gained = (mass * (rate[-1, :, k] - rate[0, :, k])).sum()
        excess = force[:, axis] - needed
        left = 0.5 * ((excess[1:] + excess[:-1]) * np.diff(time)).sum() - gained
        result.append(float(left / (time[-1] - time[0]) / (GRAVITY * mass.sum())))
    return result[0], result[1]


def largest(history: History) -> tuple[float, float]:
    """Largest |y| of a wheelset, m, and wheel load, N."""
    y = [np.abs(history.coordinate(name, Y)).max() for name in history.dynamics.vehicle.wheelsets]
    return float(max(y)), float(history.force[..., 2].max())


def faults(run: History, short: History, mirrored: History | None) -> Iterator[str]:
    """What of a completed run is wrong.

    Parameters:
        run: with the steps that it chooses.
        short: with short steps and a fifth of the tolerance.
        mirrored: of the mirror image; None: not made.
    """
    if not (np.isfinite(run.state).all() and np.isfinite(run.force).all()):
        yield "states or forces that are no numbers"
        return
    if run.status == "completed":
        for name, part in zip(("lateral", "vertical"), momentum(run), strict=True):
            if abs(part) > MOMENTUM:
                yield f"{name} forces differ by {part:.3f} of the weight from those of the masses"
    if short.status != run.status and "completed" in (run.status, short.status):
        yield f"{run.status}, but with short steps {short.status}"
    elif run.status == "completed":
        load = short.force[0, ..., 2].mean()
        bands = ("|y|", Y_BAND, 1.0), ("Q", Q_BAND, load)
        for (name, (least, part), unit), own, other in zip(bands, largest(run), largest(short), strict=True):
            if abs(own - other) > least * unit + part * other:
                yield f"largest {name} {own:.5g}, with short steps {other:.5g}"
    if mirrored is not None and not (
        mirrored.status.split(":")[0] == run.status.split(":")[0]
        and np.array_equal(mirrored.time, run.time)
        and np.array_equal(np.abs(mirrored.state), np.abs(run.state))
    ):
        yield f"the mirror image differs: {mirrored.status}, {len(mirrored)} rows for {len(run)}"


def judged(seed: int, limit: float = 60.0) -> Verdict:
    """Verdict on the run of a seed.

    Parameters:
        seed: of the random numbers.
        limit: s of processor time of each run.
    """
    own, began = Run(seed), process_time()
    line, model = f"judged({seed})", f"{'wagon' if own.plane else 'vehicle'}, {own.method}"
    try:
        run = own.history(limit)
        seconds = process_time() - began
        if run.status == "interrupted":
            reason = f"no end in {limit:g} s, at t = {run.time[-1]:.3g} of {own.span[1]:.3g} s"
            return Verdict(seed, line, "unexplained failure", reason, (seconds, seconds), model)
        short = own.history(3.0 * limit, SHORT / own.speed)
        compared = short if short.status != "interrupted" else run
        mirrored = Run(seed, mirrored=True).history(limit) if seed % 3 == 0 else None
        found = "; ".join(faults(run, compared, mirrored))
    except Exception as error:
        text = f"{type(error).__name__}: {error}"
        return Verdict(seed, line, "wrong", text, (process_time() - began, process_time() - began), model)
    times = seconds, process_time() - began
    if found:
        return Verdict(seed, line, "wrong", found, times, model)
    if run.status == "completed":
        return Verdict(seed, line, "right", "", times, model)
    kind = "explained failure" if DERAILED.search(run.status) else "unexplained failure"
    return Verdict(seed, line, kind, run.status, times, model)


def main() -> None:
    """Judges and prints."""
    parser = argparse.ArgumentParser(prog="python -m benchmarks.population.runs", description=__doc__)
    parser.add_argument("--count", type=int, default=500, metavar="N", help="runs (500)")
    parser.add_argument("--seed", type=int, default=0, metavar="S", help="of the first run (0)")
    parser.add_argument("--processes", type=int, default=2, metavar="P", help="2")
    parser.add_argument("--only", type=int, nargs="+", default=[], metavar="SEED", help="these runs")
    parser.add_argument("--limit", type=float, default=60.0, metavar="S", help="processor time of a run, s (60)")
    parser.add_argument("--failures", type=Path, default=Path("population_runs.txt"), metavar="FILE")
    arguments = parser.parse_args()
    logging.disable(logging.WARNING)
    seeds = arguments.only or range(arguments.seed, arguments.seed + arguments.count)
    found: list[Verdict] = []
    with (
        multiprocessing.get_context("spawn").Pool(arguments.processes) as pool,
        arguments.failures.open("w", encoding="utf-8", buffering=1) as file,
    ):
        file.write(HEADER)
        for verdict in pool.imap_unordered(partial(judged, limit=arguments.limit), seeds):
            found.append(verdict)
            print(reproduction(verdict), end="", file=file)
            print(f"{len(found)} of {len(seeds)}: seed {verdict.seed} {verdict.kind} {verdict.reason}", flush=True)
    print(f"{machine_description()}; {len(found)} runs\n\n{show(sorted(found, key=lambda verdict: verdict.seed))}")


if __name__ == "__main__":
    main()
