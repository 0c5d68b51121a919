"""Material of both bodies that touches in a patch, and the inclination of their common surface.

Contact points and strips are places in space, displacements are added in each body's own axes: u_n along its normal and
u_t along its profile. To first order the wheel's material that touches at s is that of s - u_t, the material of the
rail that at the projection of s minus its own lateral displacement, and the common surface is inclined to the wheel's
undeformed one at s by du_n / ds.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from wheelrail.contact.kinematics.contact_points import SurfacePoints
from wheelrail.contact.results.patch_sums import PatchSums, inclination
from wheelrail.support.arrays import Array
from wheelrail.support.compiled import compiled


class BodyDisplacements(NamedTuple):
    """Displacements of n contact points, or of strips: means over their lengths weighted by pressure.

    Parameters:
        wheel, rail: (n,) m, lateral displacement of the upper and of the lower body along the upper one's t.
        wheel_normal: (n,) m, displacement of the upper body along its outward normal.
    """

    wheel: Array
    rail: Array
    wheel_normal: Array


def symmetric(points: SurfacePoints, traction: Array) -> bool:
    """Whether displacements are opposite on both sides of a patch: those of a plane surface without traction (n, 2)."""
    return not traction.any() and bool(np.all(points.axes == points.axes[0]))


@compiled
def on_material(sums: PatchSums, displacements: BodyDisplacements, s: Array, load: Array) -> PatchSums:
    """Sums of a patch with positions on the profiles of the material that touches, and the slope of the common surface.

    Parameters:
        sums: with positions in space.
        displacements: of its n points or strips.
        s: (n,) m, their arc length on the wheel.
        load: (n,) N.

    The slope is that of the regression line of u_n over s.
    """
    total, centre, shift_of_wheel, shift_of_rail = 0.0, 0.0, 0.0, 0.0
    for i in range(len(s)):
        total += load[i]
        centre += load[i] * (s[i] - s[0])
        shift_of_wheel += load[i] * displacements.wheel[i]
        shift_of_rail += load[i] * displacements.rail[i]
    centre, shift_of_wheel, shift_of_rail = centre / total, shift_of_wheel / total, shift_of_rail / total
    moment, inertia = 0.0, 0.0
    for i in range(len(s)):
        lever = s[i] - s[0] - centre
        moment += load[i] * lever * displacements.wheel_normal[i]
        inertia += load[i] * lever * lever
    level = np.cos(inclination(sums.axes))
    bands = sums.bands.copy()
    bands[:2] -= shift_of_wheel * level
    bands[2:] -= shift_of_rail * level
    return PatchSums(
        sums.area,
        sums.stick_area,
        sums.peak,
        sums.force,
        sums.axes,
        moment / inertia if inertia > 0.0 else 0.0,
        sums.point,
        sums.wheel - shift_of_wheel * np.array([1.0, level]),
        sums.rail - shift_of_rail * np.array([1.0, level]),
        bands,
        sums.semi_axes,
        sums.creepage,
        sums.power,
        sums.strips,
    )
