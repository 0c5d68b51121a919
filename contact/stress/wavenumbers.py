"""What loads on the surface of a body invariant along x or in angle do inside it, by wavenumbers.

One factorisation and one (complex) right-hand side per wavenumber, where and when it is asked for. In the phases of
`wheelrail.forms.waveguide` the loads (i F_x, F_y, F_z) and amplitudes U of u = (-i U_0, U_1, U_2) e^{ikx} are complex
and the stiffness stays real.
"""

from __future__ import annotations

import logging
from collections.abc import Callable, Mapping
from dataclasses import dataclass

import numpy as np
from scipy.integrate import trapezoid

from wheelrail.contact.elasticity.waveguide.coordinates import axes
from wheelrail.contact.elasticity.waveguide.section import WaveguideSection
from wheelrail.contact.elasticity.waveguide.spectrum import WavenumberAxis, interpolation, refine, rule
from wheelrail.contact.stress.surface_loads import CellLoads
from wheelrail.support.arrays import Array, Complex
from wheelrail.support.progress import ProgressTimer

log = logging.getLogger(__name__)


REACH = 2 * np.pi  # largest wavenumber times the cells' mean length: there a cell's load has its first zero
DECAY = 6.0  # largest wavenumber times the shallowest depth: beyond, e^-6 is left of what a smooth load has there


@dataclass(frozen=True)
class WavenumberResponse:
    """Amplitudes (nk, ...) of what was observed in a section at increasing wavenumbers k (nk,) 1/m.

    middle m of the loads along the body, from which phases count; shift and around as in
    `wheelrail.contact.elasticity.waveguide.spectrum`.
    """

    k: Array
    samples: Complex
    middle: float
    shift: float
    around: float | None

    def weights(self, along: Array) -> Complex:
        """Weights (nk, m) whose sum with the samples has the values at places along the body [m] as its real part."""
        x = along - self.middle
        k, w = rule(self.k, float(np.abs(x).max()), self.around)
        return np.asarray((interpolation(self.k, self.shift, k) * w[:, None]).T @ np.exp(1j * np.outer(k, x)))

    def at(self, stations: Array) -> Array:
        """Values (m, ...) of all that was observed, at every station (m,) m along the body: one product of matrices."""
        weights, flat = self.weights(stations).T, self.samples.reshape(len(self.k), -1)
        values = weights.real @ flat.real - weights.imag @ flat.imag
        return np.asarray(values.reshape(len(stations), *self.samples.shape[1:]))


def integral(found: Mapping[float, Complex]) -> float:
    """Integral of the largest amplitude over the wavenumbers: no value is larger than its third."""
    known = sorted(found)
    return float(trapezoid([np.abs(found[k]).max() for k in known], known))


def sampled(
    body: WaveguideSection,
    loads: CellLoads,
    observe: Callable[[Complex, float], Complex],
    *,
    shallowest: float,
    tolerance: float,
    scale: Callable[[Mapping[float, Complex]], Array | float] = integral,
) -> WavenumberResponse:
    """Amplitudes of what is observed of the displacements (3 n,) at each wavenumber, down to the shallowest depth [m].

    tolerance: of the interpolation between wavenumbers, relative to the scale of the first samples. Raises
    RuntimeError when 400 wavenumbers do not do.
    """
    middle = 0.5 * (loads.x.min() + loads.x.max())
    half = float((np.abs(loads.x - middle) + 0.5 * loads.step).max())
    around = None if body.radius is None else 2 * np.pi * body.radius
    force = _local(body, loads)
    found: dict[float, Complex] = {}
    timer = ProgressTimer(log, "fields inside a body by wavenumbers, up to this refinement")

    def take(wavenumbers: list[float]) -> None:
        total = len(found) + len(wavenumbers)
        for k in wavenumbers:
            cell = force * (np.sinc(k * loads.step / (2 * np.pi)) * np.exp(-1j * k * (loads.x - middle)))[:, None]
            F = np.zeros((len(body.section.surface), 3), dtype=complex)
            np.add.at(F, loads.line, cell)
            F[:, 0] *= 1j
            U = body.displacement(k, np.column_stack([F.real.ravel(), F.imag.ravel()]))
            found[k] = observe(U[:, 0] + 1j * U[:, 1], k)
            timer(len(found), total)

    size = float(np.ptp(body.section.points, axis=0).max())
    largest = min(REACH / loads.mean_step, DECAY / shallowest if shallowest > 0 else np.inf)
    axis = WavenumberAxis(1 / size, None if around is None else 2 * np.pi / around)
    first = axis.spaced(largest, 8)
    # the load's phases turn by k half: no interval may skip a turn
    take(axis.no_longer(first, 2.5 / half))
    unit = scale(found)
    refine(found, take, axis, lambda low, high: (high - low) / unit, tolerance)
    known = np.array(sorted(found))
    return WavenumberResponse(known, np.stack([found[k] for k in known]), middle, axis.shift, around)


def _local(body: WaveguideSection, loads: CellLoads) -> Array:
    """Forces (n, 3) in axes (along, y, up or outward)."""
    if body.radius is None:
        return loads.force
    return np.asarray(np.einsum("nab,na->nb", axes(loads.x / body.radius), loads.force))
