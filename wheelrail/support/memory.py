"""Estimates of memory and time before a computation."""

from __future__ import annotations

import math
import os

FACTOR = 165.0  # bytes over unknowns to the power 4/3 of CHOLMOD's factors, 185 to 160 at 30 000 to 107 000 unknowns
SPARSE = 10.0  # operations over squared unknowns of its factorisation, 8 to 15 at 6 000 to 27 000 unknowns
SPEED = 5e9  # 1/s, operations of a factorisation on one core
READING = 5e9  # B/s, of factors at a solution: 1 on a busy machine to 10


class TooLarge(ValueError):
    """A problem that needs more memory than the machine has."""


def check_memory(problem: str, gigabytes: float) -> None:
    """Raises TooLarge if a problem needs more memory than the machine has, instead of an end without a message.

    Parameters:
        problem: its name and size, for the message.
        gigabytes: estimate of its memory, at least.
    """
    machine = 1e-9 * os.sysconf("SC_PAGE_SIZE") * os.sysconf("SC_PHYS_PAGES")
    if gigabytes > machine:
        raise TooLarge(f"{problem}: about {gigabytes:.3g} GB of memory or more; this machine has {machine:.3g} GB")


def factor_memory(unknowns: float) -> float:
    """Memory of the Cholesky factors of a solid's stiffness, GB."""
    return 1e-9 * FACTOR * math.pow(unknowns, 4 / 3)


def factor_seconds(unknowns: float) -> float:
    """Time of the Cholesky factorisation of a solid's stiffness."""
    return SPARSE * unknowns**2 / SPEED


def solution_seconds(unknowns: float) -> float:
    """Time of one solution with the Cholesky factors of a stiffness."""
    return 1e9 * factor_memory(unknowns) / READING


def dense_seconds(unknowns: float) -> float:
    """Time of Gaussian elimination of a dense matrix."""
    return 2 / 3 * unknowns**3 / SPEED
