"""Equilibrium, steady-state curving, linear modes and critical speed of the vehicle of a run."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager
from dataclasses import replace
from operator import itemgetter
from pathlib import Path
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np

from wheelrail.contact.kinematics.frames import SIDES
from wheelrail.scenes.builders.vehicle import applied_loads, vehicle_on
from wheelrail.scenes.builders.wheelset import run_contact
from wheelrail.scenes.datasets.result_table import Column, Results, ResultTable
from wheelrail.scenes.quantities import RUN
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
    loads, (contact, structures) = applied_loads(scene, vehicle), run_contact(scene, vehicle.wheelsets)
    return VehicleDynamics(vehicle, Track(), contact, speed, structures, loads).with_constant_loads(0.0)


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
    cant = -superelevation if curvature < 0.0 else superelevation
    return ConstantCurve(
        scene.vehicle.first_speed, curvature, cant, line.base, line.widening(s)[0], line.friction(s)[0]
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


class _Wheelset(NamedTuple):
    """A wheelset in equilibrium.

    Parameters:
        name: of the wheelset.
        forces: of its wheels.
        static: mean wheel load of the vehicle at rest, N.
        yaw_reaction: N m; None for a wheelset that yaws.
    """

    name: str
    forces: WheelsetForces
    static: float
    yaw_reaction: float | None


def _column(name: str, of: Callable[[Any], Any], key: str = "") -> Column:
    """Column of a quantity of runs; key: in JSON, its name by default."""
    return Column.showing(RUN[name], of, key or name)


def _wheels(value: Callable[[WheelForces], float]) -> Callable[[_Wheelset], dict[Side, float]]:
    return lambda row: {side: value(wheel) for side, wheel in row.forces.wheels.items()}


def _positions(side: Side) -> Callable[[_Wheelset], list[list[float]]]:
    return lambda row: [[patch.wheel_s, patch.rail_s] for patch in row.forces.wheels[side].patches]


_WHEELSET = (
    Column("wheelset", "wheelset", lambda row: row.name),
    _column("body_y", lambda row: row.forces.y, "y"),
    _column("body_yaw", lambda row: row.forces.yaw, "yaw"),
    _column("vertical_force", _wheels(lambda wheel: wheel.vertical), "wheel_load"),
    _column("guiding_force", _wheels(lambda wheel: wheel.guiding)),
    _column("derailment_quotient", _wheels(lambda wheel: wheel.derailment_quotient)),
    _column("wheel_unloading", lambda row: _wheels(lambda wheel: 1.0 - wheel.vertical / row.static)(row)),
    _column("track_shifting_force", lambda row: row.forces.track_shifting),
    _column("longitudinal_force", _wheels(lambda wheel: wheel.longitudinal)),
    _column("t_gamma", _wheels(lambda wheel: wheel.wear_number), "wear_number"),
    *(Column(f"{side}_positions", f"{side}: position on wheel, on rail", _positions(side), "mm", 1) for side in SIDES),
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


def equilibrium_tables(at: Equilibrium, curve: ConstantCurve | None = None) -> list[ResultTable]:
    """Tables of wheelsets, of bodies and of suspension elements; curve: None on straight track."""
    return [_wheelsets_table(at, curve), _bodies_table(at), _elements_table(at)]


def _wheelsets_table(at: Equilibrium, curve: ConstantCurve | None) -> ResultTable:
    from wheelrail.vehicle.multibody.coordinates import YAW
    from wheelrail.vehicle.multibody.equations import wheelset_wrenches
    from wheelrail.vehicle.multibody.wheel_forces import check_rail_force, wheelset_forces

    d, speed = at.dynamics, at.dynamics.speed_profile(at.time).speed
    columns, where, reactions = [*_WHEELSET, Column("speed", "", lambda row: speed, "m/s")], "straight track", None
    if d.coordinates.held[d.coordinates.wheelset_bodies, YAW].all():
        reactions = d.yaw_reactions(at.time, at.state, wheelset_wrenches(at.contacts)).tolist()
        columns.append(_column("yaw_reaction", lambda row: row.yaw_reaction))
    states = d.wheelset_states(at.time, at.state)
    if d.twists:
        columns.append(_column("wheel_spin", lambda row: [states[row.name].turning_as(s).pitch_rate for s in SIDES]))
    checked = {
        name: {side: check_rail_force(result.patches, side) for side, result in sides.items()}
        for name, sides in at.contacts.items()
    }
    if any(force for sides in checked.values() for force in sides.values()):
        columns.append(_column("check_rail_force", lambda row: checked[row.name]))
    if curve is not None:
        curve = replace(curve, speed=speed)
        where = f"curvature {curve.curvature:.4g} 1/m, cant {1e3 * curve.cant:g} mm"
        columns += [
            Column("curvature", "", lambda row: curve.curvature, "1/m"),
            Column("cant", "", lambda row: curve.cant, "m"),
            Column("cant_deficiency", "cant deficiency", lambda row: curve.deficiency(), "mm", 1),
        ]
    rows = [
        _Wheelset(name, forces, d.vehicle.mean_wheel_load, reactions and reactions[k])
        for k, (name, forces) in enumerate(wheelset_forces(d, at.state, at.contacts, at.time).items())
    ]
    return ResultTable(
        "wheelsets", f"Wheelsets at {speed:g} m/s, wheels left and right: {where}", columns, rows, across=True
    )


def _elements_table(at: Equilibrium) -> ResultTable:
    d, travel = at.dynamics, at.dynamics.speed_profile(at.time)
    states = np.stack(d.bodies.element_states([travel], at.state[None]))[:, 0].tolist()
    columns = [
        Column("speed", "", lambda row: travel.speed, "m/s"),
        Column("element", "element", itemgetter(0)),
        *(_column(f"element_{name}", itemgetter(k), name) for k, name in ((1, "deflection"), (2, "force"))),
    ]
    title = "Suspension elements: x, y, z in their axes, force on the upper body with its static load"
    return ResultTable("elements", title, columns, list(zip(d.vehicle.elements, *states, strict=True)))


def _bodies_table(at: Equilibrium) -> ResultTable:
    from wheelrail.vehicle.multibody.vehicle import COORDINATES

    speed = at.dynamics.speed_profile(0.0).speed
    position, _, _ = at.dynamics.coordinates.split(at.state)
    wheelsets, rows = at.dynamics.vehicle.wheelsets, []
    for name, q in zip(at.dynamics.vehicle.names, position.tolist(), strict=True):
        pitch = {"pitch": None} if name in wheelsets else {}  # they roll
        rows.append({"speed": speed, "body": name, **dict(zip(COORDINATES, q, strict=True)), **pitch})
    columns = [Column("speed", "", itemgetter("speed"), "m/s"), Column("body", "body", itemgetter("body"))]
    for name in COORDINATES:
        columns.append(Column(name, RUN[f"body_{name}"].label, itemgetter(name), RUN[f"body_{name}"].shown))
    title = "Positions from the nominal ones, each in the track frame at its own distance"
    return ResultTable("bodies", title, columns, rows)
