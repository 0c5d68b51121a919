"""How far a result is from what finer cells would give."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

if TYPE_CHECKING:
    pass


@dataclass(frozen=True)
class ErrorEstimate:
    """Estimated errors: force N (length of the vector's error), moment N m, max_pressure Pa, area m2 (NaN: unknown)."""

    force: float
    moment: float
    max_pressure: float
    area: float

    @classmethod
    def unknown(cls) -> ErrorEstimate:
        return cls(np.nan, np.nan, np.nan, np.nan)
