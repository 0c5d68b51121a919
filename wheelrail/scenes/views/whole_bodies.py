"""Wheel, axle and rail as whole bodies from their sections, in m: for context, and to be moved about."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from wheelrail.scenes.views.plotter import pyvista
from wheelrail.support.arrays import Array

if TYPE_CHECKING:
    from wheelrail.meshes.profiles.profile import Profile


SPACING = 3e-3  # m along a profile
AXLE = 0.08  # m, radius of the axle between the wheels


def rail_body(rail: Profile, *, length: float, right: bool = False) -> Any:
    """The standing left (or right) rail from -length / 2 to length / 2 along x, its origin on top as laid."""
    from wheelrail.meshes.bodies.outlines import rail_outline

    section = rail_outline(rail, chord_error=5e-4).polygon(SPACING) * ([-1.0, 1.0] if right else [1.0, 1.0])
    start = np.column_stack([np.full(len(section), -0.5 * length), section])
    return _polygon(start).extrude((length, 0.0, 0.0), capping=True)


def wheel_body(wheel: Profile, radius: float, *, right: bool = False, sector: float = np.pi) -> Any:
    """The left (or right) wheel in its own frame, the axle along y through the origin: all of it, or a sector of so
    many rad to either side of straight below.
    """
    from wheelrail.meshes.bodies.outlines import wheel_outline

    section = wheel_outline(wheel, radius).polygon(SPACING) * ([-1.0, 1.0] if right else [1.0, 1.0])
    return revolved(np.vstack([section, section[:1]]), np.linspace(-sector, sector, 81, dtype=np.float64))


def wheelset_body(wheel: Profile, radius: float, *, wheel_y: float) -> Any:
    """Both wheels on their axle about the wheelset's centre; wheel_y m to the rolling planes."""
    left = wheel_body(wheel, radius).translate((0.0, wheel_y, 0.0))
    right = wheel_body(wheel, radius, right=True).translate((0.0, -wheel_y, 0.0))
    axle = pyvista().Cylinder(direction=(0.0, 1.0, 0.0), radius=AXLE, height=2 * wheel_y + 0.35, resolution=48)
    return left.merge(right).merge(axle.triangulate()).extract_surface(algorithm="dataset_surface")


def revolved(section: Array, angle: Array) -> Any:
    """Surface of a polyline (n, 2) of (y, r) at angles (m,) rad about the y axis, from straight below."""
    y, r = section.T
    x, z = np.outer(np.sin(angle), r), -np.outer(np.cos(angle), r)
    grid = pyvista().StructuredGrid(x[..., None], np.broadcast_to(y, x.shape)[..., None], z[..., None])
    return grid.extract_surface(algorithm="dataset_surface")


def _polygon(points: Array) -> Any:
    return pyvista().PolyData(points, np.array([len(points), *range(len(points))])).triangulate()
