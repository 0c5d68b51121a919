"""Overlap of undeformed wheels and rails that the standard contact leaves unsolved.

The region of virtual penetration ends where the bodies penetrate by 0.45 of the approach, and a hump that has just
risen on its slope has no load of its own, lest forces jump. Elastic bodies lower each other there by the pressures of
the patches, in half-spaces by F / (pi E* r) at a distance r from a force F (Boussinesq). An overlap beyond that would
carry a load.
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import TYPE_CHECKING, Any

import numpy as np

from wheelrail.contact.analytical.hertz import modulus
from wheelrail.contact.geometry.rigid_surfaces import RigidWheelRail
from wheelrail.scenes.schema.scene import HertzScene, WheelsetScene
from wheelrail.support.arrays import Mask

if TYPE_CHECKING:
    from wheelrail.scenes.builders.wheelset import SideProfiles
    from wheelrail.scenes.contacts.side_solution import SideSolution


def unsolved_overlaps(
    scene: HertzScene | WheelsetScene, solved: Mapping[str, SideSolution], profiles: SideProfiles
) -> dict[str, Any]:
    """Largest overlap beyond the elastic lowering outside the patches, and its place; of the standard contact only.

    Parameters as for `wheelrail.scenes.contacts.shapes.gap_curvatures`.
    """
    if isinstance(scene, HertzScene) or scene.model != "standard":
        return {}
    found = np.full((len(solved), 2), np.nan)
    for row, (name, solution) in enumerate(solved.items()):
        if solution.result.status == "converged":
            found[row] = _unsolved(scene, name, solution, profiles)
    return {"unsolved_overlap": found[:, 0], "unsolved_overlap_y": found[:, 1]}


def _unsolved(scene: WheelsetScene, name: str, solution: SideSolution, profiles: SideProfiles) -> tuple[float, float]:
    """Overlap m and its place m; 0 and NaN without."""
    radius, fields, pose = (
        scene.side("right" if name == "right" else "left").radius,
        solution.result.fields,
        solution.pose,
    )
    assert radius is not None
    assert fields is not None
    assert pose is not None
    pose = pose.mirrored() if name == "right" else pose
    pair = RigidWheelRail(*profiles[name], radius)
    (first, last), samples = pair.scanned(pose)
    s, depth = pair.lines.s[first:last], samples.depth[first:last]
    y = pair.wheel.point(s)[:, 0]
    bands = [patch.wheel_band for patch in solution.result.patches]
    outside = ~np.any([(low <= y) & (y <= high) for low, high in bands], axis=0)
    if scene.normal == "hertz":  # an ellipse stands for the whole overlap around its deepest point
        outside &= ~_connected(depth > 0.0, ~outside)
    outside &= depth > 0.0
    if not outside.any():
        return 0.0, np.nan
    points, _ = pair.at(pose, s[outside], samples.x[first:last][outside])
    force = fields.pressure * fields.area
    distance = np.linalg.norm(points[:, None] - fields.point[None], axis=2)
    lowering = force / np.maximum(distance, 0.5 * np.sqrt(fields.area))
    beyond = depth[outside] - lowering.sum(axis=1) / (np.pi * modulus((scene.E, scene.nu), (scene.E, scene.nu)))
    deepest = int(np.argmax(beyond))
    return (float(beyond[deepest]), float(y[outside][deepest])) if beyond[deepest] > 0.0 else (0.0, np.nan)


def _connected(overlaps: Mask, inside: Mask) -> Mask:
    """Mask (n,) of the connected parts of an overlap with points inside patches."""
    part = np.cumsum(np.diff(overlaps, prepend=False) & overlaps) * overlaps
    return np.asarray(np.isin(part, np.unique(part[inside & overlaps])) & overlaps)
