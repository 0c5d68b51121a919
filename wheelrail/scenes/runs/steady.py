"""What a run's wagon does without a run: its linear modes, and its steady positions in the curve of the scene."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import contextmanager
from dataclasses import replace
from typing import TYPE_CHECKING

from wheelrail.scenes.builders.vehicle import track, wagon
from wheelrail.scenes.builders.wheelset import wheelset_contact
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
    """On straight level track at speeds m/s, the contact included. Raises RunFailed where no equilibrium is found."""
    from wheelrail.vehicle.dynamics.equations import Dynamics
    from wheelrail.vehicle.steady.modes import modes
    from wheelrail.vehicle.track.track import Track

    given, contact = wagon(scene), wheelset_contact(scene)
    with _failures_told():
        return [modes(Dynamics(given, Track(), contact, speed)) for speed in speeds]


def curve_of(scene: RunScene) -> ConstantCurve:
    """Where the scene's track is sharpest."""
    from wheelrail.vehicle.track.constant_curve import ConstantCurve

    line, length = track(scene), scene.track.length
    s = max((length * i / 1000 for i in range(1001)), key=lambda s: abs(line.curvature(s)[0]))
    curvature, lift = line.curvature(s)[0], line.lift(s)[0]
    return ConstantCurve(scene.vehicle.first_speed, curvature, -lift if curvature < 0.0 else lift, line.base)


def curving_of(scene: RunScene, speeds: Sequence[float]) -> list[SteadyCurving]:
    """At the speeds m/s, in their order, from one to the next. Raises RunFailed where no equilibrium is found."""
    from wheelrail.vehicle.steady.curving import curving_over

    curve, contact = curve_of(scene), wheelset_contact(scene)
    with _failures_told():
        return curving_over(wagon(scene), contact, [replace(curve, speed=speed) for speed in speeds])


@contextmanager
def _failures_told() -> Iterator[None]:
    from wheelrail.vehicle.integration.problem import StepFailure
    from wheelrail.vehicle.steady.equilibrium import EquilibriumError

    try:
        with deferred_interrupts():
            yield
    except (EquilibriumError, StepFailure) as error:
        raise RunFailed(str(error)) from error


def modes_table(found: Sequence[Mode], speed: float) -> Table:
    """A row for each mode."""
    from rich.table import Table

    view = Table(title=f"Linear modes on straight track at {speed:g} m/s", title_justify="left")
    for name in ("frequency [Hz]", "damping ratio", "eigenvalue [1/s]"):
        view.add_column(name, justify="right")
    view.add_column("kinetic energy in")
    for m in found:
        value = f"{m.eigenvalue.real:.4g}" + (f" ± {m.eigenvalue.imag:.4g}i" if m.swings else "")
        view.add_row(f"{m.frequency:.4g}", f"{m.damping:.4f}", value, m.moving)
    return view


def curving_table(found: Sequence[SteadyCurving]) -> Table:
    """A column for each speed."""
    from rich.table import Table

    curve = found[0].curve
    title = f"Steady in a curve of {curve.curvature:.4g} 1/m, cant {1e3 * curve.cant:g} mm"
    view = Table(title=title, title_justify="left")
    view.add_column("speed [m/s]")
    for s in found:
        view.add_column(f"{s.curve.speed:g}", justify="right")
    for label, text in _ROWS:
        view.add_row(label, *(text(s) for s in found))
    return view


def _places(patches: Sequence[Patch]) -> str:
    return "\n".join(f"{1e3 * p.wheel_s:.1f}  {1e3 * p.rail_s:.1f}" for p in patches) or "-"


def _sides(values: Mapping[Side, float], scale: float, digits: int) -> str:
    return "  ".join(f"{scale * values[side]:.{digits}f}" for side in values)


_ROWS: tuple[tuple[str, Callable[[SteadyCurving], str]], ...] = (
    ("cant deficiency (mm)", lambda s: f"{1e3 * s.curve.deficiency():.1f}"),
    ("wheel load Q, left, right (kN)", lambda s: _sides(s.wheel_load, 1e-3, 2)),
    ("guiding force Y, outwards (kN)", lambda s: _sides(s.guiding_force, 1e-3, 2)),
    ("derailment quotient Y/Q", lambda s: _sides(s.derailment_quotient, 1.0, 3)),
    ("lateral force on the wheelset (kN)", lambda s: f"{1e-3 * s.lateral_force:.2f}"),
    ("unloading of the lighter wheel (%)", lambda s: f"{1e2 * s.unloading:.1f}"),
    ("secondary deflection (mm)", lambda s: f"{1e3 * s.secondary_deflection:.1f}"),
    ("bumpstop force (kN)", lambda s: f"{1e-3 * s.bumpstop_force:.2f}"),
    ("car body: y (mm), roll (mrad)", lambda s: f"{1e3 * s.car_body[0]:.1f}  {1e3 * s.car_body[2]:.2f}"),
    ("wheelset: y (mm), roll (mrad)", lambda s: f"{1e3 * s.wheelset[0]:.2f}  {1e3 * s.wheelset[2]:.3f}"),
    ("yaw reaction (kN m)", lambda s: f"{1e-3 * s.yaw_reaction:.2f}"),
    ("left: on the wheel, on the rail (mm)", lambda s: _places(s.patches["left"])),
    ("right: on the wheel, on the rail (mm)", lambda s: _places(s.patches["right"])),
)
