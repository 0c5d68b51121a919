"""Plane curve by arc length: point, tangent, normal, curvature, closest point; all vectorised."""

from __future__ import annotations

import hashlib
from dataclasses import dataclass, replace
from functools import cached_property
from typing import NamedTuple, TypeVar

import numpy as np
from numpy.typing import ArrayLike, NDArray

from wheelrail.bindings._contact import SAMPLE_SPACING, Shape, closest
from wheelrail.support.arrays import Array, Complex

DEGREE = 7
HOLLOW = 0.3  # rad, more than the waves of a worn or measured rail
CORNER = 1e-2  # rad: closest points on both sides of a smaller one are the same to 1e-4 of the depth
ROUNDING = 1e-12  # m: the last bits of the ends differ from machine to machine

_C = TypeVar("_C", bound="Curve")


class Closest(NamedTuple):
    """Closest points of the curve to n points.

    Parameters:
        s: (n,) m, arc length.
        distance: (n,) m, positive on the outward side.
        inside: (n,), False where the closest point is an end of the curve and the point lies beyond it.
    """

    s: Array
    distance: Array
    inside: NDArray[np.bool_]


@dataclass(frozen=True, eq=False)
class Curve:
    """Piecewise polynomial in arc length s [m], with the body on its right when s increases.

    Parameters:
        breaks: (m + 1,) m, arc length of the ends of the pieces, increasing.
        coefficients: (8, m), of y + iz in powers of the distance from the middle of each piece.

    Raises ValueError for wrong shapes, infinite numbers, or breaks that do not increase.
    """

    breaks: Array
    coefficients: Complex

    def __post_init__(self) -> None:
        if self.coefficients.shape != (DEGREE + 1, len(self.breaks) - 1):
            raise ValueError(f"coefficients must be (8, {len(self.breaks) - 1}), not {self.coefficients.shape}")
        if not (np.isfinite(self.breaks).all() and np.isfinite(self.coefficients).all()):
            raise ValueError("breaks and coefficients of a curve must be finite")
        if not (np.diff(self.breaks) > 0).all():
            raise ValueError("breaks of a curve must increase")
        self.breaks.setflags(write=False)
        self.coefficients.setflags(write=False)

    @property
    def s_range(self) -> tuple[float, float]:
        """Arc length at start and end, m."""
        return float(self.breaks[0]), float(self.breaks[-1])

    def point(self, s: ArrayLike) -> Array:
        """Points (..., 2) m at arc length s. ValueError beyond the ends, here and below."""
        return _pair(self._evaluate(s)[0])

    def tangent(self, s: ArrayLike) -> Array:
        """Unit tangents (..., 2)."""
        return _pair(self._evaluate(s)[1])

    def normal(self, s: ArrayLike) -> Array:
        """Unit normals (..., 2), out of the body."""
        return _pair(1j * self._evaluate(s)[1])

    def curvature(self, s: ArrayLike) -> Array:
        """Curvature 1/m, positive where the body's surface is convex."""
        _, t, k = self._evaluate(s)
        return np.asarray(-(t.conj() * k).imag)

    def closest(self, points: ArrayLike, guess: ArrayLike | None = None) -> Closest:
        """Nearest point of the curve for points (n, 2) m, to 1e-12 m.

        guess (n,) m: initial arc length instead of that of the nearest sample, for half of the time; the result is then
        the local minimum near it. Of two closest points whose distances d differ by less than (0.1 mm)^2 / 8 d, as on
        the bisector inside a corner, either may be returned.
        """
        p = np.asarray(points, dtype=float)
        at = np.empty(0) if guess is None else np.ascontiguousarray(guess, dtype=float)
        return Closest(*closest(self.shape, p[:, 0] + 1j * p[:, 1], at))

    def s_at_y(self, y: ArrayLike) -> Array:
        """Arc length m at lateral position y m, on the part around s = 0 where y increases; ValueError beyond it."""
        lateral = np.asarray(y, dtype=float)
        s, ys = self._samples, self._sampled.real
        back = np.flatnonzero(np.diff(ys) <= 0.0)
        origin = int(s.searchsorted(0.0))
        first = int(max(back[back < origin] + 1, default=0))
        last = int(min(back[back >= origin], default=len(s) - 1))
        inside: Array = np.clip(lateral, ys[first], ys[last])
        if not (np.abs(lateral - inside) < ROUNDING).all():
            raise ValueError(
                f"y must lie in {ys[first]:.6g} .. {ys[last]:.6g} m, where the curve is a graph: {lateral}"
            )
        i = np.clip(ys[first : last + 1].searchsorted(inside), 1, last - first) + first
        low, high = s[i - 1], s[i]
        guess = low + (high - low) * (inside - ys[i - 1]) / (ys[i] - ys[i - 1])
        for _ in range(60):
            z, t, _k = self._evaluate(guess)
            excess = z.real - inside
            low, high = np.where(excess < 0.0, guess, low), np.where(excess > 0.0, guess, high)
            new = guess - excess / np.maximum(t.real, 1e-6)
            new = np.where((new > low) & (new < high), new, np.where(excess == 0.0, guess, 0.5 * (low + high)))
            if np.abs(new - guess).max(initial=0.0) < 1e-15:
                return np.asarray(new)
            guess = new
        return np.asarray(guess)

    def transformed(self: _C, angle: float, shift: complex, s_shift: float = 0.0) -> _C:
        """The curve rotated about the origin, then translated.

        Parameters:
            angle: rad, from y to z.
            shift: translation y + iz, m.
            s_shift: increment of the arc length, m.
        """
        coefficients = self.coefficients * np.exp(1j * angle)
        coefficients[0] += shift
        return replace(self, breaks=self.breaks + s_shift, coefficients=coefficients)

    def digest(self) -> str:
        """Hash of the curve's shape, to 1e-11 m: the last bits of a fit depend on the linear algebra library."""
        shape = np.round(self.point(self.samples(1e-3)), 11) + 0.0
        return hashlib.sha256(shape.tobytes()).hexdigest()

    def samples(self, spacing: float, start: float | None = None, stop: float | None = None) -> Array:
        """Arc lengths (n,) m from start to stop, at most spacing apart, with both ends and all breaks.

        Parameters:
            spacing: m.
            start, stop: arc lengths, m; None is an end of the curve.
        """
        start, stop = (self.breaks[0] if start is None else start), (self.breaks[-1] if stop is None else stop)
        inner = self.breaks[(self.breaks > start) & (self.breaks < stop)]
        ends = np.concatenate([[start], inner, [stop]])
        counts = np.ceil(np.diff(ends) / spacing * (1 - 1e-12)).astype(int)
        number = np.arange(counts.sum()) - np.repeat(np.cumsum(counts) - counts, counts)  # within its piece
        step = np.diff(ends) / np.maximum(counts, 1)
        return np.append(number * np.repeat(step, counts) + np.repeat(ends[:-1], counts), stop)

    @cached_property
    def _samples(self) -> Array:
        return self.samples(SAMPLE_SPACING)

    @cached_property
    def _sampled(self) -> Complex:
        return np.asarray(self._evaluate(self._samples)[0])

    @cached_property
    def shape(self) -> Shape:
        """The curve for the core."""
        table = np.ascontiguousarray(self._table.transpose(2, 0, 1))
        sampled = self._samples, self._sampled
        return Shape(self.breaks.copy(), self._middles, table, *sampled, self._hollow, self._corners)

    @cached_property
    def _hollow(self) -> bool:
        """Whether the body's surface turns inwards by more than `HOLLOW` somewhere."""
        angle = np.unwrap(np.angle(self._evaluate(self._samples)[1]))
        return bool((angle - np.minimum.accumulate(angle)).max() > HOLLOW)

    @cached_property
    def _corners(self) -> Array:
        """Arc lengths (k,) m at which the body's surface turns outwards by more than `CORNER`."""
        at, j = self.breaks[1:-1], np.arange(len(self.breaks) - 2)
        before, after = self.local(at, j)[1], self.local(at, j + 1)[1]
        return np.asarray(at[np.angle(after / before) < -CORNER])

    @cached_property
    def _middles(self) -> Array:
        return 0.5 * (self.breaks[1:] + self.breaks[:-1])

    @cached_property
    def _table(self) -> Complex:
        """Coefficients of the position and its first two derivatives, (3, 8, m)."""
        c, n = self.coefficients, np.arange(1.0, DEGREE + 1.0)[:, None]
        table = np.zeros((3, *c.shape), dtype=complex)
        table[0] = c
        table[1, :-1] = n * table[0, 1:]
        table[2, :-1] = n * table[1, 1:]
        return table

    def piece(self, s: Array) -> NDArray[np.intp]:
        """Index of the piece that contains s."""
        return np.asarray(self.breaks[1:-1].searchsorted(s, side="right"))

    def local(self, s: Array, j: NDArray[np.intp]) -> Complex:
        """Position, first and second derivative (3, n) at s in pieces j."""
        x = s - self._middles[j]
        powers = np.empty((DEGREE + 1, *x.shape))
        powers[0] = 1.0
        for n in range(DEGREE):
            np.multiply(powers[n], x, out=powers[n + 1, ...])
        return np.asarray(np.einsum("dk...,k...->d...", self._table.take(j, axis=2), powers))

    def _evaluate(self, s: ArrayLike) -> Complex:
        s = np.asarray(s, dtype=float)
        start, stop = self.s_range
        if s.size and not (s.min() >= start - 1e-9 and s.max() <= stop + 1e-9):
            raise ValueError(f"arc length must lie in {start:.6g} .. {stop:.6g} m: {s.min():.6g} .. {s.max():.6g}")
        return self.local(s, self.piece(s))


def _pair(z: Complex) -> Array:
    return np.stack([z.real, z.imag], axis=-1)


def crossing(points: Array) -> tuple[int, int] | None:
    """First pair of crossing segments of a polyline (n, 2); n (n - 1) / 2 tests, row by row, but of points in order."""
    if (np.diff(points[:, 0]) > 0.0).all():
        return None
    p = points[:, 0] + 1j * points[:, 1]
    a, d = p[:-1], np.diff(p)
    for i in range(len(d) - 2):
        b, e = a[i + 2 :], d[i + 2 :]
        turn = (d[i].conjugate() * e).imag
        turn[np.abs(turn) < 1e-9 * np.abs(d[i]) * np.abs(e)] = np.inf  # parallel: no crossing
        u, v = ((b - a[i]).conj() * e).imag / turn, ((b - a[i]).conj() * d[i]).imag / turn
        where = np.flatnonzero((u > 0.0) & (u < 1.0) & (v > 0.0) & (v < 1.0))
        if len(where):
            return i, i + 2 + int(where[0])
    return None
