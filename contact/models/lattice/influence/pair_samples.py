"""Compiled: coefficients of the tables of pairs of strips, from half-spaces and the deviations of finite bodies."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from wheelrail.contact.elasticity.half_space import pair_antiderivative, pair_geometry
from wheelrail.contact.models.lattice.influence.body_correction import START, add_pair_mean
from wheelrail.contact.models.lattice.influence.pair_grid import (
    CELLS,
    COMPONENTS,
    DEGREE,
    EVEN,
    NN,
    REACH,
    ROLL,
    TN,
    TN_TURN,
    TO_POWERS,
    TT,
    XN,
    XT,
    XX,
    join_cells,
    lobatto,
)
from wheelrail.support.arrays import Array, Nodes
from wheelrail.support.compiled import borrowing, compiled

NODES = lobatto(DEGREE + 1)
INTEGRALS = (NODES[:, None] ** np.arange(1, DEGREE + 2) / np.arange(1, DEGREE + 2)) @ TO_POWERS  # from 0 to the nodes
NEAR = 0.004, 0.03, 0.5  # of the width, on the strip itself and next to it; of the distance, beyond


class LatticeStrips(NamedTuple):
    """Strips of a lattice on the upper body.

    Parameters:
        sides: (K + 1,) m, lateral bounds.
        angle: (K,) rad, inclination to the axle.
        stretch: (K,) length over that on the rolling circle.
    """

    sides: Array
    angle: Array
    stretch: Array


class HalfSpaces(NamedTuple):
    """Half-spaces under both bodies, upper and lower.

    Parameters:
        nu: (2,) Poisson's ratios.
        scale: (2,) 1/Pa.
        outward: (2,) 1 where the normal of the tables is the body's outward one, else -1.
        radius: m, of a wheel that compresses; 0 without.
    """

    nu: Array
    scale: Array
    outward: Array
    radius: float


class Deviation(NamedTuple):
    """Deviation of a body from a half-space that does not depend on the pose.

    Parameters:
        lines: (ns, ns, cells, DEGREE + 1, COMPONENTS) between all lines, see `BodyCorrection`.
        first: number of the first line.
        share: (K, n) weights of lines in the means over the strips; (0, 0) without deviation.
    """

    lines: Array
    first: int
    share: Array


@borrowing
def start_of(strips: LatticeStrips, i: int, j: int) -> float:
    """Length m of the first octave of cells of a pair."""
    sides = strips.sides
    width = min(sides[i + 1] - sides[i], sides[j + 1] - sides[j])
    if i == j:
        return float(NEAR[0] * width)
    distance = 0.5 * (sides[j] + sides[j + 1] - sides[i] - sides[i + 1])
    return float(max(NEAR[1] * width, NEAR[2] * (distance - width)))


@borrowing
def count_of(start: float) -> int:
    """Number of cells up to `REACH`."""
    return int(np.ceil(np.log2(1.0 + REACH / start))) * CELLS


@borrowing
def _rotate(near: Array, cosine: float, sine: float, to: Array) -> None:
    """Components (COMPONENTS,) of a half-space in the axes of two strips.

    Parameters:
        near: (6,) along, across, normal, along by across, along by normal and across by normal, in the strips' mean
            axes, from which the axes of the displaced strip are turned by -tilt, those of the loaded one by tilt,
            positive from the lateral towards the upper body's outward normal.
        cosine, sine: of the tilt.
    """
    across, normal, t_by_n = near[1], near[2], near[5]
    twice_cosine, twice_sine = cosine * cosine - sine * sine, 2.0 * cosine * sine
    to[XX] = near[0]
    to[TT] = cosine * cosine * across - sine * sine * normal + twice_sine * t_by_n
    to[NN] = cosine * cosine * normal - sine * sine * across + twice_sine * t_by_n
    to[TN] = 0.0
    to[TN_TURN] = twice_cosine * t_by_n - cosine * sine * (across + normal)
    to[XT] = near[3] * cosine + near[4] * sine
    to[ROLL] = 0.0
    to[XN] = near[4] * cosine - near[3] * sine


@borrowing
def _at(coefficients: Array, x: float, to: Array) -> None:
    """Values (COMPONENTS,) of a deviation at x >= 0 m."""
    z = x / START + 1.0
    octave = int(np.floor(np.log2(z)))
    base = 2.0**octave
    cell = min(octave * CELLS + int((z / base - 1.0) * CELLS), len(coefficients) - 1)
    base = 2.0 ** (cell // CELLS)
    u = z - base * (1.0 + (cell % CELLS) / CELLS)
    for c in range(COMPONENTS):
        value = coefficients[cell, DEGREE, c]
        for k in range(DEGREE - 1, -1, -1):
            value = value * u + coefficients[cell, k, c]
        to[c] = value


@compiled
def pair_coefficients(
    strips: LatticeStrips,
    i: int,
    j: int,
    bodies: HalfSpaces,
    deviations: tuple[Deviation, Deviation],
    values: Array,
) -> None:
    """Write the coefficients (cells, DEGREE + 1, COMPONENTS) of a pair i <= j."""
    start = start_of(strips, i, j)
    tilt, angle = 0.5 * (strips.angle[j] - strips.angle[i]), 0.5 * (strips.angle[i] + strips.angle[j])
    cosine, sine = np.cos(tilt), np.sin(tilt)
    normal = np.cos(angle)
    stretch = 0.5 * (strips.stretch[i] + strips.stretch[j])
    rolls = bodies.radius > 0.0 and len(deviations[0].share) > 0
    means = np.zeros((2, count_of(START), DEGREE + 1, COMPONENTS))
    for b in range(2):
        body = deviations[b]
        if len(body.share):
            add_pair_mean(body.lines, body.first, body.share[i], body.share[j], means[b])
    row, column = strips.sides[i : i + 2], strips.sides[j : j + 2]
    geometry, near, samples = np.empty(5), np.empty(6), np.zeros((DEGREE + 1, COMPONENTS))
    upper, lower, part = np.empty(COMPONENTS), np.empty(COMPONENTS), np.empty(COMPONENTS)
    integral, radial = 0.0, np.empty(DEGREE + 1)
    widths = np.empty(len(values))
    for cell in range(len(values)):
        base = 2.0 ** (cell // CELLS)
        lower_z, width = base * (1.0 + (cell % CELLS) / CELLS), base / CELLS
        widths[cell] = width
        for node in range(DEGREE + 1):
            x = (lower_z + width * NODES[node] - 1.0) * start
            pair_geometry(x, row, column, geometry)
            for b in range(2):
                total = upper if b == 0 else lower
                pair_antiderivative(geometry, bodies.nu[b], near)
                for c in range(6):
                    near[c] *= bodies.scale[b] * (bodies.outward[b] if c >= 4 else 1.0)
                _rotate(near, cosine, sine, total)
                if len(deviations[b].share):
                    _at(means[b], x / stretch, part)
                    for c in range(COMPONENTS):
                        total[c] += stretch * stretch * part[c]
            for c in range(COMPONENTS):
                samples[node, c] = upper[c] + lower[c]
            radial[node] = normal * upper[NN]
        if rolls:
            for node in range(DEGREE + 1):
                total_integral = integral
                for k in range(DEGREE + 1):
                    total_integral += width * start * INTEGRALS[node, k] * radial[k]
                samples[node, ROLL] = total_integral / (bodies.radius * stretch)
            integral = samples[DEGREE, ROLL] * bodies.radius * stretch
        for k in range(DEGREE + 1):
            for c in range(COMPONENTS):
                value = 0.0
                for node in range(DEGREE + 1):
                    value += TO_POWERS[k, node] * samples[node, c]
                values[cell, k, c] = value / width**k
    join_cells(values, widths, EVEN)


@compiled
def fill(
    strips: LatticeStrips,
    pairs: Nodes,
    bodies: HalfSpaces,
    deviations: tuple[Deviation, Deviation],
    first: Nodes,
    values: Array,
) -> None:
    """Write the coefficients of pairs (P, 2) into the tables' values from cells first (P + 1,) on."""
    for p in range(len(pairs)):
        i, j = pairs[p]
        pair_coefficients(strips, i, j, bodies, deviations, values[first[p] : first[p + 1]])
