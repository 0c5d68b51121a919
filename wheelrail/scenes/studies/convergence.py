"""Errors of a study along one dimension, and their order of convergence."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from wheelrail.scenes.plots.fits import EXACT, fitted
from wheelrail.scenes.schema.scene import KINDS, HertzScene
from wheelrail.scenes.studies.plan import Plan, StudyAxis
from wheelrail.scenes.studies.quantities import PHYSICAL
from wheelrail.support.arrays import Array

if TYPE_CHECKING:
    from xarray import DataArray, Dataset

ERROR, REFERENCE, ORDER, ORDER_ERROR = "relative_error_", "reference_", "order_", "order_error_"


def with_errors(data: Dataset, plan: Plan) -> Dataset:
    """Results with `reference_...`, `relative_error_...` and fitted `order_...` of every quantity with a reference, and
    the standard error of the order, `order_error_...`.

    Parameters:
        data: Dataset of the study.
        plan: of the study.

    A reference case is removed. The order is the slope of log error over log size; where larger values are finer, as of
    a number of strips or a penalty stiffness, the size is the reciprocal.
    """
    convergence = plan.study.convergence
    if plan.convergence is None or convergence is None:
        return data
    axis = plan.convergence
    size = data[axis.name] ** -1.0 if increasing(plan, axis) else data[axis.name]
    if axis.reference:
        reference_case, data = data.isel({axis.name: -1}), data.isel({axis.name: slice(None, -1)})
        size = size[:-1]
        coordinates = [name for name in reference_case.coords if data[name].dims == (axis.name,)]
        references = {name: reference_case[name].drop_vars(coordinates) for name in PHYSICAL if name in data}
    else:
        references = closed_form(data, plan)
    for name in convergence.quantities or references:
        if name not in references:
            continue
        reference = references[name]
        error = abs(data[name] / reference.where(reference != 0.0) - 1.0)
        if convergence.rms_over:
            error = (error**2).mean(list(convergence.rms_over)) ** 0.5
        if not float(error.max()) > EXACT:
            continue
        unit, text = PHYSICAL[name].unit, PHYSICAL[name].text
        data[REFERENCE + name] = reference.assign_attrs(units=unit, long_name=f"{text}, reference")
        data[ERROR + name] = error.assign_attrs(units="1", long_name=f"{text}: relative error")
        order, deviation = fitted(error, size, axis.name, convergence.finest)
        data[ORDER + name] = order.assign_attrs(units="1", long_name=f"{text}: order of the error")
        data[ORDER_ERROR + name] = deviation.assign_attrs(units="1", long_name=f"{text}: standard error of the order")
    return data.assign_attrs(
        convergence_over=axis.name,
        convergence_counts=int(increasing(plan, axis)),
        convergence_finest=convergence.finest or data.sizes[axis.name],
    )


def closed_form(data: Dataset, plan: Plan) -> dict[str, DataArray]:
    """Closed-form solutions of the cases of a Hertz pair."""
    from wheelrail.contact.analytical.hertz import hertz, modulus

    solutions: dict[str, Array] = {}
    for case in plan.cases:
        scene = case.scene
        assert isinstance(scene, HertzScene)
        up, low = scene.upper, scene.lower
        A, B = (
            0.5 * (1 / upper_radius + 1 / lower_radius)
            for upper_radius, lower_radius in zip(up.radii, low.radii, strict=True)
        )
        exact = hertz(A, B, modulus((up.E, up.nu), (low.E, low.nu)), force=scene.load, approach=scene.approach)
        a, b = exact.semi_axes
        values = {"max_pressure": exact.peak, "area": np.pi * a * b, "semi_axis_x": a, "semi_axis_y": b}
        values |= {"approach": exact.approach} if scene.approach is None else {"normal_force": exact.force}
        for name, value in values.items():
            solutions.setdefault(name, np.full(plan.shape, np.nan))[case.index] = value
    return {name: data["seconds"].copy(data=values) for name, values in solutions.items() if name in data}


def increasing(plan: Plan, axis: StudyAxis) -> bool:
    """Whether larger values of a dimension are finer: those of a reference beyond all others, and numbers of cells."""
    from wheelrail.scenes.schema.messages import whole

    name, values = next(iter(axis.values.items()))
    if axis.reference:
        return bool(values[-1] > max(values[:-1]))
    return whole(KINDS[plan.kind], tuple(name.split(".")))


def increasing_of(data: Dataset) -> bool:
    """Whether larger values of the dimension of convergence of results are finer."""
    return bool(data.attrs["convergence_counts"])


def finest_of(data: Dataset) -> int | None:
    """Number of the finest sizes for the fitted orders of results; None for all."""
    return int(data.attrs["convergence_finest"]) if "convergence_finest" in data.attrs else None


def series_of(data: Dataset) -> list[dict[str, int]]:
    """Series of errors over the dimension of convergence: indices in all other dimensions, where there are errors."""
    over, errors = str(data.attrs["convergence_over"]), errors_of(data)
    dims = [str(dim) for dim in next(iter(errors.values())).dims if dim != over]
    series = (dict(zip(dims, index, strict=True)) for index in np.ndindex(*(data.sizes[dim] for dim in dims)))
    return [index for index in series if any(bool(error.isel(index).notnull().any()) for error in errors.values())]


def largest_errors(data: Dataset) -> dict[str, Any]:
    """Largest relative error over sides and other dimensions, along the dimension of convergence, by quantity."""
    over = str(data.attrs["convergence_over"])
    return {name: error.max([dim for dim in error.dims if dim != over]) for name, error in errors_of(data).items()}


def errors_of(data: Dataset) -> dict[str, Any]:
    """Relative errors by quantity."""
    return {str(name).removeprefix(ERROR): data[name] for name in data if str(name).startswith(ERROR)}
