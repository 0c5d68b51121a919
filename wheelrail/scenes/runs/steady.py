"""Linear modes and steady-state curving of the wagon of a run."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from dataclasses import replace
from typing import TYPE_CHECKING

from wheelrail.scenes.builders.vehicle import track, wagon
from wheelrail.scenes.builders.wheelset import run_contact
from wheelrail.scenes.datasets.number_text import significant
from wheelrail.scenes.datasets.result_table import Column, ResultTable
from wheelrail.scenes.schema.errors import RunFailed
from wheelrail.scenes.schema.scene import RunScene
from wheelrail.support.interrupts import deferred_interrupts

if TYPE_CHECKING:
    from wheelrail.contact.results.result import Patch
    from wheelrail.vehicle.steady.curving import SteadyCurving
    from wheelrail.vehicle.steady.modes import Mode
    from wheelrail.vehicle.track.constant_curve import ConstantCurve


def modes_of(scene: RunScene, speeds: Sequence[float]) -> list[list[Mode]]:
    """Linear modes on straight level track with the contact, at speeds (n,), m/s.

    Raises RunFailed without an equilibrium.
    """
    from wheelrail.vehicle.multibody.plane_wagon import wagon_dynamics
    from wheelrail.vehicle.steady.modes import modes
    from wheelrail.vehicle.track.track import Track

    vehicle, (contact, structure) = wagon(scene), run_contact(scene)
    with failures_as_run_failed():
        return [modes(wagon_dynamics(vehicle, Track(), contact, speed, structure)) for speed in speeds]


def curve_of(scene: RunScene) -> ConstantCurve:
    """The sharpest curve of the track, of 1001 stations."""
    from wheelrail.vehicle.track.constant_curve import ConstantCurve

    line, length = track(scene), scene.track.length
    s = max((length * i / 1000 for i in range(1001)), key=lambda s: abs(line.curvature(s)[0]))
    curvature, superelevation = line.curvature(s)[0], line.superelevation(s)[0]
    return ConstantCurve(
        scene.vehicle.first_speed, curvature, -superelevation if curvature < 0.0 else superelevation, line.base
    )


def curving_of(scene: RunScene, speeds: Sequence[float]) -> list[SteadyCurving]:
    """Steady-state curving at speeds (n,), m/s, by continuation in their order.

    Raises RunFailed without an equilibrium.
    """
    from wheelrail.vehicle.steady.curving import curving_over

    curve, (contact, structure) = curve_of(scene), run_contact(scene)
    with failures_as_run_failed():
        return curving_over(wagon(scene), contact, [replace(curve, speed=speed) for speed in speeds], structure)


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


def curving_table(states: Sequence[SteadyCurving]) -> ResultTable:
    """Table with one column per speed."""
    curve = states[0].curve
    title = f"Steady-state curving: curvature {curve.curvature:.4g} 1/m, cant {1e3 * curve.cant:g} mm"
    return ResultTable("curving", title, _CURVING, states, across=True)


def _positions(patches: Sequence[Patch]) -> list[list[float]]:
    return [[patch.wheel_s, patch.rail_s] for patch in patches]


_CURVING = (
    Column("speed", "speed", lambda s: s.curve.speed, "m/s"),
    Column("curvature", "", lambda s: s.curve.curvature, "1/m"),
    Column("cant", "", lambda s: s.curve.cant, "m"),
    Column("cant_deficiency", "cant deficiency", lambda s: s.curve.deficiency(), "mm", 1),
    Column("wheel_load", "wheel load Q, left, right", lambda s: s.wheel_load, "kN", 2),
    Column("guiding_force", "guiding force Y, positive outwards", lambda s: s.guiding_force, "kN", 2),
    Column("derailment_quotient", "derailment quotient Y/Q", lambda s: s.derailment_quotient, "1", 3),
    Column("lateral_force", "lateral force on the wheelset", lambda s: s.lateral_force, "kN", 2),
    Column("unloading", "wheel unloading", lambda s: s.unloading, "%", 1),
    Column("secondary_deflection", "secondary deflection", lambda s: s.secondary_deflection, "mm", 1),
    Column("bumpstop_force", "bumpstop force", lambda s: s.bumpstop_force, "kN", 2),
    Column("car_body_y", "car body: y", lambda s: s.car_body[0].item(), "mm", 1),
    Column("car_body_roll", "car body: roll", lambda s: s.car_body[2].item(), "mrad", 2),
    Column("wheelset_y", "wheelset: y", lambda s: s.wheelset[0].item(), "mm", 2),
    Column("wheelset_roll", "wheelset: roll", lambda s: s.wheelset[2].item(), "mrad", 3),
    Column("yaw_reaction", "yaw reaction", lambda s: s.yaw_reaction, "kN m", 2),
    Column("left_positions", "left: position on wheel, on rail", lambda s: _positions(s.patches["left"]), "mm", 1),
    Column("right_positions", "right: position on wheel, on rail", lambda s: _positions(s.patches["right"]), "mm", 1),
)
