"""Meshes of whole wheel, axle and rail from their sections, in m, for animations."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from wheelrail.scenes.views.plotter import pyvista
from wheelrail.support.arrays import Array

if TYPE_CHECKING:
    from wheelrail.meshes.profiles.profile import Profile


SPACING = 3e-3  # m, of points along a profile
AXLE = 0.08  # m, radius of the axle between the wheels


def rail_body(rail: Profile, *, length: float, right: bool = False) -> Any:
    """Left (or right) rail.

    Parameters:
        rail: inclined profile; its top is the origin.
        length: m, centred at x = 0.
        right: whether it is the right rail.
    """
    from wheelrail.meshes.bodies.outlines import rail_outline

    section = rail_outline(rail, chord_error=5e-4).polygon(SPACING) * ([-1.0, 1.0] if right else [1.0, 1.0])
    start = np.column_stack([np.full(len(section), -0.5 * length), section])
    return _polygon(start).extrude((length, 0.0, 0.0), capping=True)


def wheel_body(wheel: Profile, radius: float, *, right: bool = False, sector: float = np.pi) -> Any:
    """Left (or right) wheel in its own frame, with the axle along y through the origin.

    Parameters:
        wheel: profile.
        radius: of the rolling circle, m.
        right: whether it is the right wheel.
        sector: half angle about the lowest line, rad.
    """
    from wheelrail.meshes.bodies.outlines import wheel_outline

    section = wheel_outline(wheel, radius).polygon(SPACING) * ([-1.0, 1.0] if right else [1.0, 1.0])
    return revolved(np.vstack([section, section[:1]]), np.linspace(-sector, sector, 81, dtype=np.float64))


def wheelset_body(left: Any, right: Any, *, wheel_y: float) -> Any:
    """Both wheels and the axle about the centre of the wheelset.

    Parameters:
        left, right: wheels from `wheel_body`.
        wheel_y: lateral position of the rolling circles, m.
    """
    left, right = left.translate((0.0, wheel_y, 0.0)), right.translate((0.0, -wheel_y, 0.0))
    axle = pyvista().Cylinder(direction=(0.0, 1.0, 0.0), radius=AXLE, height=2 * wheel_y + 0.35, resolution=48)
    return left.merge(right).merge(axle.triangulate()).extract_surface(algorithm="dataset_surface")


def revolved(section: Array, angle: Array) -> Any:
    """Surface of revolution about y of a polyline (n, 2) of (y, r), m, at angles (m,), rad, from straight below."""
    y, r = section.T
    x, z = np.outer(np.sin(angle), r), -np.outer(np.cos(angle), r)
    grid = pyvista().StructuredGrid(x[..., None], np.broadcast_to(y, x.shape)[..., None], z[..., None])
    return grid.extract_surface(algorithm="dataset_surface")


def _polygon(points: Array) -> Any:
    return pyvista().PolyData(points, np.array([len(points), *range(len(points))])).triangulate()
