"""Equilibrium, steady-state curving, linear modes and critical speed of a vehicle in three dimensions."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from wheelrail.scenes.builders.vehicle import applied_loads, vehicle_on
from wheelrail.scenes.builders.wheelset import wheelset_contact
from wheelrail.scenes.datasets.number_text import fixed, significant
from wheelrail.scenes.runs.steady import curve_of, failures_as_run_failed
from wheelrail.scenes.schema.errors import RunFailed
from wheelrail.scenes.schema.scene import RunScene

if TYPE_CHECKING:
    from rich.table import Table

    from wheelrail.vehicle.multibody.equations import VehicleDynamics
    from wheelrail.vehicle.multibody.wheel_forces import WheelForces, WheelsetForces
    from wheelrail.vehicle.steady.critical_speed import CriticalSpeed
    from wheelrail.vehicle.steady.equilibrium import Equilibrium
    from wheelrail.vehicle.steady.modes import Mode
    from wheelrail.vehicle.track.constant_curve import ConstantCurve

TABLE_DIGITS = 4


def vehicle_dynamics(scene: RunScene, file: Path, speed: float) -> VehicleDynamics:
    """Equations of motion of the vehicle of a file on straight track, with contact, profiles and rails of a scene, and
    its torques and forces of time zero.

    Parameters:
        scene: of a run; its wagon is not used.
        file: vehicle file.
        speed: m/s.

    Raises SceneError, also for wheels of another radius than those of the scene.
    """
    from wheelrail.vehicle.multibody.equations import VehicleDynamics
    from wheelrail.vehicle.track.track import Track

    vehicle = vehicle_on(scene, file)
    loads = applied_loads(scene, vehicle)
    return VehicleDynamics(vehicle, Track(), wheelset_contact(scene), speed, loads=loads).with_constant_loads(0.0)


def vehicle_modes_of(scene: RunScene, file: Path, speeds: Sequence[float]) -> list[list[Mode]]:
    """Linear modes on straight level track at speeds (n,) m/s. Raises RunFailed without an equilibrium, SceneError."""
    from wheelrail.vehicle.steady.critical_speed import modes_over_speed

    dynamics = vehicle_dynamics(scene, file, speeds[0])
    with failures_as_run_failed():
        return modes_over_speed(dynamics, speeds)


def critical_speeds_of(
    scene: RunScene, file: Path, speeds: tuple[float, float], places: int
) -> list[CriticalSpeed | None]:
    """Linear critical speeds on straight level track within a range, None without one: of strips, one for each place of
    their lattice, otherwise a single one.

    Parameters:
        scene: of a run; its wagon is not used.
        file: vehicle file.
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


def straight_equilibria_of(scene: RunScene, file: Path, speeds: Sequence[float]) -> list[Equilibrium]:
    """Equilibrium on straight level track at speeds (n,) m/s. Raises as above."""
    from wheelrail.vehicle.steady.equilibrium import equilibrium

    dynamics = vehicle_dynamics(scene, file, speeds[0])
    with failures_as_run_failed():
        return [equilibrium(replace(dynamics, speed=speed)) for speed in speeds]


def curve_equilibria_of(scene: RunScene, file: Path, speeds: Sequence[float]) -> list[Equilibrium]:
    """Steady position in the sharpest curve of the scene at speeds (n,) m/s. Raises as above."""
    from wheelrail.vehicle.steady.equilibrium import curve_dynamics, equilibrium

    dynamics, curve = vehicle_dynamics(scene, file, speeds[0]), curve_of(scene)
    with failures_as_run_failed():
        return [equilibrium(curve_dynamics(dynamics, replace(curve, speed=speed))) for speed in speeds]


def critical_speed_lines(found: Sequence[CriticalSpeed | None], speeds: tuple[float, float]) -> list[str]:
    """Critical speed, frequency, wavelength and mode as lines of text.

    Parameters:
        found: results, one for each place of the strips: their mean with its standard error.
        speeds: range in which they were looked for, m/s.
    """
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
    error, places = "", ""
    if len(values) > 1:
        error = f" ± {values.std(ddof=1) / np.sqrt(len(values)):.2f}"
        places = f", mean of {len(values)} places of the strips ({values.min():.2f} to {values.max():.2f} m/s)"
    return [
        f"linear critical speed: {values.mean():.2f}{error} m/s ({3.6 * values.mean():.1f} km/h){places}",
        f"frequency: {critical.mode.frequency:.3f} Hz, wavelength: {critical.wavelength:.2f} m",
        f"kinetic energy in: {critical.mode.main_coordinates}",
    ]


@dataclass(frozen=True)
class _Row:
    """A row of the table of wheelsets: label, and text of one wheelset."""

    label: str
    text: Callable[[WheelsetForces], str]


def _wheels(value: Callable[[WheelForces], float], scale: float, digits: int) -> Callable[[WheelsetForces], str]:
    return lambda w: "  ".join(fixed(scale * value(wheel), digits) for wheel in (w.left, w.right))


_ROWS = (
    _Row("lateral displacement y (mm)", lambda w: fixed(1e3 * w.y, 3)),
    _Row("yaw (mrad)", lambda w: fixed(1e3 * w.yaw, 3)),
    _Row("wheel load Q, left, right (kN)", _wheels(lambda wheel: wheel.vertical, 1e-3, 2)),
    _Row("guiding force Y, positive outwards (kN)", _wheels(lambda wheel: wheel.guiding, 1e-3, 2)),
    _Row("derailment quotient Y/Q", _wheels(lambda wheel: wheel.derailment_quotient, 1.0, 3)),
    _Row("sum of Y, positive to the right (kN)", lambda w: fixed(1e-3 * w.track_shifting, 2)),
    _Row("longitudinal force on the wheel (kN)", _wheels(lambda wheel: wheel.longitudinal, 1e-3, 2)),
    _Row("wear number T gamma (N)", _wheels(lambda wheel: wheel.wear_number, 1.0, 1)),
)


def wheelsets_table(at: Equilibrium, curve: ConstantCurve | None = None) -> Table:
    """Table of attitude and forces with one column per wheelset; curve for its title."""
    from rich.table import Table

    from wheelrail.vehicle.multibody.wheel_forces import wheelset_forces

    speed = at.dynamics.speed_profile(0.0).speed
    where = "straight track" if curve is None else f"curvature {curve.curvature:.4g} 1/m, cant {1e3 * curve.cant:g} mm"
    table = Table(title=f"Wheelsets at {speed:g} m/s: {where}", title_justify="left")
    forces = wheelset_forces(at.dynamics, at.state, at.contacts)
    table.add_column("")
    for name in forces:
        table.add_column(name, justify="right")
    for line in _ROWS:
        table.add_row(line.label, *(line.text(w) for w in forces.values()))
    return table


def bodies_table(at: Equilibrium) -> Table:
    """Table of the positions of all bodies."""
    from rich.table import Table

    from wheelrail.vehicle.multibody.vehicle import COORDINATES

    table = Table(
        title="Positions from the nominal ones, each in the track frame at its own distance", title_justify="left"
    )
    for label in ("body", "x [mm]", "y [mm]", "z [mm]", "roll [mrad]", "pitch [mrad]", "yaw [mrad]"):
        table.add_column(label, justify="left" if label == "body" else "right")
    position, _, _ = at.dynamics.coordinates.split(at.state)
    wheelsets = at.dynamics.vehicle.wheelsets
    for name, q in zip(at.dynamics.vehicle.names, position.tolist(), strict=True):
        texts = [significant(1e3 * value, TABLE_DIGITS) for value in q]
        if name in wheelsets:  # they roll
            texts[COORDINATES.index("pitch")] = "-"
        table.add_row(name, *texts)
    return table
