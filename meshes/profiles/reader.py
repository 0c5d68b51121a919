"""Profiles from files: points oriented, checked, and interpolated by a spline."""

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
    """Profile through the points of a file, by a spline.

    Parameters:
        path: of a .prr, .prw, .ban, .whl, .txt, .csv or .dat file, see `wheelrail.meshes.profiles.formats`.
        kind: "wheel" or "rail".
        noise: RMS distance between spline and points, m; 0 interpolates.
        inclination: of the rail in the file, rad, by which only web and foot are rotated.
        flange_back: y of the flange's back, the origin of MiniProf, m.

    The origin of a rail is at its highest point; z of a wheel is 0 at y = 0. Raises ProfileError with file, line, value
    and the allowed range.
    """
    path = Path(path)
    raw = oriented(read_points(path, kind), kind, flange_back)
    points = checked(raw, kind)
    middle = points[len(points) // 2]
    rough = from_sections(through(points - middle, noise), name=path.stem, kind=kind)
    if kind == "wheel":
        foot = _rolling_circle(rough, raw, middle[0])
        return rough.transformed(0.0, -complex(*rough.point(foot)), -foot)
    top = rough.highest()
    rail = rough.transformed(0.0, -complex(*rough.point(top)), -top)
    return replace(rail, placement=_placement(rail, inclination))


def _rolling_circle(rough: Profile, raw: RawProfile, middle: float) -> float:
    try:
        return float(rough.s_at_y(-middle))
    except ValueError:
        low, high = rough.point(rough.s_range)[:, 0] + middle
        problem = f"points from y = {1e3 * low:.2f} to {1e3 * high:.2f} mm miss the rolling circle"
        raise ProfileError(raw.path, int(raw.lines[0]), problem, "y counted from the rolling circle") from None


def _placement(rail: Profile, inclination: float) -> Placement:
    """Placement of a 60E1 rail of that inclination with the same top and the least-squares lateral position of the
    field-side flank.

    That flank is not worn. Without it (less than 15 mm deep) the highest points coincide.
    """
    standard = named_profile("60E1").inclined(inclination)
    points = rail.point(rail.samples(1e-3, start=0.0))
    flank = points[(points[:, 1] < -15e-3) & (points[:, 1] > -34e-3)]
    offset = 0.0
    if len(flank):
        for _ in range(3):
            closest = standard.closest(flank - (offset, 0.0))
            offset += float(np.mean(closest.distance / standard.normal(closest.s)[:, 0]))
    return standard.placement.then(0.0, complex(offset))
