"""Irregularities of a track: where the rails lie beside where they should, along the distance s."""

from __future__ import annotations

from bisect import bisect_right
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from wheelrail.contact.kinematics.wheelset_state import RailShift
from wheelrail.support.arrays import Array
from wheelrail.vehicle.track.piecewise import PiecewiseFunction

QUANTITIES = ("alignment", "level", "cross_level", "gauge")
# Lateral and vertical shift of the left and of the right rail by the four quantities.
RAILS = np.array([[1.0, 0.0, 0.0, 0.5], [0.0, 1.0, -0.5, 0.0], [1.0, 0.0, 0.0, -0.5], [0.0, 1.0, 0.5, 0.0]])


@dataclass(frozen=True, eq=False)
class Irregularities:
    """Deviations by a cubic spline through samples, and none outside.

    stations (n,) m, rising strictly; values (n, 4) m: alignment, both rails to the left; level, both rails up;
    cross_level, the right rail above the left like a track's lift; gauge, wider. Raises ValueError for stations that do
    not rise, values that are not finite, and ends that are not 0 (see `faded`).
    """

    stations: Array
    values: Array

    def __post_init__(self) -> None:
        if self.values.shape != (len(self.stations), len(QUANTITIES)) or len(self.stations) < 2:
            raise ValueError(f"irregularities need two stations at least, and {len(QUANTITIES)} values at each")
        if not (np.diff(self.stations) > 0.0).all():
            raise ValueError("stations must rise strictly")
        if not np.isfinite(self.values).all() or self.values[[0, -1]].any():
            raise ValueError("irregularities must be finite, and 0 at both ends")

    @classmethod
    def faded(cls, stations: Array, values: Array, *, start: float = 0.0, fade: float = 10.0) -> Irregularities:
        """The same from a start m on, growing from nothing over `fade` m and going back to nothing before the last
        station, so that a run begins at rest.

        Raises ValueError, too, where the samples do not hold both.
        """
        start, end = max(start, float(stations[0])), float(stations[-1])
        if not (fade > 0.0 and end - start >= 2.0 * fade):
            raise ValueError(f"irregularities from {start:g} to {end:g} m are shorter than two fades of {fade:g} m")
        at = np.concatenate([[start], stations[stations > start]])
        share = PiecewiseFunction((0.0, fade), (0.0, 1.0))
        weight = np.array([share(s - start)[0] * share(end - s)[0] for s in at.tolist()])
        inside = np.vstack([np.zeros(len(QUANTITIES)), values[stations > start]])
        return cls(at, inside * weight[:, None])

    @cached_property
    def _knots(self) -> list[float]:
        return [float(s) for s in self.stations.tolist()]

    @cached_property
    def _cubics(self) -> list[list[list[float]]]:
        """Of each piece and each component of both rails, four coefficients from the cube down; level at the ends.

        Plain numbers: of so few an array costs more than it saves.
        """
        from scipy.interpolate import CubicSpline

        spline = CubicSpline(self.stations, self.values @ RAILS.T, bc_type="clamped")
        pieces: list[list[list[float]]] = spline.c.transpose(1, 2, 0).tolist()
        return pieces

    def _piece(self, s: float) -> tuple[list[list[float]], float] | None:
        i = bisect_right(self._knots, s) - 1
        return (self._cubics[i], s - self._knots[i]) if 0 <= i < len(self._knots) - 1 else None

    def rails(self, s: float) -> RailShift | None:
        """Lateral and vertical shift of the left and of the right rail at s, m; None where there are none."""
        piece = self._piece(s)
        if piece is None:
            return None
        cubics, x = piece
        left_y, left_z, right_y, right_z = [((a * x + b) * x + c) * x + d for a, b, c, d in cubics]
        return (left_y, left_z), (right_y, right_z)

    def at(self, stations: Array) -> Array:
        """The four quantities (m, 4) at stations (m,), m."""
        shifts = [self.rails(s) or ((0.0, 0.0), (0.0, 0.0)) for s in stations.tolist()]
        return np.asarray(np.reshape(np.array(shifts), (-1, 4)) @ np.linalg.inv(RAILS).T)
