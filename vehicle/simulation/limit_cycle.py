"""Limit cycles of a vehicle on straight track: hunting after a disturbance, over descending speeds."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np

from wheelrail.support.arrays import Array
from wheelrail.vehicle.integration.integrate import StepSettings
from wheelrail.vehicle.integration.rosenbrock import ROSENBROCK4
from wheelrail.vehicle.multibody.coordinates import Coordinates, Y
from wheelrail.vehicle.multibody.equations import VehicleDynamics
from wheelrail.vehicle.simulation.history import History
from wheelrail.vehicle.simulation.simulate import simulate
from wheelrail.vehicle.steady.critical_speed import least_damped
from wheelrail.vehicle.steady.equilibrium import equilibrium
from wheelrail.vehicle.steady.modes import Mode, modes

SAMPLE = 1e-3  # s, of the interpolated displacements: 150 samples a period at 6 Hz


@dataclass(frozen=True)
class CycleSearch:
    """When a motion counts as a limit cycle.

    Parameters:
        window: s, over which an amplitude is the largest displacement; several periods.
        tolerance: of the amplitudes of two windows one after another, relative.
        smallest: m, amplitude below which the linear modes decide: the motion dies out where they decay; where one
            grows, a motion that decreases has a cycle of at most this amplitude.
        longest: s, after which the search ends.
        rtol, atol: tolerances of the steps, of order 4, see `simulate`. Steps are also so short that the method's own
            damping of the least damped mode does not exceed half of what `tolerance` can tell.
    """

    window: float = 1.0
    tolerance: float = 0.02
    smallest: float = 2e-5
    longest: float = 20.0
    rtol: float = 3e-3
    atol: float = 3e-5

    def steps(self, mode: Mode) -> StepSettings:
        """Settings of the steps of a motion near a mode.

        The error of a step does not limit a motion below atol, whose steps grow until the method damps it: by 0.1 1/s
        at eight steps a period.
        """
        damping = 0.5 * self.tolerance / self.window
        longest = ROSENBROCK4.exact.longest_step(mode.eigenvalue.imag, damping)
        return StepSettings(ROSENBROCK4.name, self.rtol, self.atol, max_step=longest)


@dataclass(frozen=True)
class LimitCycle:
    """Motion of w wheelsets in the last window of a search.

    Parameters:
        speed: m/s.
        growth: 1/s of a small motion: the real part of the least damped mode of lateral motion and yaw.
        status: "limit cycle", "dies out", "not settled", or "failed: ..." with the reason.
        amplitude: (w,) m, half the difference of the extreme lateral displacements.
        frequency: Hz, of the wheelset with the largest amplitude; NaN if it died out.
        track_shifting: (w,) N, largest sum of Y, unfiltered.
        frictional_power: W, mean of all wheels.
        duration: s of the motion.
        state: (2 c + m,) at the end.
    """

    speed: float
    growth: float
    status: str
    amplitude: Array
    frequency: float
    track_shifting: Array
    frictional_power: float
    duration: float
    state: Array


def kicked(coordinates: Coordinates, state: Array, velocities: Mapping[str, float]) -> Array:
    """The state with lateral velocities added.

    Parameters:
        coordinates: of the vehicle.
        state: (2 c + m,).
        velocities: m/s to the left, by body.

    Raises ValueError for an unknown body, and for one that is held laterally.
    """
    result = state.copy()
    for body, velocity in velocities.items():
        if body not in coordinates.vehicle.names:
            raise ValueError(f'no body "{body}"; must be one of {", ".join(coordinates.vehicle.names)}')
        if "y" in coordinates.vehicle.bodies[body].held:
            raise ValueError(f"{body}: held laterally; its velocity must not be given")
        result[coordinates.count + coordinates.index(body, Y)] += velocity
    return result


def limit_cycles(
    dynamics: VehicleDynamics, speeds: Sequence[float], kick: Mapping[str, float], search: CycleSearch | None = None
) -> Iterator[LimitCycle]:
    """Motions at one speed after another; the first one starts from a kick, each other one where the last one ended.

    Parameters:
        dynamics: equations of motion on straight track; its speed is not used.
        speeds: m/s; descending ones follow the branch of stable cycles down to the nonlinear critical speed.
        kick: lateral velocities m/s to the left, by body, added to the equilibrium at the first speed.
        search: when a motion counts as a limit cycle.

    A motion that fails is the last one. Raises EquilibriumError, ValueError for an unknown body or one that is held.
    """
    state: Array | None = None
    for speed in speeds:
        at = replace(dynamics, speed=speed)
        if state is None:
            state = kicked(at.coordinates, equilibrium(at).state, kick)
        cycle = limit_cycle(at, state, search)
        yield cycle
        if cycle.status.startswith("failed"):
            return
        state = cycle.state


def fold_bracket(cycles: Sequence[LimitCycle]) -> tuple[LimitCycle, LimitCycle] | None:
    """Motions between whose speeds the limit cycles vanish: the slowest one that keeps a cycle, and the fastest of the
    slower ones that die out; None unless there are both.
    """
    kept = min((c for c in cycles if c.status == "limit cycle"), key=lambda c: c.speed, default=None)
    if kept is None:
        return None
    dying = [c for c in cycles if c.status == "dies out" and c.speed < kept.speed]
    return (kept, max(dying, key=lambda c: c.speed)) if dying else None


def bisected_fold(
    dynamics: VehicleDynamics, cycles: Sequence[LimitCycle], width: float, search: CycleSearch | None = None
) -> Iterator[LimitCycle]:
    """Motions that enclose the nonlinear critical speed, the lowest one with a limit cycle, ever more closely.

    Parameters:
        dynamics: equations of motion on straight track; its speed is not used.
        cycles: motions over descending speeds, see `limit_cycles`; none follow unless `fold_bracket` has both.
        width: largest distance of the two speeds at the end, m/s.
        search: when a motion counts as a limit cycle.

    Each one starts from the cycle at the slowest speed that keeps one. A motion that is neither a limit cycle nor dies
    out is the last one: near the fold both take long, and the bracket remains as wide as it is.
    """
    known = list(cycles)
    while (bracket := fold_bracket(known)) is not None:
        kept, dying = bracket
        if kept.speed - dying.speed <= width:
            return
        known.append(limit_cycle(replace(dynamics, speed=0.5 * (kept.speed + dying.speed)), kept.state, search))
        yield known[-1]
        if known[-1].status not in ("limit cycle", "dies out"):
            return


def limit_cycle(dynamics: VehicleDynamics, initial: Array, search: CycleSearch | None = None) -> LimitCycle:
    """Motion from an initial state until its amplitude is constant or has died out.

    Parameters:
        dynamics: equations of motion on straight track at constant speed.
        initial: (2 c + m,).
        search: when it ends.

    Raises EquilibriumError, and ValueError for a vehicle without such modes.
    """
    search = search or CycleSearch()
    state, before, duration = initial, np.inf, 0.0
    mode = least_damped(m for m in modes(dynamics) if _is_lateral(m))
    steps, growth = search.steps(mode), mode.eigenvalue.real
    while True:
        span = (0.0, search.window)
        history = simulate(dynamics, span, initial=state, steps=steps)
        if history.status != "completed":
            return _cycle(history, history.status, growth, duration)
        state, duration = history.state[-1], duration + search.window
        largest = float(_amplitudes(history).max())
        small, falling = largest < search.smallest, largest <= before < np.inf
        if small and growth < 0.0:
            return _cycle(history, "dies out", growth, duration)
        if abs(largest - before) <= search.tolerance * largest or (small and falling):
            return _cycle(history, "limit cycle", growth, duration)
        if duration >= search.longest:
            return _cycle(history, "not settled", growth, duration)
        before = largest


def _is_lateral(mode: Mode) -> bool:
    """Whether most of the kinetic energy is in lateral motion and yaw, not in vibrations on the contacts."""
    lateral = [name.endswith(("_y", "_yaw")) for name in mode.names]
    return float(mode.energy_fraction[lateral].sum()) > 0.5


def _cycle(history: History, status: str, growth: float, duration: float) -> LimitCycle:
    """Figures of the last window."""
    amplitude = _amplitudes(history)
    time, displacement = _displacements(history)
    alive = status in ("limit cycle", "not settled")
    return LimitCycle(
        history.dynamics.speed_profile(0.0).speed,
        growth,
        status,
        amplitude,
        frequency_of(time, displacement[:, np.argmax(amplitude)]) if alive else np.nan,
        np.abs(history.force[..., 1].sum(axis=2)).max(axis=0),
        _mean(history.time, history.frictional_power.sum(axis=(1, 2))),
        duration,
        history.state[-1],
    )


def _mean(time: Array, values: Array) -> float:
    """Mean over time; NaN for a single row."""
    from scipy.integrate import trapezoid

    return float(trapezoid(values, time) / (time[-1] - time[0])) if len(time) > 1 else float("nan")


def _amplitudes(history: History) -> Array:
    """(w,) m."""
    _, displacement = _displacements(history)
    return np.asarray(0.5 * np.ptp(displacement, axis=0))


def _displacements(history: History) -> tuple[Array, Array]:
    """Times (n,) s and lateral displacements (n, w) m of the wheelsets, interpolated with their velocities."""
    from scipy.interpolate import CubicHermiteSpline

    position, rate, _ = history.dynamics.coordinates.split(history.state)
    wheelsets = history.dynamics.coordinates.wheelset_bodies
    y, y_rate = position[:, wheelsets, Y], rate[:, wheelsets, Y]
    if len(history) < 2:
        return history.time, np.asarray(y)
    time = np.arange(history.time[0], history.time[-1], SAMPLE)
    return time, np.asarray(CubicHermiteSpline(history.time, y, y_rate)(time))


def frequency_of(time: Array, values: Array) -> float:
    """Frequency Hz by the upward crossings of the mean; NaN for fewer than two.

    Parameters:
        time: (n,) s.
        values: (n,).
    """
    centred = values - 0.5 * (values.max() + values.min())
    before = np.flatnonzero((centred[:-1] < 0.0) & (centred[1:] >= 0.0))
    if len(before) < 2:
        return float("nan")
    rise = centred[before + 1] - centred[before]
    crossings = time[before] - centred[before] / rise * (time[before + 1] - time[before])
    return float((len(crossings) - 1) / (crossings[-1] - crossings[0]))
