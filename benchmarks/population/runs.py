"""A population of vehicle runs: vehicles, tracks, profiles, loads, methods, speeds and starts at random, each result
judged by oracles of its own: momentum of the whole vehicle, Newton's law for wheels that turn by themselves, Coulomb's
bound at each place, a run with short steps, the mirror image, and whether a vehicle that is said to have left the rails
has.

python -m benchmarks.population.runs [--count N] [--seed S] [--processes P] [--only SEED ...] [--limit S]
                                     [--failures FILE] [--events]

Run k of seed S is drawn from the integer S + k. With --events each method meets each event that is prescribed.
"""

from __future__ import annotations

import argparse
import logging
import multiprocessing
from collections.abc import Callable, Iterator, Sequence
from dataclasses import replace
from functools import partial
from pathlib import Path
from time import process_time

import numpy as np

from benchmarks.common.machine import machine_description
from benchmarks.population.drawn_run import GRAVITY, Run
from benchmarks.population.judge import Kind, Verdict
from benchmarks.population.report import reproduction, show
from wheelrail.contact.kinematics.frames import SIDES
from wheelrail.support.arrays import Array
from wheelrail.vehicle.evaluation.resolved_loads import unresolved_loads
from wheelrail.vehicle.multibody.coordinates import ROLL, YAW, Y, Z
from wheelrail.vehicle.simulation.history import History

HEADER = "from benchmarks.population.runs import judged\n"
MOMENTUM = 0.01  # of the weight: means of forces over a run, by rows at all steps
SPIN = 0.02  # of the moments on both wheels: means over a run
FRICTION = 1e-3  # of the bound: forces are split by normals of undeformed wheels
SHORT = 0.25  # m, steps of the comparison
Y_BAND = 3e-4, 0.1  # m, and part of the largest |y|
Q_BAND = 0.05, 0.15  # of the mean wheel load, and of the wheel's largest Q
CLIMBING, TURNED, UNLOADED = 9e-3, 0.2, 0.01  # m beyond all clearances of flanges; rad; of the mean wheel load
PLACE = 10.0  # m, within which short steps end likewise
MORE = 1.001  # times the friction: less than anyone knows
GRID = 4000  # times at which curves are sampled, whatever the steps
USUAL = dict.fromkeys(("plane", "free", "tolerance"), 0.5) | {"wheel": 0.0, "rail": 0.0, "speed": 0.7, "at": 0.6}
USUAL |= dict.fromkeys(["hand", "rough", "load", "brake", "start", "elastic", "profile", "sleepers"], 1.0)
USUAL |= dict.fromkeys(["named", "turning", "rubbing", "supple", "worn"], 1.0)
EVENTS: dict[str, dict[str, float]] = {
    "curve": {"hand": 0.1, "radius": 0.35, "cant": 0.0},
    "curve, wagon": {"plane": 0.1, "hand": 0.1, "radius": 0.35, "cant": 0.0},
    "joint, 0.3 mm": {"rough": 0.5, "depth": 0.5, "length": 0.2, "joint": 0.0},
    "dip, 0.1 mm, one rail": {"rough": 0.5, "depth": 0.0, "length": 0.2, "joint": 1.0},
    "irregular": {"rough": 0.1},
    "wind over distance": {"load": 0.1, "pull": 1.0},
    "change of speed": {"profile": 0.1},
    "joint, free speed": {"free": 0.1, "rough": 0.5, "depth": 0.5, "length": 0.2, "joint": 0.0},
    "sleepers, wagon": {"plane": 0.1, "sleepers": 0.0},
    "contacts by name, curve": {"named": 0.0, "hand": 0.1, "radius": 0.35, "cant": 0.0},
    "independent wheels, curve": {"turning": 0.0, "hand": 0.1, "radius": 0.35, "cant": 0.0},
    "leaves, curve": {"rubbing": 0.1, "hand": 0.1, "radius": 0.35, "cant": 0.0},
    "elastic axle": {"supple": 0.0, "rough": 0.5, "depth": 0.5, "length": 0.2, "joint": 0.0, "at": 0.0},
    "worn wheels, curve": {"worn": 0.1, "hand": 0.1, "radius": 0.35, "cant": 0.0},
}
BY_METHOD = {"rosenbrock": 0.5, "rosenbrock4": 0.1, "rosenbrock_ends": 0.7, "ode23": 0.85, "ode45": 0.95}


def integral(values: Array, times: Array) -> float:
    """By the trapezoidal rule."""
    return float(0.5 * ((values[1:] + values[:-1]) * np.diff(times)).sum())


def momentum(history: History) -> tuple[float, float]:
    """Mean lateral and vertical force of all wheels that is not that of the masses, over the weight.

    Newton's law for the whole vehicle by its masses, the curvature and cant under each body, and the change of
    momentum: of what the equations of motion do, neither suspension nor rotations enter.
    """
    d, time = history.dynamics, history.time
    bodies, rate = d.vehicle.bodies, d.coordinates.split(history.state).rate
    mass, place = np.array([b.mass for b in bodies.values()]), np.array([b.x for b in bodies.values()])
    times = np.linspace(time[0], time[-1], GRID)
    at = np.interp(times, time, history.distance)[:, None] + place
    curvature = np.array([[d.track.curvature(s)[0] for s in row] for row in at.tolist()])
    cant = np.array([[np.arcsin(d.track.superelevation(s)[0] / d.track.base) for s in row] for row in at.tolist()])
    outwards = np.interp(times, time, history.speeds)[:, None] ** 2 * curvature
    lateral = (mass * (outwards * np.cos(cant) - GRAVITY * np.sin(cant))).sum(axis=1)
    vertical = (mass * (GRAVITY * np.cos(cant) + outwards * np.sin(cant))).sum(axis=1)
    _, applied = history.applied()
    force = history.force.sum(axis=(1, 2)) + applied.sum(axis=1)
    result = []
    for k, axis, needed in ((Y, 1, lateral), (Z, 2, vertical)):
        gained = (mass * (rate[-1, :, k] - rate[0, :, k])).sum()
        left = integral(force[:, axis], time) - integral(needed, times) - gained
        result.append(float(left / (time[-1] - time[0]) / (GRAVITY * mass.sum())))
    return result[0], result[1]


def spin(history: History, turning: Sequence[str]) -> float:
    """Largest mean moment between both wheels of a wheelset, of some that turn by themselves, that is not that of their
    difference of spin, over the largest moment of a wheel.

    Newton's law for each wheel about its axle, whose direction is that of the wheelset's roll and yaw.
    """
    d, time, found = history.dynamics, history.time, 0.0
    for name in turning:
        body, number = d.vehicle.bodies[name], d.vehicle.wheelsets.index(name)
        roll, yaw = (history.coordinate(name, k) for k in (ROLL, YAW))
        axle = np.stack([-np.sin(yaw) * np.cos(roll), np.cos(yaw) * np.cos(roll), np.sin(roll)], axis=1)
        moments = np.einsum("nsk,nk->ns", history.moment[:, number], axle)
        rate = history.state[:, d.coordinates.twist_rates][:, list(d.vehicle.independent).index(name)]
        needed = body.inertia[1] * (rate[-1] - rate[0]) + 4.0 * body.torsion[1] * integral(rate, time)
        left = integral(moments[:, 0] - moments[:, 1], time) - needed
        found = max(found, abs(left) / (time[-1] - time[0]) / max(float(np.abs(moments).max()), 1e-9))
    return found


def beyond_friction(history: History, own: Run) -> float:
    """Largest tangential force of a patch over its bound, by the coefficient of the own wheelset at its own place.

    The bound is mu times the integral of the pressure: the normal force over the cosine of the range of the normals.
    On a flange root, where that is 0.8 rad, full slip is 1.015 of mu times the normal force.
    """
    found, bodies = 0.0, history.dynamics.vehicle.bodies
    for distance, row in zip(history.distance.tolist(), history.rows, strict=True):
        for name, pair in zip(history.dynamics.vehicle.wheelsets, row.patches, strict=True):
            bound = own.coefficient(name, distance + bodies[name].x)
            for patch in (patch for patches in pair for patch in patches):
                range_of_normals = np.cos(min(own.turn(name, *patch.wheel_band), 1.5))
                used = np.hypot(*patch.tangential_force) * range_of_normals / max(bound * patch.normal_force, 1e-9)
                found = max(found, float(used))
    return found


def largest(history: History) -> tuple[Array, Array]:
    """Largest |y| of each wheelset (w,), m, and load of each wheel (w, 2), N."""
    y = [np.abs(history.coordinate(name, Y)).max() for name in history.dynamics.vehicle.wheelsets]
    return np.array(y), history.force[..., 2].max(axis=0)


def off_the_rails(history: History) -> str:
    """Which wheelset or body is off the rails or overturned at the end, by displacements and loads; empty: none."""
    if not len(history):
        return ""
    d, last = history.dynamics, history.state[-1]
    load = history.force[0, ..., 2].mean()
    position = d.coordinates.split(last).position
    for i, (name, shift) in enumerate((name, history.coordinate(name, Y)[-1]) for name in d.vehicle.wheelsets):
        rails = [0.0, 0.0]
        if d.track.irregularities is not None:
            at = float(history.distance[-1]) + d.vehicle.bodies[name].x
            rails = d.track.irregularities.derivatives(np.array([at]))[0][0, [0, 2]].tolist()
        if min(abs(shift - rail) for rail in rails) > CLIMBING:
            return f"{name} is {1e3 * abs(shift):.1f} mm beside the track"
        if history.force[-1, i, :, 2].max() < UNLOADED * load:
            return f"{name} is without load"
    for name, q in zip(d.vehicle.names, position, strict=True):
        if max(abs(q[ROLL]), abs(q[YAW])) > TURNED:
            return f"{name} is turned over"
    return ""


def faults(run: History, short: History, mirrored: History | None, own: Run | None = None) -> Iterator[str]:
    """What of a completed run is wrong.

    Parameters:
        run: with the steps that it chooses.
        short: with short steps and a fifth of the tolerance.
        mirrored: of the mirror image; None: not made.
        own: that was drawn; None: friction and wheels that turn by themselves are not judged.
    """
    if not (np.isfinite(run.state).all() and np.isfinite(run.force).all()):
        yield "states or forces that are no numbers"
        return
    if run.status == "completed":
        if (place := off_the_rails(run)) and "without load" not in place:
            yield f"completed, but {place}"
        for name, part in zip(("lateral", "vertical"), momentum(run), strict=True):
            if abs(part) > MOMENTUM:
                yield f"{name} forces differ by {part:.3f} of the weight from those of the masses"
        if own is not None and (used := beyond_friction(run, own)) > 1.0 + FRICTION:
            yield f"a tangential force of {used:.4g} times the bound of friction"
        if own is not None and (part := spin(short if short.status == "completed" else run, own.turning)) > SPIN:
            yield f"moments between wheels that turn by themselves differ by {part:.3f} from those of their masses"
    yield from unlike(run, short)
    if mirrored is not None and not (
        mirrored.status.split(":")[0] == run.status.split(":")[0]
        and np.array_equal(mirrored.time, run.time)
        and np.array_equal(np.abs(mirrored.state), np.abs(run.state))
    ):
        yield f"the mirror image differs: {mirrored.status}, {len(mirrored)} rows for {len(run)}"


def unlike(run: History, short: History) -> Iterator[str]:
    """Differences to a run with short steps, of how it ends and of the largest values of each wheelset and wheel."""
    if short.status != run.status and "completed" in (run.status, short.status):
        yield f"{run.status}, but with short steps {short.status}"
    elif run.status == "completed":
        load, names = short.force[0, ..., 2].mean(), run.dynamics.vehicle.wheelsets
        bands = ("|y|", Y_BAND, 1.0), ("Q", Q_BAND, load)
        for (name, (least, part), unit), own, other in zip(bands, largest(run), largest(short), strict=True):
            for i, *side in np.argwhere(np.abs(own - other) > least * unit + part * other):
                whose, at = " ".join([names[i], *(SIDES[j] for j in side)]), (i, *side)
                yield f"largest {name} of {whose} {own[at]:.5g}, with short steps {other[at]:.5g}"


def conclusion(
    run: History,
    short: History,
    mirrored: History | None,
    own: Run | None = None,
    nearby: Callable[[], History] | None = None,
) -> tuple[Kind, str]:
    """Kind of a run that ended, and its reason; parameters as for `faults`.

    A run that says why it ended is explained where the vehicle is off the rails, and is so with short steps near there;
    one that differs in largest loads of which it says that steps do not resolve these, too.
    Where `nearby`, a run with short steps and `MORE` friction, differs from the one without as much as the run does,
    data do not settle what the vehicle does: on the edge of derailment. Everything else that is found is wrong.
    """
    if found := [*faults(run, short, mirrored, own)]:
        only_unlike = found == [*unlike(run, short)]
        wheelsets = run.dynamics.vehicle.wheelsets
        told = unresolved_loads(run.time, run.distance, wheelsets, run.force[..., 2])
        rough = tuple(text.split(",")[0].replace("The largest load", "largest Q") for text in told)
        if only_unlike and all(text.startswith(rough) for text in found):
            return "explained failure", f"says that loads are not resolved: {'; '.join(found)}"
        if nearby is not None and only_unlike and (other := [*unlike(nearby(), short)]):
            return "explained failure", f"on an edge: {'; '.join(found)}; by {MORE - 1.0:.1%} more friction {other[0]}"
        return "wrong", "; ".join(found)
    if run.status == "completed":
        return "right", ""
    off = off_the_rails(run) and off_the_rails(short)
    explained = off and abs(run.distance[-1] - short.distance[-1]) < PLACE
    return "explained failure" if explained else "unexplained failure", run.status


def judged(seed: int, limit: float = 60.0, fixed: tuple[tuple[str, float], ...] = ()) -> Verdict:
    """Verdict on the run of a seed.

    Parameters:
        seed: of the random numbers.
        limit: s of processor time of each run.
        fixed: see `Run`.
    """
    own, began = Run(seed, fixed=fixed), process_time()
    line = f"judged({seed}{f', fixed={fixed}' if fixed else ''})"
    model = f"{'wagon' if own.plane else 'vehicle'}, {own.method}"
    try:
        run = own.history(limit)
        seconds = process_time() - began
        if run.status == "interrupted":
            reason = f"no end in {limit:g} s, at t = {run.time[-1]:.3g} of {own.span[1]:.3g} s"
            return Verdict(seed, line, "unexplained failure", reason, (seconds, seconds), model)
        short = own.history(3.0 * limit, SHORT / own.speed)
        compared = short if short.status != "interrupted" else run
        image = replace(own, mirrored=True).history(limit) if seed % 3 == 0 else None

        def nearby() -> History:
            return replace(own, rougher=MORE).history(3.0 * limit, SHORT / own.speed)

        kind, reason = conclusion(run, compared, image, own, nearby)
    except Exception as error:
        kind, reason, seconds = "wrong", f"{type(error).__name__}: {error}", process_time() - began
    return Verdict(seed, line, kind, reason, (seconds, process_time() - began), model)


def at_events(limit: float) -> None:
    """Prints the verdict of each method at each event, with the mirror image."""
    for event, numbers in EVENTS.items():
        for method, number in BY_METHOD.items():
            fixed = tuple((USUAL | {"method": number} | numbers).items())
            if Run(0, fixed=fixed).method == method:
                verdict = judged(0, limit, fixed)
                print(f"{event}, {method}: {verdict.kind} {verdict.reason} ({verdict.seconds[0]:.1f} s)", flush=True)


def main() -> None:
    """Judges and prints."""
    parser = argparse.ArgumentParser(prog="python -m benchmarks.population.runs", description=__doc__)
    parser.add_argument("--count", type=int, default=500, metavar="N", help="runs (500)")
    parser.add_argument("--seed", type=int, default=0, metavar="S", help="of the first run (0)")
    parser.add_argument("--processes", type=int, default=2, metavar="P", help="2")
    parser.add_argument("--only", type=int, nargs="+", default=[], metavar="SEED", help="these runs")
    parser.add_argument("--limit", type=float, default=60.0, metavar="S", help="processor time of a run, s (60)")
    parser.add_argument("--failures", type=Path, default=Path("population_runs.txt"), metavar="FILE")
    parser.add_argument("--events", action="store_true", help="each method at each event, instead")
    arguments = parser.parse_args()
    logging.disable(logging.WARNING)
    if arguments.events:
        at_events(arguments.limit)
        return
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
