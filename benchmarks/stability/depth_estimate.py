"""Depth at which a wheel carries approximately a load: virtual penetration, Piotrowski and Kik 2008,
doi:10.1080/00423110701586444. A stress test needs a range of loads, not exact ones.

The load of half-spaces at this depth is 0.8 to 1.5 times the given one. Lateral compliance of wheel and rail reduces it
for the same pose on a flange, down to a twentieth.
"""

from __future__ import annotations

import numpy as np
from scipy.optimize import brentq

from benchmarks.stability.sample import RADIUS, SampledCase
from wheelrail.bindings._contact import crests
from wheelrail.contact.geometry.strip_surfaces import ProfileStrips
from wheelrail.contact.kinematics.frames import Pose
from wheelrail.contact.laws.material import Material
from wheelrail.contact.models.lattice.system.surface import surface_data
from wheelrail.meshes.bodies.solids import contact_range
from wheelrail.meshes.profiles.named import named_profile
from wheelrail.support.arrays import Array

PENETRATION = 0.55  # of the maximum penetration
FIRST, LAST = contact_range(named_profile("S1002"))
LINES = np.linspace(FIRST, LAST, 400)  # m of the wheel's arc
LOWEST, HIGHEST = -0.05, 0.02  # m, of the depth
DEEPEST = 1e-3  # m of penetration


class NoDepth(ValueError):
    """No depth within the profiles carries the load."""


def depth_for(case: SampledCase) -> float:
    """Depth m from nominal height. Raises NoDepth with the reason."""
    surfaces = ProfileStrips(named_profile("S1002"), named_profile(case.rail), RADIUS)

    def penetration(depth: float) -> float:
        return float(_profile(surfaces, case.at(depth)[0], LINES)[0].max())

    def excess(depth: float) -> float:
        return _load(surfaces, case, depth) - case.load

    depths = np.linspace(LOWEST, HIGHEST, 71)
    penetrating = [depth for depth in depths if penetration(depth) > 0]
    if not penetrating or penetrating[0] == LOWEST:
        raise NoDepth("no contact within 50 mm below the nominal height")
    touching_depth = float(brentq(penetration, penetrating[0] - (depths[1] - depths[0]), penetrating[0], xtol=1e-10))
    high = 1e-5
    while excess(touching_depth + high) < 0:
        high *= 2
        if penetration(touching_depth + high) > DEEPEST:
            raise NoDepth("the load needs a penetration of more than 1 mm")
    return float(brentq(excess, touching_depth, touching_depth + high, xtol=1e-9))


def penetration_outside(case: SampledCase, pose: Pose, bands: list[tuple[float, float]]) -> float:
    """Largest penetration outside lateral bands [m] of the wheel's profile over that inside, or a line next to them."""
    surfaces = ProfileStrips(named_profile("S1002"), named_profile(case.rail), RADIUS)
    penetration = _profile(surfaces, pose, LINES)[0]
    y = surfaces.wheel.point(LINES)[:, 0]
    margin = float(np.diff(LINES).max())
    inside = np.zeros(len(y), dtype=bool)
    for low, high in bands:
        inside |= (y >= low - margin) & (y <= high + margin)
    within = float(penetration[inside].max(initial=0.0))
    return float(penetration[~inside].max(initial=0.0)) / within if within > 0 else np.inf


def _profile(surfaces: ProfileStrips, pose: Pose, s: Array) -> tuple[Array, Array]:
    """Largest penetration (n,) m along lines s (n,) m, and the relative curvature (n,) 1/m there."""
    found, _, curvature = crests(surface_data(surfaces), *pose.arrays, s)
    return found.depth, curvature


def _load(surfaces: ProfileStrips, case: SampledCase, depth: float) -> float:
    """Vertical force N."""
    steel = Material()
    pose = case.at(depth)[0]
    penetration = _profile(surfaces, pose, LINES)[0]
    deepest = int(np.argmax(penetration))
    inside = penetration - (1 - PENETRATION) * penetration[deepest]
    if penetration[deepest] <= 0:
        return 0.0
    # strips finer than the lines, about the deepest one
    low, high = LINES[np.flatnonzero(inside > 0)[[0, -1]]]
    s = np.linspace(low - 1e-4, high + 1e-4, 80)
    depth, curvature = _profile(surfaces, pose, s)
    half2 = np.maximum(2 * (depth - (1 - PENETRATION) * penetration[deepest]) / curvature, 0.0)
    t = (np.arange(40) + 0.5) / 20 - 1
    root = np.sqrt(half2)[:, None] * np.sqrt(1 - t * t)
    x, y = np.sqrt(half2)[:, None] * t, (s - LINES[deepest])[:, None]
    weight = np.sqrt(half2)[:, None] * root
    mean_distance = weight.sum() / max((weight / np.maximum(np.hypot(x, y), 1e-6)).sum(), 1e-300)
    upright = np.abs(surfaces.wheel.normal(s)[:, 1])
    cosine = float((weight.sum(axis=1) * upright).sum() / max(weight.sum(), 1e-300))
    return float(np.pi * steel.E * penetration[deepest] / (2 * (1 - steel.nu**2)) * mean_distance * cosine)
