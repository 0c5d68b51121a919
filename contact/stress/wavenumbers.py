"""Internal response of a body invariant along x or in angle to loads on its surface, by wavenumbers.

One factorisation and one (complex) right-hand side per wavenumber. In the phases of `wheelrail.forms.waveguide` the
loads (i F_x, F_y, F_z) and amplitudes U of u = (-i U_0, U_1, U_2) e^{ikx} are complex and the stiffness is real.
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
from wheelrail.support.terminal import ProgressTimer

log = logging.getLogger(__name__)


REACH = 2 * np.pi  # largest wavenumber times the cells' mean length: first zero of a cell's load
DECAY = 6.0  # largest wavenumber times the smallest depth, where a smooth load has decayed by e^-6


@dataclass(frozen=True)
class WavenumberResponse:
    """Amplitudes of observed quantities of a section at increasing wavenumbers.

    Parameters:
        k: (nk,) 1/m.
        samples: (nk, ...).
        middle: m, centre of the loads along the body, origin of the phases.
        shift, around: as in `wheelrail.contact.elasticity.waveguide.spectrum`.
    """

    k: Array
    samples: Complex
    middle: float
    shift: float
    around: float | None

    def weights(self, along: Array) -> Complex:
        """Weights (nk, m) of the samples; the real part of the sum is the value at positions along the body (m,) m."""
        x = along - self.middle
        k, w = rule(self.k, float(np.abs(x).max()), self.around)
        return np.asarray((interpolation(self.k, self.shift, k) * w[:, None]).T @ np.exp(1j * np.outer(k, x)))

    def at(self, stations: Array) -> Array:
        """Values (m, ...) of all observed quantities at stations (m,) m along the body."""
        weights, flat = self.weights(stations).T, self.samples.reshape(len(self.k), -1)
        values = weights.real @ flat.real - weights.imag @ flat.imag
        return np.asarray(values.reshape(len(stations), *self.samples.shape[1:]))


def integral(samples: Mapping[float, Complex]) -> float:
    """Integral of the largest amplitude over the wavenumbers; values are at most a third of it."""
    wavenumbers = sorted(samples)
    return float(trapezoid([np.abs(samples[k]).max() for k in wavenumbers], wavenumbers))


def sampled(
    body: WaveguideSection,
    loads: CellLoads,
    observe: Callable[[Complex, float], Complex],
    *,
    shallowest: float,
    tolerance: float,
    scale: Callable[[Mapping[float, Complex]], Array | float] = integral,
) -> WavenumberResponse:
    """Amplitudes of quantities observed from the displacements, sampled adaptively.

    Parameters:
        body: section.
        loads: on its surface.
        observe: quantities from the displacements (3 n,) at a wavenumber 1/m.
        shallowest: m, smallest depth at which they are needed.
        tolerance: of the interpolation between wavenumbers, relative to the scale.
        scale: of the quantities, from the first samples.

    Raises RuntimeError if 400 wavenumbers do not suffice.
    """
    middle = 0.5 * (loads.x.min() + loads.x.max())
    half_length = float((np.abs(loads.x - middle) + 0.5 * loads.step).max())
    circumference = None if body.radius is None else 2 * np.pi * body.radius
    force = _local(body, loads)
    samples: dict[float, Complex] = {}
    timer = ProgressTimer(log, "fields inside a body by wavenumbers, up to this refinement")

    def take(wavenumbers: list[float]) -> None:
        total = len(samples) + len(wavenumbers)
        for k in wavenumbers:
            cell = force * (np.sinc(k * loads.step / (2 * np.pi)) * np.exp(-1j * k * (loads.x - middle)))[:, None]
            F = np.zeros((len(body.section.surface), 3), dtype=complex)
            np.add.at(F, loads.line, cell)
            F[:, 0] *= 1j
            U = body.displacement(k, np.column_stack([F.real.ravel(), F.imag.ravel()]))
            samples[k] = observe(U[:, 0] + 1j * U[:, 1], k)
            timer(len(samples), total)

    size = float(np.ptp(body.section.points, axis=0).max())
    largest = min(REACH / loads.mean_step, DECAY / shallowest if shallowest > 0 else np.inf)
    axis = WavenumberAxis(1 / size, None if circumference is None else 2 * np.pi / circumference)
    first = axis.spaced(largest, 8)
    # the load's phase is k half: every interval must resolve its rotation
    take(axis.no_longer(first, 2.5 / half_length))
    unit = scale(samples)
    refine(samples, take, axis, lambda low, high: (high - low) / unit, tolerance)
    k_samples = np.array(sorted(samples))
    return WavenumberResponse(k_samples, np.stack([samples[k] for k in k_samples]), middle, axis.shift, circumference)


def _local(body: WaveguideSection, loads: CellLoads) -> Array:
    """Forces (n, 3) in axes (along, y, up or outward)."""
    if body.radius is None:
        return loads.force
    return np.asarray(np.einsum("nab,na->nb", axes(loads.x / body.radius), loads.force))
