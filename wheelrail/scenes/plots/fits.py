"""Orders of convergence, fitted by least squares of logarithms."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from wheelrail.support.arrays import Array

if TYPE_CHECKING:
    from xarray import DataArray

EXACT = 1e-12  # relative errors below it are round-off, without an order


def fitted(error: DataArray, size: DataArray, dim: str) -> DataArray:
    """Slope of the errors along a dimension."""
    from xarray import apply_ufunc

    def order(errors: Array) -> float:
        return slope(size.values, errors)

    significant = error.where(error > EXACT)
    orders: DataArray = apply_ufunc(order, significant, input_core_dims=[[dim]], vectorize=True, output_dtypes=[float])
    return orders


def slope(size: Array, error: Array) -> float:
    """Slope of log error (n,) over log size (n,), without zeros and NaN; NaN for fewer than two sizes."""
    valid = np.isfinite(error) & (error > 0.0)
    if len(set(size[valid].tolist())) < 2:
        return float("nan")
    return float(np.polyfit(np.log(size[valid]), np.log(error[valid]), 1)[0])
