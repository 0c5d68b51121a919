"""How far a result is from what finer cells would give."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

if TYPE_CHECKING:
    from contact.result import ContactResult

FALL = 3.0  # of an error when cells halve both ways: 4 at second order, 2 at first
SHARE = 1 / (FALL - 1)


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


def difference(fine: ContactResult, rough: ContactResult) -> ErrorEstimate:
    """From the same contact on half as many cells each way, errors falling by three, that of the area by two."""

    def peak(result: ContactResult) -> float:
        return max((patch.max_pressure for patch in result.patches), default=0.0)

    def area(result: ContactResult) -> float:
        return sum(patch.area for patch in result.patches)

    return ErrorEstimate(
        force=SHARE * float(np.linalg.norm(fine.force - rough.force)),
        moment=SHARE * float(np.linalg.norm(fine.moment - rough.moment)),
        max_pressure=SHARE * abs(peak(fine) - peak(rough)),
        area=abs(area(fine) - area(rough)),
    )
