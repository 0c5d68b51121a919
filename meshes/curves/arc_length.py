"""Curves by arc length from sections of a plane curve with any parameter.

Points are complex numbers y + iz: rigid motion is a product and a sum, the normal is i times the tangent.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import partial
from itertools import pairwise

import numpy as np
from numpy.polynomial.legendre import leggauss, legint, legval, legvander

from wheelrail.meshes.curves.curve import DEGREE, Curve
from wheelrail.support.arrays import Array, Complex

Function = Callable[[Array], Complex]

TOLERANCE = 1e-15  # m, of a polynomial piece against its section; the coordinates themselves carry about 1e-17 m
GAP = 1e-6  # m, largest gap between sections that is attributed to rounding of their coordinates
ROUNDING = 1e-15  # of half a piece, change of the parameter that is rounding
TERMS = 24  # of the speed of a piece: three times as many as of its position
_NODES, _WEIGHTS = leggauss(TERMS)  # type: ignore[no-untyped-call]
_TO_SERIES = _WEIGHTS[:, None] * legvander(_NODES, TERMS - 1) * (np.arange(TERMS) + 0.5)  # type: ignore[no-untyped-call]
_integrated: Callable[..., Array] = partial(legint, lbnd=-1.0, axis=1)
_summed: Callable[..., Array] = partial(legval, tensor=False)
_LOBATTO = -np.cos(np.pi * np.arange(DEGREE + 1) / DEGREE)
_TO_POWERS = np.linalg.inv(np.vander(_LOBATTO, increasing=True))
_BETWEEN = 0.5 * (_LOBATTO[1:] + _LOBATTO[:-1])
_PLACES = np.concatenate([_LOBATTO, [0.0], _BETWEEN])  # of a piece, from -1 to 1


@dataclass(frozen=True)
class CurveSegment:
    """Part of a curve, smooth between its knots (k,), an increasing parameter; position m and its derivative."""

    position: Function
    velocity: Function
    knots: Array

    @property
    def start(self) -> complex:
        return complex(self.position(self.knots[:1])[0])

    @property
    def stop(self) -> complex:
        return complex(self.position(self.knots[-1:])[0])


def arc(centre: complex, radius: float, start: float, stop: float) -> CurveSegment:
    """Circular arc from polar angle start to stop [rad], clockwise if stop < start; the parameter is its length."""
    turn = np.sign(stop - start) / radius

    def spoke(t: Array) -> Complex:
        return np.asarray(np.exp(1j * (start + turn * t)))

    return CurveSegment(
        lambda t: centre + radius * spoke(t),
        lambda t: 1j * turn * radius * spoke(t),
        np.array([0.0, radius * abs(stop - start)]),
    )


def line(start: complex, stop: complex) -> CurveSegment:
    """Straight line; the parameter is its length."""
    length = abs(stop - start)
    direction = (stop - start) / length
    return CurveSegment(
        lambda t: np.asarray(start + direction * t, dtype=complex),
        lambda t: np.full(t.shape, direction, dtype=complex),
        np.array([0.0, length]),
    )


def graph(height: Callable[[Array], Array], slope: Callable[[Array], Array], start: float, stop: float) -> CurveSegment:
    """The graph z = height(y) from y = start to stop, with its slope; the parameter is y."""
    return CurveSegment(
        lambda y: y + 1j * height(y), lambda y: np.asarray(1.0 + 1j * slope(y), dtype=complex), np.array([start, stop])
    )


def _step(x: Array) -> Array:
    """From 0 to 1 with two vanishing derivatives at both ends."""
    return x**3 * (10.0 + x * (6.0 * x - 15.0))


def _step_slope(x: Array) -> Array:
    return 30.0 * (x * (1.0 - x)) ** 2


def bridged(
    first: CurveSegment, second: CurveSegment, before: float, after: float
) -> tuple[CurveSegment, CurveSegment]:
    """Both sections, with the small gap between closed by a smooth step.

    Parameters:
        first, second: sections.
        before, after: distances from the joint to the start and the end of the step, in the parameters, which must have
            the same scale.
    """
    gap, width = second.start - first.stop, before + after

    def shifted(section: CurveSegment, joint: float, level: float) -> CurveSegment:
        def x(t: Array) -> Array:
            return np.clip((t - joint + before) / width, 0.0, 1.0)

        ends = [joint - before, joint + after]
        inside = [end for end in ends if section.knots[0] < end < section.knots[-1]]
        return CurveSegment(
            lambda t: section.position(t) + gap * (_step(x(t)) - level),
            lambda t: section.velocity(t) + gap / width * _step_slope(x(t)),
            np.union1d(section.knots, inside),
        )

    return shifted(first, first.knots[-1], 0.0), shifted(second, second.knots[0], 1.0)


def curve(sections: Sequence[CurveSegment]) -> Curve:
    """The sections, end to end, as one curve by arc length from zero at its start.

    Piecewise polynomials in arc length, equal to the sections to round-off (by bisection of the pieces). Gaps from
    rounded coordinates are closed. Raises ValueError for a gap above 1 um and for a section that is not smooth.
    """
    sections = list(sections)
    for i, (first, second) in enumerate(pairwise(sections)):
        gap = abs(second.start - first.stop)
        if not gap <= GAP:
            raise ValueError(f"sections of a curve must meet within {GAP} m, section {i + 1} starts {gap:.3g} m off")
        if gap > TOLERANCE:
            width = 0.2 * float(min(np.ptp(first.knots), np.ptp(second.knots)))
            sections[i : i + 2] = bridged(sections[i], second, width, width)
    lengths, coefficients = zip(*(fitted(section) for section in sections), strict=True)
    breaks = np.concatenate([[0.0], np.cumsum(np.concatenate(lengths))])
    return Curve(breaks, np.concatenate(coefficients, axis=1))


def fitted(section: CurveSegment) -> tuple[Array, Complex]:
    """Lengths (m,) and coefficients (DEGREE + 1, m) of polynomials in the arc length from each piece's middle."""
    knots = section.knots
    start, stop = knots[:-1, None], knots[1:, None]
    done: list[tuple[Array, Array, Complex]] = []
    for _ in range(12):
        length, rest, parameter = _by_length(section, start, stop)
        values, middle, expected = np.split(section.position(parameter), [DEGREE + 1, DEGREE + 2], axis=1)
        powers = (values - middle) @ _TO_POWERS.T
        between = middle + (powers[:, None, :] * np.vander(_BETWEEN, DEGREE + 1, increasing=True)).sum(axis=2)
        bad = np.maximum(np.abs(between - expected).max(axis=1), rest) > TOLERANCE
        powers[:, 0] += middle[:, 0]
        coefficients = powers / (0.5 * length[:, None]) ** np.arange(DEGREE + 1)
        done.append((start[~bad, 0], length[~bad], coefficients[~bad]))
        if not bad.any():
            first, lengths, pieces = (np.concatenate(parts) for parts in zip(*done, strict=True))
            order = np.argsort(first)
            return lengths[order], pieces[order].T
        cut = 0.5 * (start[bad] + stop[bad])
        start, stop = np.concatenate([start[bad], cut]), np.concatenate([cut, stop[bad]])
    raise ValueError("a section of the curve is not smooth")


def _by_length(section: CurveSegment, a: Array, b: Array) -> tuple[Array, Array, Array]:
    """Lengths (m,) of pieces, bounds (m,) of the last terms of their series, and parameters (m, n) at `_PLACES`.

    a, b: (m, 1), ends of the pieces. By Newton's method.
    """
    half = 0.5 * (b - a)
    speed = np.abs(section.velocity(a + half * (1.0 + _NODES))) @ _TO_SERIES  # of Legendre's polynomials
    travelled = _integrated(speed).T[..., None]
    speed = speed.T[..., None]
    length = _summed(np.ones((1, 1)), travelled)
    x = np.broadcast_to(_PLACES, (len(a), len(_PLACES)))
    for _ in range(6):
        last = x
        excess = _summed(x, travelled) - 0.5 * length * (1.0 + _PLACES)
        x = np.clip(x - excess / _summed(x, speed), -1.0, 1.0)
        if (np.abs(x - last) <= ROUNDING).all():
            break
    half = half[:, 0]
    return half * length[:, 0], half * np.abs(speed[-1, :, 0]) / (TERMS - 0.5), a + half[:, None] * (1.0 + x)
