"""Interpolating and smoothing splines of measured profile points."""

from __future__ import annotations

from collections.abc import Sequence
from itertools import pairwise

import numpy as np
from numpy.typing import NDArray
from scipy.interpolate import CubicSpline, make_smoothing_spline
from scipy.optimize import brentq

from wheelrail.meshes.curves.arc_length import CurveSegment
from wheelrail.support.arrays import Array, Complex

CORNER = np.radians(20.0)  # a larger angle between chords is a corner, at which a smooth spline would oscillate
CORNER_CHORD = 40.0  # times the noise, shortest chords of a corner: the noise then turns them by 3.5 degrees
PENALTIES = (-9.0, 5.0)  # log10 of the smoothing parameter in mm3: from interpolation to almost a straight line


def through(points: Array, noise: float = 0.0) -> list[CurveSegment]:
    """Cubic spline (C2) through points (n, 2) m, cut at corners sharper than 20 degrees.

    Parameters:
        points: (n, 2) m.
        noise: RMS distance of the curve from the points, normal to it, m: smoothing splines of that distance, with the
            least integral of the squared second derivative; 0 passes through the points.

    The knots of the sections are the points.
    """
    z = points[:, 0] + 1j * points[:, 1]
    sections: list[CurveSegment] = []
    for first, last in pairwise([0, *_corners(z, noise), len(z) - 1]):
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


def at_points(sections: Sequence[CurveSegment]) -> tuple[Complex, Array]:
    """Positions y + iz (n,) m of the points of `through` on its curve, and directions (n,) rad there."""
    first, *later = sections
    knots = [(first, first.knots), *((section, section.knots[1:]) for section in later)]
    position = np.concatenate([section.position(t) for section, t in knots])
    return position, np.angle(np.concatenate([section.velocity(t) for section, t in knots]))


def _corners(z: Complex, noise: float) -> list[int]:
    """Indices of the corners of a line of points y + iz m."""
    if noise > 0.0:
        spread = [0]
        for i in range(1, len(z)):
            if abs(z[i] - z[spread[-1]]) >= CORNER_CHORD * noise:
                spread.append(i)
        indices: NDArray[np.intp] = np.array(spread)
    else:
        indices = np.arange(len(z))
    chord = np.diff(z[indices])
    turns = np.flatnonzero(np.abs(np.angle(chord[1:] / chord[:-1])) > CORNER) + 1
    corners: list[int] = indices[turns].tolist()
    return corners


def _smoothed(part: Complex, length: Array, noise: float) -> CurveSegment:
    """Smoothing spline of y and z with the smoothing parameter of the discrepancy principle: residual equal to noise.

    C. Reinsch, Smoothing by spline functions, doi:10.1007/BF02162161.
    """
    parameter, points = 1e3 * length, 1e3 * part

    def fitted(penalty: float) -> tuple[CurveSegment, float]:
        y, z = (make_smoothing_spline(parameter, values, lam=10.0**penalty) for values in (points.real, points.imag))
        dy, dz = y.derivative(), z.derivative()

        def position(t: Array) -> Complex:
            return np.asarray(1e-3 * (y(1e3 * t) + 1j * z(1e3 * t)))

        def velocity(t: Array) -> Complex:
            return np.asarray(dy(1e3 * t) + 1j * dz(1e3 * t))

        tangent = velocity(length)
        normal_residual = ((position(length) - part) * tangent.conj()).imag / np.abs(tangent)
        running = np.abs(tangent.real) > np.abs(tangent.imag)  # noise may be vertical
        counted = normal_residual[running] if 2 * running.sum() > len(running) else normal_residual
        return CurveSegment(position, velocity, length), float(np.sqrt(np.mean(counted**2)))

    def excess(penalty: float) -> float:
        return float(np.log(max(fitted(penalty)[1], 1e-15) / noise))

    low, high = PENALTIES
    if excess(low) > 0.0:
        return fitted(low)[0]
    if excess(high) < 0.0:
        return fitted(high)[0]
    return fitted(brentq(excess, low, high, xtol=0.02))[0]


def _shifted(section: CurveSegment, shift: complex) -> CurveSegment:
    return CurveSegment(lambda t: section.position(t) + shift, section.velocity, section.knots)
