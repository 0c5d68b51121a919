"""Normal displacement caused by tangential tractions, as a piecewise linear function that can be evaluated on another
layout.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from wheelrail.contact.geometry.strip_layout import StripLayout
from wheelrail.support.arrays import Array

FARTHEST = 1.0  # times the last change of the penetration: largest extrapolation of the Anderson step


@dataclass(frozen=True)
class FrictionPenetration:
    """Penetration due to friction, linear over every part of a contact and constant beyond it.

    low and high (parts, 2) m: extent of the parts across and along; values (parts, 3): constant, slopes across and
    along from the middle.
    """

    low: Array
    high: Array
    values: Array

    @classmethod
    def by(cls, layout: StripLayout, added: Array) -> FrictionPenetration:
        """Least-squares fit to the penetration due to friction, added (S, M) m, on the cells of a layout."""
        low, high, values = [], [], []
        for number in np.unique(layout.patch):
            own = layout.patch == number
            edges = layout.edges[own]
            x = 0.5 * (edges[:, 1:] + edges[:, :-1])
            s = np.broadcast_to(layout.middle[own, None], x.shape)
            place = np.column_stack([s.ravel(), x.ravel()])
            low.append(place.min(axis=0))
            high.append(place.max(axis=0))
            away = place - 0.5 * (low[-1] + high[-1])
            weight = np.sqrt(np.diff(edges).ravel())
            matrix = np.column_stack([np.ones(len(away)), away]) * weight[:, None]
            values.append(np.linalg.lstsq(matrix, added[own].ravel() * weight, rcond=None)[0])
        return cls(np.array(low), np.array(high), np.array(values))

    def at(self, layout: StripLayout) -> Array:
        """Its values (S, M) m on the cells of another layout, from the nearest part."""
        edges = layout.edges
        x = 0.5 * (edges[:, 1:] + edges[:, :-1])
        middle = 0.5 * (self.low + self.high)
        apart = np.maximum(self.low[:, 0] - layout.middle[:, None], layout.middle[:, None] - self.high[:, 0])
        near = np.argmin(apart, axis=1)
        s = np.clip(layout.middle, self.low[near, 0], self.high[near, 0]) - middle[near, 0]
        along = np.clip(x, self.low[near, 1:], self.high[near, 1:]) - middle[near, 1:]
        constant, across, forward = self.values[near].T
        return np.asarray((constant + across * s)[:, None] + forward[:, None] * along)

    def times(self, factor: float) -> FrictionPenetration:
        return replace(self, values=factor * self.values)

    def between(self, layout: StripLayout, least: float, most: float) -> FrictionPenetration | None:
        """The function if its largest value on the cells of a layout lies between least and most m, else None."""
        return self if least < float(np.abs(self.at(layout)).max()) <= most else None


def on_cells(penetration: FrictionPenetration | None, layout: StripLayout) -> Array:
    """Penetration due to friction (S, M) m on the cells of a layout; zero for None."""
    return np.zeros_like(layout.edges[:, 1:]) if penetration is None else penetration.at(layout)


def anderson_step(
    layout: StripLayout,
    before: tuple[FrictionPenetration | None, FrictionPenetration],
    now: tuple[FrictionPenetration | None, FrictionPenetration],
) -> FrictionPenetration:
    """Next iterate of the penetration due to friction by Anderson acceleration of depth one, doi:10.1145/321296.321305.

    Parameters:
        layout: cells on which residuals are compared.
        before, now: of the last two iterations, the penetration assumed and the one caused by the tractions then.
    """
    caused, earlier = now[1].at(layout), before[1].at(layout)
    residual = caused - on_cells(now[0], layout)
    change = residual - (earlier - on_cells(before[0], layout))
    bottom = float((change**2).sum())
    factor = float((residual * change).sum()) / bottom if bottom > 0 else 0.0
    return FrictionPenetration.by(layout, caused - np.clip(factor, -FARTHEST, 1.0) * (caused - earlier))
