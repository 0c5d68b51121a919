"""Compiled: points and axes on the surface of a wheel, its profile revolved about y."""

from __future__ import annotations

import numpy as np

from contact.pose import Array
from meshes.closest import Shape, local, piece
from meshes.compiled import compiled


@compiled
def wheel_place(
    wheel: Shape, radius: float, origin: Array, rotation: Array, s: float, x: float, point: Array, axes: Array
) -> None:
    """Put the point (3,) m and the axes (3, 3), rows longitudinal, lateral and outward, of a place s, x m on a wheel of
    a nominal radius m, posed by origin and rotation, where they are asked for.
    """
    z, t, _ = local(wheel, s, piece(wheel, s))
    r, sine, cosine = z.imag + radius, np.sin(x / radius), np.cos(x / radius)
    for c in range(3):
        row = rotation[c]
        point[c] = origin[c] + row[0] * (r * sine) + row[1] * z.real - row[2] * (r * cosine)
        axes[2, c] = row[0] * (t.real * sine) - row[1] * t.imag - row[2] * (t.real * cosine)
        axes[0, c] = row[0] * cosine + row[2] * sine
    f, u = axes[0], axes[2]
    axes[1, 0], axes[1, 1] = f[1] * u[2] - f[2] * u[1], f[2] * u[0] - f[0] * u[2]
    axes[1, 2] = f[0] * u[1] - f[1] * u[0]


@compiled
def wheel_places(
    wheel: Shape, radius: float, origin: Array, rotation: Array, s: Array, x: Array
) -> tuple[Array, Array]:
    """Points (n, 3) and axes (n, 3, 3) of places s, x (n,), s held to the profile's ends."""
    n = len(s)
    points, axes = np.empty((n, 3)), np.empty((n, 3, 3))
    for i in range(n):
        at = min(max(s[i], wheel.breaks[0]), wheel.breaks[-1])
        wheel_place(wheel, radius, origin, rotation, at, x[i], points[i], axes[i])
    return points, axes
