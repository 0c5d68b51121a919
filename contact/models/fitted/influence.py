"""Mean compliance between cells of any length and offset along the strips of a body invariant along x or in angle.

Near its load a body is a half-space, whose answer for cells is known; what elements say differs from it smoothly across
the surface, and is taken from line to line.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field
from functools import cached_property, lru_cache
from typing import Any

import numpy as np
from numpy.typing import NDArray
from scipy.ndimage import convolve1d
from scipy.special import roots_legendre

from wheelrail.contact.elasticity.half_space import floor_correction, strip_antiderivative, strip_flexibility
from wheelrail.contact.elasticity.waveguide.element_correction import SurfaceError
from wheelrail.contact.elasticity.waveguide.spectrum import Spectrum, interpolation, pair_places, rule
from wheelrail.contact.kinematics.contact_points import OutsideGrid
from wheelrail.contact.laws.material import Steel
from wheelrail.contact.models.fitted.influence_tables import EVEN, ODD, TableNodes, full_table, normal_table
from wheelrail.contact.models.fitted.line_interpolation import between_lines, shares
from wheelrail.support.arrays import Array

NODES = 128  # of the table of G over x: its error in a mean compliance stays below 1e-4
FINEST = 0.005  # spacing of the first nodes over that of the surface's lines
NEIGHBOURS = np.array([1.0, 4.0, 6.0, 4.0, 1.0]) / 16  # shares of a line in the mean over its neighbours
TILE = 8  # lines: parts of the surface are made ready so many at a time, and more on both sides
KEPT = 3.2e7  # numbers (256 MB) in these parts, a body: S1002 on UIC60 at 1 mm fill 124 MB in both from -8 to -5.5 mm
GAUSS, WEIGHT = roots_legendre(6)  # places and weights over the width of a strip


@dataclass(frozen=True)
class Smooth:
    """What elements say of lines low to high beyond half-spaces, wavenumber by wavenumber.

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
class StripKernel:
    """Spectrum of a body's surface lines, turned into tables of G for strips.

    spectrum fetches the samples when first needed; points (ns, 2) m of the lines on the section, and their arc (ns,) m;
    reach m, the longest distance along x; nu Poisson's ratio; error fetches what the elements miss near a load; unit m
    and scale turn the spectrum's lengths and compliances into m and m/N; radius m of a body of revolution. flat: the
    surface is taken as level along x, as a half-space's.
    """

    spectrum: Callable[[], Spectrum]
    points: Array
    arc: Array
    reach: float
    nu: float
    error: Callable[[], SurfaceError]
    radius: float | None = None
    unit: float = 1.0
    scale: float = 1.0
    flat: bool = False
    _known: dict[tuple[int, int], Smooth] = field(init=False, default_factory=dict, repr=False)

    @cached_property
    def samples(self) -> Spectrum:
        """The spectrum. Raises ValueError when it belongs to another number of lines."""
        found = self.spectrum()
        if found.lines != len(self.arc):
            raise ValueError(f"a spectrum of {found.lines} lines cannot serve {len(self.arc)}")
        return found

    @cached_property
    def bounds(self) -> Array:
        """Ends (ns + 1,) m of the cells around the lines."""
        middle = 0.5 * (self.arc[1:] + self.arc[:-1])
        return np.concatenate([[2 * self.arc[0] - middle[0]], middle, [2 * self.arc[-1] - middle[-1]]])

    @cached_property
    def nodes(self) -> TableNodes:
        """Nodes of the tables, units."""
        return TableNodes.over(NODES, FINEST * float(np.diff(self.arc).min()) / self.unit, self.reach / self.unit)

    @cached_property
    def weights(self) -> tuple[Array, Array]:
        """Even and odd weights (nodes, nk) that turn samples into G at the table's nodes."""
        x, samples = self.nodes.x, self.samples
        k, w = rule(samples.k, float(x[-1]), samples.round)
        phase = np.outer(x, k)
        weighted = interpolation(samples.k, samples.shift, k) * w[:, None]
        even = (0.5 * x[:, None] ** 2 * np.sinc(phase / (2 * np.pi)) ** 2) @ weighted
        odd = ((phase - np.sin(phase)) / np.maximum(k, 1e-12 * k[-1]) ** 2) @ weighted
        return np.asarray(even), np.asarray(odd)

    @property
    def _floor(self) -> float:
        """Wavenumber below which the half-space that is taken out of the spectrum is flat, 1 / unit: that of the body's
        size, or of twice round it.
        """
        samples = self.samples
        return max(samples.shift, 4 * np.pi / samples.round if samples.round else 0.0)

    @cached_property
    def _lacks(self) -> Array:
        """What the floored spectrum lacks (nodes, 3) at the table's nodes."""
        return floor_correction(self.nodes.x, self._floor, self.nu)

    def window(self, low: float, high: float) -> tuple[int, int]:
        """First and one past the last line whose cells meet an interval of arc length, m.

        Raises OutsideGrid beyond the lines.
        """
        if low < self.bounds[0] or high > self.bounds[-1]:
            raise OutsideGrid("the bodies touch beyond the part of their surface that carries contact points")
        first, last = np.searchsorted(self.bounds, [low, high], side="right") - 1
        return max(int(first), 0), min(int(last) + 1, len(self.arc))

    def normal(self, sides: Array, reach: float) -> Array:
        """Table (pairs, nodes) of G along the surface's normals between strips with sides (S, 2) m, row by row of the
        pairs i <= j, for distances along x up to a reach [m].
        """
        count = self.nodes.up_to(reach / self.unit)
        S, (across, stretch, tangent) = len(sides), self._strips(sides)
        turn = np.minimum(tangent @ tangent.T, 1.0)
        smooth = self._smooth(sides)
        if smooth is None:
            added: Array = np.zeros((len(pairs_of(S)), count))
        else:
            share, known, lines = smooth
            added = _both(share, known.normal[lines, lines], 1) @ self.weights[0][:count].T
        near = strip_antiderivative(self.nodes.x[:count], across, self.nu)
        return normal_table(near, self._lacks[:count], stretch, turn, added.reshape(-1, count), self.scale)

    def full(self, sides: Array, reach: float) -> Array:
        """Table (pairs, nodes, 9) of G of all components: displacement by force."""
        S, smooth, count = len(sides), self._smooth(sides), self.nodes.up_to(reach / self.unit)
        if smooth is None:
            pairs = len(pairs_of(S))
            even: Array = np.zeros((pairs, len(EVEN), count))
            odd: Array = np.zeros((pairs, len(ODD), count))
        else:
            share, known, lines = smooth
            even, odd = (
                _both(share, values[lines, lines], components) @ weights[:count].T
                for values, components, weights in zip(
                    (known.even, known.odd), (len(EVEN), len(ODD)), self.weights, strict=True
                )
            )
        across, stretch, tangent = self._strips(sides)
        near = strip_antiderivative(self.nodes.x[:count], across, self.nu)
        return full_table(near, self._lacks[:count], stretch, tangent, even, odd, self.scale)

    def _strips(self, sides: Array) -> tuple[Array, Array, Array]:
        """Sides (S, 2) of strips on half-spaces, units; how the strips are stretched (S,); their tangents (S, 2)."""
        sides = np.ascontiguousarray(sides)
        across = between_lines(self.arc, self._along_lines[:, :1], sides.ravel()).reshape(sides.shape) / self.unit
        seen = between_lines(self.arc, self._along_lines, 0.5 * (sides[:, 0] + sides[:, 1]))
        tangent = seen[:, 2:]
        return across, seen[:, 1], tangent / np.sqrt((tangent * tangent).sum(axis=1))[:, None]

    @cached_property
    def _along_lines(self) -> Array:
        """Of every line (ns, 4): length up to it over the stretch, m, stretch, and tangent."""
        return np.column_stack([self._across, self._stretch(self.arc), self._slope])

    def _smooth(self, sides: Array) -> tuple[Array, Smooth, slice] | None:
        """Shares (S, lines) of strips in the lines that they meet, what elements say of these, and which of its lines
        they are; None without elements.
        """
        first, last = self.window(float(sides.min()), float(sides.max()))
        first, last = max(first - 1, 0), min(last + 1, len(self.arc))
        key = first // TILE, -(-last // TILE)
        known = self._known.pop(key, None)
        if known is None:
            known = self._made(max(TILE * key[0], 0), min(TILE * key[1], len(self.arc)))
            while self._known and known.size + sum(other.size for other in self._known.values()) > KEPT:
                del self._known[next(iter(self._known))]
        self._known[key] = known  # in the order of their last use
        share = shares(self.arc[first:last], np.ascontiguousarray(sides), GAUSS, WEIGHT)
        return share, known, slice(first - known.low, last - known.low)

    def _made(self, low: int, high: int) -> Smooth:
        # with neighbours, so that what is smoothed does not depend on the part
        first, last = max(low - len(NEIGHBOURS), 0), min(high + len(NEIGHBOURS), len(self.arc))
        lines = self._lines(first, last)[:, low - first : high - first, low - first : high - first]
        normal = self._tangents(self.arc[low:high])[:, ::-1] * [-1.0, 1.0]
        along = np.einsum("kijab,ia,jb->ijk", lines[..., 1:, 1:], normal, normal, optimize=True)
        nine = lines.reshape(*lines.shape[:3], 9).transpose(1, 2, 3, 0)
        n = high - low
        even, odd = (np.ascontiguousarray(nine[:, :, list(which)]).reshape(n, n, -1) for which in (EVEN, ODD))
        return Smooth(low, high, np.ascontiguousarray(along), even, odd)

    def _lines(self, low: int, high: int) -> Array:
        """Spectrum (nk, n, n, 3, 3) of a run of lines, less that of half-spaces."""
        found = self.samples.values[:, pair_places(len(self.arc))[low:high, low:high]]
        one, other = np.tril_indices(high - low, -1)
        found[:, one, other] = found[:, other, one].swapaxes(-1, -2)
        self._mend(found, low, high)
        bounds = np.column_stack([self.bounds[low:high], self.bounds[low + 1 : high + 1]])
        found -= self._half_space(bounds)
        # what is left is smooth but for the triangles' own noise, which differs from line to line
        for axis in (1, 2):
            found = convolve1d(found, NEIGHBOURS, axis=axis, mode="nearest")
        return np.asarray(found)

    def _mend(self, found: Array, low: int, high: int) -> None:
        """Add what the elements miss near a load."""
        arc = self.arc[low:high]
        spacing = np.gradient(arc) / self.unit / self._stretch(arc)
        missing = self.error().at(np.outer(self.samples.k, spacing)) / self._stretch(arc)[:, None, None]
        line = np.arange(high - low)
        axes = self._pair_axes(arc)
        for d in range(missing.shape[2]):
            one, other = line[: len(line) - d], line[d:]
            value = 0.5 * (missing[:, one, d] + missing[:, other, d])
            part = np.einsum("kna,nab,nac->knbc", value, axes[one, other], axes[one, other], optimize=True)
            found[:, one, other] += part
            if d:
                found[:, other, one] += part

    def _half_space(self, sides: Array) -> Array:
        """Spectrum (nk, S, S, 3, 3) of strips with sides (S, 2) m on half-spaces that touch the surface in between."""
        axes = self._pair_axes(sides.mean(axis=1))
        # on a circle of another radius k and the load per length shrink by the stretch, as if strips were narrower
        across = np.interp(sides, self.arc, self._across) / self.unit
        stretch = self._stretch(sides.mean(axis=1))
        flat = strip_flexibility(self.samples.k, across, across, self.nu, self._floor)
        found = np.einsum("kija,ijab,ijac->kijbc", flat[..., :3], axes, axes, optimize=True)
        found[..., 0, 1:] = flat[..., 3:] * axes[:, :, 1, 1:]
        found[..., 1:, 0] = -found[..., 0, 1:]
        return np.asarray(found / (0.5 * (stretch[:, None] + stretch))[..., None, None])

    @cached_property
    def _across(self) -> Array:
        """Arc length (ns,) m over the stretch, summed up from line to line."""
        inverse = 1 / self._stretch(self.arc)
        steps = 0.5 * (inverse[1:] + inverse[:-1]) * np.diff(self.arc)
        return np.concatenate([[0.0], np.cumsum(steps)])

    def _pair_axes(self, arc: Array) -> Array:
        """Mean local axes (n, n, 3, 3) of pairs of places, rows along x, across and normal."""
        tangent = self._tangents(arc)
        t = tangent[:, None] + tangent
        t /= np.hypot(t[..., 0], t[..., 1])[..., None]
        axes = np.zeros((*t.shape[:2], 3, 3))
        axes[..., 0, 0], axes[..., 1, 1:], axes[..., 2, 1], axes[..., 2, 2] = 1, t, -t[..., 1], t[..., 0]
        return axes

    def _tangents(self, arc: Array) -> Array:
        """Unit tangents (n, 2) of the section at arc lengths (n,) m."""
        t = np.column_stack([np.interp(arc, self.arc, part) for part in self._slope.T])
        return np.asarray(t / np.hypot(*t.T)[:, None])

    @cached_property
    def _slope(self) -> Array:
        return np.asarray(np.gradient(self.points, self.arc, axis=0))

    def _stretch(self, arc: Array) -> Array:
        """Length on the surface over length on the rolling circle."""
        if self.radius is None:
            return np.ones_like(arc)
        return np.asarray(np.interp(arc, self.arc, self.points[:, 1]) / self.radius)


@dataclass
class HalfSpaceKernel(StripKernel):
    """The body as half-spaces that touch its surface: what codes for half-spaces see, without any elements."""

    @classmethod
    def under(cls, points: Array, arc: Array, reach: float, steel: Steel) -> HalfSpaceKernel:
        """Below the lines (ns, 2) m at arc lengths (ns,) m."""
        return cls(_nothing, points, arc, reach, steel.nu, _nothing, scale=1 / steel.E, flat=True)

    @property
    def _floor(self) -> float:
        return 0.0

    @cached_property
    def _lacks(self) -> Array:
        return np.zeros((NODES, 3))

    def _smooth(self, sides: Array) -> None:
        self.window(float(sides.min()), float(sides.max()))


def _nothing() -> Any:
    raise AssertionError("half-spaces have no elements")


def _both(share: Array, lines: Array, count: int) -> Array:
    """Means (pairs, count, nk) over two strips, of lines (L, L, count nk), by their shares (S, L)."""
    S, L = share.shape
    half = (share @ lines.reshape(L, -1)).reshape(S, L, -1)
    return np.asarray((share @ half).reshape(S * S, count, -1)[pairs_of(S)])


@lru_cache(maxsize=32)
def pairs_of(strips: int) -> NDArray[np.int64]:
    """Places of the pairs i <= j in a square of strips, row by row."""
    i, j = np.triu_indices(strips)
    return np.asarray(i * strips + j)
