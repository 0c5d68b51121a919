"""Progress messages of long computations: log messages at level INFO."""

from __future__ import annotations

import logging
from dataclasses import dataclass, field
from time import monotonic

LOGGER = "wheelrail"  # root of all loggers of this package
PERIOD = 10.0  # s between two messages of one computation


@dataclass
class ProgressTimer:
    """Logs periodically the number of completed items of a total, and the remaining time at the same rate.

    The first item may include preparations and is excluded from the rate.
    """

    log: logging.Logger
    task: str
    _first: tuple[int, float] | None = field(init=False, default=None)
    _logged: float = field(init=False, default=0.0)

    def __call__(self, done: int, total: int) -> None:
        now = monotonic()
        if self._first is None:
            self._first, self._logged = (done, now), now
        elif now - self._logged >= PERIOD:
            first, start = self._first
            self._logged = now
            left = (now - start) / (done - first) * (total - done)
            self.log.info("%s: %d of %d, %.0f s left", self.task, done, total, left)
