"""A surface's compliance by wavenumbers: where to sample it, and the way back to cells along the rolling direction."""

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
from wheelrail.support.progress import ProgressTimer

log = logging.getLogger(__name__)

Samples = TypeVar("Samples", Array, NDArray[np.complex128])

START = 8  # intervals before the first refinement
MOST = 400  # samples; a spectrum that needs more is not the smooth one of a clamped body
GAIN = 8.0  # of a midpoint over its interval: cubic splines give 16 when smooth, the rest is caution


@dataclass(frozen=True)
class ComplianceSpectrum:
    """Samples of H at increasing wavenumbers k (nk,) 1/m from zero: values (nk, pairs, 3, 3) m2/N for pairs of surface
    lines s <= t, row by row.

    Between samples (k + shift) H is a cubic spline in log(1 + k / shift). error: estimate of what that costs in any
    compliance, relative to the smallest one of a line with itself for loads over 16 surface sizes. round [m]: the way
    once round a body of revolution, whose harmonics are whole: k = 2 pi n / round (None: a prismatic body's are not).
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
        """Even and odd weights (nx, nk) that turn samples into compliances at distances x [m] along the body.

        Tractions are constant over cells of the length step [m] and displacements averaged over them:
        C(x) = 1/pi int H(k) sinc^2(k step / 2) (cos or sin)(k x) dk, the sum over whole harmonics for a body of
        revolution. Taken as continuous there, a web that lets the rim wobble would cost per cents.
        """
        k, w = rule(self.k, float(np.abs(x).max()) + step, self.round)
        weighted = interpolation(self.k, self.shift, k) * (w * np.sinc(k * step / (2 * np.pi)) ** 2)[:, None]
        phase = np.outer(x, k)
        return np.cos(phase) @ weighted, np.sin(phase) @ weighted


def rule(samples: Array, reach: float, around: float | None) -> tuple[Array, Array]:
    """Wavenumbers and weights of the way back, 1/pi int ... dk, or its sum over the harmonics once round [m]."""
    if around is None:
        k, w = quadrature(samples, reach)
        return k, w / np.pi
    k = 2 * np.pi / around * np.arange(round(samples[-1] * around / (2 * np.pi)) + 1)
    return k, np.where(k > 0, 2.0, 1.0) / around


def interpolation(samples: Array, shift: float, k: Array) -> Array:
    """Weights (m, nk) of the samples in the value at wavenumbers k (m,)."""
    cardinal = CubicSpline(np.log1p(samples / shift), np.eye(len(samples)))(np.log1p(k / shift))
    return np.asarray(cardinal * (samples + shift) / (k + shift)[:, None])


def quadrature(samples: Array, reach: float) -> tuple[Array, Array]:
    """Gauss points and weights on every interval of the samples, fine enough for phases up to k reach."""
    place, weight = roots_legendre(6)
    count = np.ceil(np.diff(samples) * reach / np.pi).astype(int) + 1
    edges = np.concatenate(
        [np.linspace(a, b, n, endpoint=False) for a, b, n in zip(samples[:-1], samples[1:], count, strict=True)]
    )
    length = np.diff(np.append(edges, samples[-1]))
    k = edges[:, None] + 0.5 * length[:, None] * (1 + place)
    return k.ravel(), (0.5 * length[:, None] * weight).ravel()


def pairs(lines: int) -> tuple[Nodes, Nodes]:
    """Lines s and t of the pairs s <= t, in the order in which they are stored."""
    return np.triu_indices(lines)


def pair_places(lines: int) -> Nodes:
    """Place (lines, lines) of a pair s <= t in that order; zero for s > t, which is t, s seen from the other side."""
    place = np.zeros((lines, lines), dtype=np.int64)
    place[pairs(lines)] = np.arange(lines * (lines + 1) // 2)
    return place


def pack(H: Array) -> Array:
    """Symmetric (3 ns, 3 ns) -> (pairs, 3, 3)."""
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
    """Sample H(k) (3 ns, 3 ns) from 0 to the largest wavenumber, halving intervals until the tolerance holds.

    step [m] is the cell length along x for which the error counts. around [m]: once round a body of revolution, which
    is sampled at whole harmonics. Raises RuntimeError when 400 samples do not do.
    """
    axis = WavenumberAxis(shift, None if around is None else 2 * np.pi / around)
    k = axis.spaced(largest, START)
    found: dict[float, Array] = {}
    timer = ProgressTimer(log, "compliance by wavenumbers, up to this refinement")

    def take(wavenumbers: list[float]) -> None:
        total = len(found) + len(wavenumbers)
        for wavenumber in wavenumbers:
            found[wavenumber] = pack(H(wavenumber))
            timer(len(found), total)

    take(k)
    scale = _scale(found, shift, 16 * step)

    def share(low: float, high: float) -> float:
        spread = min(1.0, (2 / (low * step)) ** 2) if low > 0 else 1.0
        return (high - low) * spread / np.pi / scale

    error = refine(found, take, axis, share, tolerance)
    known = sorted(found)
    return ComplianceSpectrum(np.array(known), shift, np.stack([found[place] for place in known]), error, around)


@dataclass(frozen=True)
class WavenumberAxis:
    """Wavenumbers [1/m] laid out in log(1 + k / shift), multiples of a unit [1/m] where one is given."""

    shift: float
    unit: float | None = None

    def spaced(self, largest: float, intervals: int) -> list[float]:
        """From zero to the largest, equally spaced but for the unit."""
        t = np.linspace(0.0, self.place(largest), intervals + 1)
        return sorted({0.0, *(self._snapped(self.shift * np.expm1(v)) for v in t)})

    def no_longer(self, known: list[float], length: float) -> list[float]:
        """The same with intervals divided equally until none exceeds the length [1/m] or a unit."""
        parts = [np.linspace(a, b, int(np.ceil((b - a) / length)) + 1) for a, b in pairwise(known)]
        return sorted({self._snapped(float(k)) for part in parts for k in part})

    def place(self, k: float) -> float:
        return float(np.log1p(k / self.shift))

    def middle(self, low: float, high: float) -> float | None:
        """Between two wavenumbers; None when no multiple of the unit is."""
        k = self._snapped(self.shift * np.expm1(0.5 * (self.place(low) + self.place(high))))
        if self.unit is not None and not low + 0.5 * self.unit < k < high - 0.5 * self.unit:
            k = self._snapped(0.5 * (low + high))
            return k if low + 0.5 * self.unit < k < high - 0.5 * self.unit else None
        return k

    def _snapped(self, k: float) -> float:
        return float(k if self.unit is None else self.unit * round(k / self.unit))


def refine(
    found: dict[float, Samples],
    take: Callable[[list[float]], None],
    axis: WavenumberAxis,
    share: Callable[[float, float], Array | float],
    tolerance: float,
) -> float:
    """Halve the intervals between samples until interpolation into them costs no more than the tolerance; the cost.

    take adds samples to those found; share is what an error of one all over an interval (low, high) costs, for all
    entries or each. Raises RuntimeError when 400 samples do not do.
    """
    whole = axis.place(max(found))
    open_intervals = list(pairwise(sorted(found)))
    error = np.zeros(found[0.0].shape)  # of every entry: they are not worst at the same wavenumbers
    while open_intervals:
        known = sorted(found)
        halved = [(low, middle, high) for low, high in open_intervals if (middle := axis.middle(low, high)) is not None]
        middles = [middle for _, middle, _ in halved]
        if len(found) + len(middles) > MOST:
            raise RuntimeError(f"the compliance needs more than {MOST} wavenumbers for the tolerance {tolerance:g}")
        rules = interpolation(np.array(known), axis.shift, np.array(middles))
        take(middles)
        open_intervals = []
        for (low, middle, high), weights in zip(halved, rules, strict=True):
            miss = found[middle].copy()
            for weight, place in zip(weights, known, strict=True):
                if abs(weight) > 1e-9:  # they die out from interval to interval
                    miss -= weight * found[place]
            # of a cubic's error over its interval, 8/15 of the peak on average
            lost = 8 / 15 * share(low, high) / GAIN * np.abs(miss)
            if lost.max() > tolerance * (axis.place(high) - axis.place(low)) / whole:
                open_intervals += [(low, middle), (middle, high)]
            else:
                error += lost
    return float(error.max())


def _scale(found: dict[float, Array], shift: float, length: float) -> float:
    """Smallest compliance [m/N] of a line with itself, loads and displacements averaged over a length [m]."""
    places = sorted(found)
    first, second = pairs(int(np.sqrt(2 * len(found[places[0]]))))
    own = np.stack([found[place][first == second] for place in places])
    rough = ComplianceSpectrum(np.array(places), shift, own, 0.0)
    weight = rough.weights(np.zeros(1), length)[0][0]
    return float(np.einsum("k,knaa->na", weight, own).min())
