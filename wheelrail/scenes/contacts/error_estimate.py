"""Error estimate of a contact solution from a second solve on half as many strips and cells."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from typing import TYPE_CHECKING

from wheelrail.support.interrupts import deferred_interrupts

if TYPE_CHECKING:
    from wheelrail.contact.models.wheelset import ContactModel
    from wheelrail.contact.results.result import ContactResult


def halved(model: ContactModel) -> ContactModel:
    """The model on a lattice of half as many strips and cells."""
    from wheelrail.contact.models.lattice.model import LatticeContact

    assert isinstance(model, LatticeContact)
    return replace(model, resolution=model.resolution.coarsened())


def estimated(result: ContactResult, solve_coarse: Callable[[], ContactResult]) -> ContactResult:
    """The result with an error estimate, computed at the final position only and not at every trial depth.

    Parameters:
        result: on all strips and cells.
        solve_coarse: solves the same contact on half as many; if it fails, the errors are unknown (NaN).
    """
    from wheelrail.contact.results.error_estimate import ErrorEstimate
    from wheelrail.contact.results.extrapolation import difference

    if not result.patches:
        return result
    with deferred_interrupts():
        coarse = solve_coarse()
    return replace(result, error_estimate=difference(result, coarse) if coarse.ok else ErrorEstimate.unknown())
