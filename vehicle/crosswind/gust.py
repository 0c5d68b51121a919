"""Extreme gust of EN 14067-6, formerly named after a hat: still in space, passed by the vehicle.

The text of the standard was not available. Shape and use after C. Baker, profchrisbaker.com, 2020 ("CEN extreme gust"),
and W. Bierbooms, P. Cheng, J. Wind Eng. Ind. Aerod. 90 (2002) 1237; duration after D. Delaunay, J. Locatelli, ibid. 34
(1990) 287. Numbers are from memory and not confirmed.
"""

from __future__ import annotations

from dataclasses import dataclass
from math import cos, hypot, pi, sin

import numpy as np

from wheelrail.support.arrays import Array

BAND = (1.0 / 300.0, 1.0)  # Hz, of the turbulence that makes gusts
REACH = 5.0  # decays from the middle to the ends, where 0.7 % of the gust is left


@dataclass(frozen=True)
class Gust:
    """Gust whose speed falls from its peak to the mean wind exponentially with the distance.

    Parameters:
        peak: m/s.
        angle: between track and wind, rad.
        intensity: of turbulence, standard deviation over mean wind.
        amplitude: of the gust over the standard deviation; 99 % of gusts are smaller.
        scale: length m of turbulence.
        decay: along and across the wind.
    """

    peak: float
    angle: float = 0.5 * pi
    intensity: float = 0.2446
    amplitude: float = 2.84
    scale: float = 96.0
    decay: tuple[float, float] = (5.0, 16.0)

    @property
    def mean(self) -> float:
        """Mean wind, m/s."""
        return self.peak / (1.0 + self.amplitude * self.intensity)

    @property
    def duration(self) -> float:
        """Median duration T of gusts of this amplitude, s: 0.95 a^1.42 / (2 n), with the rms frequency n, Hz, of von
        Karman's spectrum 1 / (1 + 70.8 (f L / U)^2)^(5/6) within the band.
        """
        ends = np.geomspace(*BAND, 1001)
        f = np.sqrt(ends[1:] * ends[:-1])
        weight = np.diff(ends) / (1.0 + 70.8 * (f * self.scale / self.mean) ** 2) ** (5.0 / 6.0)
        frequency = np.sqrt((f**2 @ weight) / weight.sum())
        return float(0.95 * self.amplitude**1.42 / (2.0 * frequency))

    @property
    def length(self) -> float:
        """Distance m along the track over which the gust falls to 1/e: 2 T U / c."""
        along, across = self.decay
        return 2.0 * self.duration * self.mean / hypot(along * cos(self.angle), across * sin(self.angle))

    def averaged(self, x: Array, width: float) -> Array:
        """Wind (n,) m/s, a mean over a width, m, of the vehicle, at distances (n,) m from the middle."""
        high, size = self.peak - self.mean, self.length
        if width == 0.0:
            return np.asarray(self.mean + high * np.exp(-np.abs(x) / size))

        def integral(end: Array) -> Array:  # of exp(-|x| / size) from 0
            return np.asarray(np.sign(end) * size * -np.expm1(-np.abs(end) / size))

        return np.asarray(self.mean + high / width * (integral(x + width / 2) - integral(x - width / 2)))
