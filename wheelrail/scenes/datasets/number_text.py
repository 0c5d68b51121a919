"""Numbers as text for readers: no exponents for usual magnitudes, no minus sign before zero."""

from __future__ import annotations

from math import isfinite


def fixed(value: float, digits: int) -> str:
    """A value with a number of decimals: -0.001 with two is `0.00`."""
    return f"{round(value, digits) + 0.0:.{digits}f}"


def significant(value: float, digits: int = 3) -> str:
    """A value with a number of significant digits, above 1 without exponent: 320.4 with two is `320`."""
    text = f"{value + 0.0:.{digits}g}"
    return f"{float(text):.0f}" if "e+" in text and isfinite(value) else text
