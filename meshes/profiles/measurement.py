"""Noise and spacing of measured points, and their effect on slope and contact pressure."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from scipy.interpolate import CubicSpline

from wheelrail.meshes.curves.spline import at_points, through
from wheelrail.support.arrays import Array

MODULUS = 115e9  # Pa, contact modulus E / 2 (1 - nu2) of steel on steel
NEGLIGIBLE = 1e6  # Pa, error of the pressure below which points are interpolated: 0.1 % of a usual peak pressure
NOTICEABLE = 1e8  # Pa, error of the pressure that is a warning: 10 %
LARGEST = 3e8  # Pa, allowed error of the pressure
EXACT = 0.05  # of the noise of rounding, residuals below which the numbers are not rounded
FEW = 10  # points of a running surface, below which the noise is that of all points
NORMAL_QUANTILE = 0.6745, 1.6449  # 50 % and 90 % quantiles of the absolute value of a standard normal variable


@dataclass(frozen=True)
class Measurement:
    """Points of a profile file, and the error of the fitted curve.

    Parameters:
        place: file, and line of the first point.
        count: number of points.
        spacing: median, m.
        noise: standard deviation of the points normal to the profile, m.
        smoothing: RMS distance of the curve from the points, m; 0 interpolates.
        slope_error: RMS error of the slope of the curve.
        interpolated_error, smoothed_error: the same of the curve through all points, and of the one smoothed by the
            noise.
        convention: unit, signs, order and origin as they were recognised.
        remarks: on what was left out or mended.
    """

    place: str
    count: int
    spacing: float
    noise: float
    smoothing: float
    slope_error: float
    interpolated_error: float
    smoothed_error: float
    convention: tuple[str, ...] = ()
    remarks: tuple[str, ...] = ()

    def __str__(self) -> str:
        used, interpolated, smoothed = (
            f"{1e-6 * pressure(error):.2g} MPa"
            for error in (self.slope_error, self.interpolated_error, self.smoothed_error)
        )
        curve = f"noise = {self.smoothing:.2g} m" if self.smoothing else "curve through all of them"
        others = [f"{interpolated} with noise = 0"] if self.smoothing else []
        if self.smoothing < 0.7 * self.noise and smoothed != used:
            others.append(f"{smoothed} with noise = {self.noise:.1g}")
        return "; ".join(
            [
                f"{self.place}: {self.count} points every {_length(self.spacing)}, with noise of about "
                f"{_length(self.noise)}; {curve}: error of the pressure about {used}"
                + (f" ({', '.join(others)})" if others else ""),
                *([f"read as {', '.join(self.convention)}"] if self.convention else []),
                *self.remarks,
            ]
        )

    @property
    def advice(self) -> str:
        """Advice on reducing the error of the curve."""
        if self.smoothed_error < min(self.slope_error, _slope(LARGEST)):
            return f"noise = {self.noise:.1g} (m), or no value for the estimated noise"
        return (
            f"up to {1e-6 * LARGEST:.0f} MPa; measure again with less noise or closer points, average measurements, or "
            "smooth more by the key noise (m)"
        )


class RoughProfile(ValueError):
    """A profile whose noise or spacing does not allow contact computations."""

    def __init__(self, measurement: Measurement) -> None:
        super().__init__(f"{measurement}; allowed: {measurement.advice}")


def pressure(slope_error: float) -> float:
    """RMS of the pressure, Pa, that flattens a rough surface: E* k h / 2 for waves of wavenumber k and height h.

    K. L. Johnson, Contact Mechanics, eq. (13.2); k h is the slope.
    """
    return 0.5 * MODULUS * slope_error


def _slope(of_pressure: float) -> float:
    return 2.0 * of_pressure / MODULUS


def require_usable(measurement: Measurement | None) -> None:
    """Raises RoughProfile for a profile with too large an error of the pressure; None is a standard profile."""
    if measurement is not None and measurement.slope_error > _slope(LARGEST):
        raise RoughProfile(measurement)


def measured(
    points: Array, noise: float | None, place: str, convention: Sequence[str] = (), remarks: Sequence[str] = ()
) -> Measurement:
    """Noise, spacing and smoothing of points.

    Parameters:
        points: (n, 2) m.
        noise: RMS distance of the curve from the points, m; None: the estimated noise if its effect is noticeable.
        place: file and line.
        convention, remarks: on the reading of the file.
    """
    estimated, spacing_part = estimated_noise(points), spacing_error(points)
    noise_part = interpolation_error(points, estimated)
    interpolated = float(np.hypot(noise_part, spacing_part))
    smoothed = interpolated if pressure(noise_part) < NEGLIGIBLE else smoothing_error(points, estimated, estimated)
    if noise is None:
        noise = 0.0 if pressure(noise_part) < NEGLIGIBLE else estimated
    used = interpolated if noise == 0.0 else smoothed
    if noise not in (0.0, estimated):
        used = smoothing_error(points, estimated, noise)
    spacing = float(np.median(np.hypot(*np.diff(points, axis=0).T)))
    errors = used, interpolated, smoothed
    return Measurement(place, len(points), spacing, estimated, noise, *errors, tuple(convention), tuple(remarks))


def estimated_noise(points: Array) -> float:
    """Standard deviation m of points (n, 2) m normal to their line: median residual of cubics through four neighbours.

    Of the running surface, where the line is nearer to horizontal than to vertical: noise of a laser is vertical, and
    little of it is normal to steep faces. At least that of rounded heights. As by lines through two neighbours in
    T. Gasser, L. Sroka, C. Jennen-Steinmetz,
    doi:10.1093/biomet/73.3.625.
    """
    z = points[:, 0] + 1j * points[:, 1]
    s = np.concatenate([[0.0], np.cumsum(np.abs(np.diff(z)))])
    count = len(z) - 4
    neighbours = np.array([0, 1, 3, 4])[:, None] + np.arange(count)
    nodes, middle = s[neighbours], s[2:-2]
    weights = np.ones((4, count))
    for i in range(4):
        for j in range(4):
            if i != j:
                weights[i] *= (middle - nodes[j]) / (nodes[i] - nodes[j])
    residual = z[2:-2] - (weights * z[neighbours]).sum(axis=0)
    tangent = z[3:-1] - z[1:-3]
    normal = (residual * tangent.conj()).imag / np.abs(tangent) / np.sqrt(1.0 + (weights**2).sum(axis=0))
    running = np.abs(tangent.real) > np.abs(tangent.imag)
    residuals = np.abs(normal[running] if running.sum() > FEW else normal)
    rounded = float(rounding(points[:, 1]) / np.sqrt(12.0))
    if np.quantile(residuals, 0.95) < EXACT * rounded:  # a line of numbers that need no rounding
        rounded = 0.0
    return max(float(np.median(residuals)) / NORMAL_QUANTILE[0], rounded)


def rounding(values: Array) -> float:
    """Largest power of ten, m, of which all values (n,) m are multiples; 0 below 1 nm."""
    for step in 10.0 ** np.arange(-3, -10, -1):
        multiples = values / step
        if np.abs(multiples - np.round(multiples)).max() < 1e-4:
            return float(step)
    return 0.0


def interpolation_error(points: Array, noise: float) -> float:
    """RMS error of the slope of the curve through points (n, 2) m from their noise, m."""
    s = np.concatenate([[0.0], np.cumsum(np.hypot(*np.diff(points, axis=0).T))])
    error = CubicSpline(s, noise * np.random.default_rng(0).standard_normal(len(s))).derivative()(s)
    return float(np.sqrt(np.mean(error**2)))


def smoothing_error(points: Array, noise: float, smoothing: float) -> float:
    """RMS error of the slope of a smoothed curve: that of the same smoothing of the smooth curve with new noise.

    Parameters:
        points: (n, 2) m.
        noise: of the points, m.
        smoothing: RMS distance of the curve from the points, m.
    """
    z, direction = at_points(through(points, smoothing))
    smooth = np.stack([z.real, z.imag], axis=1)
    step = rounding(points[:, 1])
    scatter = np.sqrt(max(noise**2 - step**2 / 12.0, 0.0))
    noisy = smooth + scatter * np.random.default_rng(0).standard_normal(smooth.shape)
    if step:
        noisy[:, 1] = step * np.round(noisy[:, 1] / step)
    error = _angle(at_points(through(noisy, smoothing))[1] - direction)
    return float(np.hypot(np.sqrt(np.mean(error**2)), spacing_error(smooth)))


def spacing_error(points: Array) -> float:
    """RMS error of the slope from the spacing of points (n, 2) m, by Richardson's extrapolation from half as many.

    Slopes of a cubic spline are of third order. From the 90 % quantile, so that corners do not count.
    """
    coarse = at_points(through(points[::2]))[1]
    fine = at_points(through(points))[1][::2]
    return float(np.quantile(np.abs(_angle(fine - coarse)), 0.9)) / NORMAL_QUANTILE[1] / 7.0


def _angle(difference: Array) -> Array:
    return np.asarray(np.angle(np.exp(1j * difference)))


def _length(value: float) -> str:
    return f"{1e3 * value:.2g} mm" if value >= 1e-4 else f"{1e6 * value:.2g} µm"
