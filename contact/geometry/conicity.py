"""Equivalent conicity of a wheelset on track from its rolling radius difference, EN 15302."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from scipy.optimize import brentq
from scipy.special import roots_legendre

from wheelrail.support.arrays import Array

POINTS = 400
ROUNDING = 1e-9  # of an amplitude that is as large as the positions reach


def equivalent_conicity(y: Array, difference: Array, amplitude: Array, *, base: float, radius: float) -> Array:
    """Equivalent conicity (m,), NaN where the wheelset does not oscillate, and for amplitudes beyond y.

    Parameters:
        y: (n,) m, lateral positions, increasing; from 0 on for a difference that is odd in y.
        difference: (n,) m, rolling radius difference at y, left minus right.
        amplitude: (m,) m, half the distance between the ends of the motion.
        base: e, m, between the rolling circles.
        radius: r0, m.

    EN 15302: tan g = 2 e r0 (pi / L)^2, Klingel's formula, for the wavelength L of the kinematic motion
    y'' + dr(y) / (e r0) = 0, here from its energy. Where the sides differ, the motion is not about y = 0: its ends are
    positions of equal potential.
    """
    if y[0] == 0.0:
        y, difference = np.concatenate([-y[:0:-1], y]), np.concatenate([-difference[:0:-1], difference])
    potential = Potential.of(y, difference / (base * radius))
    nodes, weights = roots_legendre(POINTS)
    angle, weight = 0.5 * np.pi * nodes, 0.5 * np.pi * weights
    conicity = np.full(len(amplitude), np.nan)
    for k, half in enumerate(amplitude.tolist()):
        middle = potential.middle(half) if half > 0.0 else None
        if middle is None:
            continue
        kinetic = potential(np.array([middle + half])) - potential(middle + half * np.sin(angle))
        if not (kinetic > 0.0).all():
            continue
        half_wave = float(weight @ (half * np.cos(angle) / np.sqrt(2.0 * kinetic)))
        conicity[k] = 2.0 * base * radius * (np.pi / (2.0 * half_wave)) ** 2
    return conicity


@dataclass(frozen=True)
class Potential:
    """Potential of a force that is linear between samples.

    Parameters:
        y: (n,) m, positions, increasing.
        force: (n,) 1/m.
        value: (n,) the potential.
    """

    y: Array
    force: Array
    value: Array

    @classmethod
    def of(cls, y: Array, force: Array) -> Potential:
        """Potential that is zero at the first position."""
        return cls(y, force, np.concatenate([[0.0], np.cumsum(0.5 * (force[1:] + force[:-1]) * np.diff(y))]))

    def __call__(self, at: Array) -> Array:
        i = np.clip(np.searchsorted(self.y, at, side="right") - 1, 0, len(self.y) - 2)
        t = at - self.y[i]
        slope = (self.force[i + 1] - self.force[i]) / (self.y[i + 1] - self.y[i])
        return np.asarray(self.value[i] + t * (self.force[i] + 0.5 * t * slope))

    def middle(self, half: float) -> float | None:
        """Middle m of the motion of an amplitude m, both of whose ends have the same potential; None beyond y."""
        low, high = float(self.y[0]) + half, float(self.y[-1]) - half

        def excess(middle: float) -> float:
            first, last = self(np.array([middle - half, middle + half]))
            return float(last - first)

        if high - low < ROUNDING * half:
            at = 0.5 * (low + high)
            ends = low - high < ROUNDING * half and abs(excess(at)) < ROUNDING * float(np.ptp(self.value))
            return at if ends else None
        if excess(low) * excess(high) > 0.0:
            return None
        return float(brentq(excess, low, high, xtol=1e-15))
