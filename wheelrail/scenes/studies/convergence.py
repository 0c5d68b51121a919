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

ERROR, REFERENCE, ORDER = "relative_error_", "reference_", "order_"


def with_errors(data: Dataset, plan: Plan) -> Dataset:
    """Results with `reference_...`, `relative_error_...` and fitted `order_...` of every quantity with a reference.

    Parameters:
        data: Dataset of the study.
        plan: of the study.

    A reference case is removed. The order is the slope of log error over log size; for counts, as of strips, the size
    is the reciprocal.
    """
    if plan.convergence is None:
        return data
    axis = plan.convergence
    size = data[axis.name] ** -1.0 if counts(plan, axis) else data[axis.name]
    if axis.reference:
        reference_case, data = data.isel({axis.name: -1}), data.isel({axis.name: slice(None, -1)})
        size = size[:-1]
        coordinates = [name for name in reference_case.coords if data[name].dims == (axis.name,)]
        references = {name: reference_case[name].drop_vars(coordinates) for name in PHYSICAL if name in data}
    else:
        references = closed_form(data, plan)
    for name, reference in references.items():
        error = abs(data[name] / reference.where(reference != 0.0) - 1.0)
        if not float(error.max()) > EXACT:
            continue
        text = PHYSICAL[name][1]
        data[REFERENCE + name] = reference.assign_attrs(units=PHYSICAL[name][0], long_name=f"{text}, reference")
        data[ERROR + name] = error.assign_attrs(units="1", long_name=f"{text}: relative error")
        data[ORDER + name] = fitted(error, size, axis.name).assign_attrs(
            units="1", long_name=f"{text}: order of the error"
        )
    return data.assign_attrs(convergence_over=axis.name, convergence_counts=int(counts(plan, axis)))


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


def counts(plan: Plan, axis: StudyAxis) -> bool:
    """Whether a dimension is a count, for which larger is finer."""
    from wheelrail.scenes.schema.messages import whole

    name = next(iter(axis.values))
    return whole(KINDS[plan.kind], tuple(name.split(".")))


def counts_of(data: Dataset) -> bool:
    """Whether the dimension of convergence of results is a count."""
    return bool(data.attrs["convergence_counts"])


def largest_errors(data: Dataset) -> dict[str, Any]:
    """Largest relative error over sides and other dimensions, along the dimension of convergence, by quantity."""
    over = str(data.attrs["convergence_over"])
    return {name: error.max([dim for dim in error.dims if dim != over]) for name, error in errors_of(data).items()}


def errors_of(data: Dataset) -> dict[str, Any]:
    """Relative errors by quantity."""
    return {str(name).removeprefix(ERROR): data[name] for name in data if str(name).startswith(ERROR)}
