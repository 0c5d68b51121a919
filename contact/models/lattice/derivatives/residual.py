"""Compiled: derivative of the residual by pose and motion at fixed unknowns.

The twelve changes of pose and motion are those of `wheelrail.contact.kinematics.sensitivity`.
"""

from __future__ import annotations

import numpy as np

from wheelrail.contact.models.lattice.derivatives.feet import foot_derivatives
from wheelrail.contact.models.lattice.derivatives.resultants import CHANGES
from wheelrail.contact.models.lattice.derivatives.velocities import add_friction_changes, store_speed_changes
from wheelrail.contact.models.lattice.influence.basis import MODES
from wheelrail.contact.models.lattice.influence.pair_tables import Lattice
from wheelrail.contact.models.lattice.system.contact_lines import ContactLines
from wheelrail.contact.models.lattice.system.equations import EquationData, cell_frames
from wheelrail.contact.models.lattice.system.partial_width import opening_changes, partial_width_changes
from wheelrail.contact.models.lattice.system.surface import (
    GAUSS,
    Motion,
    SurfaceData,
    frames,
    penetration_changes,
    touching_changes,
)
from wheelrail.support.arrays import Array
from wheelrail.support.compiled import compiled


@compiled
def residual_changes(
    values: Array, data: EquationData, lines: ContactLines, lattice: Lattice, arc: Array, slopes: Array
) -> Array:
    """Derivative (S block, CHANGES) of the residual by pose and motion at fixed unknowns.

    Parameters:
        values: (S, block), of the state.
        data: of the equations.
        lines, lattice: of all strips.
        arc: (ns,) m, lines of the lower body, see `foot_derivatives`.
        slopes: (S, M, SLOPES), of the friction residual.
    """
    surface, motion, own, block = data.surface, data.motion, data.places.strip, values.shape[1]
    crest, foot = touching_changes(surface, motion, data.places.middle, lines.x[own], lines.foot[own])
    slips, moments = foot_derivatives(values, data, arc, lines.foot[own], foot)
    total = np.zeros((len(values), block, CHANGES))
    first = block - moments.shape[2]
    for i in range(len(values)):
        for m in range(moments.shape[2]):
            for k in range(6):
                total[i, first + m, k] = moments[k, i, m]
    _add_penetration(values, data, total)
    _add_openings(values, data, lines, lattice, total)
    if motion.speed > 0.0:
        speed = np.zeros(CHANGES)
        if data.basis.slip_power != 1:  # of a displacement the speed is 1 m/s
            own = np.flatnonzero(lines.depth > 0.0)
            s, width, x = lattice.middle[own], lattice.width[own], lines.x[own]
            at, change = frames(surface, motion.origin, motion.rotation, s, x), _deepening(surface, motion, s, width, x)
            store_speed_changes(surface.revolves, motion, at, change, lines.depth[own], width, np.empty(CHANGES), speed)
        at, work = cell_frames(values, data.places, data.basis, surface, motion), np.empty((2, CHANGES))
        add_friction_changes(data, at, crest, slips, slopes, speed, work, total)
    return total.reshape(-1, CHANGES)


@compiled
def _deepening(surface: SurfaceData, motion: Motion, middle: Array, width: Array, x: Array) -> Array:
    """Derivative (n, 6) by the pose of the penetration at x (n,) m on strips with middles and widths (n,) m, means over
    their widths.
    """
    n = len(x)
    s = np.concatenate((middle - GAUSS * width, middle + GAUSS * width))
    change = penetration_changes(surface, motion.origin, motion.rotation, s, np.concatenate((x, x))).depth
    return 0.5 * (change[:n] + change[n:])


@compiled
def _add_penetration(values: Array, data: EquationData, total: Array) -> None:
    """Add the derivative of the moments of the penetration."""
    places, basis = data.places, data.basis
    S, n, moments = len(values), len(basis.stations), len(basis.penetration)
    middle, width, x = np.empty(S * n), np.empty(S * n), np.empty(S * n)
    for i in range(S):
        for g in range(n):
            middle[i * n + g], width[i * n + g] = places.middle[i], places.width[i]
            x[i * n + g] = values[i, -2] + (values[i, -1] - values[i, -2]) * basis.stations[g]
    change, first = _deepening(data.surface, data.motion, middle, width, x), values.shape[1] - moments
    for i in range(S):
        for m in range(moments):
            for g in range(n):
                for k in range(6):
                    total[i, first + m, k] += basis.penetration[m, g] * change[i * n + g, k]


@compiled
def _add_openings(values: Array, data: EquationData, lines: ContactLines, lattice: Lattice, total: Array) -> None:
    """Add the derivative of the gaps of strips that touch on a part of their width."""
    places, first = data.places, values.shape[1] - len(data.basis.penetration)
    load = 0.5 * (values[:, -1] - values[:, -2]) * values[:, -2 - MODES]
    part = np.flatnonzero(load < places.whole)
    if not len(part):
        return
    own = places.strip[part]
    near = np.empty(3 * len(part), dtype=own.dtype)
    for n in range(len(part)):
        near[3 * n : 3 * n + 3] = own[n] - 1, own[n], own[n] + 1
    middle = lattice.middle[near]
    change = _deepening(data.surface, data.motion, middle, lattice.width[near], lines.x[near]).reshape(-1, 3, 6)
    depth, width = lines.depth[near].reshape(-1, 3), lattice.width[own]
    onset, whole = partial_width_changes(depth, lines.curvature[own], middle.reshape(-1, 3), width, change)
    by_onset, by_whole = opening_changes(load[part], places.onset[part], places.whole[part])
    for n in range(len(part)):
        for k in range(6):
            total[part[n], first, k] += by_onset[n] * onset[n, k] + by_whole[n] * whole[n, k]
