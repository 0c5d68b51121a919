"""Interpenetration regions by the method of virtual penetration: around every local maximum of the penetration.

J. Piotrowski, W. Kik, Vehicle System Dynamics 46 (2008) 27-48, doi:10.1080/00423110701586444. Maxima that approach
each other, or whose minimum between them vanishes, merge continuously into one contact, so that forces do not jump:
they share its weight, and the region of each extends over the others.
"""

from __future__ import annotations

import numpy as np

from wheelrail.bindings._contact import (
    VIRTUAL,
    Lines,
    PenetrationRegions,
    half_strips,
    wheel_regions,
)
from wheelrail.bindings._contact import overlap as core_overlap
from wheelrail.contact.geometry.quadric_pair import curvature, vertical_approach
from wheelrail.contact.kinematics.frames import Pose
from wheelrail.meshes.profiles.profile import Profile


def profile_regions(
    wheel: Profile, rail: Profile, radius: float, pose: Pose, lines: Lines, merge: float
) -> tuple[PenetrationRegions | None, float]:
    """Regions (None without penetration) of a wheel on a rail, and the largest penetration m.

    Parameters:
        wheel, rail: profiles.
        radius: nominal rolling radius, m.
        pose: of the wheel's frame in the rail's frame.
        lines: of the wheel's profile on which the penetration is sampled.
        merge: m, maxima closer than that are one contact.

    Raises ValueError for a penetration that reaches an end of a profile, and for a wheel inside the rail.
    """
    found = wheel_regions(wheel.shape, rail.shape, radius, *pose.arrays, lines, merge)
    if found.beyond:
        raise ValueError(overlap(wheel, rail, radius, pose, lines))
    if not len(found.contacts):
        return None, found.approach
    peak, peak_x, depth, weight = np.ascontiguousarray(found.contacts.T)
    s, x, width, penetration, radii = np.ascontiguousarray(found.strips.T)
    regions = PenetrationRegions(peak, peak_x, depth, weight, found.contact, s, x, width, penetration, radii)
    return regions, found.approach


def overlap(wheel: Profile, rail: Profile, radius: float, pose: Pose, lines: Lines) -> str:
    """Message on interpenetration beyond the solved regions; parameters as for `profile_regions`."""
    names = wheel.name, rail.name
    return str(core_overlap(wheel.shape, rail.shape, radius, *pose.arrays, lines, *names))


def quadric_regions(
    upper: tuple[float, float], lower: tuple[float, float], pose: Pose
) -> tuple[PenetrationRegions | None, float]:
    """Region (None without penetration) of two quadrics, and the approach m.

    Parameters:
        upper, lower: principal radii in x and y, m, see `wheelrail.contact.geometry.quadric_pair`.
        pose: of the upper body's apex.
    """
    above, below = curvature(upper), curvature(lower)
    x, y = pose.origin[:2] * above / (above + below)
    A, B = above + below
    approach = vertical_approach(upper, lower, pose)
    if approach <= 0.0:
        return None, approach
    half, (positions, widths) = np.sqrt(VIRTUAL * approach / B), half_strips()
    offset = half * np.concatenate([-positions, positions])
    ones = np.ones_like(offset)
    return PenetrationRegions(
        np.array([y]),
        np.array([x]),
        np.array([approach]),
        np.array([1.0]),
        np.zeros(len(offset), dtype=np.int64),
        y + offset,
        x * ones,
        half * np.concatenate([widths, widths]),
        VIRTUAL * approach - B * offset**2,
        0.5 / A * ones,
    ), approach
