"""Compiled: residual and Jacobian of all equations of a state, from the compliance and the surfaces."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from wheelrail.contact.laws.residual_call import ResidualCode, friction_residual, friction_slopes
from wheelrail.contact.models.lattice.influence.basis import MODES, StripBasis
from wheelrail.contact.models.lattice.influence.operator import StripGrid, antiderivatives, operator, slips_and_moments
from wheelrail.contact.models.lattice.influence.pair_tables import PairTables
from wheelrail.contact.models.lattice.influence.short_strips import (
    add_short_strips,
    add_short_strips_derivative,
)
from wheelrail.contact.models.lattice.system.partial_width import opening
from wheelrail.contact.models.lattice.system.surface import (
    GAUSS,
    Motion,
    SurfaceData,
    SurfaceFrames,
    frames,
    penetration,
    rigid_shift,
)
from wheelrail.support.arrays import Array, Nodes, Single
from wheelrail.support.compiled import borrowing, compiled, inlined

SLOPES = 10 + 2 * MODES  # of the friction residual of a cell, see `slopes_of_friction`


class StripPlaces(NamedTuple):
    """Loaded strips: middle and width (S,) m, stretch (S,) length over that on the rolling circle, their longitudinal
    axes (S, 3) where the surfaces touch, their numbers (S,) on the lattice, onset (S,) m of contact, and the load
    (S,) Pa m, amplitude times half length, from which they touch on their whole width.
    """

    middle: Array
    width: Array
    stretch: Array
    level: Array
    strip: Nodes
    onset: Array
    whole: Array


class EquationData(NamedTuple):
    """Data of the equations of some strips at a pose; rho (M,) 1/Pa of the friction residual."""

    tables: PairTables
    surface: SurfaceData
    motion: Motion
    places: StripPlaces
    basis: StripBasis
    law: ResidualCode
    rho: Array


class Evaluation(NamedTuple):
    """Residual of a state and what belongs to it.

    Parameters:
        inside: whether all points lie on the surfaces and in the tables.
        residual: (S, block): friction Pa along and across, moments of the gap m.
        V: (S, M + 3, 3), see `wheelrail.contact.models.lattice.influence.operator`.
        pressure: (S, M) Pa, means over the cells.
        slip: (S, 2, M) over the speed.
        rigid_slope: (S, 2, M) 1/m, change of its rigid part along x.
        depth_slope: (S, STATIONS) change of the penetration along x.
    """

    inside: bool
    residual: Array
    V: Array
    pressure: Array
    slip: Array
    rigid_slope: Array
    depth_slope: Array


@compiled
def strip_grid(values: Array, places: StripPlaces, basis: StripBasis) -> StripGrid:
    """Cells of a state with values (S, block)."""
    S, R = len(values), len(basis.row_marks)
    x, length = np.empty((S, R)), np.empty(S)
    for i in range(S):
        low, high = values[i, -2], values[i, -1]
        length[i] = places.stretch[i] * (high - low)
        for r in range(R):
            x[i, r] = places.stretch[i] * (low + (high - low) * basis.row_marks[r])
    return StripGrid(x, length, places.width, places.stretch, places.strip, places.middle)


@compiled
def force_jumps(values: Array, places: StripPlaces, basis: StripBasis, rolls: bool) -> Array:
    """Jumps (S, M + 1, 3) N/m of the tractions times width at the cell boundaries."""
    S, M, modes = len(values), len(basis.marks) - 1, basis.mean.shape[1]
    jumps = np.zeros((S, M + 1, 3))
    for i in range(S):
        at = 2 * M if rolls else 0
        for r in range(M):
            normal = 0.0
            for m in range(modes):
                normal -= values[i, at + m] * basis.loads[r, m]
            for k in range(3):
                traction = normal if k == 2 else (values[i, k * M + r] if rolls else 0.0)
                jumps[i, r, k] += traction * places.width[i]
                jumps[i, r + 1, k] -= traction * places.width[i]
    return jumps


@compiled
def _add_penetration(values: Array, data: EquationData, moments: Array) -> tuple[bool, Array]:
    """Add the moments (S, MOMENTS) of the penetration; its slopes (S, STATIONS), and whether it is defined."""
    places, basis, motion = data.places, data.basis, data.motion
    S, n = len(values), len(basis.stations)
    s, x = np.empty(2 * S * n), np.empty(2 * S * n)
    for i in range(S):
        for g in range(2):
            for k in range(n):
                at = (2 * i + g) * n + k
                s[at] = places.middle[i] + (2 * g - 1) * GAUSS * places.width[i]
                x[at] = values[i, -2] + (values[i, -1] - values[i, -2]) * basis.stations[k]
    at_points = penetration(data.surface, motion.origin, motion.rotation, s, x)
    slope, inside = np.zeros((S, n)), True
    for i in range(S):
        for g in range(2):
            for k in range(n):
                at = (2 * i + g) * n + k
                inside = inside and np.isfinite(at_points.depth[at])
                slope[i, k] += 0.5 * at_points.slope[at]
                for m in range(moments.shape[1]):
                    moments[i, m] += 0.5 * basis.penetration[m, k] * at_points.depth[at]
    return inside, slope


@compiled
def cell_middles(values: Array, places: StripPlaces, basis: StripBasis) -> tuple[Array, Array]:
    """Middles s, x (S M,) m of all cells across and along, strip by strip from the trailing end."""
    S, M = len(values), len(basis.marks) - 1
    s, x = np.empty(S * M), np.empty(S * M)
    for i in range(S):
        for r in range(M):
            mark = 0.5 * (basis.marks[r] + basis.marks[r + 1])
            s[i * M + r] = places.middle[i]
            x[i * M + r] = values[i, -2] + (values[i, -1] - values[i, -2]) * mark
    return s, x


@compiled
def cell_frames(
    values: Array, places: StripPlaces, basis: StripBasis, surface: SurfaceData, motion: Motion
) -> SurfaceFrames:
    """Points and axes of the upper body at the middles of all cells (S M,)."""
    s, x = cell_middles(values, places, basis)
    return frames(surface, motion.origin, motion.rotation, s, x)


@compiled
def rigid_slip(values: Array, data: EquationData) -> tuple[Array, Array]:
    """Rigid slip (S, 2, M) over the speed at the cells, and its derivative 1/m along x."""
    return rigid_slip_at(cell_frames(values, data.places, data.basis, data.surface, data.motion), data)


@compiled
def rigid_slip_at(at: SurfaceFrames, data: EquationData) -> tuple[Array, Array]:
    """`rigid_slip` from the points and axes at the middles of all cells (S M,)."""
    places, motion = data.places, data.motion
    S, M = len(places.middle), len(data.basis.marks) - 1
    level = np.empty((S * M, 3))
    for i in range(S):
        level[i * M : (i + 1) * M] = places.level[i]
    shift, change, _ = rigid_shift(at, level, motion)
    slip, slope = np.empty((S, 2, M)), np.empty((S, 2, M))
    for i in range(S):
        for k in range(2):
            for r in range(M):
                slip[i, k, r] = shift[i * M + r, k] / motion.speed
                slope[i, k, r] = change[i * M + r, k] / motion.speed
    return slip, slope


@compiled
def cell_pressures(values: Array, basis: StripBasis, rolls: bool) -> Array:
    """Pressure (S, M) Pa, means over the cells."""
    S, M = len(values), len(basis.marks) - 1
    at = 2 * M if rolls else 0
    pressure = np.zeros((S, M))
    for i in range(S):
        for r in range(M):
            for m in range(basis.mean.shape[1]):
                pressure[i, r] += values[i, at + m] * basis.mean[r, m]
    return pressure


@compiled
def strip_loads(values: Array, places: StripPlaces, basis: StripBasis, rolls: bool) -> Array:
    """Loads (S, 2) N of strips: lateral tractions, and pressure."""
    S, M = len(values), len(basis.marks) - 1
    loads = np.zeros((S, 2))
    for i in range(S):
        area = places.width[i] * places.stretch[i] * (values[i, -1] - values[i, -2])
        if rolls:
            for r in range(M):
                loads[i, 0] += area * (basis.marks[r + 1] - basis.marks[r]) * values[i, M + r]
        loads[i, 1] = 0.25 * np.pi * area * values[i, -2 - MODES]
    return loads


@compiled
def resultants(values: Array, data: EquationData) -> Array:
    """Force N and moment N m about the origin (6,) on the upper body."""
    places, basis = data.places, data.basis
    S, M = len(values), len(basis.marks) - 1
    pressure = cell_pressures(values, basis, data.motion.speed > 0.0)
    rolls = data.motion.speed > 0.0
    at = cell_frames(values, places, basis, data.surface, data.motion)
    total, force = np.zeros(6), np.empty(3)
    for i in range(S):
        length = places.stretch[i] * (values[i, -1] - values[i, -2])
        for r in range(M):
            area = length * (basis.marks[r + 1] - basis.marks[r]) * places.width[i]
            axes, point = at.axes[i * M + r], at.point[i * M + r]
            along = values[i, r] if rolls else 0.0
            across = values[i, M + r] if rolls else 0.0
            for c in range(3):
                force[c] = area * (along * axes[0, c] + across * axes[1, c] - pressure[i, r] * axes[2, c])
                total[c] += force[c]
            for c in range(3):
                a, b = (c + 1) % 3, (c + 2) % 3
                total[3 + c] += point[a] * force[b] - point[b] * force[a]
    return total


@compiled
def displacements(values: Array, grid: StripGrid, jumps: Array, data: EquationData) -> tuple[bool, Array]:
    """Whether all distances lie in the tables, and the antiderivative V (S, M + 3, 3) of the displacements, by jumps
    (S, M + 1, 3) N/m of `force_jumps`.
    """
    basis = data.basis
    inside, V = antiderivatives(data.tables, grid, jumps)
    return inside and add_short_strips(data.tables, grid, values, basis, data.motion.speed > 0.0, V), V


@compiled
def _assembled(values: Array, V: Array, grid: StripGrid, data: EquationData) -> Evaluation:
    """Evaluation from the antiderivative V of the displacements, without the residual of friction."""
    basis, motion, places = data.basis, data.motion, data.places
    S, M = len(values), len(basis.marks) - 1
    rolls = motion.speed > 0.0
    slip, moments = slips_and_moments(V, grid, basis)
    inside, depth_slope = _add_penetration(values, data, moments)
    at = 2 * M if rolls else 0
    pressure = cell_pressures(values, basis, rolls)
    residuals = np.empty((S, at + moments.shape[1]))
    residuals[:, at:] = moments
    rigid_slope = np.zeros((S, 2, M))
    if rolls:
        rigid, rigid_slope = rigid_slip(values, data)
        slip += rigid
    for i in range(S):
        load = 0.5 * values[i, at] * (values[i, -1] - values[i, -2])
        residuals[i, at] += opening(load, places.onset[i], places.whole[i])[0]
    return Evaluation(inside, residuals, V, pressure, slip, rigid_slope, depth_slope)


@compiled
def _by_cell(values: Array, evaluation: Evaluation, data: EquationData) -> tuple[Array, Array, Array, Array]:
    """Tractions (2, S M) Pa, slips (2, S M) over the speed, pressures (2, S M) Pa at the ends and rho (S M,) 1/Pa.

    The pressure of a trial state may be negative: its bound is zero.
    """
    (S, M), ends = evaluation.pressure.shape, data.basis.ends
    q, s, p, rho = np.empty((2, S * M)), np.empty((2, S * M)), np.empty((2, S * M)), np.empty(S * M)
    for i in range(S):
        for r in range(M):
            n = i * M + r
            rho[n] = data.rho[r]
            for k in range(2):
                pressure = 0.0
                for m in range(MODES):
                    pressure += values[i, 2 * M + m] * ends[r, k, m]
                p[k, n] = max(pressure, 0.0)
                q[k, n], s[k, n] = values[i, k * M + r], evaluation.slip[i, k, r]
    return q, s, p, rho


@compiled
def _add_friction(values: Array, evaluation: Evaluation, data: EquationData) -> None:
    """Complete the residual by that of friction."""
    S, M = evaluation.pressure.shape
    F = friction_residual(data.law, *_by_cell(values, evaluation, data), data.motion.speed)
    for i in range(S):
        for k in range(2):
            for r in range(M):
                evaluation.residual[i, k * M + r] = F[k, i * M + r]


@compiled
def slopes_of_friction(values: Array, evaluation: Evaluation, data: EquationData) -> Array:
    """Slopes (S, M, SLOPES) of the friction residual by traction (4), slip (4), speed (2), and the pressure modes (2
    each); M = 0 without friction.
    """
    (S, M), ends = evaluation.pressure.shape, data.basis.ends
    if not data.motion.speed > 0.0:
        return np.zeros((S, 0, SLOPES))
    q, s, p, rho = _by_cell(values, evaluation, data)
    at_cells = friction_slopes(data.law, q, s, p, rho, data.motion.speed)
    slopes = np.zeros((S, M, SLOPES))
    for i in range(S):
        for r in range(M):
            n, to = i * M + r, slopes[i, r]
            at = at_cells[n]
            to[:8], to[8:10] = at[:8], at[12:]
            for k in range(2):
                if p[k, n] > 0.0:
                    for m in range(MODES):
                        to[10 + 2 * m] += at[8 + 2 * k] * ends[r, k, m]
                        to[11 + 2 * m] += at[9 + 2 * k] * ends[r, k, m]
    return slopes


@compiled
def evaluate(values: Array, data: EquationData) -> Evaluation:
    """Evaluation of a state with values (S, block)."""
    places, basis = data.places, data.basis
    grid = strip_grid(values, places, basis)
    jumps = force_jumps(values, places, basis, data.motion.speed > 0.0)
    inside, V = displacements(values, grid, jumps, data)
    evaluation = _assembled(values, V, grid, data)
    if data.motion.speed > 0.0:
        _add_friction(values, evaluation, data)
    return Evaluation(inside and evaluation.inside, *evaluation[1:])


@inlined
def linearise(values: Array, data: EquationData) -> tuple[Evaluation, Array]:
    """Evaluation and operator (n, n) of a state with values (S, block).

    Rows of the operator are slips, which `friction_rows` replaces by the friction residual, and moments.
    """
    places, basis = data.places, data.basis
    S, M = len(values), len(basis.marks) - 1
    rolls = data.motion.speed > 0.0
    grid = strip_grid(values, places, basis)
    inside, A, V = operator(data.tables, grid, force_jumps(values, places, basis, rolls), basis, rolls)
    inside = inside and add_short_strips_derivative(data.tables, grid, values, basis, rolls, A, V)
    evaluation = _assembled(values, V, grid, data)
    if rolls:
        _add_friction(values, evaluation, data)
    block, moments = values.shape[1], basis.penetration.shape[0]
    for i in range(S):
        last = (i + 1) * block
        for k in range(moments):
            for g in range(len(basis.stations)):
                part = basis.penetration[k, g] * evaluation.depth_slope[i, g]
                A[last - moments + k, last - 2] += part * (1.0 - basis.stations[g])
                A[last - moments + k, last - 1] += part * basis.stations[g]
        amplitude, half = values[i, -2 - MODES], 0.5 * (values[i, -1] - values[i, -2])
        slope = opening(amplitude * half, places.onset[i], places.whole[i])[1]
        A[last - moments, last - 2 - MODES] += slope * half
        A[last - moments, last - 2] -= 0.5 * slope * amplitude
        A[last - moments, last - 1] += 0.5 * slope * amplitude
        if rolls:
            for a in range(2):
                for r in range(M):
                    mark = 0.5 * (basis.marks[r] + basis.marks[r + 1])
                    A[i * block + a * M + r, last - 2] += evaluation.rigid_slope[i, a, r] * (1.0 - mark)
                    A[i * block + a * M + r, last - 1] += evaluation.rigid_slope[i, a, r] * mark
    return Evaluation(inside and evaluation.inside, *evaluation[1:]), A


@borrowing
def friction_rows(A: Array, D: Array) -> None:
    """Replace the slip rows of an operator by those of the friction residual, in place.

    Parameters:
        A: (S block, S block).
        D: (S, M, SLOPES), slopes of the friction residual.
    """
    S, M = D.shape[0], D.shape[1]
    block = A.shape[0] // S
    for i in range(S):
        for r in range(M):
            x, y = i * block + r, i * block + M + r
            d = D[i, r]
            xx, xy, yx, yy = d[4], d[5], d[6], d[7]
            first, second = A[x], A[y]
            for c in range(A.shape[1]):
                along, across = first[c], second[c]
                first[c] = xx * along + xy * across
                second[c] = yx * along + yy * across
            A[x, x] += d[0]
            A[x, y] += d[1]
            A[y, x] += d[2]
            A[y, y] += d[3]
            for m in range(MODES):
                A[x, i * block + 2 * M + m] += d[10 + 2 * m]
                A[y, i * block + 2 * M + m] += d[11 + 2 * m]


class Linearisation(NamedTuple):
    """Equations of a state, linearised.

    Parameters:
        evaluation: of the residual.
        jacobian: (n, n).
        slips: (S, 2 M, n), derivatives of the slips by the unknowns.
        slopes: (S, M, SLOPES), of the friction residual, see `slopes_of_friction`.
    """

    evaluation: Evaluation
    jacobian: Array
    slips: Single
    slopes: Array


@compiled
def linearised(values: Array, data: EquationData) -> Linearisation:
    """Linearisation of a state with values (S, block)."""
    evaluation, A = linearise(values, data)
    slopes = slopes_of_friction(values, evaluation, data)
    S, M = len(values), slopes.shape[1]
    block = values.shape[1]
    slips = np.empty((S, 2 * M, len(A)), dtype=np.float32)
    for i in range(S):
        for r in range(2 * M):
            for c in range(len(A)):
                slips[i, r, c] = A[i * block + r, c]
    friction_rows(A, slopes)
    return Linearisation(evaluation, A, slips, slopes)
