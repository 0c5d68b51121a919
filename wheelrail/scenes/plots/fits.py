"""Orders of convergence, fitted by least squares of logarithms."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from wheelrail.support.arrays import Array

if TYPE_CHECKING:
    from xarray import DataArray

EXACT = 1e-12  # relative errors below it are round-off, without an order


def fitted(error: DataArray, size: DataArray, dim: str, finest: int | None = None) -> tuple[DataArray, DataArray]:
    """Slope of the errors along a dimension, and its standard error; finest: as for `slope`."""
    from xarray import apply_ufunc

    def order(errors: Array) -> tuple[float, float]:
        return line_fit(size.values, errors, finest)

    significant = error.where(error > EXACT)
    orders, deviations = apply_ufunc(
        order, significant, input_core_dims=[[dim]], output_core_dims=[[], []], vectorize=True
    )
    return orders, deviations


def slope(size: Array, error: Array, finest: int | None = None) -> float:
    """Slope of log error (n,) over log size (n,), without zeros and NaN; NaN for fewer than two sizes.

    Parameters:
        size, error: (n,).
        finest: number of sizes, the smallest ones, that are used; all by default.
    """
    return line_fit(size, error, finest)[0]


def line_fit(size: Array, error: Array, finest: int | None = None) -> tuple[float, float]:
    """`slope`, and its standard error from the residuals; NaN for fewer than three sizes."""
    valid = np.flatnonzero(np.isfinite(error) & (error > 0.0))
    valid = valid[np.argsort(size[valid], kind="stable")][:finest]
    if len(set(size[valid].tolist())) < 2:
        return float("nan"), float("nan")
    x, y = np.log(size[valid]), np.log(error[valid])
    order, level = np.polyfit(x, y, 1)
    if len(valid) < 3:
        return float(order), float("nan")
    variance = ((y - order * x - level) ** 2).sum() / (len(valid) - 2)
    return float(order), float(np.sqrt(variance / ((x - x.mean()) ** 2).sum()))
