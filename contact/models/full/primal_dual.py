"""Tangent of regularised friction with the direction of the last predicted traction, in place of that of the slip.

With t = -b s / max(|s|, eps), Newton's method diverges where points change from stick to slip: the exact tangent at a
sliding point has no stiffness along the slip. T. F. Chan, G. H. Golub, P. Mulet, SIAM J. Sci. Comput. 20 (1999)
1964-1977, DOI 10.1137/S1064827596299767, linearise max(|s|, eps) w = s instead, with w = -t / b as an unknown: the
direction of the slip in the tangent becomes w, that of the traction predicted by the last linear step, of length 1 at
most. At a solution w is the direction of the slip, so convergence stays quadratic.
"""

from __future__ import annotations

import numpy as np

from wheelrail.support.arrays import Array


def primal_dual_tangent(derivative: Array, z: Array, forces: Array, predicted: Array) -> Array:
    """Tangent (n, c, c) of nodal forces by z = (d, s1, s2) at n points; without friction (c = 1) the derivative.

    Parameters:
        derivative: (n, c, c), of the law.
        z: (n, c), penetration m and slip.
        forces: (n, c) N, of the law at z, friction opposite to the slip.
        predicted: (n, c) N, by the last linear step.

    With t = -beta s, beta = |t| / |s|, the derivative is -beta I - s (x) grad beta; in its second part s is replaced by
    |s| w. By the slip this part vanishes in the viscous range, so that points that stick keep their derivative.
    """
    if z.shape[1] == 1:
        return derivative
    slip, traction, dual = z[:, 1:], forces[:, 1:], -predicted[:, 1:]
    length, size = np.hypot(*slip.T), np.hypot(*traction.T)
    direction = slip / np.where(length > 0, length, 1.0)[:, None]
    bound = np.maximum(size, np.hypot(*dual.T))
    dual = dual / np.where(bound > 0, bound, 1.0)[:, None]
    secant = np.zeros_like(derivative[:, 1:])
    secant[:, [0, 1], [1, 2]] = (size / np.where(length > 0, length, np.inf))[:, None]
    by_bound = derivative[:, 1:] + secant
    # points without slip have a viscous law, and no direction to replace
    by_bound = np.where((length > 0)[:, None, None], dual[:, :, None] * (direction[:, None] @ by_bound), by_bound)
    return np.concatenate([derivative[:, :1], by_bound - secant], axis=1)
