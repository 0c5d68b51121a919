"""Linear modes of a vehicle over speed, and its linear critical speed."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass, replace
from itertools import pairwise

import numpy as np

from wheelrail.support.arrays import Array
from wheelrail.vehicle.multibody.equations import VehicleDynamics
from wheelrail.vehicle.steady.equilibrium import equilibria, equilibrium
from wheelrail.vehicle.steady.modes import Mode, modes

SLOWEST = 0.8  # Hz: slower modes, of creep along the track and of the speed hold, are no instability of the running


@dataclass(frozen=True)
class CriticalSpeed:
    """Lowest speed of a range at which a mode is no longer damped.

    Parameters:
        speed: m/s.
        mode: with the largest real part at this speed.
    """

    speed: float
    mode: Mode

    @property
    def wavelength(self) -> float:
        """Of the motion along the track, m."""
        return self.speed / self.mode.frequency


def modes_over_speed(dynamics: VehicleDynamics, speeds: Sequence[float]) -> list[list[Mode]]:
    """Linear modes on the track of the dynamics at speeds (n,) m/s, each equilibrium the guess of the next one.

    Raises EquilibriumError, StepFailure.
    """
    return [modes(at.dynamics, at) for at in equilibria(dynamics, speeds)]


def least_damped(candidates: Iterable[Mode]) -> Mode:
    """The oscillating mode above 0.8 Hz with the largest real part. Raises ValueError without such a mode."""
    fast = [mode for mode in candidates if mode.eigenvalue.imag > 2 * np.pi * SLOWEST]
    if not fast:
        raise ValueError(f"no mode oscillates above {SLOWEST:g} Hz")
    return max(fast, key=lambda mode: mode.eigenvalue.real)


def critical_speed(
    dynamics: VehicleDynamics, speeds: tuple[float, float], *, interval: float = 10.0, tolerance: float = 0.01
) -> CriticalSpeed | None:
    """Linear critical speed on the track of the dynamics: the largest real part of the eigenvalues crosses zero.

    Parameters:
        dynamics: equations of motion.
        speeds: lowest and highest of the range, m/s.
        interval: largest distance of the speeds between which a crossing is looked for, m/s.
        tolerance: of the critical speed, m/s.

    Returns None if all modes are damped at all speeds looked at; the lowest speed if one is not damped there. Raises
    EquilibriumError, StepFailure, and ValueError for a range that is not positive and increasing.
    """
    from scipy.optimize import brentq

    if not 0.0 < speeds[0] < speeds[1]:
        raise ValueError(f"speeds {speeds} m/s: must be positive and increase")
    at_speeds: dict[float, Mode] = {}
    guess: Array | None = None

    def growth(speed: float) -> float:
        nonlocal guess
        if speed not in at_speeds:
            at = equilibrium(replace(dynamics, speed=speed), guess=guess)
            guess, at_speeds[speed] = at.state, least_damped(modes(at.dynamics, at))
        return at_speeds[speed].eigenvalue.real

    count = int(np.ceil((speeds[1] - speeds[0]) / interval)) + 1
    samples = np.linspace(*speeds, count).tolist()
    if growth(samples[0]) >= 0.0:
        return CriticalSpeed(samples[0], at_speeds[samples[0]])
    for low, high in pairwise(samples):
        if growth(high) >= 0.0:
            speed = float(brentq(growth, low, high, xtol=tolerance, rtol=1e-12))
            growth(speed)
            return CriticalSpeed(speed, at_speeds[speed])
    return None
