"""Equilibrium, steady-state curving, linear modes and critical speed of the vehicle of a run."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager
from dataclasses import replace
from operator import itemgetter
from pathlib import Path
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np

from wheelrail.scenes.builders.vehicle import applied_loads, vehicle_on
from wheelrail.scenes.builders.wheelset import run_contact
from wheelrail.scenes.datasets.result_table import Column, Results, ResultTable
from wheelrail.scenes.quantity import significant
from wheelrail.scenes.schema.errors import RunFailed
from wheelrail.scenes.schema.scene import RunScene
from wheelrail.support.interrupts import deferred_interrupts

if TYPE_CHECKING:
    from wheelrail.contact.kinematics.frames import Side
    from wheelrail.vehicle.multibody.equations import VehicleDynamics
    from wheelrail.vehicle.multibody.wheel_forces import WheelForces, WheelsetForces
    from wheelrail.vehicle.steady.critical_speed import CriticalSpeed
    from wheelrail.vehicle.steady.equilibrium import Equilibrium
    from wheelrail.vehicle.steady.modes import Mode
    from wheelrail.vehicle.track.constant_curve import ConstantCurve


def vehicle_dynamics(scene: RunScene, file: Path | None, speed: float) -> VehicleDynamics:
    """Equations of motion of the vehicle of a run on straight track, with torques and forces of time zero.

    Parameters:
        scene: of a run.
        file: vehicle file; None: the plane wagon of the scene.
        speed: m/s.

    Raises SceneError as `vehicle_on`.
    """
    from wheelrail.vehicle.multibody.equations import VehicleDynamics
    from wheelrail.vehicle.track.track import Track

    vehicle = vehicle_on(scene, file)
    loads, (contact, structure) = applied_loads(scene, vehicle), run_contact(scene)
    return VehicleDynamics(vehicle, Track(), contact, speed, structure, loads).with_constant_loads(0.0)


def modes_of(scene: RunScene, file: Path | None, speeds: Sequence[float]) -> list[list[Mode]]:
    """Linear modes on straight level track at speeds (n,) m/s. Raises RunFailed without an equilibrium, SceneError."""
    from wheelrail.vehicle.steady.critical_speed import modes_over_speed

    dynamics = vehicle_dynamics(scene, file, speeds[0])
    with failures_as_run_failed():
        return modes_over_speed(dynamics, speeds)


def critical_speeds_of(
    scene: RunScene, file: Path | None, speeds: tuple[float, float], places: int
) -> list[CriticalSpeed | None]:
    """Linear critical speeds on straight level track within a range, None without one: of strips, one for each place of
    their lattice, otherwise a single one.

    Parameters:
        scene: of a run.
        file: vehicle file; None: the plane wagon of the scene.
        speeds: lowest and highest of the range, m/s.
        places: of the lattice, evenly over the width of a strip.

    Raises as above.
    """
    from wheelrail.contact.models.strip_places import at_places
    from wheelrail.vehicle.steady.critical_speed import critical_speed

    dynamics = vehicle_dynamics(scene, file, speeds[0])
    try:
        with failures_as_run_failed():
            return [
                critical_speed(replace(dynamics, contact=contact), speeds)
                for contact in at_places(dynamics.contact, places)
            ]
    except ValueError as error:
        raise RunFailed(str(error)) from error


def curve_of(scene: RunScene) -> ConstantCurve:
    """The sharpest curve of the track, of 1001 stations."""
    from wheelrail.vehicle.track.constant_curve import ConstantCurve

    line, length = scene.track.track(), scene.track.length
    s = max((length * i / 1000 for i in range(1001)), key=lambda s: abs(line.curvature(s)[0]))
    curvature, superelevation = line.curvature(s)[0], line.superelevation(s)[0]
    return ConstantCurve(
        scene.vehicle.first_speed, curvature, -superelevation if curvature < 0.0 else superelevation, line.base
    )


def equilibria_of(
    scene: RunScene, file: Path | None, speeds: Sequence[float], curve: ConstantCurve | None = None
) -> list[Equilibrium]:
    """Steady positions at speeds (n,) m/s on straight level track, or in a curve, each the guess of the next one.

    Raises as `modes_of`.
    """
    from wheelrail.vehicle.steady.equilibrium import equilibria

    dynamics = vehicle_dynamics(scene, file, speeds[0])
    if curve is not None:
        dynamics = replace(dynamics, track=curve.track)
    with failures_as_run_failed():
        return equilibria(dynamics, speeds)


@contextmanager
def failures_as_run_failed() -> Iterator[None]:
    """Raise RunFailed for an equilibrium that is not found and for a contact that fails."""
    from wheelrail.vehicle.integration.problem import StepFailure
    from wheelrail.vehicle.steady.equilibrium import EquilibriumError

    try:
        with deferred_interrupts():
            yield
    except (EquilibriumError, StepFailure) as error:
        raise RunFailed(str(error)) from error


def modes_table(modes: Sequence[Mode], speed: float) -> ResultTable:
    """Table with one row per mode; speed in m/s for its title."""
    title = f"Linear modes on straight track at {speed:g} m/s"
    return ResultTable("modes", title, [Column("speed", "", lambda m: speed, "m/s"), *_MODE], modes)


def _eigenvalue(mode: Mode) -> str:
    value = mode.eigenvalue
    return significant(value.real, 4) + (f" ± {significant(value.imag, 4)}i" if mode.oscillates else "")


_MODE = (
    Column("frequency", "frequency", lambda m: m.frequency, "Hz"),
    Column("damping_ratio", "damping ratio", lambda m: m.damping, "1", 4),
    Column("", "eigenvalue [1/s]", _eigenvalue),
    Column("eigenvalue", "", lambda m: [m.eigenvalue.real, m.eigenvalue.imag], "1/s"),
    Column("", "kinetic energy in", lambda m: m.main_coordinates),
    Column("kinetic_energy", "", lambda m: dict(zip(m.names, m.energy_fraction, strict=True)), "1"),
)


class _Curving(NamedTuple):
    """Steady position of the plane wagon in a curve.

    Parameters:
        curve: curve and speed.
        forces: of the wheels.
        position: m and rad by body and coordinate, as "car_body_y".
        elements: lateral deflection m of each suspension element, and its force N on the upper body.
        yaw_reaction: N m.
    """

    curve: ConstantCurve
    forces: WheelsetForces
    position: dict[str, float]
    elements: dict[str, tuple[float, float]]
    yaw_reaction: float


def curving_table(states: Sequence[Equilibrium], curve: ConstantCurve) -> ResultTable:
    """Table of the plane wagon with one column per speed; curve: that of the states, at any speed."""
    from wheelrail.vehicle.multibody.coordinates import Y
    from wheelrail.vehicle.multibody.equations import wheelset_wrenches
    from wheelrail.vehicle.multibody.wheel_forces import wheelset_forces

    rows = []
    for at in states:
        d, travel = at.dynamics, at.dynamics.speed_profile(at.time)
        (forces,) = wheelset_forces(d, at.state, at.contacts, at.time).values()
        lateral = np.stack(d.bodies.element_states([travel], at.state[None]))[:, 0, :, Y].T.tolist()
        rows.append(
            _Curving(
                replace(curve, speed=travel.speed),
                forces,
                dict(zip(d.coordinates.names, at.state.tolist(), strict=False)),
                {name: (m, n) for name, (m, n) in zip(d.vehicle.elements, lateral, strict=True)},
                d.yaw_reactions(at.time, at.state, wheelset_wrenches(at.contacts)).item(),
            )
        )
    title = f"Steady-state curving: curvature {curve.curvature:.4g} 1/m, cant {1e3 * curve.cant:g} mm"
    return ResultTable("curving", title, _CURVING, rows, across=True)


def _unloading(row: _Curving) -> float:
    """Relative reduction of the load of the lighter wheel."""
    loads = [wheel.vertical for wheel in row.forces.wheels.values()]
    return 1.0 - 2.0 * min(loads) / sum(loads)


def _secondary(row: _Curving) -> float:
    """Lateral deflection of the secondary springs, mean of both sides, m."""
    return 0.5 * (row.elements["left_secondary_spring"][0] + row.elements["right_secondary_spring"][0])


def _positions(side: Side) -> Callable[[_Curving], list[list[float]]]:
    return lambda row: [[patch.wheel_s, patch.rail_s] for patch in row.forces.wheels[side].patches]


class _Wheelset(NamedTuple):
    """Name and forces of a wheelset."""

    name: str
    forces: WheelsetForces


def _wheels(value: Callable[[WheelForces], float]) -> Callable[[_Wheelset | _Curving], dict[Side, float]]:
    return lambda row: {side: value(wheel) for side, wheel in row.forces.wheels.items()}


_FORCES = (
    Column("wheel_load", "wheel load Q, left, right", _wheels(lambda wheel: wheel.vertical), "kN", 2),
    Column("guiding_force", "guiding force Y, positive outwards", _wheels(lambda wheel: wheel.guiding), "kN", 2),
    Column("derailment_quotient", "derailment quotient Y/Q", _wheels(lambda w: w.derailment_quotient), "1", 3),
)
_CURVING = (
    Column("speed", "speed", lambda s: s.curve.speed, "m/s"),
    Column("curvature", "", lambda s: s.curve.curvature, "1/m"),
    Column("cant", "", lambda s: s.curve.cant, "m"),
    Column("cant_deficiency", "cant deficiency", lambda s: s.curve.deficiency(), "mm", 1),
    *_FORCES,
    Column("lateral_force", "lateral force on the wheelset", lambda s: s.forces.track_shifting, "kN", 2),
    Column("unloading", "wheel unloading", _unloading, "%", 1),
    Column("secondary_deflection", "secondary deflection", _secondary, "mm", 1),
    Column("bumpstop_force", "bumpstop force", lambda s: s.elements["bumpstop"][1] + 0.0, "kN", 2),  # never -0
    Column("car_body_y", "car body: y", lambda s: s.position["car_body_y"], "mm", 1),
    Column("car_body_roll", "car body: roll", lambda s: s.position["car_body_roll"], "mrad", 2),
    Column("wheelset_y", "wheelset: y", lambda s: s.position["wheelset_y"], "mm", 2),
    Column("wheelset_roll", "wheelset: roll", lambda s: s.position["wheelset_roll"], "mrad", 3),
    Column("yaw_reaction", "yaw reaction", lambda s: s.yaw_reaction, "kN m", 2),
    Column("left_positions", "left: position on wheel, on rail", _positions("left"), "mm", 1),
    Column("right_positions", "right: position on wheel, on rail", _positions("right"), "mm", 1),
)
_WHEELSET = (
    Column("wheelset", "wheelset", lambda row: row.name),
    Column("y", "lateral displacement y", lambda row: row.forces.y, "mm", 3),
    Column("yaw", "yaw", lambda row: row.forces.yaw, "mrad", 3),
    *_FORCES,
    Column("track_shifting_force", "sum of Y, positive to the right", lambda r: r.forces.track_shifting, "kN", 2),
    Column("longitudinal_force", "longitudinal force on the wheel", _wheels(lambda w: w.longitudinal), "kN", 2),
    Column("wear_number", "wear number T gamma", _wheels(lambda wheel: wheel.wear_number), "N", 1),
)


def critical_speed_results(found: Sequence[CriticalSpeed | None], speeds: tuple[float, float]) -> Results:
    """Critical speed, frequency, wavelength and mode.

    Parameters:
        found: results, one for each place of the strips: their mean with its standard error.
        speeds: range in which they were looked for, m/s.
    """
    facts: dict[str, Any] = {
        "range": speeds,
        "critical_speeds": [one and one.speed for one in found],
        **dict.fromkeys(("critical_speed", "standard_error", "frequency", "wavelength", "kinetic_energy")),
    }
    lines = _critical_speed(found, speeds, facts)
    return Results("critical", ["\n".join(lines)], facts, CRITICAL_UNITS)


CRITICAL_UNITS = {
    **dict.fromkeys(("range", "critical_speeds", "critical_speed", "standard_error"), "m/s"),
    "frequency": "Hz",
    "wavelength": "m",
    "kinetic_energy": "1",
}


def _critical_speed(
    found: Sequence[CriticalSpeed | None], speeds: tuple[float, float], facts: dict[str, Any]
) -> list[str]:
    """Lines of text; enters the mean of the critical speeds, its error and the mode, if there is one, in the facts."""
    low, high = (f"{speed:g} m/s" for speed in speeds)
    known = [one for one in found if one is not None]
    if len(known) < len(found):
        some = "" if not known else f" at {len(found) - len(known)} of {len(found)} places of the strips"
        return [f"no linear critical speed from {low} to {high}{some}: all modes above 0.8 Hz are damped"]
    lowest = min(known, key=lambda one: one.speed)
    if lowest.speed == speeds[0]:
        return [f"already unstable at {low}: {lowest.mode}"]
    values = np.array([one.speed for one in known])
    critical = known[int(np.argmin(np.abs(values - values.mean())))]
    mode, error, places = critical.mode, "", ""
    facts |= {
        "critical_speed": values.mean(),
        "frequency": mode.frequency,
        "wavelength": critical.wavelength,
        "kinetic_energy": dict(zip(mode.names, mode.energy_fraction, strict=True)),
    }
    if len(values) > 1:
        facts["standard_error"] = values.std(ddof=1) / np.sqrt(len(values))
        error = f" ± {facts['standard_error']:.2f}"
        places = f", mean of {len(values)} places of the strips ({values.min():.2f} to {values.max():.2f} m/s)"
    return [
        f"linear critical speed: {values.mean():.2f}{error} m/s ({3.6 * values.mean():.1f} km/h){places}",
        f"frequency: {mode.frequency:.3f} Hz, wavelength: {critical.wavelength:.2f} m",
        f"kinetic energy in: {mode.main_coordinates}",
    ]


def wheelsets_table(at: Equilibrium, curve: ConstantCurve | None = None) -> ResultTable:
    """Table of attitude and forces with one column per wheelset; curve for its title."""
    from wheelrail.vehicle.multibody.wheel_forces import wheelset_forces

    speed = at.dynamics.speed_profile(0.0).speed
    where = "straight track" if curve is None else f"curvature {curve.curvature:.4g} 1/m, cant {1e3 * curve.cant:g} mm"
    rows = [_Wheelset(*own) for own in wheelset_forces(at.dynamics, at.state, at.contacts).items()]
    columns = [*_WHEELSET, Column("speed", "", lambda row: speed, "m/s")]
    return ResultTable("wheelsets", f"Wheelsets at {speed:g} m/s: {where}", columns, rows, across=True)


def bodies_table(at: Equilibrium) -> ResultTable:
    """Table of the positions of all bodies."""
    from wheelrail.vehicle.multibody.vehicle import COORDINATES

    speed = at.dynamics.speed_profile(0.0).speed
    position, _, _ = at.dynamics.coordinates.split(at.state)
    wheelsets, rows = at.dynamics.vehicle.wheelsets, []
    for name, q in zip(at.dynamics.vehicle.names, position.tolist(), strict=True):
        pitch = {"pitch": None} if name in wheelsets else {}  # they roll
        rows.append({"speed": speed, "body": name, **dict(zip(COORDINATES, q, strict=True)), **pitch})
    columns = [Column("speed", "", itemgetter("speed"), "m/s"), Column("body", "body", itemgetter("body"))]
    for name in COORDINATES:
        columns.append(Column(name, name, itemgetter(name), "mm" if name in "xyz" else "mrad"))
    title = "Positions from the nominal ones, each in the track frame at its own distance"
    return ResultTable("bodies", title, columns, rows)
