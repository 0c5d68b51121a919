"""Estimated discretisation error of a contact result."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np


@dataclass(frozen=True)
class ErrorEstimate:
    """Estimated discretisation errors; NaN is unknown.

    Parameters:
        force: N, length of the error vector.
        moment: N m, length of the error vector.
        max_pressure: Pa.
        area: m2.
    """

    force: float
    moment: float
    max_pressure: float
    area: float

    @classmethod
    def unknown(cls) -> ErrorEstimate:
        """The estimate with all values NaN."""
        return cls(np.nan, np.nan, np.nan, np.nan)
