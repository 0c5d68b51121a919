"""Lattice of strips fixed on the profile of the upper body, refined where the surfaces are sharply curved."""

from __future__ import annotations

import numpy as np

from wheelrail.contact.geometry.strip_surfaces import ProfileStrips, QuadricStrips, StripSurfaces
from wheelrail.meshes.profiles.profile import Profile
from wheelrail.support.arrays import Array

USUAL_DEPTH = 1e-4  # m, approach of a usual wheel load, for which the strips' widths are chosen
WIDEST, NARROWEST = 1.0e-3, 0.4e-3  # m, at STRIPS over a usual patch
STRIPS = 16
WIDE = 3.0  # width over length of a patch, beyond which there are more strips
SMOOTHED = 3e-3  # m, length over which the width of the strips varies
SPACING = 1e-4  # m, of the samples from which widths are taken
NORMAL_SAMPLES = 400


def lattice_sides(surfaces: StripSurfaces, arc: Array, strips: int, offset: float = 0.0) -> Array:
    """Lateral bounds (K + 1,) m of adjacent strips for a number of strips over a patch: over the lines arc (ns,) m of
    profiles, over the width of quadrics, which does not depend on the lines of their meshes.
    """
    if isinstance(surfaces, QuadricStrips):
        return _uniform(surfaces, strips, offset)
    assert isinstance(surfaces, ProfileStrips)
    s = np.arange(arc[0], arc[-1] + 0.5 * SPACING, SPACING)
    width = _widths(surfaces, s) * STRIPS / strips
    count = np.concatenate([[0.0], np.cumsum(0.5 * (1 / width[1:] + 1 / width[:-1]) * np.diff(s))])
    return np.asarray(np.interp(np.arange(int(count[-1] - offset) + 1) + offset, count, s))


def _uniform(surfaces: QuadricStrips, strips: int, offset: float) -> Array:
    """Strips over twice the half width, that of the largest penetration, and one more on either side.

    The expected patch ends a quarter of a strip before a bound, where the error by whole strips, which has the period
    of a strip, changes its sign. Patches that are much wider than long have more strips, in proportion: under spin
    their longitudinal force is a small difference between both halves, off by up to 2.4 % of mu F_n on 14 strips.
    """
    along, across = surfaces.semi_axes
    if across > WIDE * along:
        strips = 2 * int(np.ceil(0.5 * strips * across / (WIDE * along)))
    width = 2 * across / (strips - 0.5)
    count = int(np.ceil(surfaces.half_width / width))
    return np.asarray(width * (np.arange(-count - 1, count + 2) + offset))


def _widths(surfaces: ProfileStrips, s: Array) -> Array:
    """Widths (n,) m of strips at s, by the magnitudes of the curvatures of wheel and rail where both have one slope:
    where they cancel, the contact is wide but changes over short distances.
    """
    wheel, rail = surfaces.wheel, surfaces.rail
    curvature = np.abs(wheel.curvature(s)) + np.abs(_curvature_by_slope(rail, -_slope(wheel, s)))  # outward is down
    semi_axis = np.sqrt(2 * USUAL_DEPTH / np.maximum(curvature, 1e-3))
    width = np.clip(2 * semi_axis / STRIPS, NARROWEST, WIDEST)
    window = np.hanning(2 * int(SMOOTHED / SPACING) + 1)
    half = len(window) // 2
    padded = np.pad(width, half, mode="edge")
    return np.asarray(np.convolve(padded, window / window.sum(), mode="valid"))


def _slope(profile: Profile, s: Array) -> Array:
    """Angle (n,) rad of the tangent."""
    t = profile.tangent(s)
    return np.asarray(np.arctan2(t[:, 1], t[:, 0]))


def _curvature_by_slope(rail: Profile, slope: Array) -> Array:
    """Curvature (n,) 1/m of a rail where its tangent has given angles rad."""
    s = np.linspace(*rail.s_range, NORMAL_SAMPLES)
    angle, curvature = _slope(rail, s), rail.curvature(s)
    order = np.argsort(angle)
    return np.asarray(np.interp(slope, angle[order], curvature[order]))
