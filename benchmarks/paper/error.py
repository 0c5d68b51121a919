"""Cost and error of a run."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from wheelrail.vehicle.simulation.history import History, RunCost


@dataclass(frozen=True)
class Ran:
    """A run: its cost and, relative to the reference, RMS error of the wheelset's lateral position m and of the contact
    forces on both wheels over the static wheel load; the reason of a failure, and of a missing error.
    """

    cost: RunCost
    lateral: float = np.nan
    force: float = np.nan
    failure: str = ""
    note: str = ""

    @property
    def solves(self) -> int:
        return sum(side.solves for side in self.cost.contact.values())

    @property
    def newton(self) -> float:
        """Newton iterations per contact problem."""
        return sum(side.newton for side in self.cost.contact.values()) / max(self.solves, 1)

    @property
    def linear(self) -> float:
        """Linear iterations per Newton iteration."""
        newton = sum(side.newton for side in self.cost.contact.values())
        return sum(side.linear for side in self.cost.contact.values()) / max(newton, 1)


def difference(history: History, reference: History) -> tuple[float, float]:
    """RMS difference of the wheelset's lateral position m and of the six components of contact force N, at 400 common
    times; forces are interpolated linearly.
    """
    times = np.linspace(max(history.time[0], reference.time[0]), min(history.time[-1], reference.time[-1]), 400)
    y = [np.interp(times, run.time, run.state[:, 6]) for run in (history, reference)]
    rows = [run.force[:, 0].reshape(-1, 6).T for run in (history, reference)]
    forces = [
        np.array([np.interp(times, run.time, row) for row in six])
        for run, six in zip((history, reference), rows, strict=True)
    ]
    rms = [float(np.sqrt(np.mean((a - b) ** 2))) for a, b in (y, forces)]
    return rms[0], rms[1]
