"""Comparison of piecewise polynomials with cubics through their ends, in compiled code."""

from __future__ import annotations

from wheelrail.support.arrays import Array
from wheelrail.support.compiled import borrowing

PARTS = 4  # of each smooth piece, at whose ends values and slopes are compared


@borrowing
def differ(starts: Array, coefficients: Array, first: float, last: float, value: float, slope: float) -> bool:
    """Whether a function differs, between two abscissae, from the cubic through its values and slopes at both.

    Parameters:
        starts: (m,), of the pieces, the first and the last of which are unbounded.
        coefficients: (m, degree + 1, k), see `LocalPolynomials`.
        first, last: abscissae.
        value, slope: differences that are not exceeded.
    """
    span, begin = last - first, piece_at(starts, first)
    for k in range(coefficients.shape[2]):
        at_start, left = value_and_slope(starts, coefficients, begin, k, first)
        at_end, right = value_and_slope(starts, coefficients, piece_at(starts, last), k, last)
        rise, left, right = at_end - at_start, left * span, right * span
        bend, piece, low = left + right - 2.0 * rise, begin, first
        while low < last:
            high = min(last, starts[piece + 1]) if piece + 1 < len(starts) else last
            for part in range(1, PARTS + 1):
                s = low + (high - low) * part / PARTS
                u = (s - first) / span
                there, tilt = value_and_slope(starts, coefficients, piece, k, s)
                cubic = u * (rise + (1.0 - u) * (left - rise - u * bend))
                if abs(there - at_start - cubic) > value:
                    return True
                if abs(tilt - (left + u * (2.0 * (rise - left - bend) + 3.0 * u * bend)) / span) > slope:
                    return True
            piece, low = piece + 1, high
    return False


@borrowing
def piece_at(starts: Array, s: float) -> int:
    """Index of the piece at an abscissa."""
    low, high = 0, len(starts) - 1
    while low < high:
        middle = (low + high + 1) // 2
        if s >= starts[middle]:
            low = middle
        else:
            high = middle - 1
    return low


@borrowing
def value_and_slope(starts: Array, coefficients: Array, piece: int, function: int, s: float) -> tuple[float, float]:
    """Value and slope of a polynomial of a piece."""
    x, value, slope = s - starts[piece], 0.0, 0.0
    for power in range(coefficients.shape[1] - 1, -1, -1):
        slope = slope * x + value
        value = value * x + coefficients[piece, power, function]
    return value, slope
