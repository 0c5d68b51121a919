"""Pressure on strips along the rolling direction, semi-elliptic on each: of Hertz, or of Piotrowski and Kik."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from wheelrail.contact.geometry.interpenetration import POSITIONS, VIRTUAL, WIDTHS, PenetrationRegions
from wheelrail.contact.models.standard.ellipse import axis_ratio, ellipse, strip_potential
from wheelrail.support.arrays import Array, Nodes
from wheelrail.support.compiled import borrowing, compiled


class StripPressures(NamedTuple):
    """Pressures on n strips of k contacts.

    Parameters:
        contact: (n,), index of the contact.
        s, x: (n,) m, middle of the strip: arc length on the upper body's profile, and along the rolling direction.
        width, half: (n,) m, width and half length.
        scale: (n,) Pa/m; the pressure at x from the middle is scale sqrt(half^2 - x^2).
        load: (k,) N, normal force.
        along, across: (k,) m, semi-axes of the ellipse with the pressure's second moments.
    """

    contact: Nodes
    s: Array
    x: Array
    width: Array
    half: Array
    scale: Array
    load: Array
    along: Array
    across: Array


@borrowing
def moments(s: Array, x: Array, width: Array, half: Array) -> tuple[float, float, float, float]:
    """Centre m, as s and x, and semi-axes m, along and across, of the ellipse whose Hertz pressure has the same first
    and second moments as strips.

    s, x, width and half length (n,) m.
    """
    total, first, first_x, second, along = 0.0, 0.0, 0.0, 0.0, 0.0
    for i in range(len(s)):
        load = half[i] * half[i] * width[i]
        total += load
        first += load * s[i]
        first_x += load * x[i]
        along += load * half[i] * half[i]
    for i in range(len(s)):
        second += half[i] * half[i] * width[i] * (s[i] - first / total) ** 2
    return first / total, first_x / total, np.sqrt(1.25 * along / total), np.sqrt(5.0 * second / total)


@compiled
def virtual_penetration(zones: PenetrationRegions, E_star: float) -> StripPressures:
    """Piotrowski and Kik's pressure on the interpenetration regions, with shape correction.

    The deflection at the deepest point equals the penetration there. An elliptic region is too slender: length and
    width are scaled about the centre of the normal force, at constant area, to the ratio of semi-axes that Hertz gives
    for the same curvatures. Non-elliptic regions by their second moments.
    """
    s, x, width, half = (
        zones.s.copy(),
        zones.x.copy(),
        zones.width.copy(),
        np.sqrt(2.0 * zones.penetration * zones.radius),
    )
    scale, k = np.empty_like(s), len(zones.peak)
    load, along, across = np.empty(k), np.empty(k), np.empty(k)
    start = 0
    for c in range(k):
        stop = start
        while stop < len(s) and zones.contact[stop] == c:
            stop += 1
        own = slice(start, stop)
        middle, middle_x, a, b = moments(s[own], x[own], width[own], half[own])
        curvatures = (b / a) ** 2
        k_hertz = axis_ratio(curvatures) if curvatures <= 1.0 else axis_ratio(1.0 / curvatures)
        stretch = np.sqrt((1.0 / k_hertz if curvatures <= 1.0 else k_hertz) * b / a)
        volume, potential = 0.0, 0.0
        for i in range(start, stop):
            away = (s[i] - zones.peak[c]) / stretch
            s[i], x[i] = middle + (s[i] - middle) / stretch, middle_x + (x[i] - middle_x) / stretch
            half[i], width[i] = half[i] * stretch, width[i] / stretch
            volume += 0.5 * np.pi * half[i] * half[i] * width[i]
            potential += strip_potential(half[i], abs(away)) * width[i]
        scale[own] = np.pi * E_star * zones.depth[c] / potential
        load[c] = np.pi * E_star * zones.depth[c] / potential * volume
        along[c], across[c] = a * stretch, b / stretch
        start = stop
    return StripPressures(zones.contact, s, x, width, half, scale, load, along, across)


@compiled
def hertzian(zones: PenetrationRegions, E_star: float) -> StripPressures:
    """Hertz's pressure: the lateral curvature is that of the parabola whose interpenetration region has the same second
    moment.
    """
    k, m = len(zones.peak), len(POSITIONS)
    n = 2 * m * k
    contact, s, x, width, half, scale = (
        np.empty(n, dtype=np.int64),
        np.empty(n),
        np.empty(n),
        np.empty(n),
        np.empty(n),
        np.empty(n),
    )
    load, along, across = np.empty(k), np.empty(k), np.empty(k)
    start, n = 0, 0
    for c in range(k):
        stop, radius = start, 0.0
        while stop < len(zones.s) and zones.contact[stop] == c:
            stop += 1
        own = slice(start, stop)
        loads = zones.penetration[own] * zones.radius[own] * zones.width[own]
        radius = (loads * zones.radius[own]).sum() / loads.sum()
        long = np.sqrt(2.0 * zones.penetration[own] * zones.radius[own])
        wide = moments(zones.s[own], zones.x[own], zones.width[own], long)[3]
        a, b, peak = ellipse(0.5 / radius, VIRTUAL * zones.depth[c] / wide**2, zones.depth[c], E_star)
        load[c], along[c], across[c] = 2.0 / 3.0 * np.pi * peak * a * b, a, b
        for sign in (-1.0, 1.0):
            for q in range(m):
                contact[n], s[n], x[n] = c, zones.peak[c] + sign * b * POSITIONS[q], zones.peak_x[c]
                width[n], half[n] = b * WIDTHS[q], a * np.sqrt(1.0 - POSITIONS[q] ** 2)
                scale[n] = peak / a
                n += 1
        start = stop
    return StripPressures(contact, s, x, width, half, scale, load, along, across)
