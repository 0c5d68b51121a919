"""Stresses from displacement gradients, and equivalent stresses."""

from __future__ import annotations

from typing import TypeVar

import numpy as np
from numpy.typing import NDArray

from wheelrail.support.arrays import Array

Values = TypeVar("Values", Array, NDArray[np.complex128])


def cauchy(gradient: Values, λ: float, μ: float) -> Values:
    """σ = λ tr ε I + 2 μ ε of gradients (..., 3, 3), real or complex; Lamé's constants in Pa."""
    trace = np.trace(gradient, axis1=-2, axis2=-1)[..., None, None]
    return np.asarray(μ * (gradient + gradient.swapaxes(-1, -2)) + λ * trace * np.eye(3), dtype=gradient.dtype)


def von_mises(σ: Array) -> Array:
    """sqrt(3/2 s : s) of stresses (..., 3, 3), s their deviator."""
    s = σ - np.trace(σ, axis1=-2, axis2=-1)[..., None, None] / 3 * np.eye(3)
    return np.asarray(np.sqrt(1.5 * (s * s).sum(axis=(-2, -1))))
