"""Points and axes on the surface of a wheel, its profile revolved about y; compiled."""

from __future__ import annotations

import numpy as np

from wheelrail.meshes.curves.closest_point import Shape, foot, local, nearer_sample, nearest_sample, next_piece, piece
from wheelrail.support.arrays import Array
from wheelrail.support.compiled import borrowing, unchecked

Place = tuple[float, float, float]
NEXT = 1e-3  # m: points closer than that have neighbouring closest points


@borrowing
def on_circle(
    z: complex, t: complex, radius: float, origin: Array, rotation: Array, x: float
) -> tuple[Place, Place, Place]:
    """Point m, forward axis and outward normal at x m along the circle of a profile's point z with the tangent t."""
    r, sine, cosine = z.imag + radius, np.sin(x / radius), np.cos(x / radius)
    back, down, inward, low = r * sine, r * cosine, t.real * sine, t.real * cosine
    y, axial = z.real, t.imag
    return (
        (
            origin[0] + rotation[0, 0] * back + rotation[0, 1] * y - rotation[0, 2] * down,
            origin[1] + rotation[1, 0] * back + rotation[1, 1] * y - rotation[1, 2] * down,
            origin[2] + rotation[2, 0] * back + rotation[2, 1] * y - rotation[2, 2] * down,
        ),
        (
            rotation[0, 0] * cosine + rotation[0, 2] * sine,
            rotation[1, 0] * cosine + rotation[1, 2] * sine,
            rotation[2, 0] * cosine + rotation[2, 2] * sine,
        ),
        (
            rotation[0, 0] * inward - rotation[0, 1] * axial - rotation[0, 2] * low,
            rotation[1, 0] * inward - rotation[1, 1] * axial - rotation[1, 2] * low,
            rotation[2, 0] * inward - rotation[2, 1] * axial - rotation[2, 2] * low,
        ),
    )


@borrowing
def write_frame(point: Place, forward: Place, normal: Place, points: Array, axes: Array, i: int) -> None:
    """Write a point and its axes, longitudinal, lateral and outward, into row i of (n, 3) m and (n, 3, 3)."""
    for c in range(3):
        points[i, c], axes[i, 0, c], axes[i, 2, c] = point[c], forward[c], normal[c]
    axes[i, 1, 0] = forward[1] * normal[2] - forward[2] * normal[1]
    axes[i, 1, 1] = forward[2] * normal[0] - forward[0] * normal[2]
    axes[i, 1, 2] = forward[0] * normal[1] - forward[1] * normal[0]


@borrowing
def wheel_place(
    wheel: Shape, radius: float, origin: Array, rotation: Array, s: float, x: float, points: Array, axes: Array, i: int
) -> None:
    """Write point and axes at s, x on a wheel into row i of points and axes.

    Parameters:
        wheel: shape of the profile.
        radius: nominal rolling radius, m.
        origin, rotation: (3,) m and (3, 3), pose of the wheel.
        s, x: m, arc length on the profile, and along the rolling circle.
        points, axes: (n, 3) m and (n, 3, 3), rows longitudinal, lateral and outward.
        i: row.
    """
    z, t, _ = local(wheel, s, piece(wheel, s))
    write_frame(*on_circle(z, t, radius, origin, rotation, x), points, axes, i)


@unchecked
def wheel_points(
    wheel: Shape, radius: float, origin: Array, rotation: Array, s: Array, x: Array
) -> tuple[Array, Array]:
    """Points (n, 3) m and axes (n, 3, 3) at s, x (n,) m on a wheel, s limited to the profile's ends.

    Parameters as for `wheel_place`.
    """
    n, j = len(s), 0
    points, axes = np.empty((n, 3)), np.empty((n, 3, 3))
    for i in range(n):
        limited = min(max(s[i], wheel.breaks[0]), wheel.breaks[-1])
        j = next_piece(wheel, limited, j) if i > 0 else piece(wheel, limited)
        z, t, _ = local(wheel, limited, j)
        write_frame(*on_circle(z, t, radius, origin, rotation, x[i]), points, axes, i)
    return points, axes


@unchecked
def profile_places(wheel: Shape, rail: Shape, s: Array, points: Array) -> tuple[Array, Array]:
    """Arc lengths and lateral positions (n, 2) m of points on the profiles of wheel and rail.

    Parameters:
        wheel, rail: shapes of the profiles.
        s: (n,) m, arc lengths on the wheel, limited to its ends.
        points: (n, 3) m, whose closest points on the rail are taken.
    """
    on_wheel, on_rail = np.empty((len(s), 2)), np.empty((len(s), 2))
    last, sample = complex(np.inf, 0.0), 0
    for i in range(len(s)):
        on_wheel[i, 0] = min(max(s[i], wheel.breaks[0]), wheel.breaks[-1])
        q = complex(points[i, 1], points[i, 2])
        sample = nearer_sample(rail, q, sample) if abs(q - last) < NEXT else nearest_sample(rail, q)
        on_rail[i, 0], last = foot(rail, q, rail.samples[sample])[0], q
        for shape, place in ((wheel, on_wheel), (rail, on_rail)):
            place[i, 1] = local(shape, place[i, 0], piece(shape, place[i, 0]))[0].real
    return on_wheel, on_rail
