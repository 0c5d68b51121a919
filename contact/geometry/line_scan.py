"""Lines of a wheel's profile on which the penetration is sampled."""

from __future__ import annotations

import numpy as np

from wheelrail.bindings._contact import Box, Lines
from wheelrail.meshes.profiles.profile import Profile
from wheelrail.support.arrays import Array, Complex


def sampled_lines(wheel: Profile, rail: Profile, ordinary: tuple[float, float], spacing: float) -> Lines:
    """Lines of the whole profile of a wheel for a rail.

    Parameters:
        wheel, rail: the profiles.
        ordinary: m, ends of the part of the wheel's profile that touches rails in ordinary running.
        spacing: m, at most, of the lines.
    """
    (start, stop), (low, high) = ordinary, wheel.s_range
    middle = np.linspace(start, stop, int(np.ceil((stop - start) / spacing)) + 1)
    parts = wheel.samples(spacing, low, start)[:-1], middle, wheel.samples(spacing, stop, high)[1:]
    s = np.concatenate([part[(part >= low) & (part <= high)] for part in parts])
    point, tangent = _complex(wheel.point(s)), _complex(wheel.tangent(s))
    first, end = int(np.searchsorted(s, start)), int(np.searchsorted(s, stop, side="right"))
    order, at = np.argsort(rail.shape.sampled.real, kind="stable"), rail.shape.samples
    heights = rail.shape.sampled.imag[order]
    before, after = np.maximum.accumulate(heights), np.maximum.accumulate(heights[::-1])[::-1]
    return Lines(
        s,
        point,
        tangent,
        _complex(rail.tangent(at)),
        rail.curvature(at),
        first,
        end,
        _box(point[:first], 1.0),
        _box(point[end:], -1.0),
        float(np.abs(point.real).max()),
        np.array([rail.shape.sampled.real[order], heights, before, after]),
    )


def _complex(pairs: Array) -> Complex:
    return np.ascontiguousarray(pairs[:, 0] + 1j * pairs[:, 1])


def _box(points: Complex, hand: float) -> Box:
    """Bounds of points (n,) m whose side towards the ordinary lines is that of hand times y."""
    if not len(points):
        return Box(0.0, 0.0, 0.0)
    side = hand * float((hand * points.real).max())
    return Box(side, float(points.imag.min()), float(points.imag.max()))
