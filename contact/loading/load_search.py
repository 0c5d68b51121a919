"""Depth at which a contact carries a given load, by the core: `contact/loading/core/load_search.hpp`."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

from wheelrail.bindings._contact import RTOL, depth_for_load
from wheelrail.contact.results.result import ContactResult
from wheelrail.support.interrupts import check_interrupt

Results = tuple[ContactResult, ...]
Lowered = Callable[[float, Results | None], Results]  # depth m, earlier results -> results


class LoadError(RuntimeError):
    """The search for the depth at which the contact carries the load failed."""


@dataclass(frozen=True)
class LoadSolution:
    """Depth at which the contact carries a load.

    Parameters:
        depth: m, downwards from the origin of the scale.
        results: of the contact at that depth.
        error: of the vertical force, over the load.
        trials: number of solves.
        slope: of F^(2/3) by depth, N^(2/3)/m.
    """

    depth: float
    results: Results
    error: float
    trials: int
    slope: float


def find_depth_for_load(
    contact: Lowered,
    load: float,
    *,
    expected: float,
    start: float = 0.0,
    rtol: float = RTOL,
    deepest: float = 0.1,
    guess: Results | None = None,
    known_slope: float | None = None,
) -> LoadSolution:
    """Depth of the upper body at which the vertical force equals a load.

    Parameters:
        contact: results at a depth m, with earlier results as initial guess.
        load: N.
        expected: estimate of the approach under the load, m.
        start: depth of the first solve, m.
        rtol: tolerance of the force over the load.
        deepest: largest depth below the start, or below the gap there, m.
        guess: initial guess of the first solve.
        known_slope: of F^(2/3) by depth at the start, if known from a similar contact, N^(2/3)/m.

    Raises LoadError when contact solves fail, or when the load is not reached.
    """
    lowered = interruptible(contact)
    return LoadSolution(*depth_for_load(lowered, load, expected, start, rtol, deepest, guess, known_slope))


def interruptible(contact: Callable[..., Results]) -> Callable[..., Results]:
    """The contact, with an end of the search after Ctrl-C."""

    def solve(*arguments: object) -> Results:
        check_interrupt()
        return contact(*arguments)

    return solve
