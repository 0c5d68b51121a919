"""Profiles as users bring them: standard ones, worn in a parametric way, cones, discs, rails of arcs, grooved rails.

`wheel("S1002", hollow=1e-3)` and `rail("arcs", crown=0.254)` are shapes; their points are written to a file and read as
those of a user. Lengths in m.
"""

from __future__ import annotations

import hashlib
import os
import tempfile
from collections.abc import Callable, Mapping
from dataclasses import dataclass, replace
from functools import cached_property
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from wheelrail.meshes.profiles.named import NAMES, named_profile
from wheelrail.meshes.profiles.worn import cell_bounds
from wheelrail.support.arrays import Array

if TYPE_CHECKING:
    from wheelrail.meshes.profiles.profile import Kind, Profile

SPACING = 2e-4  # m, of the points
FOLDER = Path(tempfile.gettempdir(), "wheelrail-population")


@dataclass(frozen=True)
class Shape:
    """A profile by its kind, the name of its unworn form or a measured file, and the parameters of form and wear."""

    kind: Kind
    base: str
    parameters: tuple[tuple[str, float], ...] = ()

    def __repr__(self) -> str:
        return f"{self.kind}({', '.join([repr(self.base), *(f'{key}={value!r}' for key, value in self.parameters)])})"

    @cached_property
    def points(self) -> Array:
        """Points (n, 2) m, y to the field side, ascending along the curve."""
        if self.base in NAMES:
            curve = named_profile(self.base)
            points = curve.point(curve.samples(SPACING))
        elif self.base in FORMS:
            own = {key: value for key, value in self.parameters if key not in WEAR}
            points = resampled(FORMS[self.base](**own), SPACING)
        else:
            curve = self.profile
            return curve.point(curve.samples(SPACING))
        for key, value in self.parameters:
            if key in WEAR:
                points = WEAR[key](points, value)
        return points

    @cached_property
    def profile(self) -> Profile:
        """As the package reads it: a standard one by its name, others from a file."""
        import wheelrail as wr

        if self.base in NAMES and not self.parameters:
            return wr.profile(self.base)
        if depth := dict(self.parameters).get("abraded"):  # in its frame: the radius falls by the wear
            return abraded(replace(self, parameters=self.parameters[:-1]).profile, depth)
        if self.base not in NAMES and self.base not in FORMS:
            return wr.profile(self.base, self.kind)
        text = "".join(f"{1e3 * y:.6f} {1e3 * z:.6f}\n" for y, z in self.points)
        file = FOLDER / f"{self.base}_{hashlib.sha256(text.encode()).hexdigest()[:12]}.{self.kind}"
        if not file.exists():
            FOLDER.mkdir(parents=True, exist_ok=True)
            own = file.with_suffix(f".{os.getpid()}")
            own.write_text(text, encoding="utf-8")
            own.replace(file)
        return wr.profile(file, rolling_circle=0.0 if self.kind == "wheel" else None)


def wheel(base: str, **parameters: float) -> Shape:
    """Shape of a wheel: "S1002", "cone", "disc" or a file; wear by hollow, place, flange and tread."""
    return Shape("wheel", base, tuple(parameters.items()))


def rail(base: str, **parameters: float) -> Shape:
    """Shape of a rail: a standard name, "arcs", "groove", "flat" or a file; wear by crown, corner and side."""
    return Shape("rail", base, tuple(parameters.items()))


def bump(x: Array, middle: float, half: float) -> Array:
    """cos^2 around a middle, zero beyond half of its width."""
    t = np.clip((x - middle) / half, -1.0, 1.0)
    return np.asarray(np.cos(0.5 * np.pi * t) ** 2)


def normals(points: Array) -> Array:
    """Outward unit normals (n, 2) of a curve with the body below it."""
    t = np.gradient(points, axis=0)
    t /= np.hypot(*t.T)[:, None]
    return np.column_stack([-t[:, 1], t[:, 0]])


def worn(points: Array, depth: Array) -> Array:
    """Points moved into the body by depths (n,) m."""
    return points - depth[:, None] * normals(points)


def hollow(points: Array, depth: float) -> Array:
    """A tread worn hollow around the rolling circle, 50 mm wide."""
    return worn(points, depth * bump(points[:, 0], 0.0, 25e-3))


def hollow_field(points: Array, depth: float) -> Array:
    """A tread worn hollow with a false flange towards the field side."""
    return worn(points, depth * bump(points[:, 0], 15e-3, 30e-3))


def tread(points: Array, depth: float) -> Array:
    """A tread worn down from the flange root on, as under long service in straight track."""
    return worn(points, depth * bump(points[:, 0], -8e-3, 28e-3))


def flange(points: Array, depth: float) -> Array:
    """A worn flange face."""
    y, z = points.T
    return worn(points, depth * bump(z, 13e-3, 13e-3) * (y > y[np.argmax(z)]))


def ground(points: Array, depth: float) -> Array:
    """A running surface between flange root and field side, as `abraded` removes it."""
    return worn(points, depth * bump(points[:, 0], -8e-3, 25e-3))


def abraded(profile: Profile, depth: float) -> Profile:
    """A profile that loses the area (1 - k d / 2) d of each length to a depth d m along its normals, k its curvature,
    as by a calculation of wear.
    """
    bounds = cell_bounds(profile)
    middle = 0.5 * (bounds[1:] + bounds[:-1])
    depths = depth * bump(profile.point(middle)[:, 0], -8e-3, 25e-3)
    return profile.worn(bounds, (1.0 - 0.5 * profile.curvature(middle) * depths) * depths * np.diff(bounds))


def flattened(points: Array, depth: float) -> Array:
    """A crown worn flat."""
    return worn(points, depth * bump(points[:, 0], 0.0, 28e-3))


def corner(points: Array, depth: float) -> Array:
    """A worn gauge corner."""
    s = arc(points)
    at = int(np.argmin(np.abs(normals(points) @ [1.0, 1.0]) + (points[:, 0] > 0.0)))
    return worn(points, depth * bump(s, s[at], 16e-3))


def side(points: Array, depth: float) -> Array:
    """A worn gauge face, from 2 to 30 mm below the top."""
    y, z = points.T
    return worn(points, depth * bump(z - z.max(), -16e-3, 14e-3) * (y < 0.0))


WEAR: Mapping[str, Callable[[Array, float], Array]] = {
    **{"hollow": hollow, "hollow_field": hollow_field, "tread": tread, "flange": flange},
    **{"flattened": flattened, "corner": corner, "side": side, "abraded": ground},
}


def cone(slope: float = 0.05, face: float = 1.22, root: float = 13e-3, thickness: float = 32.5e-3) -> Array:
    """A conical tread with a straight flange face at an angle rad, and a root radius m; slope 0 is a cylinder."""
    tip = 28.5e-3
    at_10 = -70e-3 + thickness  # y of the face 10 mm above the rolling circle
    run = 1.0 / np.tan(face)
    foot = (at_10 + 10e-3 * run) / (1.0 - slope * run)  # where the face meets the tread z = -slope y
    vertices = [(-70e-3, 10e-3), (-63e-3, tip), (at_10 - (tip - 10e-3) * run, tip), (foot, -slope * foot)]
    return filleted([*vertices, (60e-3, -slope * 60e-3)], [7e-3, 8e-3, root])


def disc(crown: float = 0.3, width: float = 60e-3) -> Array:
    """A roller without a flange, of a test rig, with a crown radius m."""
    y = np.linspace(-0.5 * width, 0.5 * width, 1201)
    return np.column_stack([y, np.sqrt(crown**2 - y**2) - crown])


def arcs(crown: float = 0.3, shoulder: float = 80e-3, radius: float = 13e-3, half: float = 10.15e-3) -> Array:
    """A rail head of a crown, shoulders that end 26 mm from the middle, and corners, with faces inclined by 1/20."""
    y, z, turn, points = 0.0, 0.0, 0.0, [(0.0, 0.0)]
    last = 0.5 * np.pi - 0.05
    ends = (np.arcsin(half / crown), None, last)
    for r, end in zip((crown, shoulder, radius), ends, strict=True):
        stop = np.arcsin(min(np.sin(turn) + (26e-3 - y) / r, 0.95)) if end is None else end
        angles = np.linspace(turn, stop, max(int(r * (stop - turn) / 5e-5), 8))[1:]
        points += [(y + r * (np.sin(a) - np.sin(turn)), z + r * (np.cos(a) - np.cos(turn))) for a in angles]
        (y, z), turn = points[-1], float(stop)
    points.append((y + 1.25e-3, z - 25e-3))
    right = np.array(points)
    return np.concatenate([(right * (-1.0, 1.0))[:0:-1], right])


def groove(depth: float = 47e-3, width: float = 42e-3, lip: float = 5e-3, **head: float) -> Array:
    """A grooved rail: the head, a groove of depth and width m on its gauge side, and a lip below the top by lip m."""
    points = arcs(**head)
    inner, foot = points[1], points[0]
    down = (inner[1] + depth) / max(inner[1] - foot[1], 1e-9)
    floor = inner + (foot - inner) * down
    floor[1] = -depth
    low = (floor[0] - width + 8e-3, -depth)
    up = (floor[0] - width, -lip)
    left = filleted([(up[0] - 15e-3, -lip), up, low, (floor[0], floor[1]), (inner[0], inner[1])], [3e-3, 8e-3, 8e-3])
    return np.concatenate([left[:-1], points[1:]])


def flat(width: float = 65e-3, radius: float = 10e-3, slope: float = 0.0) -> Array:
    """A flat top with rounded edges, sloping up towards the field side."""
    h = 0.5 * width
    vertices = [(-h - 1e-3, -30e-3 - slope * h), (-h, -slope * h), (h, slope * h), (h + 1e-3, -30e-3 + slope * h)]
    return filleted(vertices, [radius, radius])


FORMS: Mapping[str, Callable[..., Array]] = {"cone": cone, "disc": disc, "arcs": arcs, "groove": groove, "flat": flat}


def filleted(vertices: list[tuple[float, float]], radii: list[float]) -> Array:
    """A polyline whose inner vertices are rounded by radii m."""
    v = np.array(vertices)
    points = [v[0]]
    for before, at, after, r in zip(v, v[1:], v[2:], radii, strict=False):
        a, b = (before - at) / np.hypot(*(before - at)), (after - at) / np.hypot(*(after - at))
        half = 0.5 * np.arccos(np.clip(a @ b, -1.0, 1.0))
        middle = at + (a + b) / np.hypot(*(a + b)) * r / np.sin(half)
        first, last = at + a * r / np.tan(half), at + b * r / np.tan(half)
        begin, end = (np.arctan2(*(p - middle)[::-1]) for p in (first, last))
        turn = (end - begin + np.pi) % (2.0 * np.pi) - np.pi
        angles = begin + turn * np.linspace(0.0, 1.0, max(int(r * abs(turn) / 5e-5), 8))
        points += list(middle + r * np.column_stack([np.cos(angles), np.sin(angles)]))
    return np.array([*points, v[-1]])


def arc(points: Array) -> Array:
    """Arc length (n,) m from the first point."""
    return np.concatenate([[0.0], np.cumsum(np.hypot(*np.diff(points, axis=0).T))])


def resampled(points: Array, spacing: float) -> Array:
    """Points at most spacing m apart on the polyline."""
    s = arc(points)
    at = np.linspace(0.0, s[-1], int(np.ceil(s[-1] / spacing)) + 1)
    return np.column_stack([np.interp(at, s, points[:, 0]), np.interp(at, s, points[:, 1])])
