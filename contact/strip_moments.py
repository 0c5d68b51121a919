"""Peak pressure and semi-axes of a patch from the mean pressures of its cells, to second order."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from contact.pose import Array
from contact.result import ContactResult
from contact.strips import Layout

EDGE = 2  # cells next to an end, where pressure goes like a square root, have no peak


def sharpened(result: ContactResult, layout: Layout, pressure: Array) -> ContactResult:
    """The result with the peak between the cells' middles, and semi-axes that know that pressure varies in a cell."""
    p = pressure.reshape(len(layout.sides), -1)
    assert result.fields is not None
    labels = result.fields.patch.reshape(p.shape).max(axis=1)
    found = []
    for k, patch in enumerate(result.patches):
        own = labels == k
        edges, s, width = layout.edges[own], layout.middle[own], layout.width[own]
        x, length = 0.5 * (edges[:, 1:] + edges[:, :-1]), np.diff(edges)
        load = p[own] * length
        across, wide = (np.broadcast_to(value, load.T.shape) for value in (s, width))
        axes = (spread(p[own], x, length, load), spread(p[own].T, across, wide, load.T))
        found.append(replace(patch, max_pressure=peak(p[own], x, length, s), semi_axes=axes))
    return replace(result, patches=tuple(found))


def spread(p: Array, x: Array, length: Array, weight: Array) -> float:
    """Semi-axis m of the ellipse whose Hertz pressure has the same second moment along the last axis.

    A cell's pressure has a slope p': its second moment is p (x^2 + l^2/12) + 2 x p' l^2/12.
    """
    total = weight.sum()
    centre = (weight * x).sum() / total
    if p.shape[1] < 2:
        return float(np.sqrt(5 * (weight * (x - centre) ** 2).sum() / total))
    slope = np.array([np.gradient(row, at) for row, at in zip(p, x, strict=True)])
    part = length**2 / 12
    share = np.divide(weight, p, out=np.zeros_like(weight), where=p > 0)
    moment = (weight * ((x - centre) ** 2 + part) + share * 2 * (x - centre) * slope * part).sum() / total
    return float(np.sqrt(5 * max(moment, 0.0)))


def peak(p: Array, x: Array, length: Array, s: Array) -> float:
    """Largest pressure Pa: a parabola through the mean pressures of the largest cell and its neighbours each way."""
    inner = p.copy()
    inner[:, :EDGE] = inner[:, -EDGE:] = 0.0
    i, j = np.unravel_index(np.argmax(inner), p.shape)
    best = float(p[i, j])
    if not inner[i, j] > 0:
        return float(p.max())
    along = _rise(p[i, j - 1 : j + 2], x[i, j - 1 : j + 2], float(length[i, j]))
    across = _rise(p[i - 1 : i + 2, j], s[i - 1 : i + 2], float(s[1] - s[0])) if 0 < i < len(p) - 1 else 0.0
    return best + along + across


def _rise(p: Array, x: Array, length: float) -> float:
    """How far the top of a parabola through three means lies above the middle one, Pa."""
    a, b, _ = np.polyfit(x - x[1], p, 2)
    if a >= 0:
        return 0.0
    return float(-a * length**2 / 12 - b * b / (4 * a)) if abs(b / (2 * a)) < length else float(-a * length**2 / 12)
