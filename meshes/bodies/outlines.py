"""Closed outlines of the bodies' cross-sections: the running surface, and the remaining boundary of the body."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray

from wheelrail.meshes.bodies.wheel_web import WheelShape
from wheelrail.meshes.profiles.named import named_profile
from wheelrail.meshes.profiles.profile import Profile
from wheelrail.support.arrays import Array

HEIGHT = 172.0  # mm, of the 60E1 section
SNAP = 2e-4  # m; corners of the boundary closer than this to an end of the profile are replaced by it
MISFIT = 8e-3  # m; largest distance of a rail profile's end from the standard section: heavy wear, not another rail
SMALLEST_RADIUS = 0.013  # m, of the arcs of the standard head

# Right half of 60E1 from the lower end of the flank to the axis, mm: x from the axis, height above the underside,
# centre of the preceding arc (None: a line) and its sense. EN 13674-1; fillets of 35 and 7 mm between web and faces.
_Corner = tuple[float, float, tuple[float, float] | None, int]
_START = (37.04876, 136.72473)
_LOWER_BOUNDARY: list[_Corner] = [
    (35.07774, 133.75554, (34.05251, 136.57492), -1),
    (16.50562, 127.00204, None, 0),
    (12.24533, 122.60165, (18.89782, 120.42349), 1),
    (11.43745, 119.72413, (45.50778, 111.71084), 1),
    (8.25, 92.25, (128.25, 92.25), 1),
    (8.25, 60.25, None, 0),
    (11.43745, 32.77587, (128.25, 60.25), 1),
    (12.24533, 29.89835, (45.50778, 40.78916), 1),
    (16.50562, 25.49796, (18.89782, 32.07651), 1),
    (44.86223, 15.18646, None, 0),
    (55.68207, 12.87985, (58.53195, 52.7782), 1),
    (71.28499, 11.76536, None, 0),
    (75.0, 7.77552, (71.0, 7.77552), -1),
    (75.0, 2.0, None, 0),
    (73.0, 0.0, (73.0, 2.0), -1),
]


@dataclass(frozen=True)
class Outline:
    """Cross-section of a body, clockwise in its plane (y to the field side, z or the radius upwards).

    Parameters:
        profile: running surface.
        surface_range: arc lengths at its start and end, m.
        boundary: (m, 2) m, remaining boundary from the end of the surface back to its start, both included.
        clamped: first and last index of the points of boundary between which the body is clamped.
        offset: (2,) m, translation of the profile.

    Raises ValueError if boundary does not close the outline.
    """

    profile: Profile
    surface_range: tuple[float, float]
    boundary: Array
    clamped: tuple[int, int]
    offset: tuple[float, float] = (0.0, 0.0)

    def __post_init__(self) -> None:
        start, stop = self.surface(self.surface_range)
        if max(np.abs(self.boundary[0] - stop).max(), np.abs(self.boundary[-1] - start).max()) > 1e-12:
            raise ValueError(f"boundary of section {self.profile.name} must start and end at the ends of its surface")
        if not 0 <= self.clamped[0] < self.clamped[1] < len(self.boundary):
            raise ValueError(f"clamped must be two indices of boundary in order, not {self.clamped}")
        self.boundary.setflags(write=False)

    @property
    def radius(self) -> float | None:
        """Radius m of the rolling circle of a body of revolution; None: of a rail."""
        return self.offset[1] if self.profile.kind == "wheel" else None

    def surface(self, s: ArrayLike) -> Array:
        """Points (..., 2) m of the running surface at arc length s m of the profile."""
        return np.asarray(self.profile.point(s) + self.offset)

    def is_clamped(self, points: Array) -> NDArray[np.bool_]:
        """Which of points (n, 2) m lie on the clamped part, within 1e-9 m."""
        line = self.boundary[self.clamped[0] : self.clamped[1] + 1]
        a, d = line[:-1], np.diff(line, axis=0)
        along = np.einsum("nmk,mk->nm", points[:, None] - a, d) / (d**2).sum(axis=1)
        closest = a + np.clip(along, 0.0, 1.0)[..., None] * d
        return np.asarray((np.hypot(*(points[:, None] - closest).transpose(2, 0, 1)) < 1e-9).any(axis=1))

    def polygon(self, spacing: float) -> Array:
        """Closed polygon (n, 2) m, first point not repeated, with the surface sampled every spacing [m] or closer."""
        s = self.profile.samples(spacing, *self.surface_range)
        return np.concatenate([self.surface(s), self.boundary[1:-1]])


def rail_outline(profile: Profile, *, chord_error: float = 5e-5) -> Outline:
    """Section of an inclined rail: the profile on web and foot of 60E1, clamped at the underside of the foot.

    Parameters:
        profile: of the inclined rail.
        chord_error: largest distance of the polyline of web and foot from its arcs, m.

    The profile is used down to the lower end of the flank, 35.3 mm below the crown; one that ends higher is continued
    by a straight line, or farther from the flank by the standard head. Raises ValueError if an end of the profile is
    more than 8 mm from the standard section.
    """
    if profile.kind != "rail":
        raise ValueError(f"{profile.name} is a {profile.kind}, not a rail")
    right = np.array(_lower_boundary(chord_error / 1e-3))
    section = np.concatenate([right, right[::-1] * (-1.0, 1.0)])
    boundary = profile.placement((section - (0.0, HEIGHT)) * 1e-3)
    (stop, field), (start, gauge) = (
        _end(profile, boundary[end], side, chord_error) for end, side in ((0, 1), (-1, -1))
    )
    boundary = np.concatenate([field, boundary, gauge[::-1]])
    boundary, dropped = _joined(boundary, profile.point(stop), profile.point(start))
    foot = len(field) + len(right) - 1 - dropped
    return Outline(profile, (start, stop), boundary, (foot, foot + 1))


def rim_outline(
    profile: Profile, radius: float, *, rim_thickness: float = 0.065, faces: tuple[float, float] = (-0.070, 0.065)
) -> Outline:
    """Section of a wheel's rim in (y, r), r = radius + z, clamped at its inner face.

    Parameters:
        profile: of the wheel.
        radius: nominal rolling radius, m.
        rim_thickness: m.
        faces: y of back and front, m.

    A profile that ends between the faces is continued to them at constant radius; a wider one widens the rim. Raises
    ValueError if the profile ends below the middle of the rim or covers less than half of its width.
    """
    inner = radius - rim_thickness
    stop, front, back, start = _rim(profile, radius, rim_thickness, faces)
    boundary = np.array([stop, [front, stop[1]], [front, inner], [back, inner], [back, start[1]], start])
    distinct = np.concatenate([[True], np.hypot(*np.diff(boundary, axis=0).T) > 0.0])
    first = int(distinct[:2].sum())
    return Outline(profile, profile.s_range, boundary[distinct], (first, first + 1), (0.0, radius))


def wheel_outline(profile: Profile, radius: float, shape: WheelShape | None = None) -> Outline:
    """Section of a monobloc wheel in (y, r), r = radius + z: rim, web and hub, clamped at the bore.

    Parameters:
        profile: of the wheel, treated as by `rim_outline`.
        radius: nominal rolling radius, m.
        shape: dimensions below the rim; None is the default `WheelShape`.

    Raises ValueError if the profile or the shape is incompatible with the radius.
    """
    shape = shape or WheelShape()
    stop, front, back, start = _rim(profile, radius, shape.rim_thickness, shape.faces)
    head = np.array([stop, [front, stop[1]]])
    tail = np.array([[back, start[1]], start])
    body = shape.below_the_rim(radius, front, back)
    boundary = np.concatenate([head, body, tail])
    distinct = np.concatenate([[True], np.hypot(*np.diff(boundary, axis=0).T) > 0.0])
    bore = np.flatnonzero(boundary[distinct][:, 1] == shape.bore_radius)
    return Outline(profile, profile.s_range, boundary[distinct], (int(bore[0]), int(bore[-1])), (0.0, radius))


def _rim(
    profile: Profile, radius: float, rim_thickness: float, faces: tuple[float, float]
) -> tuple[Array, float, float, Array]:
    """End of the profile on the field side, y of the front and the back of the rim, its end on the flange."""
    if profile.kind != "wheel":
        raise ValueError(f"{profile.name} is a {profile.kind}, not a wheel")
    if not 0.0 < rim_thickness < radius:
        raise ValueError(f"rim_thickness must lie in 0 .. {radius} m, not {rim_thickness}")
    start, stop = profile.point(profile.s_range) + np.array([0.0, radius])
    inner = radius - rim_thickness
    if min(start[1], stop[1]) < 0.5 * (radius + inner):
        raise ValueError(
            f"wheel {profile.name} reaches radius {min(start[1], stop[1]):.4f} m, into a rim from {inner} m"
        )
    if stop[0] - start[0] < 0.5 * (faces[1] - faces[0]):
        raise ValueError(
            f"wheel {profile.name} is {stop[0] - start[0]:.4f} m wide, the rim {faces[1] - faces[0]:.4f} m"
        )
    back = start[0] if start[0] < faces[0] + SNAP else faces[0]
    front = stop[0] if stop[0] > faces[1] - SNAP else faces[1]
    return stop, front, back, start


def _lower_boundary(chord_error: float) -> list[tuple[float, float]]:
    """Right half of the section from the lower end of the flank to the underside, mm."""
    points = [_START]
    for x, y, centre, sense in _LOWER_BOUNDARY:
        if centre is not None:
            (x0, y0), c = points[-1], complex(*centre)
            a, b = complex(x0, y0) - c, complex(x, y) - c
            turn = np.angle(b / a)
            if np.sign(turn) != sense:
                raise ValueError(f"arc to ({x}, {y}) has the wrong sense")
            # sagitta R (1 - cos(step / 2))
            count = max(2, int(np.ceil(abs(turn) / (2.0 * np.arccos(1.0 - min(chord_error / abs(a), 0.1))))))
            for k in range(1, count):
                p = c + a * np.exp(1j * turn * k / count)
                points.append((p.real, p.imag))
        points.append((x, y))
    return points


def _end(profile: Profile, corner: Array, side: int, chord_error: float) -> tuple[float, Array]:
    """Arc length m at which the profile ends, and points (n, 2) m of the standard head from there to the boundary.

    Parameters:
        profile: of the inclined rail.
        corner: (2,) m, first point of the boundary.
        side: 1 for the field side, -1 for the gauge side.
        chord_error: as for `rail_outline`.
    """
    s = float(profile.closest(corner[None]).s[0])
    gap = profile.point(s) - corner
    if s * side >= 0.0 and abs(gap[0]) <= MISFIT:
        return s, np.empty((0, 2))
    s = profile.s_range[1 if side > 0 else 0]
    head = named_profile("60E1")
    spacing = float(np.sqrt(8.0 * SMALLEST_RADIUS * chord_error))
    standard = profile.placement(
        head.point(head.samples(spacing, start=0.0) if side > 0 else head.samples(spacing, stop=0.0)[::-1])
    )
    distance = np.hypot(*(standard - profile.point(s)).T)
    nearest = int(np.argmin(distance))
    if distance[nearest] > MISFIT:
        where = "field" if side > 0 else "gauge"
        raise ValueError(
            f"rail {profile.name} ends {1e3 * distance[nearest]:.1f} mm from the standard section on the {where} side; "
            f'allowed: {1e3 * MISFIT:g} mm, to which the inclination of its file may be given, or bodies = "half-space"'
        )
    beyond = np.arange(len(standard)) > nearest
    return s, standard[beyond & (distance > SNAP)][:-1]


def _joined(boundary: Array, first: Array, last: Array) -> tuple[Array, int]:
    """Boundary between the profile's ends, without corners next to an end; number of corners removed at its start."""
    near_first = np.hypot(*(boundary - first).T) < SNAP
    near_last = np.hypot(*(boundary - last).T) < SNAP
    kept = boundary[~near_first & ~near_last]
    return np.concatenate([[first], kept, [last]]), int(near_first.sum()) - 1
