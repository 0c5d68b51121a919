"""Motion of the track frame along a track in tests."""

from __future__ import annotations

from functools import cache
from typing import NamedTuple

import numpy as np

from wheelrail.support.arrays import Array
from wheelrail.vehicle.track.section_poses import TrackSections
from wheelrail.vehicle.track.track import Track


class Frame(NamedTuple):
    """Motion of the track frame (x tangent, y left, z normal to the rails), components in its own axes.

    Parameters:
        speed, acceleration: along x, m/s and m/s2.
        rate, rate_dot: (3,) rad/s and rad/s2.
        down: (3,) unit vector of gravity.
    """

    speed: float
    acceleration: float
    rate: Array
    rate_dot: Array
    down: Array


sections = cache(TrackSections)


def frame_at(track: Track, s: float, speed: float, acceleration: float = 0.0) -> Frame:
    """Frame at a distance m."""
    _, axes, rate, slope = sections(track).at(np.array(s), s)
    return Frame(speed, acceleration, speed * rate, acceleration * rate + speed**2 * slope, -axes[2])


def heading(track: Track, s: float) -> float:
    """Angle of the tangent in plan relative to s = 0, rad."""
    alignment = TrackSections(track).alignment
    return float(alignment(np.array(s))[0] - alignment(np.array(0.0))[0])
