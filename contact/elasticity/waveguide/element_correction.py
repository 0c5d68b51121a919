"""Near-field correction of a finite-element surface: closed form minus elements, on a half-space.

The response to a load on one line of the surface is resolved by the elements except within a few lines. This near field
is independent of the rest of the body: it is that of a large flat block, whose exact solution is the half-space's
(`wheelrail.contact.elasticity.half_space`). Per unit modulus it depends on the wavenumber times the lines' spacing, and
on Poisson's ratio.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import lru_cache

import numpy as np
from scipy.interpolate import CubicSpline

from wheelrail.contact.elasticity.half_space import strip_flexibility
from wheelrail.contact.elasticity.waveguide.spectrum import pair_indices
from wheelrail.contact.laws.material import Material
from wheelrail.support.arrays import Array

MIRRORED = np.array([[1, -1, 1], [-1, 1, -1], [1, -1, 1]])  # mirrored across the surface H(k) = MIRRORED * H(k)^T
ODD_ACROSS = [3, 5]  # components that change their sign with the lateral distance
FAR = 8  # lines away from the load, where elements and half-space differ by the block's finite size only


@dataclass(frozen=True)
class SurfaceError:
    """Missing flexibility of loads over one line, lines 0 .. 7 apart, per unit modulus.

    Parameters:
        log_q: (m,), log q, q = k times the lines' spacing.
        values: (m, 8, 6), components of `strip_flexibility`.
    """

    log_q: Array
    values: Array

    def at(self, q: Array) -> Array:
        """Missing flexibility (..., 8, 6) at wavenumbers times spacing (...)."""
        limited = np.clip(np.log(np.maximum(q, 1e-300)), self.log_q[0], self.log_q[-1])
        return np.asarray(CubicSpline(self.log_q, self.values)(limited))


@lru_cache(maxsize=32)
def surface_error(nu: float, degree: int) -> SurfaceError:
    """Missing flexibility of an endless block, whose compliance is cached, or computed in half a second.

    Parameters:
        nu: Poisson's ratio.
        degree: of the displacements, 1 or 2.
    """
    from wheelrail.contact.elasticity.waveguide.bodies import block_waveguide

    compliance, _ = block_waveguide((1, 2 * FAR), Material(1.0, nu), size=1.0, half_width=512.0, degree=degree)
    samples = compliance.samples
    ns = samples.lines
    resolved = samples.k > 0.02
    q, lines = samples.k[resolved], np.arange(FAR + 1)
    index = pair_indices(ns)
    elements = np.empty((len(q), FAR + 1, 6))
    middle = np.arange(FAR // 2, ns - FAR // 2 - FAR)
    for d in lines:
        flexibility = samples.values[resolved][:, index[middle, middle + d]].mean(axis=1)
        mirrored = flexibility.swapaxes(1, 2) * MIRRORED
        elements[:, d, :3] = np.diagonal(flexibility, axis1=1, axis2=2)
        elements[:, d, 3:] = 0.5 * (flexibility + mirrored)[:, *np.triu_indices(3, 1)]
    unit = np.column_stack([lines - 0.5, lines + 0.5])
    missing = strip_flexibility(q, unit[:1], unit, nu, 0.0)[:, 0] - elements
    near = missing[:, :FAR] - missing[:, FAR:]
    near[:, 0, ODD_ACROSS] = 0.0
    return SurfaceError(np.log(q), near)
