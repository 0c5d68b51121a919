"""Worn profiles: material removed from a new one, as areas of its section in cells of its arc length.

The worn curve is x(s) = x0(s) - d(s) m(s). The depth d is a spline of degree 4 whose cells have the given areas, and m
is the normal of the new curve at the bounds of cells, smooth between: along the normals themselves a jump of the
curvature would become a corner of the worn curve, of the angle d d' times the jump. Between bounds the curves enclose
the integral of d cos(psi) - k d^2 / 2, with psi from m to the normal and k the curvature of m.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import NamedTuple, TypeVar

import numpy as np
from numpy.typing import ArrayLike, NDArray
from scipy.integrate import trapezoid
from scipy.interpolate import BSpline, CubicSpline
from scipy.linalg import solve_banded

from wheelrail.bindings._contact import SAMPLE_SPACING
from wheelrail.meshes.curves.arc_length import CurveSegment, fitted
from wheelrail.meshes.curves.curve import Curve, crossing
from wheelrail.support.arrays import Array, Complex

CELL = 0.5e-3  # m, of the arc length of a new profile
UNIFORM = 1e-9  # m, differences of the widths of cells that are rounding
NOTHING = 1e-17  # m, depths below the rounding of coordinates
DEGREE = 4
REACH = DEGREE // 2  # cells on both sides that a coefficient of the depth acts on
BAND = np.array([1.0, 26.0, 66.0, 26.0, 1.0]) / 120.0  # means over cells of the B-spline of degree 4
AREA = 1e-12  # of all removed area
ITERATIONS = 500
INVERSE_SPACING = 5e-5  # m, of samples between which the worn curve is as long as straight
SECTION_SPACING = 2e-5  # m, of the trapezoidal rule between two profiles: 1e-6 of the section of bumps of 3 mm
_NODES, _WEIGHTS = np.polynomial.legendre.leggauss(6)  # type: ignore[no-untyped-call]
_C = TypeVar("_C", bound=Curve)


def cell_bounds(new: Curve, width: float = CELL) -> Array:
    """Bounds (n + 1,) m of equal cells, about width m wide, that span the arc length of a new profile."""
    start, stop = new.s_range
    return np.linspace(start, stop, max(round((stop - start) / width), 2 * DEGREE) + 1)


def worn(new: _C, s: ArrayLike, removed_area: ArrayLike) -> _C:
    """The new profile without the material that is removed from cells of its arc length.

    Parameters:
        new: profile of a wheel or a rail.
        s: (n + 1,) m, bounds of equal cells on the new profile, as of `cell_bounds`.
        removed_area: (n,) m2 of each cell, not negative.

    The frame stays: z of a worn wheel is negative at y = 0, and s = 0 there. Pieces of the curve without wear stay as
    they are. Cells keep their areas, but at edges where the depth falls by more than it is itself within a cell or two:
    there it stays positive, and the area moves to the next cell. The sum is exact. Raises ValueError for other cells or
    areas, and with the place for wear that does not fit on the profile: wider than it, deeper than its radius of
    curvature, or through another part of it.
    """
    cells = _Cells.checked(new, s, removed_area)
    if not cells.area.any():
        return new
    depth = _depth(new, cells)
    breaks, coefficients = _pieces(new, depth)
    moved = replace(new, breaks=breaks, coefficients=coefficients)
    points = moved.point(at := moved.samples(2.0 * SAMPLE_SPACING))
    if (crossed := crossing(points)) is not None:
        raise ValueError(f"the worn profile crosses itself at {_place(points[crossed[0]])}, s = {at[crossed[0]]:.5g} m")
    return moved.transformed(0.0, 0.0, -float(moved.s_at_y(0.0)))


def new_arc_length(new: Curve, worn: Curve, s: ArrayLike) -> Array:
    """Arc lengths (n,) m on the new profile of places s (n,) m of the worn one, by closest points.

    Places beyond an end of the worn profile are as far beyond that place on the new one.
    """
    places = np.asarray(s, dtype=float)
    on = np.clip(places, *worn.s_range)
    return np.asarray(new.closest(worn.point(on)).s + places - on)


def worn_arc_length(new: Curve, worn: Curve, s: Array) -> Array:
    """Arc lengths (n,) m on the worn profile of ascending places s (n,) m of the new one, as of `new_arc_length`."""
    samples = np.linspace(*worn.s_range, 1 + int(np.ceil(np.ptp(worn.s_range) / INVERSE_SPACING)))
    on = np.maximum.accumulate(new_arc_length(new, worn, samples))
    on, first = np.unique(on, return_index=True)
    return np.asarray(np.interp(s, on, samples[first]))


class RemovedSection(NamedTuple):
    """Section between a new and a worn profile.

    Parameters:
        area: m2.
        z: of its centroid, m; NaN without area.
    """

    area: float
    z: float


def removed_section(new: Curve, worn: Curve) -> RemovedSection:
    """The section between both profiles, where closest points of the worn one lie on the new one within its ends."""
    points = worn.point(worn.samples(SECTION_SPACING))
    s, distance, inside = new.closest(points)
    s, depth = s[inside], -distance[inside]
    # the curvature jumps: the angle of the tangent, with the differential -k ds, does not
    turn = np.unwrap(np.angle(new.tangent(s) @ [1.0, 1j]))
    normal, z = new.normal(s)[:, 1], new.point(s)[:, 1]
    area = float(trapezoid(depth, s) + trapezoid(0.5 * depth**2, turn))
    moment = trapezoid(z * depth - 0.5 * normal * depth**2, s)
    moment += trapezoid(0.5 * z * depth**2 - normal * depth**3 / 3.0, turn)
    return RemovedSection(area, float(moment) / area if area else np.nan)


@dataclass(frozen=True)
class _Cells:
    """Equal cells that cover the new profile: bounds (n + 1,) m, removed areas (n,) m2."""

    bounds: Array
    area: Array

    @property
    def width(self) -> float:
        return float(np.ptp(self.bounds)) / len(self.area)

    @classmethod
    def checked(cls, new: Curve, s: ArrayLike, removed_area: ArrayLike) -> _Cells:
        """The cells, with cells without wear up to the ends of the profile. Raises ValueError."""
        bounds, area = np.asarray(s, dtype=float), np.asarray(removed_area, dtype=float)
        if area.ndim != 1 or bounds.shape != (len(area) + 1,):
            raise ValueError(f"s must have the shape (n + 1,) and removed_area (n,), not {bounds.shape}, {area.shape}")
        if not (np.isfinite(bounds).all() and np.isfinite(area).all() and (area >= 0.0).all()):
            raise ValueError("s must be finite, and removed_area finite and not negative")
        width, (start, stop) = np.diff(bounds), new.s_range
        if not (len(area) and width[0] > 0.0 and np.ptp(width) < UNIFORM):
            raise ValueError("s must be bounds of equal cells, increasing")
        if not (bounds[0] > start - UNIFORM and bounds[-1] < stop + UNIFORM):
            raise ValueError(f"s must lie in {start:.6g} .. {stop:.6g} m: {bounds[0]:.6g} .. {bounds[-1]:.6g}")
        h = float(np.mean(width))
        ends = [int(np.ceil((gap - UNIFORM) / h)) for gap in (bounds[0] - start, stop - bounds[-1])]
        before, after = (gap + (2 * DEGREE if 0 < gap < 2 * DEGREE else 0) for gap in ends)
        bounds = bounds[0] + h * np.arange(-before, len(area) + after + 1)
        return cls(bounds, np.concatenate([np.zeros(before), area, np.zeros(after)]))


class _Depth(NamedTuple):
    """Depth m over the new arc length, angle rad of the tangent that belongs to m, and bounds m of cells with depth."""

    depth: BSpline
    angle: CubicSpline
    worn: NDArray[np.bool_]
    bounds: Array


def _depth(new: Curve, cells: _Cells) -> _Depth:
    """Depth with the areas of the cells, by iteration over the part that the curvature takes."""
    bounds, h, n = cells.bounds, cells.width, len(cells.area)
    angle = _angle(new, bounds)
    at, weights, cell = _quadrature(new, bounds, angle.x)
    inside = _nearest(np.flatnonzero(cells.area), n)[cell]  # the spline reaches beyond the worn cells
    psi = np.angle(np.exp(1j * angle(at)) * (new.tangent(at) @ [1.0, -1j]))
    cosine, curvature = np.cos(psi), -angle.derivative()(at)
    knots = bounds[0] + h * np.arange(-DEGREE, n + DEGREE + 1)
    linear, most = cells.area, float(cells.area.max())
    for _ in range(ITERATIONS):
        coefficients = _positive_interpolation(linear / h)
        depth = BSpline(knots, np.pad(coefficients, REACH, mode="symmetric"), DEGREE)
        d = depth(at)
        enclosed = np.bincount(inside, weights * (d * cosine - 0.5 * curvature * d**2), n)
        flat = np.bincount(inside, weights * d, n)
        left = cosine - d * curvature  # of the length of the new curve; the radius of curvature is left / curvature
        change = (cells.area + flat - enclosed - linear) / np.maximum(np.bincount(cell, weights * left, n) / h, 1.0)
        last, linear = linear, _not_negative(linear + change)
        if not (left > SAMPLE_SPACING * curvature).all() or np.abs(linear - last).max() <= 1e-15 * most:
            break
    if (folded := left - SAMPLE_SPACING * curvature).min() <= 0.0:
        i = int(np.argmin(folded))
        raise ValueError(
            f"wear of {1e3 * d[i]:.3g} mm at {_place(new.point(at[i]))}, s = {at[i]:.5g} m, is deeper than the radius "
            f"of curvature, {1e3 / curvature[i]:.3g} mm"
        )
    if abs(enclosed.sum() - cells.area.sum()) > AREA * cells.area.sum():
        lost, total = (1e6 * area for area in (cells.area.sum() - enclosed.sum(), cells.area.sum()))
        raise ValueError(
            f"{lost:.3g} of {total:.3g} mm2 do not fit on the profile; cells reach its ends where it wears there"
        )
    acting = np.convolve(coefficients > NOTHING, np.ones(2 * REACH + 1), mode="same") > 0.5
    return _Depth(depth, angle, acting, bounds)


def _nearest(worn: NDArray[np.intp], n: int) -> NDArray[np.intp]:
    """The nearest of some cells (k,), in order, to each of n."""
    return worn[np.searchsorted(0.5 * (worn[1:] + worn[:-1]), np.arange(n))]


def _not_negative(areas: Array) -> Array:
    """Areas (n,) m2, with negative ones moved to the larger neighbour."""
    below = np.flatnonzero(areas < 0.0)
    padded = np.pad(areas, 1)
    neighbour = np.where(padded[below] > padded[below + 2], below - 1, below + 1)
    moved = areas.copy()
    np.add.at(moved, neighbour, areas[below])
    moved[below] -= areas[below]
    return moved


def _angle(new: Curve, bounds: Array) -> CubicSpline:
    """Angle rad of the tangent over s, interpolated at bounds of cells, of wide ones between, too."""
    parts = int(np.ceil(np.diff(bounds)[0] / CELL - 1e-6))
    s = np.linspace(bounds[0], bounds[-1], parts * (len(bounds) - 1) + 1)
    on = np.clip(s, *new.s_range)
    return CubicSpline(s, np.unwrap(np.angle(new.tangent(on) @ [1.0, 1j])) - new.curvature(on) * (s - on))


def _quadrature(new: Curve, bounds: Array, knots: Array) -> tuple[Array, Array, NDArray[np.intp]]:
    """Places (m,) m on the new curve, weights (m,) m and cells (m,) of Gauss's rule between breaks and knots (k,) m."""
    ends = np.unique(np.clip(np.concatenate([new.breaks, knots]), *new.s_range))
    middle, half = 0.5 * (ends[1:] + ends[:-1]), 0.5 * np.diff(ends)
    cell = np.clip(np.searchsorted(bounds, middle) - 1, 0, len(bounds) - 2)
    at, weights = middle[:, None] + half[:, None] * _NODES, half[:, None] * _WEIGHTS
    return at.ravel(), weights.ravel(), np.repeat(cell, len(_NODES))


def _positive_interpolation(mean: Array) -> Array:
    """Coefficients (n,) of the spline whose means over cells are given (n,), limited to positive ones.

    Even at both ends. What interpolation moves from cell to cell, as against the means themselves as coefficients, is
    limited so that coefficients stay positive, and zero where a cell and its neighbours are zero: flux-corrected
    transport, S. T. Zalesak, doi:10.1016/0021-9991(79)90051-2.
    """
    n = len(mean)
    bands = np.repeat(BAND[:, None], n, axis=1)
    for end, inner in ((0, 1), (n - 1, n - 2)):
        bands[2, end] += BAND[1]
        bands[3 if end == 0 else 1, end] += BAND[0]
        bands[1 if end == 0 else 3, inner] += BAND[0]
    coefficients = solve_banded((2, 2), bands, mean)
    flux = np.concatenate([[0.0], np.cumsum(mean - coefficients)])  # to the next cell
    flux[-1] = 0.0
    out = np.maximum(flux[1:], 0.0) - np.minimum(flux[:-1], 0.0)
    gives = np.minimum(1.0, np.divide(mean, out, out=np.ones(n), where=out > 0.0))
    takes = np.convolve(mean > NOTHING, np.ones(3), mode="same") > 0.5
    forwards = flux[1:-1] > 0.0
    share = np.where(forwards, gives[:-1] * takes[1:], gives[1:] * takes[:-1])
    flux[1:-1] *= share
    return np.asarray(mean + flux[:-1] - flux[1:])


def _pieces(new: Curve, depth: _Depth) -> tuple[Array, Complex]:
    """Breaks and coefficients of the worn curve; pieces without wear are unchanged."""
    first = np.searchsorted(new.breaks, depth.bounds[:-1][depth.worn], "right")
    last = np.searchsorted(new.breaks, depth.bounds[1:][depth.worn])
    touched = np.zeros(len(new.breaks) - 1, dtype=bool)
    for i, j in zip(np.maximum(first - 1, 0), last, strict=True):
        touched[i:j] = True
    segment, lengths, coefficients = _segment(new, depth), list[Array](), list[Complex]()
    changes = np.flatnonzero(np.diff(touched)) + 1
    for part in np.split(np.arange(len(touched)), changes):
        ends = new.breaks[part[0] : part[-1] + 2]
        if touched[part[0]]:
            inner = depth.bounds[(depth.bounds > ends[0]) & (depth.bounds < ends[-1])]
            apart = np.abs(inner[:, None] - ends).min(axis=1) > UNIFORM
            fit = fitted(replace(segment, knots=np.union1d(ends, inner[apart])))
        else:
            fit = np.diff(ends), new.coefficients[:, part]
        lengths.append(fit[0])
        coefficients.append(fit[1])
    breaks = new.breaks[0] + np.concatenate([[0.0], np.cumsum(np.concatenate(lengths))])
    return breaks, np.concatenate(coefficients, axis=1)


def _segment(new: Curve, depth: _Depth) -> CurveSegment:
    """The worn curve over the new arc length, without knots."""
    slope, turn = depth.depth.derivative(), depth.angle.derivative()

    def position(s: Array) -> Complex:
        return np.asarray(new.point(s) @ [1.0, 1j] - depth.depth(s) * 1j * np.exp(1j * depth.angle(s)))

    def velocity(s: Array) -> Complex:
        d = depth.depth(s)
        normal = 1j * np.exp(1j * depth.angle(s))
        return np.asarray(new.tangent(s) @ [1.0, 1j] - (slope(s) + 1j * d * turn(s)) * normal)

    return CurveSegment(position, velocity, np.empty(0))


def _place(point: Array) -> str:
    return f"({1e3 * point[0]:.3f}, {1e3 * point[1]:.3f}) mm"
