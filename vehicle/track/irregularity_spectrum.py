"""Random irregularities from the spectra of ERRI B176, low and high.

Formulas and constants are those that public codes and the literature on track dynamics quote for ORE / ERRI B176 and
for the German railways, with different names; the report itself was not available. The manual of GENSYS lists values
of the high class (www.gensys.se/doc_html/trc_ipsd.html) in m2/(1/m), 2 pi times the unit here: they agree to four
digits, and its white spectrum shows that they are one-sided. B176 does not define the gauge: its spectrum has the same
form and is the one used with B176 in the Chinese literature.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal

import numpy as np

from wheelrail.support.arrays import Array
from wheelrail.vehicle.track.irregularity import Irregularities

Class = Literal["low", "high"]

CUT, LONG, ROLL = 0.8246, 0.0206, 0.4380  # rad/m: Omega_c, Omega_r, Omega_s
WAVES = 600
BLOCK = 256  # samples whose waves are one table
PER_WAVE = 20  # samples per shortest wavelength: relative error of the cubic spline 1e-4


@dataclass(frozen=True)
class IrregularitySpectrum:
    """One-sided spectral densities S m2/(rad/m) over the angular wave number O rad/m: the variance of a quantity is the
    integral of S over positive O.

    Parameters:
        alignment, level, gauge: rad m, the constants A of S = A Oc^2 / ((O^2 + Or^2)(O^2 + Oc^2)), for the gauge times
            O^2 / (O^2 + Os^2).
        half_base: m. The density of the cross level as an angle is that of the level over half_base^2, times
            O^2 / (O^2 + Os^2); as a difference of heights over 2 half_base it is four times that of the level, times
            the same factor.
    """

    alignment: float
    level: float
    gauge: float
    half_base: float = 0.75

    def __call__(self, wave_number: Array) -> Array:
        """Densities (..., 4) of alignment, level, cross level (as a height) and gauge at wave numbers (...) rad/m."""
        o2 = np.square(wave_number)
        plain = CUT**2 / ((o2 + LONG**2) * (o2 + CUT**2))
        rolling = plain * o2 / (o2 + ROLL**2)
        angle = self.level / self.half_base**2 * rolling
        height = (2.0 * self.half_base) ** 2 * angle
        return np.stack([self.alignment * plain, self.level * plain, height, self.gauge * rolling], axis=-1)

    def irregularities(
        self,
        length: float,
        *,
        seed: int,
        wavelengths: tuple[float, float] = (3.0, 100.0),
        start: float = 0.0,
        fade: float = 10.0,
    ) -> Irregularities:
        """A random realisation.

        Parameters:
            length: m, from s = 0.
            seed: of the random numbers; the same seed gives the same track for any length.
            wavelengths: shortest and longest, m.
            start: distance at which they begin, m.
            fade: length of the ramps at both ends, m.

        Sum of cosines of random phase, one at a random wave number in each bin of equal width in log(Omega), with the
        variance of the bin. Raises ValueError for wavelengths that do not increase, or a track shorter than two fades.
        """
        shortest, longest = wavelengths
        if not 0.0 < shortest < longest < np.inf:
            raise ValueError(f"wavelengths {shortest} to {longest} m: must be positive, the shortest first")
        random = np.random.default_rng(seed)
        edges = np.geomspace(2.0 * np.pi / longest, 2.0 * np.pi / shortest, WAVES + 1)
        widths = np.diff(edges)
        wave_number = edges[:-1] + random.random(WAVES) * widths
        phase = random.uniform(0.0, 2.0 * np.pi, (WAVES, 4))
        amplitude = np.sqrt(2.0 * self(np.sqrt(edges[1:] * edges[:-1])) * widths[:, None])
        stations = np.linspace(0.0, length, int(np.ceil(length * PER_WAVE / shortest)) + 1, dtype=np.float64)
        waves = amplitude * np.exp(1j * phase)
        parts = np.split(stations, np.arange(BLOCK, len(stations), BLOCK))
        within = np.exp(1j * np.outer(parts[0], wave_number))  # exp(i O (s + t)) = exp(i O s) exp(i O t)
        turned = [waves * np.exp(1j * part[0] * wave_number)[:, None] for part in parts]
        values = np.vstack([(within[: len(part)] @ own).real for part, own in zip(parts, turned, strict=True)])
        return Irregularities.faded(stations, values, start=start, fade=fade)


ERRI: dict[Class, IrregularitySpectrum] = {
    "low": IrregularitySpectrum(alignment=2.119e-7, level=4.032e-7, gauge=5.32e-8),
    "high": IrregularitySpectrum(alignment=6.125e-7, level=1.080e-6, gauge=1.032e-7),
}
