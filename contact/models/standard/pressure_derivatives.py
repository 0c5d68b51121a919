"""Derivatives of strip pressures by the wheel's pose, in closed form."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from wheelrail.contact.geometry.interpenetration import PenetrationRegions
from wheelrail.contact.models.standard.ellipse import axis_ratio, complete
from wheelrail.contact.models.standard.normal import StripPressures
from wheelrail.contact.models.standard.region_derivatives import MOTIONS, RegionDerivatives
from wheelrail.support.arrays import Array
from wheelrail.support.compiled import borrowing, unchecked

CIRCULAR = 1e-5  # 1 - k^2 below which the derivative of D is that at k = 1: its error is of this order


class PressureDerivatives(NamedTuple):
    """Derivatives by the six rigid motions of the wheel.

    Parameters:
        strips: (n, 5, 6), of position, x, width and half length, and of the strip's normal force over pi / 2.
        patches: (k, 3, 6), of the load, and of the semi-axes along and across.
    """

    strips: Array
    patches: Array


@borrowing
def complete_derivatives(k: float, K: float, D: float) -> tuple[float, float]:
    """Derivatives of K and D of `complete` by k."""
    m = (1.0 - k) * (1.0 + k)
    by_m = 3.0 * np.pi / 32.0 if m < CIRCULAR else ((K - D) / (2.0 * k * k) - 0.5 * D) / m
    return -(K - D) / k, -2.0 * k * by_m


@borrowing
def axis_ratio_slope(k: float) -> float:
    """Logarithmic derivative of `axis_ratio` by the ratio of curvatures, where its value is k."""
    K, D = complete(k)
    by_K, by_D = complete_derivatives(k, K, D)
    return 1.0 / (2.0 + k * (by_D / D - (by_K - by_D) / (K - D)))


@borrowing
def potential_slopes(half: float, away: float) -> tuple[float, float, float]:
    """`strip_potential`, homogeneous of degree 1, and its derivatives by half length and distance."""
    reach = np.sqrt(half * half + away * away)
    K, D = complete(max(away / reach, 1e-12))
    value, by_half = 2.0 * (half / reach) * half * D, 2.0 * half / reach * K
    return value, by_half, (value - half * by_half) / away if away > 0.0 else 0.0


@unchecked
def virtual_penetration_derivatives(
    zones: PenetrationRegions, pressures: StripPressures, by: RegionDerivatives
) -> PressureDerivatives:
    """Derivatives of `wheelrail.contact.models.standard.normal.virtual_penetration`.

    Parameters:
        zones: interpenetration regions.
        pressures: on them.
        by: derivatives of the regions.
    """
    k, n = len(zones.peak), len(zones.s)
    result = PressureDerivatives(np.empty((n, 5, MOTIONS)), np.zeros((k, 3, MOTIONS)))
    fill_derivatives(zones, pressures, by, result, np.empty((n, MOTIONS)), np.empty(MOTIONS), np.empty(MOTIONS))
    return result


@borrowing
def fill_derivatives(
    zones: PenetrationRegions,
    pressures: StripPressures,
    by: RegionDerivatives,
    result: PressureDerivatives,
    by_half: Array,
    by_potential: Array,
    by_stretches: Array,
) -> None:
    """Fill the derivatives of `virtual_penetration_derivatives`, whose parameters these are.

    Parameters:
        result: filled, zero before.
        by_half, by_potential, by_stretches: (n, 6), (6,) and (6,), filled: of the half lengths, and of a patch's
            potential and, logarithmic, stretch.
    """
    strips, patches, k, n = result.strips, result.patches, len(zones.peak), len(zones.s)
    start = 0
    for c in range(k):
        stop, total, middle, middle_x, along, second = start, 0.0, 0.0, 0.0, 0.0, 0.0
        while stop < n and zones.contact[stop] == c:
            load = 2.0 * zones.penetration[stop] * zones.radius[stop] * zones.width[stop]
            total += load
            middle += load * zones.s[stop]
            middle_x += load * zones.x[stop]
            along += load * 2.0 * zones.penetration[stop] * zones.radius[stop]
            stop += 1
        middle, middle_x = middle / total, middle_x / total
        for i in range(start, stop):
            load = 2.0 * zones.penetration[i] * zones.radius[i] * zones.width[i]
            second += load * (zones.s[i] - middle) ** 2
        ratio = second * 4.0 * total / (along * total)  # (b / a)^2 = (5 second / total) / (1.25 along / total)
        slender = axis_ratio(ratio) if ratio <= 1.0 else axis_ratio(1.0 / ratio)
        stretch = np.sqrt((1.0 / slender if ratio <= 1.0 else slender) * np.sqrt(ratio))
        # the stretched axes are those of Hertz: logarithmic derivative of the stretch by b / a
        power = 0.5 - axis_ratio_slope(slender)
        potential = 0.0
        for q in range(MOTIONS):
            by_total, by_along, by_second, by_potential[q] = 0.0, 0.0, 0.0, 0.0
            by_first, by_first_x = 0.0, 0.0
            for i in range(start, stop):
                depth, radius, width = zones.penetration[i], zones.radius[i], zones.width[i]
                square, away, behind = 2.0 * depth * radius, zones.s[i] - middle, zones.x[i] - middle_x
                by_square = 2.0 * (by.strips[i, 3, q] * radius + depth * by.strips[i, 4, q])
                by_half[i, q] = 0.5 * by_square / np.sqrt(square)
                by_load = by_square * width + square * by.strips[i, 2, q]
                by_total += by_load
                by_first += by_load * away + square * width * by.strips[i, 0, q]
                by_first_x += by_load * behind + square * width * by.strips[i, 1, q]
                by_along += by_load * square + square * width * by_square
                by_second += by_load * away * away + 2.0 * square * width * away * by.strips[i, 0, q]
            by_ratio = 0.5 * (by_second / second - by_along / along)
            by_stretch = power * by_ratio  # logarithmic, as the two before
            by_stretches[q], by_middle, by_middle_x = by_stretch, by_first / total, by_first_x / total
            by_a = 0.5 * (by_along / along - by_total / total) + by_stretch
            by_b = 0.5 * (by_second / second - by_total / total) - by_stretch
            patches[c, 1, q], patches[c, 2, q] = by_a * pressures.along[c], by_b * pressures.across[c]
            for i in range(start, stop):
                away, behind = zones.s[i] - middle, zones.x[i] - middle_x
                half = np.sqrt(2.0 * zones.penetration[i] * zones.radius[i])
                strips[i, 0, q] = by_middle + (by.strips[i, 0, q] - by_middle - by_stretch * away) / stretch
                strips[i, 1, q] = by_middle_x + (by.strips[i, 1, q] - by_middle_x - by_stretch * behind) / stretch
                strips[i, 2, q] = (by.strips[i, 2, q] - by_stretch * zones.width[i]) / stretch
                strips[i, 3, q] = (by_half[i, q] + by_stretch * half) * stretch
        for i in range(start, stop):
            half, width = pressures.half[i], pressures.width[i]
            away = zones.s[i] - zones.peak[c]
            value, by_length, by_distance = potential_slopes(half, abs(away) / stretch)
            potential += value * width
            for q in range(MOTIONS):
                distance = by.strips[i, 0, q] - by.contacts[c, 0, q] - by_stretches[q] * away
                distance *= (1.0 if away > 0.0 else -1.0) / stretch
                change = by_length * strips[i, 3, q] + by_distance * distance
                by_potential[q] += change * width + value * strips[i, 2, q]
        for i in range(start, stop):
            half, width, scale = pressures.half[i], pressures.width[i], pressures.scale[i]
            for q in range(MOTIONS):
                by_scale = by.contacts[c, 2, q] / zones.depth[c] - by_potential[q] / potential
                strips[i, 4, q] = (
                    scale * half * (half * (width * by_scale + strips[i, 2, q]) + 2.0 * width * strips[i, 3, q])
                )
                patches[c, 0, q] += 0.5 * np.pi * strips[i, 4, q]
        start = stop
