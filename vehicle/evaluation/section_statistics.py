"""Estimated maxima over several sections of track after EN 14363, for equal or for target conditions.

The text of the standard was not available. The estimate mean + k s of section values stands in one public text (for
accelerations, k = 2.2); k = 3 for running safety, k = 0 for quasi-static quantities, and the regression on one variable
with Student's t in the place of k (two-dimensional method) are from memory, unconfirmed.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from wheelrail.support.arrays import Array

SAFETY, LOADING, QUASI_STATIC = 3.0, 2.2, 0.0  # factors k of the standard deviation


def estimated_maximum(values: Array, factor: float) -> float:
    """Mean and a multiple of the standard deviation of section values (one-dimensional method).

    Parameters:
        values: (n,), n > 1, of equal sections, such as percentiles.
        factor: k, see SAFETY, LOADING, QUASI_STATIC.

    Raises ValueError for fewer than two sections.
    """
    if len(values) < 2:
        raise ValueError(f"{len(values)} sections: must be 2 at least")
    return float(np.mean(values) + factor * np.std(values, ddof=1))


@dataclass(frozen=True)
class TargetEstimate:
    """Section values at target conditions by linear regression (two-dimensional method).

    Parameters:
        mean: of the regression line at the target.
        bound: upper end of the prediction interval of one further section there.
        slope: of the line.
        extrapolated: whether the target lies beyond the sections.
    """

    mean: float
    bound: float
    slope: float
    extrapolated: bool


def target_estimate(variable: Array, values: Array, target: float, confidence: float = 0.99) -> TargetEstimate:
    """Estimate at a target from sections of different conditions, for example cant deficiency.

    Parameters:
        variable: (n,), n > 2, conditions of the sections.
        values: (n,) section values, such as percentiles.
        target: value of the variable.
        confidence: of the prediction interval, two-sided.

    The interval is that of normal deviations from a line, t s (1 + 1/n + (x - mean)^2 / S)^(1/2) with n - 2 degrees of
    freedom. Raises ValueError for fewer than three sections, and for equal conditions.
    """
    from scipy.stats import t

    n, x = len(variable), variable - np.mean(variable)
    spread = float(x @ x)
    if n < 3 or not spread > 0.0:
        raise ValueError(f"{n} sections: must be 3 at least, of different conditions")
    slope, away = float(x @ values) / spread, target - float(np.mean(variable))
    mean = float(np.mean(values)) + slope * away
    residual = values - np.mean(values) - slope * x
    deviation = float(np.sqrt(residual @ residual / (n - 2) * (1.0 + 1.0 / n + away**2 / spread)))
    bound = mean + float(t.ppf(0.5 + 0.5 * confidence, n - 2)) * deviation
    return TargetEstimate(mean, bound, slope, not variable.min() <= target <= variable.max())
