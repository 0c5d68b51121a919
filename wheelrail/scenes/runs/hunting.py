"""Limit cycles of a vehicle over speed: table and bifurcation diagram."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from wheelrail.scenes.datasets.number_text import fixed
from wheelrail.scenes.plots.style import SERIES, literal, save, styled
from wheelrail.scenes.runs.steady import failures_as_run_failed
from wheelrail.scenes.runs.vehicle_run import vehicle_for_run
from wheelrail.scenes.runs.vehicle_steady import vehicle_dynamics
from wheelrail.scenes.schema.errors import SceneError
from wheelrail.scenes.schema.scene import RunScene

if TYPE_CHECKING:
    from matplotlib.figure import Figure
    from rich.table import Table

    from wheelrail.vehicle.simulation.limit_cycle import CycleSearch, LimitCycle


def hunting_of(
    scene: RunScene, file: Path, speeds: Sequence[float], search: CycleSearch, width: float | None = None
) -> Iterator[LimitCycle]:
    """Limit cycles on straight track at one speed after another, from the kick of a scene.

    Parameters:
        scene: of a run with a kick; its wagon and track are not used.
        file: vehicle file.
        speeds: m/s.
        search: when a motion counts as a limit cycle.
        width: m/s, to which the nonlinear critical speed is enclosed by bisection afterwards; None: not at all.

    Raises SceneError for a scene without a kick, RunFailed without an equilibrium.
    """
    from wheelrail.vehicle.simulation.limit_cycle import bisected_fold, limit_cycles

    if not scene.kick:
        raise SceneError("kick: missing: must give lateral velocities of bodies, m/s")
    vehicle_for_run(scene, file)
    with failures_as_run_failed():
        dynamics, cycles = vehicle_dynamics(scene, file, speeds[0]), []
        for cycle in limit_cycles(dynamics, speeds, scene.kick, search):
            cycles.append(cycle)
            yield cycle
        if width is not None:
            yield from bisected_fold(dynamics, cycles, width, search)


def fold_line(cycles: Sequence[LimitCycle]) -> str:
    """The nonlinear critical speed in words, with its bracket."""
    from wheelrail.vehicle.simulation.limit_cycle import fold_bracket

    bracket = fold_bracket(cycles)
    if bracket is None:
        return "nonlinear critical speed: needs a speed that keeps a limit cycle and a lower one at which it dies out"
    kept, dying = bracket
    text = f"between {dying.speed:g} m/s (dies out) and {kept.speed:g} m/s (limit cycle)"
    return f"nonlinear critical speed, of the branch of this kick: {text}"


def hunting_table(cycles: Sequence[LimitCycle], wheelsets: Sequence[str]) -> Table:
    """Table with one row per speed."""
    from rich.table import Table

    title = "Motion on straight track after a kick, each speed from the motion at the one before"
    table = Table(title=title, title_justify="left")
    for name in ("speed [m/s]", "status", *(f"{name} y [mm]" for name in wheelsets)):
        table.add_column(name, justify="left" if name == "status" else "right")
    for name in (
        "growth of small motions [1/s]",
        "frequency [Hz]",
        "sum of Y [kN]",
        "frictional power [kW]",
        "duration [s]",
    ):
        table.add_column(name, justify="right")
    for cycle in sorted(cycles, key=lambda c: -c.speed):
        table.add_row(
            f"{cycle.speed:g}",
            cycle.status,
            *(fixed(1e3 * value, 3) for value in cycle.amplitude),
            fixed(cycle.growth, 3),
            fixed(cycle.frequency, 3) if np.isfinite(cycle.frequency) else "-",
            fixed(1e-3 * float(cycle.track_shifting.max()), 2),
            fixed(1e-3 * cycle.frictional_power, 3),
            fixed(cycle.duration, 1),
        )
    return table


def draw_bifurcation(cycles: Sequence[LimitCycle], wheelsets: Sequence[str], file: Path) -> None:
    """Save the bifurcation diagram: amplitude of every wheelset over speed, and where the cycles vanish."""
    with styled():
        save(_bifurcation(cycles, wheelsets), file)


def _bifurcation(cycles: Sequence[LimitCycle], wheelsets: Sequence[str]) -> Figure:
    from matplotlib.figure import Figure

    from wheelrail.vehicle.simulation.limit_cycle import fold_bracket

    figure = Figure(figsize=(5.2, 3.6), layout="constrained")
    ax = figure.subplots()
    cycles = sorted(cycles, key=lambda c: c.speed)
    speeds, bracket = [cycle.speed for cycle in cycles], fold_bracket(cycles)
    if bracket is not None:
        label = f"the cycle vanishes\nbetween {bracket[1].speed:g} and {bracket[0].speed:g} m/s"
        ax.axvspan(bracket[1].speed, bracket[0].speed, color="0.85", label=label)
    for i, name in enumerate(wheelsets):
        ax.plot(speeds, [1e3 * c.amplitude[i] for c in cycles], label=literal(name), **SERIES[i % len(SERIES)])
    ax.set_title("Amplitude of the lateral motion over speed")
    ax.set_xlabel("speed [m/s]")
    ax.set_ylabel("amplitude of y [mm]")
    ax.set_ylim(bottom=0.0)
    ax.legend()
    return figure
