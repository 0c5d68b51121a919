"""Linear modes and steady-state curving of the wagon of a run."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import contextmanager
from dataclasses import replace
from typing import TYPE_CHECKING

from wheelrail.scenes.builders.vehicle import track, wagon
from wheelrail.scenes.builders.wheelset import run_contact
from wheelrail.scenes.datasets.number_text import fixed, significant
from wheelrail.scenes.schema.errors import RunFailed
from wheelrail.scenes.schema.scene import RunScene
from wheelrail.support.interrupts import deferred_interrupts

if TYPE_CHECKING:
    from rich.table import Table

    from wheelrail.contact.kinematics.frames import Side
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


def modes_table(modes: Sequence[Mode], speed: float) -> Table:
    """Table with one row per mode; speed in m/s for its title."""
    from rich.table import Table

    view = Table(title=f"Linear modes on straight track at {speed:g} m/s", title_justify="left")
    for name in ("frequency [Hz]", "damping ratio", "eigenvalue [1/s]"):
        view.add_column(name, justify="right")
    view.add_column("kinetic energy in")
    for m in modes:
        value = significant(m.eigenvalue.real, 4) + (f" ± {significant(m.eigenvalue.imag, 4)}i" if m.oscillates else "")
        view.add_row(significant(m.frequency, 4), f"{m.damping:.4f}", value, m.main_coordinates)
    return view


def curving_table(states: Sequence[SteadyCurving]) -> Table:
    """Table with one column per speed."""
    from rich.table import Table

    curve = states[0].curve
    title = f"Steady-state curving: curvature {curve.curvature:.4g} 1/m, cant {1e3 * curve.cant:g} mm"
    view = Table(title=title, title_justify="left")
    view.add_column("speed [m/s]")
    for s in states:
        view.add_column(f"{s.curve.speed:g}", justify="right")
    for label, text in _ROWS:
        view.add_row(label, *(text(s) for s in states))
    return view


def _positions(patches: Sequence[Patch]) -> str:
    return "\n".join(f"{fixed(1e3 * p.wheel_s, 1)}  {fixed(1e3 * p.rail_s, 1)}" for p in patches) or "-"


def _sides(values: Mapping[Side, float], scale: float, digits: int) -> str:
    return "  ".join(fixed(scale * values[side], digits) for side in values)


_ROWS: tuple[tuple[str, Callable[[SteadyCurving], str]], ...] = (
    ("cant deficiency (mm)", lambda s: f"{1e3 * s.curve.deficiency():.1f}"),
    ("wheel load Q, left, right (kN)", lambda s: _sides(s.wheel_load, 1e-3, 2)),
    ("guiding force Y, positive outwards (kN)", lambda s: _sides(s.guiding_force, 1e-3, 2)),
    ("derailment quotient Y/Q", lambda s: _sides(s.derailment_quotient, 1.0, 3)),
    ("lateral force on the wheelset (kN)", lambda s: f"{1e-3 * s.lateral_force:.2f}"),
    ("wheel unloading (%)", lambda s: f"{1e2 * s.unloading:.1f}"),
    ("secondary deflection (mm)", lambda s: f"{1e3 * s.secondary_deflection:.1f}"),
    ("bumpstop force (kN)", lambda s: f"{1e-3 * s.bumpstop_force:.2f}"),
    ("car body: y (mm), roll (mrad)", lambda s: f"{1e3 * s.car_body[0]:.1f}  {1e3 * s.car_body[2]:.2f}"),
    ("wheelset: y (mm), roll (mrad)", lambda s: f"{1e3 * s.wheelset[0]:.2f}  {1e3 * s.wheelset[2]:.3f}"),
    ("yaw reaction (kN m)", lambda s: f"{1e-3 * s.yaw_reaction:.2f}"),
    ("left: position on wheel, on rail (mm)", lambda s: _positions(s.patches["left"])),
    ("right: position on wheel, on rail (mm)", lambda s: _positions(s.patches["right"])),
)
