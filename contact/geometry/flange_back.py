"""Shapes of a flange's back and of a check rail or the wall of a groove."""

from __future__ import annotations

from dataclasses import dataclass
from math import inf

import numpy as np

from wheelrail.meshes.profiles.profile import Profile

UPRIGHT = 0.2  # rad, largest deviation of the end of a flange's back from the vertical
ASIDE = 1e-3  # m, largest distance of the end of a profile from the back


@dataclass(frozen=True)
class FlangeBack:
    """Plane back of a flange up to its rounded edge, in the wheel's frame.

    Parameters:
        y: m, of the plane from the rolling circle, negative to the flange's side.
        height: m, of the end of the plane beyond the rolling circle, outward from the axle.
        rounding: m, radius of the edge.
    """

    y: float
    height: float
    rounding: float

    @classmethod
    def of(cls, wheel: Profile, y: float) -> FlangeBack:
        """Back of a wheel whose profile begins there.

        Parameters:
            wheel: profile.
            y: m, of the back.

        Raises ValueError for a profile that begins elsewhere.
        """
        first = wheel.s_range[0]
        (at, height), (across, _), curvature = wheel.point(first), wheel.tangent(first), float(wheel.curvature(first))
        if abs(at - y) > ASIDE or abs(across) > np.sin(UPRIGHT) or curvature <= 0.0:
            raise ValueError(f"{wheel.name} begins at y = {1e3 * at:.3g} mm, not on the flange's back")
        return cls(y, float(height), 1.0 / curvature)


@dataclass(frozen=True)
class CheckRail:
    """Face of a check rail or a groove's wall, in the frame of the running rail.

    Parameters:
        y: m, of the face.
        height: m, of its top above the top of the running rail.
        rounding: m, radius of the upper edge.
        stiffness: N/m, of the check rail on its supports, in series with the contact; inf: rigid.
    """

    y: float
    height: float
    rounding: float
    stiffness: float = inf
