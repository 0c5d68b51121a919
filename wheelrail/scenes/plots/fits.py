"""Slopes of errors over sizes, fitted by least squares in logarithms."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from wheelrail.support.arrays import Array

if TYPE_CHECKING:
    from xarray import DataArray

EXACT = 1e-12  # a relative error below it is none: nothing falls there


def fitted(error: DataArray, size: DataArray, dim: str) -> DataArray:
    """Slope of the errors along a dimension."""
    from xarray import apply_ufunc

    def one(errors: Array) -> float:
        return slope(size.values, errors)

    kept = error.where(error > EXACT)
    found: DataArray = apply_ufunc(one, kept, input_core_dims=[[dim]], vectorize=True, output_dtypes=[float])
    return found


def slope(size: Array, error: Array) -> float:
    """Slope of log error (n,) over log size (n,) by least squares, of errors that are known and not zero; NaN for
    fewer than two sizes.
    """
    known = np.isfinite(error) & (error > 0.0)
    if len(set(size[known].tolist())) < 2:
        return float("nan")
    return float(np.polyfit(np.log(size[known]), np.log(error[known]), 1)[0])
