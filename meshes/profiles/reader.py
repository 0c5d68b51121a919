"""Profiles from files: points oriented, checked, and interpolated or smoothed by splines."""

from __future__ import annotations

import logging
import warnings
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

import numpy as np

from wheelrail.meshes.curves.spline import through
from wheelrail.meshes.profiles.formats import ProfileError, RawProfile, read_points
from wheelrail.meshes.profiles.measurement import NOTICEABLE, measured, pressure, require_usable
from wheelrail.meshes.profiles.named import named_profile
from wheelrail.meshes.profiles.profile import Kind, Placement, Profile, from_sections
from wheelrail.meshes.profiles.sections import single_section
from wheelrail.meshes.profiles.validation import checked, oriented

log = logging.getLogger(__name__)
LONG = 3000  # points, whose smoothing takes more than about 3 s


@dataclass(frozen=True)
class Reading:
    """How a profile file is read.

    Parameters:
        noise: RMS distance of the curve from the points, m; 0 interpolates; None: the noise that is estimated from the
            points, where its effect is noticeable.
        rolling_circle: y of the rolling circle in the file of a wheel, m; None: 0, or recognised, see `oriented`.
        section: number of the section of the file, from 1; None for a file with one section.
        inclination: of the rail in the file, rad, by which only web and foot are rotated.
        flange_back: y of the flange's back from the rolling circle, the origin of MiniProf, m.
    """

    noise: float | None = None
    rolling_circle: float | None = None
    section: int | None = None
    inclination: float = 0.0
    flange_back: float = -0.070


def read_profile(path: str | Path, kind: Kind, **options: Any) -> Profile:
    """Profile near the points of a file, by a spline.

    Parameters:
        path: of a .prr, .prw, .ban, .whl, .rail, .wheel, .txt, .csv or .dat file, see
            `wheelrail.meshes.profiles.formats`.
        kind: "wheel" or "rail".
        options: of `Reading`.

    The origin of a rail is at its highest point; z of a wheel is 0 at y = 0. Raises ProfileError with file, line, value
    and the allowed range, RoughProfile for points whose estimated noise cannot be smoothed sufficiently. A rough curve
    by a given noise is a warning.
    """
    path, reading = Path(path), Reading(**options)
    raw = single_section(read_points(path, kind), reading.section)
    raw = checked(oriented(raw, kind, reading.flange_back, reading.rolling_circle), kind)
    if len(raw.points) > LONG:
        log.info("%s: %d points: noise and smoothing take some seconds", path, len(raw.points))
    measurement = measured(raw.points, reading.noise, f"{path}, line {raw.lines.min()}", raw.remarks)
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
    top = rough.highest()
    rail = rough.transformed(0.0, -complex(*rough.point(top)), -top)
    return replace(rail, placement=_placement(rail, reading.inclination))


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
