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
    """Equivalent conicity (m,) at amplitudes; 0 where the wheelset does not swing, NaN beyond y.

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
    odd = y[0] == 0.0
    if odd:
        y, difference = np.concatenate([-y[:0:-1], y]), np.concatenate([-difference[:0:-1], difference])
    potential = Potential.of(y, difference / (base * radius))
    nodes, weights = roots_legendre(POINTS)
    angle, weight = 0.5 * np.pi * nodes, 0.5 * np.pi * weights
    conicity = np.full(len(amplitude), np.nan)
    for k, half in enumerate(amplitude.tolist()):
        if not 0.0 < half <= 0.5 * np.ptp(y) * (1.0 + ROUNDING):
            continue
        middles = [0.0] if odd else potential.middles(half)
        for middle in sorted(middles, key=abs):
            kinetic = potential(np.array([middle + half])) - potential(middle + half * np.sin(angle))
            if (kinetic > 0.0).all():
                half_wave = float(weight @ (half * np.cos(angle) / np.sqrt(2.0 * kinetic)))
                conicity[k] = 2.0 * base * radius * (np.pi / (2.0 * half_wave)) ** 2
                break
        else:
            conicity[k] = 0.0 if middles else np.nan
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

    def middles(self, half: float) -> list[float]:
        """Middles m of the motions of an amplitude m whose ends have the same potential; none beyond y."""
        low, high = float(self.y[0]) + half, float(self.y[-1]) - half
        nodes = np.concatenate([self.y - half, self.y + half, [low, high]])
        at = np.unique(nodes[(nodes >= low) & (nodes <= high)])

        def excess(middle: Array) -> Array:
            return self(middle + half) - self(middle - half)

        signs = np.sign(excess(at))
        found: list[float] = at[signs == 0.0].tolist()
        for i in np.flatnonzero(signs[1:] * signs[:-1] < 0.0):
            found.append(brentq(lambda m: float(excess(np.array([m]))[0]), at[i], at[i + 1], xtol=1e-15))
        return found
