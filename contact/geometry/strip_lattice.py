"""Lattice of strips fixed on the profile of the upper body, refined where the surfaces are sharply curved."""

from __future__ import annotations

import numpy as np
from scipy.special import ellipe, ellipk

from wheelrail.contact.geometry.strip_surfaces import ProfileStrips, QuadricStrips, StripSurfaces
from wheelrail.meshes.profiles.profile import Profile
from wheelrail.support.arrays import Array

USUAL_DEPTH = 1e-4  # m, approach of a usual wheel load, for which the strips' widths are chosen
WIDEST, NARROWEST = 1.0e-3, 0.25e-3  # m, at STRIPS over a usual patch
STRIPS = 16
WIDE = 3.0  # width over length of a patch, beyond which there are more strips
LONG = 1.5  # length over width of a patch, beyond which there are more cells
SMOOTHED = 3e-3  # m, length over which the width of the strips varies
SPACING = 1e-4  # m, of the samples from which widths are taken
NORMAL_SAMPLES = 400
SLENDER = 2 / np.pi  # exponent of the ratio of curvatures in that of the semi-axes: Hamrock, Brewe 1983


def lattice_sides(surfaces: StripSurfaces, arc: Array, strips: int, offset: float = 0.0) -> Array:
    """Lateral bounds (K + 1,) m of adjacent strips for a number of strips over a patch: over the whole profile of a
    wheel, from the first of the lines arc (ns,) m in both directions; over the width of quadrics, which does not depend
    on the lines of their meshes.
    """
    if isinstance(surfaces, QuadricStrips):
        return _uniform(surfaces, strips, offset)
    assert isinstance(surfaces, ProfileStrips)
    first, last = surfaces.wheel.s_range
    middle = _steps(surfaces, np.arange(arc[0], arc[-1] + 0.5 * SPACING, SPACING), strips, offset)
    before, after = (
        _steps(surfaces, np.append(np.arange(start, stop, np.copysign(SPACING, stop - start)), stop), strips, 0.0)
        for start, stop in ((middle[0], first), (middle[-1], last))
    )
    return np.concatenate([before[:0:-1], middle, after[1:]])


def _steps(surfaces: ProfileStrips, s: Array, strips: int, offset: float) -> Array:
    """Bounds (k,) m of whole strips from the first of positions (n,) m on, and by an offset in strips."""
    width = _widths(surfaces, s) * STRIPS / strips
    count = np.concatenate([[0.0], np.cumsum(0.5 * (1 / width[1:] + 1 / width[:-1]) * np.abs(np.diff(s)))])
    return np.asarray(np.interp(np.arange(int(count[-1] - offset) + 1) + offset, count, s))


def cells_along(surfaces: StripSurfaces, cells: int) -> int:
    """Cells along a strip for their number along one of a usual patch. On patches that are longer than wide tractions
    vary over distances of the width near the ends, where cells are smallest: quadrics have more then, as the root.
    """
    if isinstance(surfaces, QuadricStrips):
        along, across = surfaces.semi_axes
        if along > LONG * across:
            return int(np.ceil(cells * np.sqrt(along / (LONG * across))))
    return cells


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


def slenderness(surfaces: StripSurfaces, s: Array) -> Array:
    """Width (n,) of the undeformed penetration at s over that of the patch, relative to this of a circle; 1 for patches
    that are wider than long.

    The ratio is that of an ellipse on half-spaces: for a length over width of 5 it is 1.24, of 20 1.48 (Hertz).
    """
    if isinstance(surfaces, QuadricStrips):
        along, across = surfaces.semi_axes
        ratio = np.full(len(s), across / along)
    else:
        assert isinstance(surfaces, ProfileStrips)
        ratio = (_curvature(surfaces, s) * surfaces.radius) ** -SLENDER
    ratio = np.clip(ratio, 1e-3, 0.999)
    m = 1.0 - ratio**2
    K, E = ellipk(m), ellipe(m)
    return np.asarray(np.sqrt(0.5 * m * K / (E - ratio**2 * K)))


def _curvature(surfaces: ProfileStrips, s: Array) -> Array:
    """Sum (n,) 1/m of the magnitudes of the curvatures of wheel and rail where both have the slope of the wheel at s:
    where they cancel, the contact is wide but changes over short distances.
    """
    wheel, rail = surfaces.wheel, surfaces.rail
    curvature = np.abs(wheel.curvature(s)) + np.abs(_curvature_by_slope(rail, -_slope(wheel, s)))  # outward is down
    return np.asarray(np.maximum(curvature, 1e-3))


def _widths(surfaces: ProfileStrips, s: Array) -> Array:
    """Widths (n,) m of strips at s."""
    semi_axis = np.sqrt(2 * USUAL_DEPTH / _curvature(surfaces, s))
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
