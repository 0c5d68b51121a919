"""Profiles from files: points oriented, checked, and interpolated or smoothed by splines."""

from __future__ import annotations

import logging
import warnings
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

import numpy as np

from wheelrail.meshes.curves.spline import through
from wheelrail.meshes.profiles.convention import oriented, to_rolling_circle
from wheelrail.meshes.profiles.formats import ProfileError, RawProfile, read_points
from wheelrail.meshes.profiles.measurement import NOTICEABLE, measured, pressure, require_usable
from wheelrail.meshes.profiles.named import named_profile
from wheelrail.meshes.profiles.profile import Kind, Placement, Profile, from_sections
from wheelrail.meshes.profiles.sections import single_section
from wheelrail.meshes.profiles.validation import checked, cleaned

log = logging.getLogger(__name__)
LONG = 3000  # points, whose smoothing takes more than about 3 s
END = 1e-4  # m, of arc length, within which the highest point is an end


@dataclass(frozen=True)
class Reading:
    """How a profile file is read.

    Parameters:
        noise: RMS distance of the curve from the points, m; 0 interpolates; None: the noise that is estimated from the
            points, where its effect is noticeable.
        rolling_circle: y of the rolling circle in the points of a wheel, m; None: recognised, see `to_rolling_circle`.
        section: number of the section of the file, from 1; None for a file with one section.
        inclination: of the rail in the file, rad, by which only web and foot are rotated.
        flange_back: y of the flange's back from the rolling circle, the origin of MiniProf, m.
        scale: factor of all coordinates of the file.
        shift: added to y and z after it, m.
        mirror, flip: whether the sign of y, z then changes; None: as recognised, see `oriented`.
    """

    noise: float | None = None
    rolling_circle: float | None = None
    section: int | None = None
    inclination: float = 0.0
    flange_back: float = -0.070
    scale: float | None = None
    shift: tuple[float, float] | None = None
    mirror: bool | None = None
    flip: bool | None = None


def read_profile(path: str | Path, kind: Kind, **options: Any) -> Profile:
    """Profile near the points of a file, by a spline.

    Parameters:
        path: of a file, see `wheelrail.meshes.profiles.formats`.
        kind: "wheel" or "rail".
        options: of `Reading`.

    The origin of a rail is at its highest point; z of a wheel is 0 at y = 0. Raises ProfileError with file, line, value
    and the allowed range, RoughProfile for points whose estimated noise cannot be smoothed sufficiently. A rough curve
    by a given noise, and a shape that contradicts its signs, are warnings.
    """
    path, reading = Path(path), Reading(**options)
    raw = cleaned(single_section(read_points(path, kind), reading.section))
    scale, (dy, dz) = reading.scale or 1.0, reading.shift or (0.0, 0.0)
    changes = [f"scaled by {scale:g}"] if reading.scale else []
    changes += [f"shifted by ({1e3 * dy:g}, {1e3 * dz:g}) mm"] if reading.shift else []
    raw = replace(raw, points=raw.points * scale + np.array([dy, dz]))
    raw = oriented(raw, kind, reading.mirror, reading.flip, changes=changes)
    if kind == "wheel":
        raw = to_rolling_circle(raw, reading.flange_back, reading.rolling_circle)
    raw = checked(raw, kind)
    if len(raw.points) > LONG:
        log.info("%s: %d points: noise and smoothing take some seconds", path, len(raw.points))
    place = f"{path}, line {raw.lines.min()}"
    measurement = measured(raw.points, reading.noise, place, raw.convention, raw.remarks)
    if reading.noise is None:
        require_usable(measurement)
    if pressure(measurement.slope_error) > NOTICEABLE:
        warnings.warn(f"{measurement}", stacklevel=2)
    middle = raw.points[len(raw.points) // 2]
    sections = through(raw.points - middle, measurement.smoothing)
    rough = replace(from_sections(sections, name=path.stem, kind=kind), measurement=measurement)
    if kind == "wheel":
        foot = _rolling_circle(rough, raw, middle[0])
        return rough.transformed(0.0, -complex(*rough.point(foot)), -foot)
    return _at_top(rough, middle[0], reading.inclination)


def _at_top(rough: Profile, middle: float, inclination: float) -> Profile:
    """Rail with its origin at the highest point; where that is an end, as of a plane, at y = 0 or the middle point."""
    top = rough.highest()
    if not rough.s_range[0] + END < top < rough.s_range[1] - END:
        warnings.warn(f"{rough.name}: the highest point is an end of the profile; y = 0 is its origin", stacklevel=3)
        try:
            top = float(rough.s_at_y(-middle))
        except ValueError:
            top = 0.0
    rail = rough.transformed(0.0, -complex(*rough.point(top)), -top)
    return replace(rail, placement=_placement(rail, inclination))


def _rolling_circle(rough: Profile, raw: RawProfile, middle: float) -> float:
    try:
        return float(rough.s_at_y(-middle))
    except ValueError:
        low, high = rough.point(rough.s_range)[:, 0] + middle
        problem = f"points from y = {1e3 * low:.2f} to {1e3 * high:.2f} mm miss the rolling circle"
        allowed = "y counted from the rolling circle, or its y in the file as rolling_circle"
        raise ProfileError(raw.path, int(raw.lines[0]), problem, allowed) from None


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
