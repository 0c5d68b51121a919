"""Names of the files that a run writes."""

from __future__ import annotations

from typing import TYPE_CHECKING

if TYPE_CHECKING:
    pass

RESULTS, CHECKPOINTS = "run.nc", "run.checkpoints"
