"""Compiled: contact points of the cells of a state, with their tractions, slips and displacements."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from wheelrail.contact.models.lattice.influence.operator import slips_and_moments
from wheelrail.contact.models.lattice.system.equations import (
    EquationData,
    cell_middles,
    cell_pressures,
    displacements,
    force_jumps,
    rigid_slip_at,
    strip_grid,
)
from wheelrail.contact.models.lattice.system.friction import margins
from wheelrail.contact.models.lattice.system.surface import SurfaceData, SurfaceFrames, frames, penetration
from wheelrail.contact.results.patch_sums import PatchPoints
from wheelrail.meshes.curves.closest_point import local, piece
from wheelrail.support.arrays import Array, Nodes
from wheelrail.support.compiled import borrowing, compiled


class StripCells(NamedTuple):
    """Cells of S strips of M cells, strip by strip from the trailing end.

    Parameters:
        inside: whether all distances lie in the tables.
        points: their middles, n = S M contact points.
        penetration: (n,) m, undeformed penetration.
        slip: (n, 2) over the rolling speed; zero without friction.
        displacement: (n, 3) m, upper minus lower body, means over the cells.
        margin: (n,) Pa, see `margins`; zero without friction.
        patch: (S,) number of the strip's patch, by decreasing load.
    """

    inside: bool
    points: PatchPoints
    penetration: Array
    slip: Array
    displacement: Array
    margin: Array
    patch: Nodes


@compiled
def strip_cells(values: Array, data: EquationData) -> StripCells:
    """`StripCells` of a state with values (S, block)."""
    places, basis, motion, surface = data.places, data.basis, data.motion, data.surface
    S, M = len(values), len(basis.marks) - 1
    rolls, n = motion.speed > 0.0, S * M
    grid = strip_grid(values, places, basis)
    inside, V = displacements(values, grid, force_jumps(values, places, basis, rolls), data)
    s, x = cell_middles(values, places, basis)
    at = frames(surface, motion.origin, motion.rotation, s, x)
    under = penetration(surface, motion.origin, motion.rotation, s, x)
    on_wheel, on_rail, level = np.empty((n, 2)), np.empty((n, 2)), np.empty((n, 3))
    _store_places(surface, motion.rotation, s, at, under.foot, on_wheel, on_rail, level)
    area, step, displacement = np.empty(n), np.empty(n), np.empty((n, 3))
    pressure = cell_pressures(values, basis, rolls).ravel()
    for i in range(S):
        for r in range(M):
            q, length = i * M + r, grid.x[i, r + 1] - grid.x[i, r]
            step[q], area[q] = length, length * places.width[i]
            for k in range(3):
                displacement[q, k] = (V[i, r + 1, k] - V[i, r, k]) / length
    traction, slip, margin = np.zeros((n, 2)), np.zeros((n, 2)), np.zeros(n)
    if rolls:
        elastic, rigid = slips_and_moments(V, grid, basis)[0], rigid_slip_at(at, data)[0]
        _store_friction(values, elastic, rigid, pressure, data, traction, slip, margin)
    points = PatchPoints(at.point, at.axes, level, area, step, on_wheel, on_rail, pressure, traction, margin > 0.0)
    patch = strip_patches(values, places.strip, pressure * area)
    return StripCells(inside, points, under.depth, slip, displacement, margin, patch)


@borrowing
def _store_places(
    surface: SurfaceData,
    rotation: Array,
    s: Array,
    at: SurfaceFrames,
    foot: Array,
    on_wheel: Array,
    on_rail: Array,
    level: Array,
) -> None:
    """Fill places on both profiles and longitudinal axes in the rail's surface, perpendicular to the axle, of points
    at s (n,) m with closest points foot (n,) m on the rail.
    """
    z, last = 0j, np.inf
    for i in range(len(s)):
        on_wheel[i, 0], on_rail[i, 0] = s[i], foot[i]
        if not surface.revolves:
            on_wheel[i, 1], on_rail[i, 1] = s[i], foot[i]
            for c in range(3):
                level[i, c] = at.axes[i, 0, c]
            continue
        if s[i] != last:
            z, _, _ = local(surface.wheel, s[i], piece(surface.wheel, s[i]))
            last = s[i]
        on, t, _ = local(surface.rail, foot[i], piece(surface.rail, foot[i]))
        on_wheel[i, 1], on_rail[i, 1] = z.real, on.real
        # axle times the rail's normal (0, -t_z, t_y)
        forward = rotation[1, 1] * t.real + rotation[2, 1] * t.imag
        size = np.sqrt(forward * forward + rotation[0, 1] * rotation[0, 1])
        level[i, 0] = forward / size
        level[i, 1], level[i, 2] = -rotation[0, 1] * t.real / size, -rotation[0, 1] * t.imag / size


@compiled
def _store_friction(
    values: Array,
    elastic: Array,
    rigid: Array,
    pressure: Array,
    data: EquationData,
    traction: Array,
    slip: Array,
    margin: Array,
) -> None:
    """Fill tractions, slips and margins from the elastic and the rigid slip (S, 2, M) and pressures (n,) Pa."""
    S, _, M = elastic.shape
    q, s, p, rho = np.empty((2, S * M)), np.empty((2, S * M)), np.empty(S * M), np.empty(S * M)
    for i in range(S):
        for r in range(M):
            n = i * M + r
            p[n], rho[n] = max(pressure[n], 0.0), data.rho[r]
            for k in range(2):
                q[k, n], s[k, n] = values[i, k * M + r], elastic[i, k, r] + rigid[i, k, r]
                traction[n, k], slip[n, k] = q[k, n], s[k, n]
    margin[:] = margins(data.law, q, s, p, rho, data.motion.speed)


@compiled
def strip_patches(values: Array, strip: Nodes, load: Array) -> Nodes:
    """Patch (S,) of every strip, by decreasing load: neighbours that overlap along x share one.

    Parameters:
        values: (S, block) of the strips.
        strip: (S,) their numbers on the lattice, ascending.
        load: (S M,) N, of their cells.
    """
    S = len(values)
    M, count = len(load) // S, 0
    patch, total = np.zeros(S, dtype=np.int64), np.zeros(S)
    for i in range(S):
        overlaps = i > 0 and values[i, -2] < values[i - 1, -1] and values[i - 1, -2] < values[i, -1]
        if not (overlaps and strip[i] == strip[i - 1] + 1):
            count += 1
        patch[i] = count - 1
        for r in range(M):
            total[count - 1] += load[i * M + r]
    rank = np.empty(count, dtype=np.int64)
    rank[np.argsort(-total[:count], kind="mergesort")] = np.arange(count)
    return rank[patch]
