"""Track geometry: alignment and centre line."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, field, replace
from functools import cached_property
from itertools import pairwise
from math import cos, inf

import numpy as np

from wheelrail.contact.kinematics.wheelset_state import NO_SHIFT, RailShift
from wheelrail.support.arrays import Array
from wheelrail.vehicle.track.alignment import Segment, track_functions
from wheelrail.vehicle.track.irregularity import Irregularities
from wheelrail.vehicle.track.piecewise import PiecewiseFunction, Shape


def centre_line(track: Track, length: float, *, spacing: float = 1.0) -> tuple[Array, Array]:
    """Stations (n,) m and points (n, 3) m of the centre line.

    Parameters:
        track: the alignment.
        length: m, from s = 0.
        spacing: largest distance of stations, m.

    x along the tangent at the start in plan, y to its left, z up. Gauss quadrature of the tangent, four points for each
    interval: errors of an arc are of the order (spacing / radius)^8.
    """
    stations = np.linspace(0.0, length, int(np.ceil(length / spacing)) + 1, dtype=np.float64)
    nodes, weights = np.polynomial.legendre.leggauss(4)  # type: ignore[no-untyped-call]
    half = 0.5 * np.diff(stations)[:, None]
    inner = (0.5 * (stations[1:] + stations[:-1])[:, None] + half * nodes).ravel()
    heading = np.array([track.heading(s) for s in inner.tolist()])
    gradient = np.array([track.gradient(s)[0] for s in inner.tolist()])
    along = np.stack([np.cos(gradient) * np.cos(heading), np.cos(gradient) * np.sin(heading), np.sin(gradient)], axis=1)
    steps = (half * weights)[:, :, None] * along.reshape(len(half), -1, 3)
    return stations, np.concatenate([np.zeros((1, 3)), np.cumsum(steps.sum(axis=1), axis=0)])


def _zero() -> PiecewiseFunction:
    return PiecewiseFunction.constant(0.0)


def _one() -> PiecewiseFunction:
    return PiecewiseFunction.constant(1.0)


@dataclass(frozen=True)
class Track:
    """Alignment as functions of the distance s; the plane of the rails rotates about the centre line.

    Parameters:
        curvature: in plan, 1/m, positive to the left.
        superelevation: m, height of the right rail above the left (the cant of a left-hand curve).
        gradient: rad, positive uphill.
        base: m, lateral distance over which the superelevation is measured.
        irregularities: of the rails, if any.
        widening: of the gauge, m, half of it by each rail.
        friction: factor on the coefficient of friction, positive.

    Raises ValueError for a superelevation not smaller than the base, and for friction that is not positive.
    """

    curvature: PiecewiseFunction = field(default_factory=_zero)
    superelevation: PiecewiseFunction = field(default_factory=_zero)
    gradient: PiecewiseFunction = field(default_factory=_zero)
    base: float = 1.5
    irregularities: Irregularities | None = None
    widening: PiecewiseFunction = field(default_factory=_zero)
    friction: PiecewiseFunction = field(default_factory=_one)

    def __post_init__(self) -> None:
        if not self.base > max(abs(h) for h in self.superelevation.values):
            raise ValueError(f"cant {self.superelevation.values} m: must be less than base = {self.base} m")
        if not all(0.0 < factor < inf for factor in self.friction.values):
            raise ValueError(f"friction {self.friction.values}: must be positive and finite factors")

    @classmethod
    def curve(
        cls,
        *,
        curvature: float,
        cant: float = 0.0,
        tangent: float = 0.0,
        transition: float,
        length: float,
        exit_transition: float | None = None,
        gradient: float = 0.0,
        shape: Shape = "quintic",
    ) -> Track:
        """Tangent, transition, full curve and, with exit_transition, transition back to an infinite tangent.

        Parameters:
            curvature: of the full curve, 1/m, positive to the left.
            cant: of the full curve, m, positive raises the outer rail.
            tangent, transition, length, exit_transition: lengths of the segments, m.
            gradient: rad.
            shape: of the transitions, as in `Segment`.

        Base and corners have the default values of `Track.of`, which takes any sequence of segments. Raises
        AlignmentError, a ValueError, for lengths that are not positive.
        """
        segments = [Segment("tangent", tangent)] if tangent else []
        segments += [Segment("transition", transition, shape=shape), Segment("arc", length, curvature, cant)]
        if exit_transition is not None:
            segments.append(Segment("transition", exit_transition, shape=shape))
        segments[0] = replace(segments[0], gradient=gradient)
        return cls.of(segments)

    @classmethod
    def of(
        cls,
        segments: Sequence[Segment],
        *,
        base: float = 1.5,
        corner: float = 3.0,
        irregularities: Irregularities | None = None,
        friction: PiecewiseFunction | None = None,
    ) -> Track:
        """Track of a sequence of segments from s = 0.

        Parameters:
            segments: in order.
            base: m, lateral distance over which the superelevation is measured.
            corner: m, length of rounded corners as in `PiecewiseFunction`.
            irregularities: of the rails, if any.
            friction: factor on the coefficient of friction; None: 1.

        Raises AlignmentError, a ValueError, for invalid segments, or values that are not continuous.
        """
        functions = track_functions(segments, corner=corner)
        return cls(*functions[:3], base, irregularities, functions.widening, friction or _one())

    @property
    def functions(self) -> tuple[PiecewiseFunction, ...]:
        """Curvature, superelevation, gradient and widening."""
        return self.curvature, self.superelevation, self.gradient, self.widening

    def changed(self, s: float, change: Callable[[PiecewiseFunction], PiecewiseFunction]) -> Track:
        """Track with smooth rails, all functions changed, and the friction of a distance s m."""
        curvature, superelevation, gradient, widening = map(change, self.functions)
        friction = PiecewiseFunction.constant(self.friction(s)[0])
        return Track(curvature, superelevation, gradient, self.base, widening=widening, friction=friction)

    @cached_property
    def rubs(self) -> bool:
        """Whether friction differs from that of the contact."""
        return any(factor != 1.0 for factor in self.friction.values)

    @cached_property
    def widens(self) -> bool:
        """Whether the gauge widens."""
        return any(self.widening.values)

    @property
    def moves_rails(self) -> bool:
        """Whether irregularities or the widening of the gauge displace the rails."""
        return self.irregularities is not None or self.widens

    def rails(self, s: float) -> RailShift | None:
        """Displacements y, z m of the left and the right rail at a distance s m; None: none."""
        shift = None if self.irregularities is None else self.irregularities.rails(s)
        if not self.widens:
            return shift
        (left, left_z), (right, right_z) = shift or NO_SHIFT
        half = 0.5 * self.widening(s)[0]
        return (left + half, left_z), (right - half, right_z)

    def rail_slopes(self, s: Array) -> Array:
        """Derivatives (m, 4) by distance of y and z of the left and the right rail at distances (m,)."""
        slopes = np.zeros((len(s), 4)) if self.irregularities is None else self.irregularities.derivatives(s)[1].copy()
        if self.widens:
            slopes[:, [0, 2]] += np.outer([self.widening(x)[1] for x in s.tolist()], [0.5, -0.5])
        return slopes

    def heading(self, s: float) -> float:
        """Angle of the tangent in plan relative to s = 0, rad, by Gauss quadrature over each smooth piece."""
        low, high = min(0.0, s), max(0.0, s)
        breaks = sorted({low, high, *(x for c in (self.curvature, self.gradient) for x in c.breaks if low < x < high)})
        nodes, weights = np.polynomial.legendre.leggauss(8)  # type: ignore[no-untyped-call]
        total = 0.0
        for a, b in pairwise(breaks):
            points = (0.5 * (a + b) + 0.5 * (b - a) * nodes).tolist()
            turns = [self.curvature(x)[0] * cos(self.gradient(x)[0]) for x in points]
            total += 0.5 * (b - a) * float(weights @ np.array(turns))
        return total if s >= 0.0 else -total
