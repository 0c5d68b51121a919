"""Material of both bodies that touches in a patch, and the inclination of their common surface.

Contact points and strips are places in space, displacements are added in each body's own axes, see the core's
`on_material`.
"""

from __future__ import annotations

import numpy as np

from wheelrail.contact.kinematics.contact_points import SurfacePoints
from wheelrail.support.arrays import Array


def symmetric(points: SurfacePoints, traction: Array) -> bool:
    """Whether displacements are opposite on both sides of a patch: those of a plane surface without traction (n, 2)."""
    return not traction.any() and bool(np.all(points.axes == points.axes[0]))
