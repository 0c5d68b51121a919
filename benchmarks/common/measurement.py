"""Rows of measured quantities, and the peak memory of this process."""

from __future__ import annotations

import resource
from typing import Any

Row = dict[str, Any]


def peak() -> float:
    """Largest resident memory [MB] of this process so far."""
    return resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1024
