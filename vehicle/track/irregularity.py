"""Track irregularities: deviations of the rails from their nominal position as functions of distance s."""

from __future__ import annotations

from bisect import bisect_right
from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from wheelrail.contact.kinematics.frames import Side
from wheelrail.contact.kinematics.wheelset_state import RailShift
from wheelrail.support.arrays import Array
from wheelrail.vehicle.track.piecewise import PiecewiseFunction

JOINT_SAMPLES = 100  # on either side
MARGIN = 12  # samples beside a joint, along which the spline comes to rest
QUANTITIES = ("alignment", "level", "cross_level", "gauge")
# Lateral and vertical shift of the left and of the right rail by the four quantities.
RAILS = np.array([[1.0, 0.0, 0.0, 0.5], [0.0, 1.0, -0.5, 0.0], [1.0, 0.0, 0.0, -0.5], [0.0, 1.0, 0.5, 0.0]])


@dataclass(frozen=True, eq=False)
class Irregularities:
    """Deviations interpolated by a cubic spline, zero outside the samples.

    Parameters:
        stations: (n,) m, strictly increasing.
        values: (n, 4) m: alignment, both rails to the left; level, both rails up; cross_level, the right rail above the
            left like the superelevation; gauge, widening.

    Raises ValueError for stations that do not increase, values that are not finite, and ends that are not 0 (see
    `faded`).
    """

    stations: Array
    values: Array

    def __post_init__(self) -> None:
        if self.values.shape != (len(self.stations), len(QUANTITIES)) or len(self.stations) < 2:
            raise ValueError(f"irregularities must have two stations at least, and {len(QUANTITIES)} values at each")
        if not (np.diff(self.stations) > 0.0).all():
            raise ValueError("stations must increase strictly")
        if not np.isfinite(self.values).all() or self.values[[0, -1]].any():
            raise ValueError("irregularities must be finite, and 0 at both ends")

    @classmethod
    def faded(cls, stations: Array, values: Array, *, start: float = 0.0, fade: float = 10.0) -> Irregularities:
        """Irregularities faded in after the start and out before the last station, so that a run starts in equilibrium.

        Parameters:
            stations, values: as of the class.
            start: m.
            fade: length of both ramps, m.

        Raises ValueError for invalid samples, or samples shorter than both ramps.
        """
        start, end = max(start, float(stations[0])), float(stations[-1])
        if not (fade > 0.0 and end - start >= 2.0 * fade):
            raise ValueError(f"irregularities from {start:g} to {end:g} m are shorter than two fades of {fade:g} m")
        faded_stations = np.concatenate([[start], stations[stations > start]])
        ramp = PiecewiseFunction((0.0, fade), (0.0, 1.0))
        weight = np.array([ramp(s - start)[0] * ramp(end - s)[0] for s in faded_stations.tolist()])
        inside = np.vstack([np.zeros(len(QUANTITIES)), values[stations > start]])
        return cls(faded_stations, inside * weight[:, None])

    @classmethod
    def joints(
        cls, places: Sequence[float], angle: float, length: float, sides: Sequence[Side] = ("left", "right")
    ) -> Irregularities:
        """Dipped joints: parabolas that fall towards each place and meet there at an angle.

        Parameters:
            places: m, increasing, two lengths from one another at least.
            angle: rad, between the rails' ends.
            length: of each parabola, m.
            sides: rails with joints.

        Raises ValueError for joints that overlap.
        """
        if (np.diff(places) < 2.0 * length).any():
            raise ValueError(f"joints must be {2.0 * length:g} m from one another at least, two lengths")
        spacing = length / JOINT_SAMPLES
        x = np.arange(-JOINT_SAMPLES - MARGIN, JOINT_SAMPLES + MARGIN + 1) / JOINT_SAMPLES
        dip = -0.25 * angle * length * np.maximum(1.0 - np.abs(x), 0.0) ** 2
        left, right = ("left" in sides), ("right" in sides)
        values = np.zeros((len(x), len(QUANTITIES)))
        values[:, 1], values[:, 2] = 0.5 * (left + right) * dip, (right - left) * dip
        stations = np.add.outer(places, length * x)
        middles = 0.5 * np.add(places[1:], places[:-1])[:, None]  # up to which margins reach
        kept = np.ones(stations.shape, dtype=bool)
        kept[:-1] = stations[:-1] < middles - 0.25 * spacing
        kept[1:] &= stations[1:] >= middles - 0.01 * spacing
        return cls(stations[kept], np.tile(values, (len(places), 1))[kept.ravel()])

    @cached_property
    def _spline(self) -> Array:
        """Coefficients (n - 1, 4, 4), highest power first, of each piece and component of both rails; zero slope at the
        ends.
        """
        from scipy.interpolate import CubicSpline

        spline = CubicSpline(self.stations, self.values @ RAILS.T, bc_type="clamped")
        return np.ascontiguousarray(spline.c.transpose(1, 0, 2))

    @cached_property
    def _cubics(self) -> list[list[list[float]]]:
        """Coefficients of each piece and component. Plain numbers are faster than arrays for so few values."""
        pieces: list[list[list[float]]] = self._spline.transpose(0, 2, 1).tolist()
        return pieces

    @cached_property
    def _knots(self) -> list[float]:
        return [float(s) for s in self.stations.tolist()]

    def rails(self, s: float) -> RailShift | None:
        """Lateral and vertical displacement, m, of the left and the right rail at s; None outside the samples."""
        i = bisect_right(self._knots, s) - 1
        if not 0 <= i < len(self._knots) - 1:
            return None
        x = s - self._knots[i]
        left_y, left_z, right_y, right_z = [((a * x + b) * x + c) * x + d for a, b, c, d in self._cubics[i]]
        return (left_y, left_z), (right_y, right_z)

    def derivatives(self, s: Array) -> Array:
        """Displacements (4, m, 4) by distance: m and their first three derivatives, 1 to 1/m2, each of y and z of the
        left and of the right rail at distances s (m,); zero outside the samples.
        """
        i = np.searchsorted(self.stations, s, side="right") - 1
        inside = (i >= 0) & (i < len(self.stations) - 1)
        i = np.where(inside, i, 0)
        a, b, c, d = np.where(inside[:, None], self._spline[i].transpose(1, 0, 2), 0.0)
        x = (s - self.stations[i])[:, None]
        slopes = (3.0 * a * x + 2.0 * b) * x + c
        return np.asarray([((a * x + b) * x + c) * x + d, slopes, 6.0 * a * x + 2.0 * b, 6.0 * a])

    def at(self, stations: Array) -> Array:
        """The four quantities (m, 4) m at stations (m,), m."""
        shifts = [self.rails(s) or ((0.0, 0.0), (0.0, 0.0)) for s in stations.tolist()]
        return np.asarray(np.reshape(np.array(shifts), (-1, 4)) @ np.linalg.inv(RAILS).T)
