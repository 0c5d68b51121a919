"""Mean compliance between cells of any length and offset along the strips of a body invariant along x or in angle.

Near its load a body is a half-space, whose answer for cells is known; what elements say differs from it smoothly across
the surface, and is taken from line to line. With G'' = C the compliance along x, the mean over cells [a1, a2] by
loads on [b1, b2] is the second difference (G(a2 - b1) + G(a1 - b2) - G(a2 - b2) - G(a1 - b1)) / ((a2 - a1) (b2 - b1)):
four look-ups for any two cells.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field
from functools import cached_property
from typing import Any

import numpy as np
from scipy.ndimage import convolve1d
from scipy.special import roots_legendre

from contact.half_space import floor_correction, strip_antiderivative, strip_flexibility
from contact.laws import Steel
from contact.points import OutsideGrid
from contact.pose import Array
from contact.spectrum import Spectrum, interpolation, pair_places, rule
from contact.surface_error import SurfaceError

NODES = 400  # of the table of G over x: its error in a mean compliance stays below 1e-4
NEIGHBOURS = np.array([1.0, 4.0, 6.0, 4.0, 1.0]) / 16  # shares of a line in the mean over its neighbours
GAUSS = 6  # points over the width of a strip
FINEST = 0.05  # spacing of the first nodes over that of the surface's lines


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
    _window: tuple[int, int] = field(init=False, default=(0, 0), repr=False)
    _smooth: Array = field(init=False, repr=False)
    _smooth_normal: Array = field(init=False, repr=False)

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
    def _spread(self) -> tuple[float, float]:
        """Nodes of the table lie at x0 sinh(rate n), units."""
        first = FINEST * float(np.diff(self.arc).min()) / self.unit
        rate = 1.0 / NODES
        for _ in range(50):
            rate = float(np.arcsinh(self.reach / self.unit * rate / first)) / (NODES - 3)
        return first / rate, rate

    @cached_property
    def _nodes(self) -> Array:
        """Distances along x of the table's nodes, units; one before zero for the interpolation."""
        start, rate = self._spread
        return np.asarray(start * np.sinh(rate * np.arange(-1, NODES - 1)))

    @cached_property
    def weights(self) -> tuple[Array, Array]:
        """Even and odd weights (nodes, nk) that turn samples into G at the table's nodes."""
        x, samples = self._nodes, self.samples
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
        """What the floored spectrum lacks (nodes, 1, 1, 3) at the table's nodes."""
        return floor_correction(self._nodes, self._floor, self.nu)[:, None, None]

    def window(self, low: float, high: float) -> tuple[int, int]:
        """First and one past the last line whose cells meet an interval of arc length, m.

        Raises OutsideGrid beyond the lines.
        """
        if low < self.bounds[0] or high > self.bounds[-1]:
            raise OutsideGrid("the bodies touch beyond the part of their surface that carries contact points")
        first, last = np.searchsorted(self.bounds, [low, high], side="right") - 1
        return max(int(first), 0), min(int(last) + 1, len(self.arc))

    def shares(self, sides: Array, window: tuple[int, int]) -> Array:
        """Shares (S, lines of the window) of the lines in the means over strips, sides (S, 2) m, of what is linear from
        line to line.
        """
        arc = self.arc[window[0] : window[1]]
        place, weight = roots_legendre(GAUSS)
        s = sides.mean(axis=1)[:, None] + 0.5 * np.diff(sides) * place
        near = np.clip(np.searchsorted(arc, s) - 1, 0, len(arc) - 2)
        part = np.clip((s - arc[near]) / (arc[near + 1] - arc[near]), 0.0, 1.0)
        found = np.zeros((len(sides), len(arc)))
        row = np.broadcast_to(np.arange(len(sides))[:, None], s.shape)
        np.add.at(found, (row, near), 0.5 * weight * (1 - part))
        np.add.at(found, (row, near + 1), 0.5 * weight * part)
        return found

    def normal(self, sides: Array) -> Array:
        """Table (S, S, nodes, 1) of G along the surface's normals between strips with sides (S, 2) m."""
        near = self._near(sides, tangential=False)
        tangent = self._tangents(sides.mean(axis=1))
        turn = np.clip(tangent @ tangent.T, -1.0, 1.0)[..., None]  # cosine of the angle between two strips
        table = 0.5 * ((1 + turn) * near[..., 1] - (1 - turn) * near[..., 0])
        share = self._prepared(sides)
        if share is not None:
            smooth = np.tensordot(share, np.tensordot(share, self._smooth_normal, axes=(1, 1)), axes=(1, 2))  # j, i, k
            table += np.tensordot(smooth, self.weights[0], axes=(2, 1)).swapaxes(0, 1)
        return np.asarray(table[..., None] * (self.scale * self.unit**2))

    def full(self, sides: Array) -> Array:
        """Table (S, S, nodes, 9) of G of all components: displacement by force, row by row."""
        axes = self._pair_axes(sides.mean(axis=1))
        near = self._near(sides)
        table = np.einsum("ijna,ijab,ijac->ijnbc", near[..., :3], axes, axes, optimize=True)
        table[..., 0, 1:] = near[..., 3:] * axes[:, :, None, 1, 1:]
        table[..., 1:, 0] = table[..., 0, 1:]
        share = self._prepared(sides)
        if share is not None:
            half = np.tensordot(share, self._smooth, axes=(1, 1))  # i, k, line, 9
            spectrum = np.tensordot(share, half, axes=(1, 2)).swapaxes(0, 1)  # i, j, k, 9
            even, odd = (np.einsum("ijkc,nk->ijnc", spectrum, w, optimize=True) for w in self.weights)
            # u_x = -i U_x: a lateral load moves x by +sin, a load along x moves the others by -sin
            even[..., [1, 2]], even[..., [3, 6]] = odd[..., [1, 2]], -odd[..., [3, 6]]
            table += even.reshape(table.shape)
        return np.asarray(table.reshape(*table.shape[:3], 9) * (self.scale * self.unit**2))

    def _near(self, sides: Array, *, tangential: bool = True) -> Array:
        """G (S, S, nodes, 4 or 2) of strips on half-spaces, less what the floored spectrum lacks, units."""
        across = np.interp(sides, self.arc, self._across) / self.unit
        stretch = self._stretch(sides.mean(axis=1))
        x = self._nodes
        found = strip_antiderivative(np.abs(x), across, self.nu, tangential=tangential)
        if self._floor > 0:
            found[..., :3] -= self._lacks if tangential else self._lacks[..., 1:]
        if tangential:
            found[x < 0, ..., 3] *= -1
        between = 0.5 * (stretch[:, None] + stretch)[..., None, None]
        return np.asarray(found.transpose(1, 2, 0, 3) / between)

    def _prepared(self, sides: Array) -> Array | None:
        """Shares of strips in the lines of the present window, moved when they are not in it; None without lines."""
        window = self.window(float(sides.min()), float(sides.max()))
        low, high = self._window
        if not (low <= window[0] and window[1] <= high):
            low, high = max(window[0] - 4, 0), min(window[1] + 4, len(self.arc))
            # with neighbours, so that what is smoothed does not depend on the window
            first, last = max(low - len(NEIGHBOURS), 0), min(high + len(NEIGHBOURS), len(self.arc))
            lines = self._lines(first, last)[:, low - first : high - first, low - first : high - first]
            normal = self._tangents(self.arc[low:high])[:, ::-1] * [-1.0, 1.0]
            self._smooth_normal = np.einsum("kijab,ia,jb->kij", lines[..., 1:, 1:], normal, normal, optimize=True)
            self._smooth = lines.reshape(*lines.shape[:3], 9)
            self._window = low, high
        return self.shares(sides, (low, high))

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

    def means(self, table: Array, rows: Array, columns: Array) -> Array:
        """Mean compliance (S, R, S, M, components) m/N between cells that end at rows (S, R + 1), columns (S, M + 1) m.

        Components that are odd in x (all but xx and those without x) change sign with it.
        """
        start, rate = self._spread
        S, count = table.shape[0], table.shape[-1]
        x = (rows[:, :, None, None] - columns) / self.unit
        place = np.arcsinh(np.abs(x) / start) / rate + 1.0
        first = np.minimum(place.astype(np.int64) - 1, NODES - 4)
        if place.max() > NODES - 1:
            raise OutsideGrid("the overlap is longer than what fitted cells were made for")
        pair = (np.arange(S)[:, None, None, None] * S + np.arange(S)[:, None]) * NODES
        flat, line = table.reshape(-1, count), (pair + first).ravel()
        found = sum(
            weight.reshape(-1, 1) * flat.take(line + o, axis=0) for o, weight in enumerate(_cubic(place - first))
        ).reshape(*x.shape, count)
        if count == 9:
            sign = np.sign(x)[..., None]
            found[..., ODD] *= sign
        total = np.diff(np.diff(found, axis=1), axis=3)
        lengths = np.diff(rows)[:, :, None, None] * np.diff(columns)
        return np.asarray(-total / lengths[..., None])


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

    def _prepared(self, sides: Array) -> None:
        self.window(float(sides.min()), float(sides.max()))


def _nothing() -> Any:
    raise AssertionError("half-spaces have no elements")


ODD = [1, 2, 3, 6]  # xy, xz, yx, zx


def _cubic(t: Array) -> tuple[Array, Array, Array, Array]:
    """Lagrange's weights of nodes 0 .. 3 at t."""
    a, b, c, d = t, t - 1, t - 2, t - 3
    return -b * c * d / 6, a * c * d / 2, -a * b * d / 2, a * b * c / 6
