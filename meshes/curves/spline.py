"""Splines through measured points of a profile."""

from __future__ import annotations

from itertools import pairwise
from typing import Any

import numpy as np
from scipy.interpolate import CubicSpline, splev, splprep

from wheelrail.meshes.curves.arc_length import CurveSegment
from wheelrail.support.arrays import Array, Complex

CORNER = np.radians(20.0)  # a larger angle between chords is a corner, at which a smooth spline would oscillate


def through(points: Array, noise: float = 0.0) -> list[CurveSegment]:
    """Cubic spline (C2) through points (n, 2) m, cut at corners sharper than 20 degrees.

    noise m: RMS distance that the spline may keep from the points, to smooth measured ones; 0 passes through them.
    """
    z = points[:, 0] + 1j * points[:, 1]
    chord = np.diff(z)
    corners = np.flatnonzero(np.abs(np.angle(chord[1:] / chord[:-1])) > CORNER) + 1
    sections: list[CurveSegment] = []
    for first, last in pairwise([0, *corners.tolist(), len(z) - 1]):
        part = z[first : last + 1]
        length = np.concatenate([[0.0], np.cumsum(np.abs(np.diff(part)))])
        if noise > 0.0 and len(part) > 4:
            section = _smoothed(part, length, noise)
            shift = sections[-1].stop - section.start if sections else 0.0  # smoothed parts must meet
            sections.append(_shifted(section, shift))
        else:
            spline = CubicSpline(length, part)
            shift = sections[-1].stop - part[0] if sections else 0.0
            sections.append(_shifted(CurveSegment(spline, spline.derivative(), length), shift))
    return sections


def _smoothed(part: Complex, length: Array, noise: float) -> CurveSegment:
    knots, (y, z), degree = splprep([part.real, part.imag], u=length, s=len(part) * noise**2)[0]

    def value(t: Array, order: int) -> Complex:
        parts: list[Any] = [splev(t, (knots, c, degree), der=order) for c in (y, z)]
        return np.asarray(parts[0] + 1j * parts[1])

    return CurveSegment(lambda t: value(t, 0), lambda t: value(t, 1), np.unique(np.clip(knots, 0.0, length[-1])))


def _shifted(section: CurveSegment, shift: complex) -> CurveSegment:
    return CurveSegment(lambda t: section.position(t) + shift, section.velocity, section.knots)
