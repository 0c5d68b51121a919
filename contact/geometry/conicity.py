"""Equivalent conicity of a wheelset on track from its rolling radius difference, EN 15302."""

from __future__ import annotations

import numpy as np
from scipy.special import roots_legendre

from wheelrail.support.arrays import Array

POINTS = 400


def equivalent_conicity(y: Array, difference: Array, amplitude: Array, *, base: float, radius: float) -> Array:
    """Equivalent conicity (m,), NaN where the wheelset does not oscillate, and for amplitudes beyond y.

    Parameters:
        y: (n,) m, lateral positions from 0 on, increasing.
        difference: (n,) m, rolling radius difference at y, left minus right, odd in y.
        amplitude: (m,) m.
        base: e, m, between the rolling circles.
        radius: r0, m.

    EN 15302: tan g = 2 e r0 (pi / L)^2, Klingel's formula, for the wavelength L of the kinematic motion
    y'' + dr(y) / (e r0) = 0, here from its energy.
    """
    force = difference / (base * radius)
    potential = np.concatenate([[0.0], np.cumsum(0.5 * (force[1:] + force[:-1]) * np.diff(y))])
    nodes, weights = roots_legendre(POINTS)
    angle, weight = 0.25 * np.pi * (nodes + 1.0), 0.25 * np.pi * weights

    def energy(at: Array) -> Array:
        """Potential at lateral positions, the force linear between the samples."""
        i = np.clip(np.searchsorted(y, at, side="right") - 1, 0, len(y) - 2)
        t = at - y[i]
        return np.asarray(potential[i] + t * (force[i] + 0.5 * t * (force[i + 1] - force[i]) / (y[i + 1] - y[i])))

    conicity = np.full(len(amplitude), np.nan)
    for k, largest in enumerate(amplitude.tolist()):
        if not 0.0 < largest <= y[-1] * (1 + 1e-12):
            continue
        largest = min(largest, float(y[-1]))
        kinetic = energy(np.array([largest])) - energy(largest * np.sin(angle))
        if not (kinetic > 0.0).all():
            continue
        quarter = float(weight @ (largest * np.cos(angle) / np.sqrt(2.0 * kinetic)))
        conicity[k] = 2.0 * base * radius * (np.pi / (4.0 * quarter)) ** 2
    return conicity
