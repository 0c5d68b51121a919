"""Sections of a track in compiled code, see `wheelrail.vehicle.track.section_poses`."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from wheelrail.support.arrays import Array
from wheelrail.vehicle.multibody.compiled.vectors import Matrix, Number, Vector, add, analytic, load, product, store
from wheelrail.vehicle.track.section_poses import GAUSS_NODES, GAUSS_WEIGHTS

# Indices of functions of the alignment; those of the first and the second derivatives are larger by 3 and 6.
HEADING, CURVATURE, SUPERELEVATION, GRADIENT = range(4)
STEP = 1e-20  # imaginary part of a distance; its square is lost in the real parts


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
def section_of(rows: Array) -> Section:
    """Section of rows (6, 3), see `store_section`."""
    return Section(load(rows[0]), (load(rows[1]), load(rows[2]), load(rows[3])), load(rows[4]), load(rows[5]))


@analytic
def store_section(section: Section, rows: Array) -> None:
    """Fill rows (6, 3): position, axes, rotation per length and its derivative."""
    store(rows[0], section.position)
    for k in range(3):
        store(rows[1 + k], section.axes[k])
    store(rows[4], section.rate)
    store(rows[5], section.rate_slope)


@analytic
def piece_of(track: TrackArrays, s: Number) -> int:
    """Index of the piece at a distance m."""
    piece = 0
    while piece + 1 < len(track.starts) and s.real >= track.starts[piece + 1]:
        piece += 1
    return piece


@analytic
def alignment(track: TrackArrays, piece: int, function: int, s: Number) -> Number:
    """Value of a polynomial of a piece at a distance m."""
    x = s - track.starts[piece]
    last = track.coefficients.shape[1] - 1
    value = track.coefficients[piece, last, function] + 0.0 * x
    for power in range(last - 1, -1, -1):
        value = value * x + track.coefficients[piece, power, function]
    return value


@analytic
def advance(track: TrackArrays, piece: int, start: float, end: float, heading: float) -> Vector:
    """Displacement m along the centre line within a piece, x along a heading, rad: Gauss quadrature of the tangent."""
    half, middle = 0.5 * (end - start), 0.5 * (start + end)
    x, y, z = 0.0, 0.0, 0.0
    for i in range(len(GAUSS_NODES)):
        s, step = middle + half * GAUSS_NODES[i], half * GAUSS_WEIGHTS[i]
        turned, a = alignment(track, piece, HEADING, s) - heading, alignment(track, piece, GRADIENT, s)
        along = step * np.cos(a)
        x, y, z = x + along * np.cos(turned), y + along * np.sin(turned), z + step * np.sin(a)
    return x, y, z


@analytic
def line_position(track: TrackArrays, s: float, reference: float, heading: float) -> Vector:
    """Position m of the centre line at a distance from that at a reference, m, x along its heading, rad."""
    piece, last, start = piece_of(track, reference), piece_of(track, s), reference
    position: Vector = (0.0, 0.0, 0.0)
    while piece != last:
        end = track.starts[piece + 1] if piece < last else track.starts[piece]
        position = add(position, advance(track, piece, start, end, heading))
        piece, start = piece + (1 if piece < last else -1), end
    return add(position, advance(track, piece, start, s, heading))


@analytic
def orientation_at(track: TrackArrays, s: Number, heading: Number) -> tuple[Matrix, Vector, Vector]:
    """Axes, rotation per length and its derivative at a distance m, in axes of a heading, rad."""
    piece = piece_of(track, s)
    angle = alignment(track, piece, HEADING, s) - heading
    curvature, dcurvature = alignment(track, piece, CURVATURE, s), alignment(track, piece, CURVATURE + 3, s)
    h, dh = alignment(track, piece, SUPERELEVATION, s), alignment(track, piece, SUPERELEVATION + 3, s)
    a, da = alignment(track, piece, GRADIENT, s), alignment(track, piece, GRADIENT + 3, s)
    ddh, dda = alignment(track, piece, SUPERELEVATION + 6, s), alignment(track, piece, GRADIENT + 6, s)
    h, dh, ddh = h / -track.base, dh / -track.base, ddh / -track.base
    root = np.sqrt(1.0 - h * h)
    p, dp, ddp = np.arctan(h / root), dh / root, ddh / root + h * dh * dh / (root * root * root)
    ca, sa, cp, sp, ch, sh = np.cos(a), np.sin(a), np.cos(p), np.sin(p), np.cos(angle), np.sin(angle)
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
    return product(upright, rolled), rate, rate_slope


@analytic
def section_at(track: TrackArrays, s: float, reference: float) -> Section:
    """Section at a distance, in the axes at the distance of the reference, m."""
    heading = alignment(track, piece_of(track, reference), HEADING, reference)
    axes, rate, rate_slope = orientation_at(track, s, heading)
    return Section(line_position(track, s, reference, heading), axes, rate, rate_slope)


@analytic
def rate_curvature(track: TrackArrays, s: float) -> Vector:
    """Second derivative rad/m3 of the rotation per length at a distance m, by a complex step."""
    _, _, slope = orientation_at(track, complex(s, STEP), complex(0.0, 0.0))
    return slope[0].imag / STEP, slope[1].imag / STEP, slope[2].imag / STEP
