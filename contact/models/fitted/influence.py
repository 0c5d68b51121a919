"""Mean compliance between cells of any length and offset along the strips of a body invariant along x or in angle.

Near its load a body is a half-space, with a solution in closed form; the solution by finite elements differs from it
smoothly across the surface, and this correction is interpolated from line to line.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field
from functools import cached_property, lru_cache, partial
from typing import ClassVar

import numpy as np
from numpy.typing import NDArray
from scipy.ndimage import convolve1d
from scipy.special import roots_legendre

from wheelrail.contact.elasticity.half_space import cutoff_correction, strip_antiderivative, strip_flexibility
from wheelrail.contact.elasticity.waveguide.compliance import WaveguideCompliance
from wheelrail.contact.elasticity.waveguide.element_correction import SurfaceError, surface_error
from wheelrail.contact.elasticity.waveguide.spectrum import ComplianceSpectrum, antiderivative_weights, pair_indices
from wheelrail.contact.kinematics.contact_points import OutsideSurface
from wheelrail.contact.laws.material import Material
from wheelrail.contact.models.fitted.influence_tables import EVEN, ODD, TableNodes, full_table, normal_table
from wheelrail.contact.models.fitted.line_interpolation import between_lines, shares
from wheelrail.support.arrays import Array

NODES = 128  # of the table of G over x: its error in a mean compliance stays below 1e-4
FINEST = 0.005  # spacing of the first nodes over that of the surface's lines
NEIGHBOURS = np.array([1.0, 4.0, 6.0, 4.0, 1.0]) / 16  # shares of a line in the mean over its neighbours
TILE = 8  # lines: granularity of the parts of the surface whose correction is assembled
KEPT = 3.2e7  # numbers (256 MB) in stored parts, a body: S1002 on UIC60 at 1 mm fill 124 MB in both from -8 to -5.5 mm
GAUSS, WEIGHT = roots_legendre(6)  # points and weights over the width of a strip


@dataclass
class HalfSpaceInfluence:
    """Influence between strips on half-spaces that touch the surface of a body: tables of G in closed form.

    Parameters:
        points: (ns, 2) m, lines of the surface on the section.
        arc: (ns,) m, their arc length.
        reach: longest distance along x, m.
        nu: Poisson's ratio.
        radius: of a body of revolution, m.
        unit, scale: factors from the tables' lengths and compliances to m and m/N.
    """

    points: Array
    arc: Array
    reach: float
    nu: float
    radius: float | None = None
    unit: float = 1.0
    scale: float = 1.0
    flat: ClassVar[bool] = True  # the surface is taken as level along x

    @classmethod
    def under(cls, points: Array, arc: Array, reach: float, steel: Material) -> HalfSpaceInfluence:
        """Below the lines (ns, 2) m at arc lengths (ns,) m."""
        return cls(points, arc, reach, steel.nu, scale=1 / steel.E)

    @cached_property
    def bounds(self) -> Array:
        """Ends (ns + 1,) m of the cells around the lines."""
        middle = 0.5 * (self.arc[1:] + self.arc[:-1])
        return np.concatenate([[2 * self.arc[0] - middle[0]], middle, [2 * self.arc[-1] - middle[-1]]])

    @cached_property
    def nodes(self) -> TableNodes:
        """Nodes of the tables, units."""
        return TableNodes.over(NODES, FINEST * float(np.diff(self.arc).min()) / self.unit, self.reach / self.unit)

    def window(self, low: float, high: float) -> tuple[int, int]:
        """First and one past the last line whose cells meet an interval of arc length, m.

        Raises OutsideSurface beyond the lines.
        """
        if low < self.bounds[0] or high > self.bounds[-1]:
            raise OutsideSurface("the bodies touch beyond the part of their surface that carries contact points")
        first, last = np.searchsorted(self.bounds, [low, high], side="right") - 1
        return max(int(first), 0), min(int(last) + 1, len(self.arc))

    def normal(self, sides: Array, reach: float) -> Array:
        """Table (pairs, nodes) of G along the surface's normals between strips with sides (S, 2) m, row by row of the
        pairs i <= j, for distances along x up to a reach [m]. Raises OutsideSurface beyond the lines.
        """
        self.window(float(sides.min()), float(sides.max()))
        count = self.nodes.up_to(reach / self.unit)
        across, stretch, tangent = self._strips(sides)
        turn = np.minimum(tangent @ tangent.T, 1.0)
        near = strip_antiderivative(self.nodes.x[:count], across, self.nu)
        correction = self._normal_correction(sides, count)
        return normal_table(near, self._far_field[:count], stretch, turn, correction, self.scale)

    def full(self, sides: Array, reach: float) -> Array:
        """The same (pairs, nodes, 9) of all components: displacement by force."""
        self.window(float(sides.min()), float(sides.max()))
        count = self.nodes.up_to(reach / self.unit)
        across, stretch, tangent = self._strips(sides)
        near = strip_antiderivative(self.nodes.x[:count], across, self.nu)
        even, odd = self._full_correction(sides, count)
        return full_table(near, self._far_field[:count], stretch, tangent, even, odd, self.scale)

    @cached_property
    def _far_field(self) -> Array:
        """Far-field correction (nodes, 3) at the table's nodes: none."""
        return np.zeros((NODES, 3))

    def _normal_correction(self, sides: Array, count: int) -> Array:
        """Correction (pairs, count) of `normal`: none."""
        return np.zeros((len(pairs_of(len(sides))), count))

    def _full_correction(self, sides: Array, count: int) -> tuple[Array, Array]:
        """Corrections (pairs, 5, count) and (pairs, 4, count) of the even and odd components of `full`: none."""
        pairs = len(pairs_of(len(sides)))
        return np.zeros((pairs, len(EVEN), count)), np.zeros((pairs, len(ODD), count))

    def _strips(self, sides: Array) -> tuple[Array, Array, Array]:
        """Sides (S, 2) of strips on half-spaces, in units; metric factors (S,) and tangents (S, 2) of the strips."""
        sides = np.ascontiguousarray(sides)
        across = between_lines(self.arc, self._along_lines[:, :1], sides.ravel()).reshape(sides.shape) / self.unit
        middle = between_lines(self.arc, self._along_lines, 0.5 * (sides[:, 0] + sides[:, 1]))
        tangent = middle[:, 2:]
        return across, middle[:, 1], tangent / np.sqrt((tangent * tangent).sum(axis=1))[:, None]

    @cached_property
    def _along_lines(self) -> Array:
        """Of every line (ns, 4): arc length over the metric factor, m, metric factor, and tangent."""
        return np.column_stack([self._across, self._stretch(self.arc), self._slope])

    @cached_property
    def _across(self) -> Array:
        """Arc length (ns,) m over the metric factor, integrated from line to line."""
        inverse = 1 / self._stretch(self.arc)
        steps = 0.5 * (inverse[1:] + inverse[:-1]) * np.diff(self.arc)
        return np.concatenate([[0.0], np.cumsum(steps)])

    def _tangents(self, arc: Array) -> Array:
        """Unit tangents (n, 2) of the section at arc lengths (n,) m."""
        t = np.column_stack([np.interp(arc, self.arc, part) for part in self._slope.T])
        return np.asarray(t / np.hypot(*t.T)[:, None])

    @cached_property
    def _slope(self) -> Array:
        return np.asarray(np.gradient(self.points, self.arc, axis=0))

    def _stretch(self, arc: Array) -> Array:
        """Metric factor: length on the surface over length on the rolling circle."""
        if self.radius is None:
            return np.ones_like(arc)
        return np.asarray(np.interp(arc, self.arc, self.points[:, 1]) / self.radius)


@dataclass(frozen=True)
class ElementCorrection:
    """Spectrum by finite elements minus that of half-spaces, of lines low to high, wavenumber by wavenumber.

    normal (lines, lines, nk) along the normals; even (lines, lines, 5 nk) and odd (lines, lines, 4 nk) components.
    """

    low: int
    high: int
    normal: Array
    even: Array
    odd: Array

    @property
    def size(self) -> int:
        return self.normal.size + self.even.size + self.odd.size


@dataclass
class ElementInfluence(HalfSpaceInfluence):
    """Half-spaces corrected by finite elements: tables of G from the spectrum of a body's surface lines.

    spectrum returns the samples, error the near-field error of the elements; both are called on first use.
    """

    spectrum: Callable[[], ComplianceSpectrum] = field(kw_only=True)
    error: Callable[[], SurfaceError] = field(kw_only=True)
    flat: ClassVar[bool] = False
    _cache: dict[tuple[int, int], ElementCorrection] = field(init=False, default_factory=dict, repr=False)

    @classmethod
    def of_waveguide(
        cls,
        body: WaveguideCompliance,
        lines: Array,
        arc: Array,
        reach: float,
        material: Material,
        degree: int,
        *,
        unit: float = 1.0,
    ) -> ElementInfluence:
        """Influence from the spectrum of a body.

        Parameters:
            body: compliance by wavenumbers, with its spectrum.
            lines: (ns, 2) m, lines of the surface on the section.
            arc: (ns,) m, their arc length.
            reach: longest distance along x, m.
            material: of the body.
            degree: of the elements, 1 or 2.
            unit: length of the tables' unit, m.
        """
        return cls(
            lines,
            arc,
            reach,
            material.nu,
            radius=body.radius,
            unit=unit,
            scale=body.scale,
            spectrum=body.spectrum,
            error=partial(surface_error, material.nu, degree),
        )

    @cached_property
    def samples(self) -> ComplianceSpectrum:
        """The spectrum. Raises ValueError when it belongs to another number of lines."""
        spectrum = self.spectrum()
        if spectrum.lines != len(self.arc):
            raise ValueError(f"the spectrum must have {len(self.arc)} lines, got {spectrum.lines}")
        return spectrum

    @cached_property
    def weights(self) -> tuple[Array, Array]:
        """Even and odd weights (nodes, nk) of the samples in G at the table's nodes."""
        return antiderivative_weights(self.nodes.x, self.samples)

    @property
    def _cutoff(self) -> float:
        """Low-wavenumber cut-off of the half-space's spectrum, 1 / unit: that of the body's size, or of two
        circumferences.
        """
        samples = self.samples
        return max(samples.shift, 4 * np.pi / samples.round if samples.round else 0.0)

    @cached_property
    def _far_field(self) -> Array:
        """Far-field correction (nodes, 3) at the table's nodes: effect of the cut-off on the half-space."""
        return cutoff_correction(self.nodes.x, self._cutoff, self.nu)

    def _normal_correction(self, sides: Array, count: int) -> Array:
        share, correction, lines = self._correction(sides)
        means = _pair_means(share, correction.normal[lines, lines], 1)
        return np.asarray((means @ self.weights[0][:count].T).reshape(-1, count))

    def _full_correction(self, sides: Array, count: int) -> tuple[Array, Array]:
        share, correction, lines = self._correction(sides)
        even = _pair_means(share, correction.even[lines, lines], len(EVEN)) @ self.weights[0][:count].T
        odd = _pair_means(share, correction.odd[lines, lines], len(ODD)) @ self.weights[1][:count].T
        return even, odd

    def _correction(self, sides: Array) -> tuple[Array, ElementCorrection, slice]:
        """Weights (S, lines) of the lines in the strips' means, the correction that covers these lines, and their range
        in it.
        """
        first, last = self.window(float(sides.min()), float(sides.max()))
        first, last = max(first - 1, 0), min(last + 1, len(self.arc))
        key = first // TILE, -(-last // TILE)
        correction = self._cache.pop(key, None)
        if correction is None:
            correction = self._assembled(max(TILE * key[0], 0), min(TILE * key[1], len(self.arc)))
            while self._cache and correction.size + sum(other.size for other in self._cache.values()) > KEPT:
                del self._cache[next(iter(self._cache))]
        self._cache[key] = correction  # in the order of their last use
        share = shares(self.arc[first:last], np.ascontiguousarray(sides), GAUSS, WEIGHT)
        return share, correction, slice(first - correction.low, last - correction.low)

    def _assembled(self, low: int, high: int) -> ElementCorrection:
        # with neighbours, so that smoothing does not depend on the part
        first, last = max(low - len(NEIGHBOURS), 0), min(high + len(NEIGHBOURS), len(self.arc))
        lines = self._remainder(first, last)[:, low - first : high - first, low - first : high - first]
        normal = self._tangents(self.arc[low:high])[:, ::-1] * [-1.0, 1.0]
        along = np.einsum("kijab,ia,jb->ijk", lines[..., 1:, 1:], normal, normal, optimize=True)
        nine = lines.reshape(*lines.shape[:3], 9).transpose(1, 2, 3, 0)
        n = high - low
        even, odd = (np.ascontiguousarray(nine[:, :, list(which)]).reshape(n, n, -1) for which in (EVEN, ODD))
        return ElementCorrection(low, high, np.ascontiguousarray(along), even, odd)

    def _remainder(self, low: int, high: int) -> Array:
        """Spectrum (nk, n, n, 3, 3) of a run of lines minus that of half-spaces."""
        remainder = self.samples.values[:, pair_indices(len(self.arc))[low:high, low:high]]
        row, column = np.tril_indices(high - low, -1)
        remainder[:, row, column] = remainder[:, column, row].swapaxes(-1, -2)
        self._add_near_field(remainder, low, high)
        bounds = np.column_stack([self.bounds[low:high], self.bounds[low + 1 : high + 1]])
        remainder -= self._half_space_spectrum(bounds)
        # the remainder is smooth except for discretisation noise of the triangles, which differs from line to line
        for axis in (1, 2):
            remainder = convolve1d(remainder, NEIGHBOURS, axis=axis, mode="nearest")
        return np.asarray(remainder)

    def _add_near_field(self, spectrum: Array, low: int, high: int) -> None:
        """Add the near-field correction: the compliance missing in the elements next to a load."""
        arc = self.arc[low:high]
        spacing = np.gradient(arc) / self.unit / self._stretch(arc)
        missing = self.error().at(np.outer(self.samples.k, spacing)) / self._stretch(arc)[:, None, None]
        line = np.arange(high - low)
        axes = self._pair_axes(arc)
        for d in range(missing.shape[2]):
            one, other = line[: len(line) - d], line[d:]
            value = 0.5 * (missing[:, one, d] + missing[:, other, d])
            part = in_body_axes(value, axes[one, other])
            spectrum[:, one, other] += part
            if d:
                spectrum[:, other, one] += part.swapaxes(-1, -2)

    def _half_space_spectrum(self, sides: Array) -> Array:
        """Spectrum (nk, S, S, 3, 3) of strips with sides (S, 2) m on half-spaces that touch the surface in between."""
        axes = self._pair_axes(sides.mean(axis=1))
        # on a circle of another radius k and the load per length shrink by the metric factor, as for narrower strips
        across = np.interp(sides, self.arc, self._across) / self.unit
        stretch = self._stretch(sides.mean(axis=1))
        flat = strip_flexibility(self.samples.k, across, across, self.nu, self._cutoff)
        return np.asarray(in_body_axes(flat, axes) / (0.5 * (stretch[:, None] + stretch))[..., None, None])

    def _pair_axes(self, arc: Array) -> Array:
        """Mean local axes (n, n, 3, 3) of pairs of lines, rows along x, across and normal."""
        tangent = self._tangents(arc)
        t = tangent[:, None] + tangent
        t /= np.hypot(t[..., 0], t[..., 1])[..., None]
        axes = np.zeros((*t.shape[:2], 3, 3))
        axes[..., 0, 0], axes[..., 1, 1:], axes[..., 2, 1], axes[..., 2, 2] = 1, t, -t[..., 1], t[..., 0]
        return axes


def in_body_axes(components: Array, axes: Array) -> Array:
    """Spectrum (nk, .., 3, 3) of pairs of lines in the axes of a body.

    Parameters:
        components: (nk, .., 6) of `strip_flexibility`, in the pairs' local axes.
        axes: (.., 3, 3) these axes, rows along x, across and outward normal.

    Along x by across is a sine, and across by x the opposite one; along x and by x with the normal are equal sines.
    """
    spectrum = np.einsum("k...a,...ab,...ac->k...bc", components[..., :3], axes, axes, optimize=True)
    by_across, by_normal = (components[..., 3 + k, None] * axes[..., 1 + k, 1:] for k in range(2))
    spectrum[..., 0, 1:], spectrum[..., 1:, 0] = by_across + by_normal, by_normal - by_across
    spectrum[..., 1, 2] += components[..., 5]
    spectrum[..., 2, 1] -= components[..., 5]
    return np.asarray(spectrum)


def _pair_means(share: Array, lines: Array, count: int) -> Array:
    """Means (pairs, count, nk) over two strips, of values (L, L, count nk) at lines with weights (S, L)."""
    S, L = share.shape
    half = (share @ lines.reshape(L, -1)).reshape(S, L, -1)
    return np.asarray((share @ half).reshape(S * S, count, -1)[pairs_of(S)])


@lru_cache(maxsize=32)
def pairs_of(strips: int) -> NDArray[np.int64]:
    """Indices of the pairs i <= j in a square of strips, row by row."""
    i, j = np.triu_indices(strips)
    return np.asarray(i * strips + j)
