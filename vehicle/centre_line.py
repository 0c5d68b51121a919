"""Where a track runs in space."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from vehicle.track import Track

Array = NDArray[np.float64]


def centre_line(track: Track, length: float, *, spacing: float = 1.0) -> tuple[Array, Array]:
    """Stations (n,) m from 0 to a length, at most `spacing` m apart, and points of the centre line there (n, 3) m.

    x along the tangent at the start in plan, y to its left, z up. Four Gauss points for each interval, whose headings
    are known beforehand: errors of an arc are of the order (spacing / radius)^8.
    """
    stations = np.linspace(0.0, length, int(np.ceil(length / spacing)) + 1, dtype=np.float64)
    nodes, weights = np.polynomial.legendre.leggauss(4)  # type: ignore[no-untyped-call]
    half = 0.5 * np.diff(stations)[:, None]
    inner = (0.5 * (stations[1:] + stations[:-1])[:, None] + half * nodes).ravel()
    heading = np.array([track.heading(s) for s in inner.tolist()])
    gradient = np.array([track.gradient(s)[0] for s in inner.tolist()])
    along = np.stack([np.cos(gradient) * np.cos(heading), np.cos(gradient) * np.sin(heading), np.sin(gradient)], axis=1)
    steps = (half * weights)[:, :, None] * along.reshape(len(half), -1, 3)
    return stations, np.concatenate([np.zeros((1, 3)), np.cumsum(steps.sum(axis=1), axis=0)])
