"""Trace of a quantity along a slider, computed place by place from the present one outwards."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from wheelrail.explorer.views import Panel, trace_panel

if TYPE_CHECKING:
    from wheelrail.explorer.controls import Control
    from wheelrail.support.arrays import Array

PLACES = 41


class Trace:
    """Places of a slider and the values found there.

    Parameters:
        control: slider that is traced.
        quantity: name in `wheelrail.explorer.views.TRACED`.
        now: present place, from which the trace grows.
    """

    def __init__(self, control: Control, quantity: str, now: float) -> None:
        self.control, self.quantity = control, quantity
        self.places = np.array([float(f"{at:.9g}") for at in np.linspace(control.low, control.high, PLACES)])
        self.values: dict[str, Array] = {}
        self._order = np.argsort(np.abs(self.places - now), kind="stable").tolist()

    @property
    def place(self) -> float | None:
        """The next place; None where all are known."""
        return float(self.places[self._order[0]]) if self._order else None

    @property
    def due(self) -> bool:
        """Whether enough values have come for another picture."""
        return len(self._order) % 4 == 0

    def put(self, values: dict[str, float]) -> None:
        """Set the values at the next place, by side."""
        at = self._order.pop(0)
        for side, value in values.items():
            self.values.setdefault(side, np.full(PLACES, np.nan))[at] = value

    def panel(self, now: float) -> Panel:
        """Picture with the present place."""
        label = f"{self.control.label} [{self.control.unit or '1'}]"
        return trace_panel(self.quantity, label, self.places, self.values, now)
