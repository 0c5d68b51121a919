"""Displacement of each body in a contact on a lattice, and with it the material that touches.

The equations add displacements in each body's own axes to the penetration of undeformed surfaces. In the lateral
direction t their strips are therefore places in space: a rigid displacement c along t moves the wheel's material there
by c, and the penetration along its normal as well. The material of the wheel that touches at s is that at s - u_t, and
the material of the rail that at the closest point of s minus its own lateral displacement. The common surface of both
bodies is inclined to the wheel's undeformed one at s by du_n / ds.

The relative displacement of the solution is the sum of that of half-spaces, which divides by their compliance, and of
the deviations of finite bodies, which are evaluated body by body. The contraction of half-spaces by pressure is left
out: it is opposite on both sides of a patch, and 2 um by another patch of 40 kN at 10 mm.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from wheelrail.contact.models.lattice.influence.operator import antiderivatives
from wheelrail.contact.models.lattice.influence.pair_tables import half_space_scale
from wheelrail.contact.models.lattice.system.equations import force_jumps, strip_grid
from wheelrail.contact.models.lattice.system.problem import LatticeProblem
from wheelrail.contact.models.lattice.system.state import LatticeState
from wheelrail.contact.results.result import Patch
from wheelrail.support.arrays import Array, Mask


@dataclass(frozen=True)
class BodyDisplacements:
    """Displacements of S strips, means over their lengths weighted by pressure.

    Parameters:
        wheel, rail: (S,) m, lateral displacement of the upper and of the lower body along the upper one's t.
        wheel_normal: (S,) m, displacement of the upper body along its outward normal, without that of a half-space.
    """

    wheel: Array
    rail: Array
    wheel_normal: Array

    def of(self, strips: Mask) -> BodyDisplacements:
        """Those of some strips, a mask (S,)."""
        return BodyDisplacements(self.wheel[strips], self.rail[strips], self.wheel_normal[strips])


def body_displacements(
    problem: LatticeProblem, state: LatticeState, relative: Array, weight: Array
) -> BodyDisplacements:
    """Displacements of both bodies in a solution.

    Parameters:
        problem: equations.
        state: their solution.
        relative: (S, M, 3) m, displacement of the upper relative to the lower body, means over the cells.
        weight: (S, M) N, loads of the cells.
    """
    data = problem.of(state.strips)
    grid = strip_grid(state.values, data.places, problem.basis)
    jumps = force_jumps(state.values, data.places, problem.basis, problem.rolls)
    total = weight.sum(axis=1, keepdims=True)
    means = weight / np.where(total > 0, total, 1.0)
    feet = problem.lines.foot if problem.tables.moves else None
    deviation = np.zeros((2, *relative.shape))
    for body in (0, 1):
        tables = problem.tables.deviation_of(body, state.strips, feet, problem.reach)
        if tables is not None:
            _, V = antiderivatives(tables, grid, jumps)
            deviation[body] = (np.diff(V, axis=1) / np.diff(grid.x)[..., None])[:, : weight.shape[1]]
    upper, lower = problem.tables.operators.upper, problem.tables.operators.lower
    compliance = np.array([(1 + body.nu) * half_space_scale(body) for body in (upper, lower)])
    half_spaces = relative - deviation.sum(axis=0)
    wheel, minus_rail = deviation + (compliance / compliance.sum())[:, None, None, None] * half_spaces
    return BodyDisplacements(
        (means * wheel[..., 1]).sum(axis=1),
        -(means * minus_rail[..., 1]).sum(axis=1),
        (means * deviation[0, ..., 2]).sum(axis=1),
    )


def with_material(patch: Patch, displacements: BodyDisplacements, middle: Array, load: Array) -> Patch:
    """The patch with positions on the profiles of the material that touches, and the angle of the common surface.

    Parameters:
        patch: with positions in space and the angle of the undeformed wheel.
        displacements: of its S strips.
        middle: (S,) m, arc length of the strips' middles.
        load: (S,) N.

    The angle changes by the slope of the regression line of u_n over the strips; a half-space under pressure is not
    inclined in the mean, by reciprocity.
    """
    weight = load / load.sum()
    wheel, rail = float(weight @ displacements.wheel), float(weight @ displacements.rail)
    lever = middle - weight @ middle
    inertia = float(weight @ lever**2)
    slope = float(weight @ (lever * displacements.wheel_normal)) / inertia if len(middle) > 1 else 0.0
    level = float(np.cos(patch.contact_angle))
    return replace(
        patch,
        wheel_s=patch.wheel_s - wheel,
        rail_s=patch.rail_s - rail,
        wheel_y=patch.wheel_y - wheel * level,
        rail_y=patch.rail_y - rail * level,
        wheel_band=_shifted(patch.wheel_band, -wheel * level),
        rail_band=_shifted(patch.rail_band, -rail * level),
        contact_angle=patch.contact_angle - slope,
    )


def _shifted(band: tuple[float, float], by: float) -> tuple[float, float]:
    return band[0] + by, band[1] + by
