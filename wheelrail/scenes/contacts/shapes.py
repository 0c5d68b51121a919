"""Shapes of the bodies of a scene as variables: profiles, and curvature of the gap at the patches."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from functools import lru_cache
from typing import TYPE_CHECKING, Any

import numpy as np

from wheelrail.contact.geometry.quadric_pair import curvature
from wheelrail.scenes.quantity import Quantity, filled
from wheelrail.scenes.schema.scene import HertzScene, WheelsetScene
from wheelrail.support.arrays import Array

if TYPE_CHECKING:
    from wheelrail.meshes.profiles.profile import Profile
    from wheelrail.scenes.builders.wheelset import SideProfiles
    from wheelrail.scenes.contacts.side_solution import SideSolution

OUTLINE = 2e-4  # m, spacing of the stored points of a profile


def gap_curvatures(
    scene: HertzScene | WheelsetScene, solved: Mapping[str, SideSolution], profiles: SideProfiles
) -> dict[str, Any]:
    """Hertz coefficients A and B of the gap A x2 + B y2 between the rigid bodies at the centre of each patch.

    Parameters:
        scene: with the radii of the bodies.
        solved: solution by side.
        profiles: of wheel and inclined rail by side, for a wheelset.
    """
    most = max([1, *(len(solution.result.patches) for solution in solved.values())])
    coefficients = np.full((len(solved), most, 2), np.nan)
    for row, (name, solution) in enumerate(solved.items()):
        for k, patch in enumerate(solution.result.patches):
            if isinstance(scene, HertzScene):
                coefficients[row, k] = curvature(scene.upper.radii) + curvature(scene.lower.radii)
            else:
                radius = scene.side("right" if name == "right" else "left").radius
                assert radius is not None
                coefficients[row, k] = _local(profiles[name], radius, patch.wheel_s, patch.rail_s)
    return {f"patch_gap_curvature_{name}": coefficients[:, :, axis] for axis, name in enumerate("xy")}


def _local(profiles: tuple[Profile, Profile], radius: float, wheel_s: float, rail_s: float) -> Array:
    """A and B, 1/m, of wheel and rail at arc lengths, m.

    Longitudinally only the wheel is curved, with the normal curvature of its circle of radius r (Meusnier).
    """
    wheel, rail = profiles
    if not (wheel.s_range[0] <= wheel_s <= wheel.s_range[1] and rail.s_range[0] <= rail_s <= rail.s_range[1]):
        return np.full(2, np.nan)
    across = float(wheel.curvature(wheel_s)) + float(rail.curvature(rail_s))
    along = float(wheel.normal(wheel_s)[1]) / (radius + float(wheel.point(wheel_s)[1]))
    return 0.5 * np.array([along, across])


def turns(
    scene: HertzScene | WheelsetScene, solved: Mapping[str, SideSolution], profiles: SideProfiles
) -> dict[str, Any]:
    """Angle by which the more curved surface turns from the middle of each patch to its edge, where half-spaces stand
    for both bodies; parameters as for `gap_curvatures`.
    """
    flat = scene.model == "standard" or (scene.model != "table" and scene.discretisation.bodies == "half-space")
    if not (flat or isinstance(scene, HertzScene)):
        return {}
    most = max([1, *(len(solution.result.patches) for solution in solved.values())])
    angles = np.full((len(solved), most), np.nan)
    for row, (name, solution) in enumerate(solved.items()):
        for k, patch in enumerate(solution.result.patches):
            if isinstance(scene, HertzScene):
                radii = np.abs([scene.upper.radii, scene.lower.radii]).min(axis=0)
                angles[row, k] = np.arcsin(np.minimum(np.array(patch.semi_axes) / radii, 1.0)).max()
            else:
                places = zip(profiles[name], (patch.wheel_s, patch.rail_s), strict=True)
                angles[row, k] = max(_turn(profile, s, patch.semi_axes[1]) for profile, s in places)
    return {"patch_turn": angles}


def _turn(profile: Profile, s: float, half: float) -> float:
    """Half the angle, rad, by which a profile turns within a half width m of the arc length s m."""
    first, second = profile.tangent(np.clip([s - half, s + half], *profile.s_range)) @ [1.0, 1j]
    return 0.5 * abs(float(np.angle(second / first)))


def outlines(sides: Sequence[str], profiles: SideProfiles) -> dict[str, Any]:
    """Points of the profiles; over side, too, and padded with NaN, where the profiles of the sides differ.

    Parameters:
        sides: names.
        profiles: of wheel and inclined rail by side; empty for a Hertz pair.
    """
    variables: dict[str, Any] = {}
    for bodies in zip(*(profiles[side] for side in sides if profiles), strict=True):
        points = [_outline(profile) for profile in bodies]
        kind, values = bodies[0].kind, points[0]
        dims: tuple[str, ...] = (f"{kind}_point", "plane")
        if any(profile is not bodies[0] for profile in bodies):
            values = np.full((len(sides), max(map(len, points)), 2), np.nan)
            for row, outline in enumerate(points):
                values[row, : len(outline)] = outline
            dims = ("side", *dims)
        names = " and ".join(dict.fromkeys(profile.name for profile in bodies))
        own = Quantity(dims, "m", f"profile of the {kind} {names}: y to the field side, z up")
        variables |= filled({f"{kind}_profile": own}, {f"{kind}_profile": values})
    return variables


@lru_cache(maxsize=8)
def _outline(profile: Profile) -> Array:
    """Stored points (n, 2) m of a profile."""
    points = profile.point(profile.samples(OUTLINE))
    points.setflags(write=False)
    return points
