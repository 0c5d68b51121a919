"""Results of a study from a file."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

from wheelrail.scenes.datasets.declared import check
from wheelrail.scenes.datasets.netcdf import read
from wheelrail.scenes.quantity import Quantity, Schema
from wheelrail.scenes.schema.errors import SceneError
from wheelrail.scenes.studies.convergence import ERROR, ORDER, ORDER_ERROR, REFERENCE, errors_of
from wheelrail.scenes.studies.plan import SAMPLE
from wheelrail.scenes.studies.quantities import QUANTITIES
from wheelrail.support.text_file import json_value

if TYPE_CHECKING:
    from xarray import Dataset

KIND = "study"


def read_study(file: Path) -> Dataset:
    """Dataset of a study; raises SceneError for a file that does not have what a study writes."""
    data = read(file)
    check_study_data(data, file)
    return data


def check_study_data(data: Dataset, file: Path) -> None:
    """Raise SceneError unless a Dataset has the structure of study results, naming the difference.

    Parameters:
        data: Dataset of the file.
        file: for messages.
    """
    if data.attrs.get("kind") != KIND or "status" not in data:
        raise SceneError(f"{file}: contains no results of a study")
    dims = tuple(map(str, data["status"].dims))
    if not data["status"].size:
        raise SceneError(f"{file}: status: has no cases; must have one at least")
    check(data, file, _schema(data, dims), {"study": str, "scene": str, "scene_kind": str, **_numbers(data)})
    for name, values in data.coords.items():
        if (
            values.ndim == 1
            and values.dims[0] in dims
            and name != SAMPLE
            and not isinstance(values.attrs.get("long_name"), str)
        ):
            raise SceneError(f"{file}: {name}: without long_name; must have the name of a parameter")
    for name in ("study", "scene"):
        try:
            table = json_value(data.attrs[name])
        except ValueError as error:
            raise SceneError(f"{file}: attribute {name}: not valid JSON: {error}") from None
        if not isinstance(table, dict):
            raise SceneError(f"{file}: attribute {name}: must be tables in JSON")
    if errors_of(data) and str(data.attrs.get("convergence_over")) not in dims:
        raise SceneError(f"{file}: attribute convergence_over: must be a dimension, {', '.join(dims)}")


def _schema(data: Dataset, dims: tuple[str, ...]) -> Schema:
    """Declarations of the texts and numbers of every case, and of the quantities that the file has."""
    texts = {name: Quantity(dims, "", "") for name in ("status", "error", "host")}
    by_side = (*dims, "side") if "side" in data.dims else dims
    quantities = {
        str(name): Quantity(by_side if "side" in values.dims else dims, QUANTITIES[str(name)].unit, "")
        for name, values in data.data_vars.items()
        if name in QUANTITIES
    }
    return {**texts, "seconds": Quantity(dims, "s", "computing time"), **quantities}


def _numbers(data: Dataset) -> dict[str, type]:
    """Attributes of a convergence study."""
    counted = ("convergence_counts", "convergence_finest")
    derived = any(str(name).startswith((ERROR, REFERENCE, ORDER, ORDER_ERROR)) for name in data.data_vars)
    return dict.fromkeys(counted, float) if derived else {}
