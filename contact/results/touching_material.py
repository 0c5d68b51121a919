"""Material of both bodies that touches in a patch, and the inclination of their common surface.

Contact points and strips are places in space, displacements are added in each body's own axes: u_n along its normal and
u_t along its profile. To first order the wheel's material that touches at s is that of s - u_t, the material of the
rail that at the projection of s minus its own lateral displacement, and the common surface is inclined to the wheel's
undeformed one at s by du_n / ds.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace

import numpy as np

from wheelrail.contact.kinematics.contact_points import SurfacePoints
from wheelrail.contact.results.result import ContactResult, LazyPatches, Patch
from wheelrail.support.arrays import Array, Mask


@dataclass(frozen=True)
class BodyDisplacements:
    """Displacements of n contact points, or of strips: means over their lengths weighted by pressure.

    Parameters:
        wheel, rail: (n,) m, lateral displacement of the upper and of the lower body along the upper one's t.
        wheel_normal: (n,) m, displacement of the upper body along its outward normal.
    """

    wheel: Array
    rail: Array
    wheel_normal: Array

    def of(self, places: Mask) -> BodyDisplacements:
        """Those of some points or strips, a mask (n,)."""
        return BodyDisplacements(self.wheel[places], self.rail[places], self.wheel_normal[places])


def symmetric(points: SurfacePoints, traction: Array) -> bool:
    """Whether displacements are opposite on both sides of a patch: those of a plane surface without traction (n, 2)."""
    return not traction.any() and bool(np.all(points.axes == points.axes[0]))


def of_material(result: ContactResult, s: Array, displacements: Callable[[], BodyDisplacements]) -> ContactResult:
    """The result whose patches are placed on the material that touches, computed when they are first needed.

    Parameters:
        result: on n contact points.
        s: (n,) m, arc length of the points on the wheel.
        displacements: returns those of the points.
    """
    fields, undeformed = result.fields, result.patches
    assert fields is not None

    def patches() -> tuple[Patch, ...]:
        load, bodies = fields.pressure * fields.area, displacements()
        masks = [fields.patch == number for number in range(len(undeformed))]
        return tuple(
            with_material(patch, bodies.of(mask), s[mask], load[mask])
            for patch, mask in zip(undeformed, masks, strict=True)
        )

    return replace(result, patches=LazyPatches(patches))


def with_material(patch: Patch, displacements: BodyDisplacements, s: Array, load: Array) -> Patch:
    """The patch with positions on the profiles of the material that touches, and the angle of the common surface.

    Parameters:
        patch: with positions in space and the angle of the undeformed wheel.
        displacements: of its n points or strips.
        s: (n,) m, their arc length on the wheel.
        load: (n,) N.

    The angle changes by the slope of the regression line of u_n over them.
    """
    weight = load / load.sum()
    wheel, rail = float(weight @ displacements.wheel), float(weight @ displacements.rail)
    lever = s - weight @ s
    inertia = float(weight @ lever**2)
    slope = float(weight @ (lever * displacements.wheel_normal)) / inertia if inertia > 0 else 0.0
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
