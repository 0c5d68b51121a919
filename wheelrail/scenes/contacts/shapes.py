"""Shapes of the bodies of a scene as variables: profiles, and curvature of the gap at the patches."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING, Any

import numpy as np

from wheelrail.contact.geometry.quadric_pair import curvature
from wheelrail.scenes.datasets.patches import means
from wheelrail.scenes.schema.scene import HertzScene, WheelsetScene
from wheelrail.support.arrays import Array

if TYPE_CHECKING:
    from wheelrail.meshes.profiles.profile import Profile
    from wheelrail.scenes.contacts.side_solution import SideSolution

OUTLINE = 2e-4  # m, spacing of the stored points of a profile


def gap_curvatures(
    scene: HertzScene | WheelsetScene, solved: Mapping[str, SideSolution], profiles: Sequence[Profile]
) -> dict[str, Any]:
    """Hertz coefficients A and B of the gap A x2 + B y2 between the rigid bodies at the centre of each patch.

    Parameters:
        scene: with the radii of the bodies.
        solved: solution by side.
        profiles: of wheel and inclined rail, for a wheelset.
    """
    most = max([1, *(len(solution.result.patches) for solution in solved.values())])
    coefficients = np.full((len(solved), most, 2), np.nan)
    for row, side in enumerate(solved.values()):
        for k, patch in enumerate(side.result.patches):
            if isinstance(scene, HertzScene):
                coefficients[row, k] = curvature(scene.upper.radii) + curvature(scene.lower.radii)
            else:
                coefficients[row, k] = _local(scene, profiles, patch.wheel_s, patch.rail_s)
    text = "half the relative curvature of the rigid bodies at the patch centre, {}"
    return {
        f"patch_gap_curvature_{name}": (("side", "patch"), coefficients[:, :, axis], means("1/m", text.format(where)))
        for axis, (name, where) in enumerate((("x", "longitudinal"), ("y", "lateral")))
    }


def _local(scene: WheelsetScene, profiles: Sequence[Profile], wheel_s: float, rail_s: float) -> Array:
    """A and B, 1/m, of wheel and rail at arc lengths, m.

    Longitudinally only the wheel is curved, with the normal curvature of its circle of radius r (Meusnier).
    """
    wheel, rail = profiles
    if not (wheel.s_range[0] <= wheel_s <= wheel.s_range[1] and rail.s_range[0] <= rail_s <= rail.s_range[1]):
        return np.full(2, np.nan)
    across = float(wheel.curvature(wheel_s)) + float(rail.curvature(rail_s))
    along = float(wheel.normal(wheel_s)[1]) / (scene.wheelset.radius + float(wheel.point(wheel_s)[1]))
    return 0.5 * np.array([along, across])


def outlines(profiles: Sequence[Profile]) -> dict[str, Any]:
    """Points of the profiles."""
    return {
        f"{profile.kind}_profile": (
            (f"{profile.kind}_point", "plane"),
            profile.point(profile.samples(OUTLINE)),
            means("m", f"profile of the {profile.kind} {profile.name}: y to the field side, z up"),
        )
        for profile in profiles
    }
