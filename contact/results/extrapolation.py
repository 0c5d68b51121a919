"""Error estimate from two solutions, on all cells and on half as many."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from wheelrail.contact.results.error_estimate import ErrorEstimate

if TYPE_CHECKING:
    from wheelrail.contact.results.result import ContactResult

FALL = 3.0  # of an error when cells halve both ways: 4 at second order, 2 at first


SHARE = 1 / (FALL - 1)


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
