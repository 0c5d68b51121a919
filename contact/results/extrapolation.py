"""Error estimate from solutions on two discretisations, all cells and half as many in each direction."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import astuple
from typing import TYPE_CHECKING

import numpy as np

from wheelrail.contact.results.error_estimate import ErrorEstimate

if TYPE_CHECKING:
    from wheelrail.contact.results.result import ContactResult

REDUCTION = 3.0  # of an error on halving the cells: 4 at second order, 2 at first order


WEIGHT = 1 / (REDUCTION - 1)


def difference(fine: ContactResult, coarse: ContactResult) -> ErrorEstimate:
    """Richardson-type error estimate of the finer solution.

    Parameters:
        fine: result on all cells.
        coarse: result of the same contact on half as many cells in each direction.

    Errors are assumed to fall by `REDUCTION` on halving the cells, that of the area by two.
    """

    def peak(result: ContactResult) -> float:
        return max((patch.max_pressure for patch in result.patches), default=0.0)

    def area(result: ContactResult) -> float:
        return sum(patch.area for patch in result.patches)

    return ErrorEstimate(
        force=WEIGHT * float(np.linalg.norm(fine.force - coarse.force)),
        moment=WEIGHT * float(np.linalg.norm(fine.moment - coarse.moment)),
        max_pressure=WEIGHT * abs(peak(fine) - peak(coarse)),
        area=abs(area(fine) - area(coarse)),
    )


def estimate(fine: ContactResult, coarse: Sequence[ContactResult]) -> ErrorEstimate:
    """Largest of the estimates from several coarser solutions; unknown if one of them failed."""
    if not all(result.ok for result in coarse):
        return ErrorEstimate.unknown()
    estimates = (astuple(difference(fine, result)) for result in coarse)
    return ErrorEstimate(*(max(errors) for errors in zip(*estimates, strict=True)))
