"""Closest points of a curve: fine samples to start from, Newton's method on the curve itself."""

from __future__ import annotations

from typing import TYPE_CHECKING, NamedTuple

import numpy as np
from numpy.typing import NDArray

if TYPE_CHECKING:
    from meshes.curve import Array, Complex, Curve

SPACING = 1e-4  # m, of the samples, and the longest step
SMALL_STEP = 3e-8  # m; what one more step leaves is quadratic in it, below 1e-12 m
_FAST, _SAFE = 4, 1000


class Closest(NamedTuple):
    """Foot of each of n points: arc length s m, distance m, and whether the foot lies inside the curve.

    distance is positive on the outward side; inside is False where the foot is an end of the curve and the point lies
    beyond it.
    """

    s: Array
    distance: Array
    inside: NDArray[np.bool_]


def closest(curve: Curve, points: Array, guess: Array | None) -> Closest:
    """Nearest point of the curve for points (n, 2) m.

    Plain Newton steps settle all points but those near corners, ends and centres of curvature in two or three
    evaluations; the rest is done again, held to one smooth piece at a time.
    """
    q = points[..., 0] + 1j * points[..., 1]
    start = curve.nearest_sample(points) if guess is None else np.clip(guess, *curve.s_range)
    s = start
    for _ in range(_FAST):
        _along, across, step = _newton(curve, q, s, curve.piece(s))
        s = np.clip(s + np.clip(step, -SPACING, SPACING), *curve.s_range)
        rest = ~(np.abs(step) < SMALL_STEP)
        if not rest.any():
            break
    inside = np.ones(s.shape, dtype=bool)
    if rest.any():
        s[rest], across[rest], inside[rest] = _held(curve, q[rest], start[rest])
    return Closest(s, across, inside)


def _newton(curve: Curve, q: Complex, s: Array, j: NDArray[np.intp]) -> tuple[Array, Array, Array]:
    """Point minus curve along tangent and normal, and Newton's step for the least distance."""
    z, t, k = curve.local(s, j)
    away = q - z
    turned = t.conj() * away
    along = turned.real
    # |q - z|^2 / 2 has the slope -along and the second derivative 1 - Re(conj(z'') (q - z))
    return along, turned.imag, along / np.maximum(1.0 - (k.conj() * away).real, 1e-3)


def _held(curve: Curve, q: Complex, s: Array) -> tuple[Array, Array, NDArray[np.bool_]]:
    """The same with steps that stop at the end of a smooth piece, where the next one decides next time."""
    last = len(curve.breaks) - 2
    j, quiet = curve.piece(s), False
    for _ in range(_SAFE):
        along, across, step = _newton(curve, q, s, j)
        low, high = curve.breaks[j], curve.breaks[j + 1]
        new = np.clip(s + np.clip(step, -SPACING, SPACING), low, high)
        settled = bool(((np.abs(step) < SMALL_STEP) | (new == s)).all())
        if settled and quiet:  # idle on both sides: a corner or an end
            break
        j = np.clip(j + (new == high).astype(int) - (new == low), 0, last)
        s, quiet = new, settled
    at_rest = np.abs(along) > 2 * SMALL_STEP
    start, stop = curve.s_range
    inside = ((s > start) & (s < stop)) | ~at_rest
    return s, np.where(at_rest, np.copysign(np.hypot(along, across), across), across), inside
