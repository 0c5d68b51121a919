"""A surface's compliance by wavenumbers: where to sample it, and the way back to cells along the rolling direction."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from itertools import pairwise

import numpy as np
from scipy.interpolate import CubicSpline
from scipy.special import roots_legendre

from contact.pose import Array, Nodes

START = 8  # intervals before the first refinement
MOST = 400  # samples; a spectrum that needs more is not the smooth one of a clamped body
GAIN = 8.0  # of a midpoint over its interval: cubic splines give 16 when smooth, the rest is caution


@dataclass(frozen=True)
class Spectrum:
    """Samples of H at increasing wavenumbers k (nk,) 1/m from zero: values (nk, pairs, 3, 3) m2/N for pairs of surface
    lines s <= t, row by row.

    Between samples (k + shift) H is a cubic spline in log(1 + k / shift). error: estimate of what that costs in any
    compliance, relative to the smallest one of a line with itself for loads over 16 surface sizes.
    """

    k: Array
    shift: float
    values: Array
    error: float

    @property
    def lines(self) -> int:
        """Number ns of surface lines."""
        return int(np.sqrt(2 * self.values.shape[1]))

    def weights(self, x: Array, step: float) -> tuple[Array, Array]:
        """Even and odd weights (nx, nk) that turn samples into compliances at distances x [m] along the body.

        Tractions are constant over cells of the length step [m] and displacements averaged over them:
        C(x) = 1/pi int H(k) sinc^2(k step / 2) (cos or sin)(k x) dk.
        """
        k, w = quadrature(self.k, float(np.abs(x).max()) + step)
        weighted = interpolation(self.k, self.shift, k) * (w * np.sinc(k * step / (2 * np.pi)) ** 2 / np.pi)[:, None]
        phase = np.outer(x, k)
        return np.cos(phase) @ weighted, np.sin(phase) @ weighted


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
    progress: Callable[[int, int], None] | None = None,
) -> Spectrum:
    """Sample H(k) (3 ns, 3 ns) from 0 to the largest wavenumber, halving intervals until the tolerance holds.

    step [m] is the cell length along x for which the error counts. progress is told samples done and known to come.
    Raises RuntimeError when 400 samples do not do.
    """
    t = [float(v) for v in np.linspace(0.0, np.log1p(largest / shift), START + 1)]
    found: dict[float, Array] = {}

    def wavenumber(place: float) -> float:
        return float(shift * np.expm1(place))

    def take(places: list[float]) -> None:
        for i, place in enumerate(places):
            found[place] = pack(H(wavenumber(place)))
            if progress is not None:
                progress(len(found), len(found) + len(places) - 1 - i)

    take(t)
    scale = _scale(found, shift, 16 * step)
    open_intervals = list(pairwise(t))
    error = 0.0
    while open_intervals:
        known = sorted(found)
        middles = [0.5 * (a + b) for a, b in open_intervals]
        if len(found) + len(middles) > MOST:
            raise RuntimeError(f"the compliance needs more than {MOST} wavenumbers for the tolerance {tolerance:g}")
        k = np.array([wavenumber(place) for place in known])
        rules = interpolation(k, shift, np.array([wavenumber(place) for place in middles]))
        take(middles)
        halves = []
        for (a, b), middle, rule in zip(open_intervals, middles, rules, strict=True):
            miss = found[middle].copy()
            for weight, place in zip(rule, known, strict=True):
                miss -= weight * found[place]
            low, high = wavenumber(a), wavenumber(b)
            spread = min(1.0, (2 / (low * step)) ** 2) if low > 0 else 1.0
            # of a cubic's error over its interval, 8/15 of the peak on average
            cost = 8 / 15 * (high - low) * spread * float(np.abs(miss).max()) / np.pi / scale / GAIN
            if cost > tolerance * (b - a) / t[-1]:
                halves += [(a, middle), (middle, b)]
            else:
                error += cost
        open_intervals = halves
    places = sorted(found)
    values = np.stack([found[place] for place in places])
    return Spectrum(np.array([wavenumber(place) for place in places]), shift, values, error)


def _scale(found: dict[float, Array], shift: float, length: float) -> float:
    """Smallest compliance [m/N] of a line with itself, loads and displacements averaged over a length [m]."""
    places = sorted(found)
    first, second = pairs(int(np.sqrt(2 * len(found[places[0]]))))
    own = np.stack([found[place][first == second] for place in places])
    rough = Spectrum(shift * np.expm1(np.array(places)), shift, own, 0.0)
    weight = rough.weights(np.zeros(1), length)[0][0]
    return float(np.einsum("k,knaa->na", weight, own).min())
