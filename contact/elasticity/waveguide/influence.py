"""Surface lines of a body invariant along x or in angle, as half-spaces and as their deviation by finite elements.

Near its load a body is a half-space, with a solution in closed form; the solution by finite elements differs from it
smoothly across the surface.
"""

from __future__ import annotations

from bisect import bisect_right
from collections.abc import Callable
from dataclasses import dataclass, field
from functools import cached_property, partial

import numpy as np
from scipy.ndimage import convolve1d

from wheelrail.bindings._contact import BEYOND
from wheelrail.contact.elasticity.half_space import strip_flexibility
from wheelrail.contact.elasticity.waveguide.compliance import WaveguideCompliance
from wheelrail.contact.elasticity.waveguide.element_correction import SurfaceError, surface_error
from wheelrail.contact.elasticity.waveguide.spectrum import ComplianceSpectrum, pair_indices
from wheelrail.contact.kinematics.contact_points import OutsideSurface
from wheelrail.contact.laws.material import Material
from wheelrail.support.arrays import Array, Nodes

ODD = (1, 2, 3, 6)  # of the nine components: xy, xz, yx, zx
EVEN = (0, 4, 5, 7, 8)
NEIGHBOURS = np.array([1.0, 4.0, 6.0, 4.0, 1.0]) / 16  # shares of a line in the mean over its neighbours
MARGIN = len(NEIGHBOURS) // 2


@dataclass
class HalfSpaceInfluence:
    """Half-spaces that touch the surface of a body at its lines.

    Parameters:
        points: (ns, 2) m, lines of the surface on the section.
        arc: (ns,) m, their arc length.
        nu: Poisson's ratio.
        radius: of a body of revolution, m.
        unit, scale: factors from the lengths and compliances of the spectrum to m and m/N.
    """

    points: Array
    arc: Array
    nu: float
    radius: float | None = None
    unit: float = 1.0
    scale: float = 1.0

    @classmethod
    def under(cls, points: Array, arc: Array, material: Material) -> HalfSpaceInfluence:
        """Below the lines (ns, 2) m at arc lengths (ns,) m."""
        return cls(points, arc, material.nu, scale=1 / material.E)

    @cached_property
    def bounds(self) -> Array:
        """Ends (ns + 1,) m of the cells around the lines."""
        middle = 0.5 * (self.arc[1:] + self.arc[:-1])
        return np.concatenate([[2 * self.arc[0] - middle[0]], middle, [2 * self.arc[-1] - middle[-1]]])

    def window(self, low: float, high: float) -> tuple[int, int]:
        """First and one past the last line whose cells meet an interval of arc length, m.

        Raises OutsideSurface beyond the lines.
        """
        bounds = self._bounds
        if low < bounds[0] or high > bounds[-1]:
            raise OutsideSurface(BEYOND)
        return bisect_right(bounds, low) - 1, min(bisect_right(bounds, high), len(bounds) - 1)

    @cached_property
    def _bounds(self) -> list[float]:
        """The same as a list, in which single places are found faster."""
        return [float(bound) for bound in self.bounds]

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
    """Spectrum by finite elements minus that of half-spaces, of pairs of lines, wavenumber by wavenumber.

    even (R, C, 5, nk) and odd (R, C, 4, nk) components.
    """

    even: Array
    odd: Array


@dataclass
class ElementInfluence(HalfSpaceInfluence):
    """Half-spaces corrected by finite elements, from the spectrum of a body's surface lines.

    spectrum returns the samples, error the near-field error of the elements; both are called on first use.
    """

    spectrum: Callable[[], ComplianceSpectrum] = field(kw_only=True)
    error: Callable[[], SurfaceError] = field(kw_only=True)

    @classmethod
    def of_waveguide(
        cls,
        body: WaveguideCompliance,
        lines: Array,
        arc: Array,
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
            material: of the body.
            degree: of the elements, 1 or 2.
            unit: length of the spectrum's unit, m.
        """
        return cls(
            lines,
            arc,
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

    @property
    def _cutoff(self) -> float:
        """Low-wavenumber cut-off of the half-space's spectrum, 1 / unit: that of the body's size, or of two
        circumferences.
        """
        samples = self.samples
        return max(samples.shift, 4 * np.pi / samples.round if samples.round else 0.0)

    def correction(self, rows: slice, columns: slice) -> ElementCorrection:
        """Correction of the displacement of lines (rows) by loads on lines (columns)."""
        ranges, inner = [], []
        for part in (rows, columns):  # with neighbours, so that smoothing does not depend on the part
            low, high = max(part.start - MARGIN, 0), min(part.stop + MARGIN, len(self.arc))
            ranges.append(np.arange(low, high))
            inner.append(slice(part.start - low, part.stop - low))
        lines = self._remainder(*ranges)[:, inner[0], inner[1]]
        nine = lines.reshape(*lines.shape[:3], 9).transpose(1, 2, 3, 0)
        even, odd = (np.ascontiguousarray(nine[:, :, list(which)]) for which in (EVEN, ODD))
        return ElementCorrection(even, odd)

    def _remainder(self, rows: Nodes, columns: Nodes) -> Array:
        """Spectrum (nk, R, C, 3, 3) of two runs of lines minus that of half-spaces."""
        first, second = np.minimum(rows[:, None], columns), np.maximum(rows[:, None], columns)
        remainder = self.samples.values[:, pair_indices(len(self.arc))[first, second]]
        row, column = np.nonzero(rows[:, None] > columns)
        remainder[:, row, column] = remainder[:, row, column].swapaxes(-1, -2)
        self._add_near_field(remainder, rows, columns)
        remainder -= self._half_space_spectrum(rows, columns)
        # the remainder is smooth except for discretisation noise of the triangles, which differs from line to line
        for axis in (1, 2):
            remainder = convolve1d(remainder, NEIGHBOURS, axis=axis, mode="nearest")
        return np.asarray(remainder)

    @cached_property
    def _missing(self) -> Array:
        """Compliance (nk, ns, distances, components) missing in the elements next to a load."""
        stretch = self._stretch(self.arc)
        spacing = np.gradient(self.arc) / self.unit / stretch
        return np.asarray(self.error().at(np.outer(self.samples.k, spacing)) / stretch[:, None, None])

    def _add_near_field(self, spectrum: Array, rows: Nodes, columns: Nodes) -> None:
        """Add the near-field correction."""
        missing = self._missing
        distance = np.abs(rows[:, None] - columns)
        r, c = np.nonzero(distance < missing.shape[2])
        i, j = np.minimum(rows[r], columns[c]), np.maximum(rows[r], columns[c])
        value = 0.5 * (missing[:, i, j - i] + missing[:, j, j - i])
        part = in_body_axes(value, self._pair_axes(self.arc[i], self.arc[j]))
        turned = rows[r] > columns[c]
        part[:, turned] = part[:, turned].swapaxes(-1, -2)
        spectrum[:, r, c] += part

    def _half_space_spectrum(self, rows: Nodes, columns: Nodes) -> Array:
        """Spectrum (nk, R, C, 3, 3) of the strips around lines on half-spaces that touch the surface in between."""
        sides = np.column_stack([self.bounds[:-1], self.bounds[1:]])
        # on a circle of another radius k and the load per length shrink by the metric factor, as for narrower strips
        across = np.interp(sides, self.arc, self._across) / self.unit
        middle = sides.mean(axis=1)
        stretch = 0.5 * (self._stretch(middle[rows])[:, None] + self._stretch(middle[columns]))
        flat = strip_flexibility(self.samples.k, across[rows], across[columns], self.nu, self._cutoff)
        axes = self._pair_axes(middle[rows][:, None], middle[columns])
        return np.asarray(in_body_axes(flat, axes) / stretch[..., None, None])

    def _pair_axes(self, first: Array, second: Array) -> Array:
        """Mean local axes (.., 3, 3) of pairs of lines at arc lengths (..,) m, rows along x, across and normal."""
        first, second = np.broadcast_arrays(first, second)
        one, other = (self._tangents(arc.ravel()).reshape(*arc.shape, 2) for arc in (first, second))
        t = one + other
        t /= np.hypot(t[..., 0], t[..., 1])[..., None]
        axes = np.zeros((*t.shape[:-1], 3, 3))
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
