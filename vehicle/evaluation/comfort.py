"""Ride comfort by EN 12299 and by Sperling, from accelerations sampled at a constant rate.

The texts of the standards were not available. Weightings and Sperling's B form agree in at least two public programs
(comfpy, PyRidy, a MATLAB collection); the scope of N_MV (95th percentiles of 5 s rms values) stands in one.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal

import numpy as np
from numpy.typing import NDArray

from wheelrail.support.arrays import Array

BLOCK = 5.0  # s, of an rms value
BAND = (0.4, 100.0)  # Hz, band limit of all weightings
BAND_QUALITY = 2**-0.5


@dataclass(frozen=True)
class Weighting:
    """Frequency weighting of EN 12299.

    Parameters:
        corner: Hz, of zero and poles of the transition.
        quality: of these poles.
        step: (f5 Hz, Q3, f6 Hz, Q4, gain) of the upward step; None: none.
        steady: whether slow accelerations pass, too.
    """

    corner: float
    quality: float = 0.63
    step: tuple[float, float, float, float, float] | None = None
    steady: bool = False

    def __call__(self, frequency: Array) -> NDArray[np.complex128]:
        """Transfer function (...) at frequencies (...) Hz."""
        s = 2j * np.pi * np.asarray(frequency, dtype=float)
        low, high, corner = (2 * np.pi * f for f in (*BAND, self.corner))
        result = high**2 / _quadratic(s, high, BAND_QUALITY)
        if not self.steady:
            result = s**2 / _quadratic(s, low, BAND_QUALITY) * result
        result = result * (s + corner) * corner / _quadratic(s, corner, self.quality)
        if self.step is not None:
            f5, q3, f6, q4, gain = self.step
            below, above = 2 * np.pi * f5, 2 * np.pi * f6
            result = result * gain * (above / below) ** 2 * _quadratic(s, below, q3) / _quadratic(s, above, q4)
        return np.asarray(result)


WEIGHTINGS = {
    "Wb": Weighting(16.0, step=(2.5, 0.8, 4.0, 0.8, 0.4)),
    "Wc": Weighting(8.0),
    "Wd": Weighting(2.0),
    "Wp": Weighting(2.0, steady=True),
}
SPERLING_FACTORS = {"vertical": 0.588, "lateral": 0.737}


def _quadratic(s: NDArray[np.complex128], w: float, quality: float) -> NDArray[np.complex128]:
    return np.asarray(s**2 + w / quality * s + w**2, dtype=np.complex128)


def weighted(signal: Array, response: NDArray[np.complex128]) -> Array:
    """Signal (n,) with its spectrum multiplied by a frequency response (n // 2 + 1,).

    Parameters:
        signal: at a constant interval, regarded as periodic.
        response: at `frequencies(n, interval)`.
    """
    return np.asarray(np.fft.irfft(np.fft.rfft(signal) * response, len(signal)))


def frequencies(count: int, interval: float) -> Array:
    """Frequencies (n // 2 + 1,) Hz of the spectrum of n samples at an interval, s."""
    return np.asarray(np.fft.rfftfreq(count, interval))


def block_rms(signal: Array, interval: float, duration: float = BLOCK) -> Array:
    """Root mean squares of successive whole blocks.

    Parameters:
        signal: (n,) at a constant interval.
        interval: s.
        duration: of a block, s.

    Raises ValueError for a signal shorter than a block.
    """
    length = round(duration / interval)
    count = len(signal) // length
    if count == 0:
        raise ValueError(f"{len(signal) * interval:.3g} s of signal: must be {duration:g} s at least")
    return np.asarray(np.sqrt((signal[: count * length].reshape(count, length) ** 2).mean(axis=1)))


def mean_comfort(acceleration: Array, interval: float) -> float:
    """N_MV of EN 12299: 6 times the root of the sum of squares of the 95th percentiles of 5 s rms values.

    Parameters:
        acceleration: (n, 3) m/s2 on the floor, longitudinal, lateral, vertical; 60 blocks of 5 s by the standard.
        interval: s.

    Weighting Wd for the longitudinal and lateral, Wb for the vertical one. Raises ValueError for less than 5 s.
    """
    f = frequencies(len(acceleration), interval)
    percentiles = [
        np.percentile(block_rms(weighted(column, WEIGHTINGS[name](f)), interval), 95.0)
        for column, name in zip(acceleration.T, ("Wd", "Wd", "Wb"), strict=True)
    ]
    return 6.0 * float(np.linalg.norm(percentiles))


def sperling_weight(frequency: Array, direction: Literal["vertical", "lateral"]) -> Array:
    """Sperling's weighting B (...) of accelerations at frequencies (...) Hz, for comfort."""
    f2 = np.asarray(frequency, dtype=float) ** 2
    above, below = 1.911 * f2 + (0.25 * f2) ** 2, (1.0 - 0.277 * f2) ** 2 + f2 * (1.563 - 0.0368 * f2) ** 2
    return np.asarray(SPERLING_FACTORS[direction] * np.sqrt(above / below))


def sperling_comfort(acceleration: Array, interval: float, direction: Literal["vertical", "lateral"]) -> float:
    """Sperling's Wz of comfort: 4.42 times the weighted rms of the acceleration, m/s2, to the power of 0.3.

    Parameters:
        acceleration: (n,) m/s2 in one direction.
        interval: s.
        direction: of the acceleration.
    """
    response = sperling_weight(frequencies(len(acceleration), interval), direction).astype(complex)
    rms = float(np.sqrt(np.mean(weighted(acceleration, response) ** 2)))
    return float(4.42 * rms**0.3)
