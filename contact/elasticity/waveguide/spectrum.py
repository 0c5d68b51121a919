"""Surface compliance by wavenumbers: adaptive sampling, and inverse transform to cells along the rolling direction."""

from __future__ import annotations

import logging
from collections.abc import Callable
from dataclasses import dataclass
from itertools import pairwise
from typing import TypeVar

import numpy as np
from numpy.typing import NDArray
from scipy.interpolate import CubicSpline
from scipy.special import roots_legendre

from wheelrail.support.arrays import Array, Nodes
from wheelrail.support.terminal import ProgressTimer

log = logging.getLogger(__name__)

Samples = TypeVar("Samples", Array, NDArray[np.complex128])

START = 8  # intervals before the first refinement
MAX_SAMPLES = 400  # samples; the spectrum of a clamped body is smooth and needs fewer
GAIN = (
    8.0  # error reduction by halving an interval: 16 for cubic splines of smooth functions, with a safety factor of 2
)


@dataclass(frozen=True)
class ComplianceSpectrum:
    """Samples of H at increasing wavenumbers from zero, a cubic spline of (k + shift) H in log(1 + k / shift) between.

    Parameters:
        k: (nk,) 1/m.
        shift: 1/m.
        values: (nk, pairs, 3, 3) m2/N, for pairs of surface lines s <= t, row by row.
        error: estimated interpolation error of any compliance, relative to the smallest self-compliance of a line for
            loads over 16 surface sizes.
        round: m, circumference of a body of revolution, with integer harmonics only, k = 2 pi n / round; None:
            prismatic.
    """

    k: Array
    shift: float
    values: Array
    error: float
    round: float | None = None

    @property
    def lines(self) -> int:
        """Number ns of surface lines."""
        return int(np.sqrt(2 * self.values.shape[1]))

    def weights(self, x: Array, step: float) -> tuple[Array, Array]:
        """Even and odd weights (nx, nk) of the samples in compliances at distances along the body.

        Parameters:
            x: (nx,) m.
            step: m, length of the cells over which tractions are constant and displacements averaged.

        C(x) = 1/pi int H(k) sinc^2(k step / 2) (cos or sin)(k x) dk, or the sum over integer harmonics for a body of
        revolution. The integral instead of the sum would cause errors of per cents for a web that lets the rim wobble.
        """
        k, w = rule(self.k, float(np.abs(x).max()) + step, self.round)
        sample_weights = interpolation(self.k, self.shift, k) * (w * np.sinc(k * step / (2 * np.pi)) ** 2)[:, None]
        phase = np.outer(x, k)
        return np.cos(phase) @ sample_weights, np.sin(phase) @ sample_weights


def rule(samples: Array, reach: float, around: float | None) -> tuple[Array, Array]:
    """Wavenumbers (m,) 1/m and weights of the inverse transform, 1/pi int ... dk, or its sum over harmonics.

    Parameters:
        samples: (nk,) 1/m, wavenumbers of the samples.
        reach: m, largest distance.
        around: m, circumference of a body of revolution; None: prismatic.
    """
    if around is None:
        k, w = quadrature(samples, reach)
        return k, w / np.pi
    k = 2 * np.pi / around * np.arange(round(samples[-1] * around / (2 * np.pi)) + 1)
    return k, np.where(k > 0, 2.0, 1.0) / around


def interpolation(samples: Array, shift: float, k: Array) -> Array:
    """Weights (m, nk) of the samples in the values at other wavenumbers.

    Parameters:
        samples: (nk,) 1/m, wavenumbers of the samples.
        shift: 1/m, see `ComplianceSpectrum`.
        k: (m,) 1/m.
    """
    cardinal = CubicSpline(np.log1p(samples / shift), np.eye(len(samples)))(np.log1p(k / shift))
    return np.asarray(cardinal * (samples + shift) / (k + shift)[:, None])


def quadrature(samples: Array, reach: float) -> tuple[Array, Array]:
    """Gauss points (m,) 1/m and weights on every interval of the samples, resolving phases up to k reach [m]."""
    node, weight = roots_legendre(6)
    count = np.ceil(np.diff(samples) * reach / np.pi).astype(int) + 1
    edges = np.concatenate(
        [np.linspace(a, b, n, endpoint=False) for a, b, n in zip(samples[:-1], samples[1:], count, strict=True)]
    )
    length = np.diff(np.append(edges, samples[-1]))
    k = edges[:, None] + 0.5 * length[:, None] * (1 + node)
    return k.ravel(), (0.5 * length[:, None] * weight).ravel()


def pairs(lines: int) -> tuple[Nodes, Nodes]:
    """Lines s and t (pairs,) of the pairs s <= t, in the order of storage."""
    return np.triu_indices(lines)


def pair_indices(lines: int) -> Nodes:
    """Index (lines, lines) of a pair s <= t in the order of `pairs`; zero for s > t, by symmetry that of t, s."""
    index = np.zeros((lines, lines), dtype=np.int64)
    index[pairs(lines)] = np.arange(lines * (lines + 1) // 2)
    return index


def pack(H: Array) -> Array:
    """Blocks (pairs, 3, 3) of a symmetric matrix (3 ns, 3 ns)."""
    n = len(H) // 3
    return np.asarray(H.reshape(n, 3, n, 3).transpose(0, 2, 1, 3)[pairs(n)])


def sample(
    H: Callable[[float], Array],
    *,
    shift: float,
    largest: float,
    step: float,
    tolerance: float,
    around: float | None = None,
) -> ComplianceSpectrum:
    """Sample H(k) (3 ns, 3 ns) from 0 to the largest wavenumber, refined until the tolerance is met.

    Parameters:
        H: flexibility m2/N at a wavenumber.
        shift: 1/m, see `ComplianceSpectrum`.
        largest: wavenumber, 1/m.
        step: m, length of the cells along x, for the error.
        tolerance: of the error, see `ComplianceSpectrum`.
        around: m, circumference of a body of revolution, sampled at integer harmonics; None: prismatic.

    Raises RuntimeError if 400 samples do not suffice.
    """
    axis = WavenumberAxis(shift, None if around is None else 2 * np.pi / around)
    k = axis.spaced(largest, START)
    samples: dict[float, Array] = {}
    timer = ProgressTimer(log, "compliance by wavenumbers, up to this refinement")

    def take(wavenumbers: list[float]) -> None:
        total = len(samples) + len(wavenumbers)
        for wavenumber in wavenumbers:
            samples[wavenumber] = pack(H(wavenumber))
            timer(len(samples), total)

    take(k)
    scale = _scale(samples, shift, 16 * step)

    def weight(low: float, high: float) -> float:
        attenuation = min(1.0, (2 / (low * step)) ** 2) if low > 0 else 1.0
        return (high - low) * attenuation / np.pi / scale

    error = refine(samples, take, axis, weight, tolerance)
    wavenumbers = sorted(samples)
    return ComplianceSpectrum(np.array(wavenumbers), shift, np.stack([samples[k] for k in wavenumbers]), error, around)


@dataclass(frozen=True)
class WavenumberAxis:
    """Wavenumbers [1/m] distributed in log(1 + k / shift), multiples of a unit [1/m] unless None."""

    shift: float
    unit: float | None = None

    def spaced(self, largest: float, intervals: int) -> list[float]:
        """Wavenumbers from zero to the largest, equally spaced in the logarithm except for rounding to the unit."""
        t = np.linspace(0.0, self.transformed(largest), intervals + 1)
        return sorted({0.0, *(self._snapped(self.shift * np.expm1(v)) for v in t)})

    def no_longer(self, wavenumbers: list[float], length: float) -> list[float]:
        """The wavenumbers with intervals divided equally until none exceeds the length [1/m] or a unit."""
        parts = [np.linspace(a, b, int(np.ceil((b - a) / length)) + 1) for a, b in pairwise(wavenumbers)]
        return sorted({self._snapped(float(k)) for part in parts for k in part})

    def transformed(self, k: float) -> float:
        """Coordinate log(1 + k / shift) of a wavenumber 1/m."""
        return float(np.log1p(k / self.shift))

    def middle(self, low: float, high: float) -> float | None:
        """Midpoint of two wavenumbers; None without a multiple of the unit between them."""
        k = self._snapped(self.shift * np.expm1(0.5 * (self.transformed(low) + self.transformed(high))))
        if self.unit is not None and not low + 0.5 * self.unit < k < high - 0.5 * self.unit:
            k = self._snapped(0.5 * (low + high))
            return k if low + 0.5 * self.unit < k < high - 0.5 * self.unit else None
        return k

    def _snapped(self, k: float) -> float:
        return float(k if self.unit is None else self.unit * round(k / self.unit))


def refine(
    samples: dict[float, Samples],
    take: Callable[[list[float]], None],
    axis: WavenumberAxis,
    weight: Callable[[float, float], Array | float],
    tolerance: float,
) -> float:
    """Halve the intervals between samples until the interpolation error is below the tolerance; returns the error.

    Parameters:
        samples: by wavenumber, updated by `take`.
        take: adds the samples at given wavenumbers.
        axis: of the wavenumbers.
        weight: error of the result, by entry or for all, by a unit error over an interval (low, high).
        tolerance: of the result.

    Raises RuntimeError if 400 samples do not suffice.
    """
    whole = axis.transformed(max(samples))
    open_intervals = list(pairwise(sorted(samples)))
    error = np.zeros(samples[0.0].shape)  # by entry: the largest errors occur at different wavenumbers
    while open_intervals:
        wavenumbers = sorted(samples)
        halved = [(low, middle, high) for low, high in open_intervals if (middle := axis.middle(low, high)) is not None]
        middles = [middle for _, middle, _ in halved]
        if len(samples) + len(middles) > MAX_SAMPLES:
            raise RuntimeError(
                f"the compliance needs more than {MAX_SAMPLES} wavenumbers for the tolerance {tolerance:g}"
            )
        rules = interpolation(np.array(wavenumbers), axis.shift, np.array(middles))
        take(middles)
        open_intervals = []
        for (low, middle, high), rule_weights in zip(halved, rules, strict=True):
            defect = samples[middle].copy()
            for rule_weight, wavenumber in zip(rule_weights, wavenumbers, strict=True):
                if abs(rule_weight) > 1e-9:  # the weights decay from interval to interval
                    defect -= rule_weight * samples[wavenumber]
            # mean of a cubic's error over its interval: 8/15 of the peak
            cost = 8 / 15 * weight(low, high) / GAIN * np.abs(defect)
            if cost.max() > tolerance * (axis.transformed(high) - axis.transformed(low)) / whole:
                open_intervals += [(low, middle), (middle, high)]
            else:
                error += cost
    return float(error.max())


def _scale(samples: dict[float, Array], shift: float, length: float) -> float:
    """Smallest self-compliance [m/N] of a line, loads and displacements averaged over a length [m]."""
    wavenumbers = sorted(samples)
    first, second = pairs(int(np.sqrt(2 * len(samples[wavenumbers[0]]))))
    diagonal = np.stack([samples[k][first == second] for k in wavenumbers])
    spectrum = ComplianceSpectrum(np.array(wavenumbers), shift, diagonal, 0.0)
    weight = spectrum.weights(np.zeros(1), length)[0][0]
    return float(np.einsum("k,knaa->na", weight, diagonal).min())


def antiderivative_weights(x: Array, samples: ComplianceSpectrum) -> tuple[Array, Array]:
    """Even and odd weights (n, nk) of the samples of a spectrum in the second antiderivative G at distances x (n,)."""
    k, w = rule(samples.k, float(x[-1]), samples.round)
    phase = np.outer(x, k)
    weighted = interpolation(samples.k, samples.shift, k) * w[:, None]
    even = (0.5 * x[:, None] ** 2 * np.sinc(phase / (2 * np.pi)) ** 2) @ weighted
    odd = ((phase - np.sin(phase)) / np.maximum(k, 1e-12 * k[-1]) ** 2) @ weighted
    return np.asarray(even), np.asarray(odd)
