"""Sections of a track in compiled code, see `wheelrail.vehicle.track.section_poses`."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from wheelrail.support.arrays import Array
from wheelrail.vehicle.multibody.compiled.vectors import Matrix, Vector, add, analytic, product
from wheelrail.vehicle.track.section_poses import GAUSS_NODES, GAUSS_WEIGHTS

HEADING, GRADIENT = 0, 3  # indices of functions of the alignment
FUNCTIONS = 10  # heading; curvature, superelevation and gradient; their first, then their second derivatives


class TrackArrays(NamedTuple):
    """Local polynomials of the alignment.

    Parameters:
        starts: (m,) m, of the pieces.
        coefficients: (m, degree + 1, 10), those of `TrackSections.alignment`.
        base: m, on which the superelevation is measured.
    """

    starts: Array
    coefficients: Array
    base: float


class Section(NamedTuple):
    """Section of the track: position m, axes as columns, rotation per length rad/m and its derivative rad/m2."""

    position: Vector
    axes: Matrix
    rate: Vector
    rate_slope: Vector


@analytic
def piece_of(track: TrackArrays, s: complex) -> int:
    """Index of the piece at a distance m."""
    piece = 0
    while piece + 1 < len(track.starts) and s.real >= track.starts[piece + 1]:
        piece += 1
    return piece


@analytic
def alignment(track: TrackArrays, piece: int, function: int, s: complex) -> complex:
    """Value of a polynomial of a piece at a distance m."""
    x = s - track.starts[piece]
    last = track.coefficients.shape[1] - 1
    value: complex = track.coefficients[piece, last, function] + 0.0 * x
    for power in range(last - 1, -1, -1):
        value = value * x + track.coefficients[piece, power, function]
    return value


@analytic
def advance(track: TrackArrays, piece: int, start: complex, end: complex, heading: complex) -> Vector:
    """Displacement m along the centre line within a piece, x along a heading, rad: Gauss quadrature of the tangent."""
    half, middle = 0.5 * (end - start), 0.5 * (start + end)
    x, y, z = 0.0 * half, 0.0 * half, 0.0 * half
    angles = np.empty(2, np.complex128)
    for i in range(len(GAUSS_NODES)):
        for k in range(2):
            angles[k] = alignment(track, piece, k * GRADIENT, middle + half * GAUSS_NODES[i])
        turned, a, step = angles[0] - heading, angles[1], half * GAUSS_WEIGHTS[i]
        along = step * np.cos(a)
        x, y, z = x + along * np.cos(turned), y + along * np.sin(turned), z + step * np.sin(a)
    return x, y, z


@analytic
def line_position(track: TrackArrays, s: complex, reference: complex, heading: complex) -> Vector:
    """Position m of the centre line at a distance from that at a reference, m, x along its heading, rad."""
    piece, last, start = piece_of(track, reference), piece_of(track, s), reference + 0.0 * s
    position = (0.0 * s, 0.0 * s, 0.0 * s)
    while piece != last:
        end = track.starts[piece + 1] if piece < last else track.starts[piece]
        position = add(position, advance(track, piece, start, end + 0.0 * s, heading))
        piece, start = piece + (1 if piece < last else -1), end + 0.0 * s
    return add(position, advance(track, piece, start, s, heading))


@analytic
def section_at(track: TrackArrays, s: complex, reference: complex) -> Section:
    """Section at a distance, in the axes at the distance of the reference, m."""
    piece, values = piece_of(track, s), np.empty(FUNCTIONS, np.complex128)
    for k in range(FUNCTIONS):
        values[k] = alignment(track, piece, k, s)
    at_reference = alignment(track, piece_of(track, reference), HEADING, reference)
    heading = values[HEADING] - at_reference
    curvature, h, a = values[1], values[2], values[3]
    dcurvature, dh, da, ddh, dda = values[4], values[5], values[6], values[8], values[9]
    h, dh, ddh = h / -track.base, dh / -track.base, ddh / -track.base
    root = np.sqrt(1.0 - h * h)
    p, dp, ddp = np.arctan(h / root), dh / root, ddh / root + h * dh * dh / (root * root * root)
    ca, sa, cp, sp, ch, sh = np.cos(a), np.sin(a), np.cos(p), np.sin(p), np.cos(heading), np.sin(heading)
    turn, dturn = curvature * ca, dcurvature * ca - curvature * da * sa
    across, dacross = turn * ca, dturn * ca - turn * da * sa
    rate = (dp + turn * sa, across * sp - da * cp, across * cp + da * sp)
    rate_slope = (
        ddp + dturn * sa + turn * da * ca,
        dacross * sp + across * dp * cp - dda * cp + da * dp * sp,
        dacross * cp - across * dp * sp + dda * sp + da * dp * cp,
    )
    zero = 0.0 * sh
    upright = ((ch * ca, sh * ca, sa), (-sh, ch, zero), (-ch * sa, -sh * sa, ca))
    rolled = ((1.0 + zero, zero, zero), (zero, cp, sp), (zero, -sp, cp))
    return Section(line_position(track, s, reference, at_reference), product(upright, rolled), rate, rate_slope)
