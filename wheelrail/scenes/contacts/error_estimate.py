"""Error estimate of a contact solution from solves on half as many strips and cells."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import replace
from typing import TYPE_CHECKING

from wheelrail.support.interrupts import deferred_interrupts

if TYPE_CHECKING:
    from wheelrail.contact.models.wheelset import ContactModel
    from wheelrail.contact.results.result import ContactResult


def coarse_models(model: ContactModel) -> Sequence[ContactModel]:
    """The models on lattices of half as many strips and cells."""
    from wheelrail.contact.models.lattice.model import LatticeContact

    assert isinstance(model, LatticeContact)
    return model.coarse


def estimated(result: ContactResult, coarse_solves: Sequence[Callable[[], ContactResult]]) -> ContactResult:
    """The result with an error estimate, computed at the final position only and not at every trial depth.

    Parameters:
        result: on all strips and cells.
        coarse_solves: solve the same contact on half as many; if one fails, the errors are unknown (NaN).
    """
    from wheelrail.contact.results.extrapolation import estimate

    if not result.patches:
        return result
    with deferred_interrupts():
        coarse = [solve() for solve in coarse_solves]
    return replace(result, error_estimate=estimate(result, coarse))
