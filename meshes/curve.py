"""Plane curve by arc length: point, tangent, normal, curvature, closest point; all vectorised."""

from __future__ import annotations

import hashlib
from dataclasses import dataclass, replace
from functools import cached_property
from typing import TYPE_CHECKING, NamedTuple, TypeVar

import numpy as np
from numpy.typing import ArrayLike, NDArray

if TYPE_CHECKING:
    from scipy.spatial import cKDTree

Array = NDArray[np.float64]
Complex = NDArray[np.complex128]
DEGREE = 7
SPACING = 1e-4  # m, of the samples that start the search for closest points
SMALL_STEP = 1e-8  # m; Newton's error after one more such step is far below 1e-12 m

_C = TypeVar("_C", bound="Curve")


class Closest(NamedTuple):
    """Foot of each of n points: arc length s m, distance m, and whether the foot lies inside the curve.

    distance is positive on the outward side; inside is False where the foot is an end of the curve and the point lies
    beyond it.
    """

    s: Array
    distance: Array
    inside: NDArray[np.bool_]


@dataclass(frozen=True, eq=False)
class Curve:
    """Piecewise polynomial in arc length s [m], with the body on its right when s increases.

    breaks (m + 1,) increasing, m; coefficients (8, m) of y + iz in powers of the distance from each piece's middle.
    ValueError if they do not fit together.
    """

    breaks: Array
    coefficients: Complex

    def __post_init__(self) -> None:
        if self.coefficients.shape != (DEGREE + 1, len(self.breaks) - 1):
            raise ValueError(f"coefficients must be (8, {len(self.breaks) - 1}), not {self.coefficients.shape}")
        if not (np.isfinite(self.breaks).all() and np.isfinite(self.coefficients).all()):
            raise ValueError("a curve needs finite numbers")
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

        Starts at the nearest of fine samples, or at guess (n,) m, which finds the local minimum near it and saves half
        of the time. About two Newton steps, each held to one piece and to the samples' spacing.
        """
        xy = np.asarray(points, dtype=float)
        q = xy[..., 0] + 1j * xy[..., 1]
        if guess is None:
            s = self._samples[self._tree.query(xy)[1]]
        else:
            s = np.clip(np.asarray(guess, dtype=float), *self.s_range)
        last = self.coefficients.shape[1] - 1
        j = np.clip(self.breaks.searchsorted(s, side="right") - 1, 0, last)
        quiet = False
        for _ in range(1000):
            z, t, k = self._local(s, j)
            away = q - z
            along, across = (t.conj() * away).real, (t.conj() * away).imag
            # s minimises |q - z|^2 / 2 with slope -along and second derivative 1 - Re(conj(z'') (q - z))
            step = along / np.maximum(1.0 - (k.conj() * away).real, 1e-3)
            if s.size == 0 or np.abs(step).max() < SMALL_STEP:
                return Closest(np.clip(s + step, *self.s_range), across, np.ones(s.shape, dtype=bool))
            low, high = self.breaks[j], self.breaks[j + 1]
            new = np.minimum(np.maximum(s + np.clip(step, -SPACING, SPACING), low), high)
            settled = (np.abs(step) < SMALL_STEP) | (np.abs(new - s) == 0.0)
            # at the end of a piece the next one decides, next time: two idle rounds mean a corner or an end
            j = np.clip(j + (new == high).astype(int) - (new == low), 0, last)
            s = new
            if settled.all() and quiet:
                break
            quiet = bool(settled.all())
        inside = ((s > self.breaks[0]) & (s < self.breaks[-1])) | (np.abs(along) < SMALL_STEP)
        resting = np.abs(along) > SMALL_STEP
        return Closest(s, np.where(resting, np.copysign(np.abs(away), across), across), inside)

    def s_at_y(self, y: ArrayLike) -> Array:
        """Arc length m at lateral position y m, on the part around s = 0 where y increases; ValueError beyond it."""
        y = np.asarray(y, dtype=float)
        s, ys = self._samples, self._sampled.real
        back = np.flatnonzero(np.diff(ys) <= 0.0)
        origin = int(s.searchsorted(0.0))
        first = int(max(back[back < origin] + 1, default=0))
        last = int(min(back[back >= origin], default=len(s) - 1))
        if not ((y >= ys[first]) & (y <= ys[last])).all():
            raise ValueError(f"y must lie in {ys[first]:.6g} .. {ys[last]:.6g} m, where it fixes the point: {y}")
        i = np.clip(ys[first : last + 1].searchsorted(y), 1, last - first) + first
        low, high = s[i - 1], s[i]
        guess = low + (high - low) * (y - ys[i - 1]) / (ys[i] - ys[i - 1])
        for _ in range(60):
            z, t, _k = self._evaluate(guess)
            excess = z.real - y
            low, high = np.where(excess < 0.0, guess, low), np.where(excess > 0.0, guess, high)
            new = guess - excess / np.maximum(t.real, 1e-6)
            new = np.where((new > low) & (new < high), new, np.where(excess == 0.0, guess, 0.5 * (low + high)))
            if np.abs(new - guess).max(initial=0.0) < 1e-15:
                return np.asarray(new)
            guess = new
        return np.asarray(guess)

    def moved(self: _C, angle: float, shift: complex, s_shift: float = 0.0) -> _C:
        """The curve turned by angle [rad, from y to z] about the origin, then shifted [m]; s_shift is added to s."""
        coefficients = self.coefficients * np.exp(1j * angle)
        coefficients[0] += shift
        return replace(self, breaks=self.breaks + s_shift, coefficients=coefficients)

    def digest(self) -> str:
        """Hash of everything that shapes the curve."""
        return hashlib.sha256(self.breaks.tobytes() + self.coefficients.tobytes()).hexdigest()

    def samples(self, spacing: float, start: float | None = None, stop: float | None = None) -> Array:
        """Arc lengths (n,), both ends of the range and every break in it included, no further apart than spacing [m]."""
        start, stop = (self.breaks[0] if start is None else start), (self.breaks[-1] if stop is None else stop)
        inner = self.breaks[(self.breaks > start) & (self.breaks < stop)]
        ends = np.concatenate([[start], inner, [stop]])
        counts = np.ceil(np.diff(ends) / spacing * (1 - 1e-12)).astype(int)
        parts = [np.linspace(a, b, n, endpoint=False) for a, b, n in zip(ends, ends[1:], counts, strict=False)]
        return np.concatenate([*parts, [stop]])

    @cached_property
    def _samples(self) -> Array:
        return self.samples(SPACING)

    @cached_property
    def _sampled(self) -> Complex:
        return self._evaluate(self._samples)[0]

    @cached_property
    def _tree(self) -> cKDTree:
        from scipy.spatial import cKDTree

        return cKDTree(_pair(self._sampled))

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

    def _local(self, s: Array, j: NDArray[np.intp]) -> Complex:
        """Position, first and second derivative (3, n) at s in pieces j."""
        x = s - self._middles[j]
        powers = np.empty((DEGREE + 1, *x.shape))
        powers[0] = 1.0
        for n in range(DEGREE):
            np.multiply(powers[n], x, out=powers[n + 1])
        return np.einsum("dk...,k...->d...", self._table.take(j, axis=2), powers)

    def _evaluate(self, s: ArrayLike) -> Complex:
        s = np.asarray(s, dtype=float)
        start, stop = self.s_range
        if s.size and not (s.min() >= start - 1e-9 and s.max() <= stop + 1e-9):
            raise ValueError(f"arc length must lie in {start:.6g} .. {stop:.6g} m: {s.min():.6g} .. {s.max():.6g}")
        j = np.clip(self.breaks.searchsorted(s, side="right") - 1, 0, len(self.breaks) - 2)
        return self._local(s, j)


def _pair(z: Complex) -> Array:
    return np.stack([z.real, z.imag], axis=-1)
