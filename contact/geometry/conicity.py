"""Equivalent conicity of a wheelset on its track, from the difference of rolling radii."""

from __future__ import annotations

import numpy as np
from scipy.special import roots_legendre

from wheelrail.support.arrays import Array

POINTS = 400


def equivalent_conicity(y: Array, difference: Array, amplitude: Array, *, base: float, radius: float) -> Array:
    """Equivalent conicity (m,) at amplitudes (m,) m: that of the cones whose wheelset runs in waves of the same length.

    As EN 15302 defines it: L is the length of a wave of the kinematic motion y'' + dr(y) / (e r0) = 0, here from its
    energy, and tan g = 2 e r0 (pi / L)^2, which is Klingel's formula. y (n,) m from 0 on and difference (n,) m of the
    rolling radii there, left minus right, odd in y; base e m between the rolling circles; radius r0 m. NaN where the
    wheelset does not swing back, and beyond y.
    """
    force = difference / (base * radius)
    potential = np.concatenate([[0.0], np.cumsum(0.5 * (force[1:] + force[:-1]) * np.diff(y))])
    nodes, weights = roots_legendre(POINTS)
    angle, weight = 0.25 * np.pi * (nodes + 1.0), 0.25 * np.pi * weights

    def energy(at: Array) -> Array:
        """Integral of a force that is straight between the places."""
        i = np.clip(np.searchsorted(y, at, side="right") - 1, 0, len(y) - 2)
        t = at - y[i]
        return np.asarray(potential[i] + t * (force[i] + 0.5 * t * (force[i + 1] - force[i]) / (y[i + 1] - y[i])))

    found = np.full(len(amplitude), np.nan)
    for k, top in enumerate(amplitude.tolist()):
        if not 0.0 < top <= y[-1] * (1 + 1e-12):
            continue
        top = min(top, float(y[-1]))
        left = energy(np.array([top])) - energy(top * np.sin(angle))
        if not (left > 0.0).all():
            continue
        quarter = float(weight @ (top * np.cos(angle) / np.sqrt(2.0 * left)))
        found[k] = 2.0 * base * radius * (np.pi / (4.0 * quarter)) ** 2
    return found
