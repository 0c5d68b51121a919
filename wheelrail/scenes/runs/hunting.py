"""Limit cycles of a vehicle over speed: table and bifurcation diagram."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from functools import partial
from operator import attrgetter
from pathlib import Path
from typing import TYPE_CHECKING

from wheelrail.scenes.datasets.result_table import Column, Results, ResultTable
from wheelrail.scenes.plots.style import SERIES, literal, save, styled
from wheelrail.scenes.quantities import CYCLE
from wheelrail.scenes.runs.run import vehicle_for_run
from wheelrail.scenes.runs.steady import failures_as_run_failed, vehicle_dynamics
from wheelrail.scenes.schema.errors import SceneError
from wheelrail.scenes.schema.scene import RunScene

if TYPE_CHECKING:
    from matplotlib.figure import Figure

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


def hunting_table(cycles: Sequence[LimitCycle], wheelsets: Sequence[str]) -> ResultTable:
    """Table with one row per speed."""
    y = CYCLE["amplitude"]
    columns = [
        _column("speed"),
        Column("status", "status", lambda c: c.status),
        *(Column.showing(y._replace(label=f"{name} y"), partial(_amplitude, k)) for k, name in enumerate(wheelsets)),
        Column("amplitude", "", lambda c: dict(zip(wheelsets, c.amplitude.tolist(), strict=True)), "m"),
        _column("growth"),
        _column("frequency"),
        Column.showing(CYCLE["track_shifting_force"], lambda c: float(c.track_shifting.max()), "track_shifting_force"),
        _column("frictional_power"),
        _column("duration"),
    ]
    title = "Motion on straight track after a kick, each speed from the motion at the one before"
    return ResultTable("cycles", title, columns, sorted(cycles, key=lambda c: -c.speed))


def _column(name: str) -> Column:
    """Column of a number of each cycle."""
    return Column.showing(CYCLE[name], attrgetter(name), name)


def _amplitude(wheelset: int, cycle: LimitCycle) -> float:
    return float(cycle.amplitude[wheelset])


def hunting_results(cycles: Sequence[LimitCycle], wheelsets: Sequence[str], fold: bool) -> Results:
    """Table of cycles; fold: whether the nonlinear critical speed was looked for."""
    from wheelrail.vehicle.simulation.limit_cycle import fold_bracket

    bracket = fold_bracket(cycles)
    facts = {"nonlinear_critical_speed": None if bracket is None else sorted(cycle.speed for cycle in bracket)}
    parts: list[ResultTable | str] = [hunting_table(cycles, wheelsets)]
    if fold:
        parts.append(fold_line(cycles))
    return Results("hunting", parts, facts, {"nonlinear_critical_speed": "m/s"})


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
    ax.set_xlabel(CYCLE["speed"].head)
    ax.set_ylabel(f"amplitude of {CYCLE['amplitude'].head}")
    ax.set_ylim(bottom=0.0)
    ax.legend()
    return figure
