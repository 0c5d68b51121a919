"""Profiles from files: oriented, checked, and laid through by a spline."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np

from wheelrail.meshes.curves.spline import through
from wheelrail.meshes.profiles.formats import ProfileError, RawProfile, read_points
from wheelrail.meshes.profiles.named import named_profile
from wheelrail.meshes.profiles.profile import Kind, Placement, Profile, from_sections
from wheelrail.meshes.profiles.validation import checked, oriented


def read_profile(
    path: str | Path, kind: Kind, *, noise: float = 0.0, inclination: float = 0.0, flange_back: float = -0.070
) -> Profile:
    """Profile through the points of a .prr, .prw, .ban, .whl, .txt, .csv or .dat file (conventions:
    `wheelrail.meshes.profiles.formats`).

    noise m: RMS distance that the spline may keep from the points; 0 passes through them. inclination rad: laying
    angle already in the file, which only the rest of the rail's section follows. flange_back m: place of the flange's
    back, from which MiniProf counts. A rail's origin moves to its highest point; a wheel's z is 0 at y = 0.
    ProfileError with file, line, value and what is allowed.
    """
    path = Path(path)
    raw = oriented(read_points(path, kind), kind, flange_back)
    points = checked(raw, kind)
    middle = points[len(points) // 2]
    rough = from_sections(through(points - middle, noise), name=path.stem, kind=kind)
    if kind == "wheel":
        foot = _rolling_circle(rough, raw, middle[0])
        return rough.moved(0.0, -complex(*rough.point(foot)), -foot)
    top = rough.highest()
    rail = rough.moved(0.0, -complex(*rough.point(top)), -top)
    return replace(rail, placement=_placement(rail, inclination))


def _rolling_circle(rough: Profile, raw: RawProfile, middle: float) -> float:
    try:
        return float(rough.s_at_y(-middle))
    except ValueError:
        low, high = rough.point(rough.s_range)[:, 0] + middle
        problem = f"points from y = {1e3 * low:.2f} to {1e3 * high:.2f} mm miss the rolling circle"
        raise ProfileError(raw.path, int(raw.lines[0]), problem, "y counted from the rolling circle") from None


def _placement(rail: Profile, inclination: float) -> Placement:
    """Placement of a 60E1 rail of that inclination whose top is as high and whose field-side flank fits best.

    Wear spares that flank. Without it (less than 15 mm deep) the highest points coincide.
    """
    standard = named_profile("60E1").laid(inclination)
    points = rail.point(rail.samples(1e-3, start=0.0))
    flank = points[(points[:, 1] < -15e-3) & (points[:, 1] > -34e-3)]
    aside = 0.0
    if len(flank):
        for _ in range(3):
            found = standard.closest(flank - (aside, 0.0))
            aside += float(np.mean(found.distance / standard.normal(found.s)[:, 0]))
    return standard.placement.then(0.0, complex(aside))
