"""Tables of a study: cases and convergence."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from typing import TYPE_CHECKING, Any

import numpy as np

from wheelrail.scenes.datasets.result_table import Column, ResultTable
from wheelrail.scenes.plots.fits import slope
from wheelrail.scenes.quantity import significant
from wheelrail.scenes.studies.convergence import (
    ORDER,
    ORDER_ERROR,
    errors_of,
    finest_of,
    increasing_of,
    largest_errors,
    series_of,
)
from wheelrail.scenes.studies.plan import SAMPLE, VARIATION, shown
from wheelrail.scenes.studies.quantities import QUANTITIES, varying

if TYPE_CHECKING:
    from xarray import Dataset

ROWS = 30  # of a table; all cases are in the results


def dimensions(data: Dataset) -> list[str]:
    """Names of the dimensions of the study."""
    return [str(name) for name in data["status"].dims]


def parameters(data: Dataset) -> list[str]:
    """Names of the coordinates of parameters."""
    study_dimensions = set(dimensions(data))
    return [
        str(name)
        for name, values in data.coords.items()
        if name not in (SAMPLE, VARIATION) and values.ndim == 1 and set(values.dims) <= study_dimensions
    ]


def tables(data: Dataset) -> list[ResultTable]:
    """Table of cases, and of errors for a convergence study."""
    return [case_table(data), *convergence_tables(data)]


def convergence_tables(data: Dataset) -> list[ResultTable]:
    """Errors, their orders, and the orders of every series if there are several; none for other studies."""
    if not errors_of(data):
        return []
    return [error_table(data), largest_order_table(data), *([order_table(data)] if len(series_of(data)) > 1 else [])]


def case_table(data: Dataset, rows: int = ROWS, where: str = "in the results") -> ResultTable:
    """Table of cases, values of the sides in sequence.

    Parameters:
        data: Dataset of the study.
        rows: largest number of rows for readers.
        where: place of the other cases, for the note.
    """
    names, cases = parameters(data), data["status"].size
    main = varying(data)[: 2 if "side" in data.dims and len(names) > 3 else 4]
    sides = list(map(str, data["side"].values)) if "side" in data.dims else []
    columns = []
    for name in names:
        unit, values = _unit(data, name), flat(data, name).tolist()
        label = f"{data[name].attrs['long_name']}" + (f" [{unit}]" if unit not in ("", "1") else "")
        columns += [_texts(label, map(_short, values)), _values(name, values, unit)]
    for name in main:
        scale = QUANTITIES[name].scale
        numbers = (map(_number, np.atleast_1d(scale * own)) for own in flat(data, name))
        columns.append(_texts(QUANTITIES[name].head, map(" / ".join, numbers)))
    for name, quantity in QUANTITIES.items():
        if name in data:
            values = flat(data, name).tolist()
            by_side = [dict(zip(sides, own, strict=True)) if isinstance(own, list) else own for own in values]
            columns.append(_values(name, by_side, quantity.unit))
    seconds, statuses, errors = (flat(data, name).tolist() for name in ("seconds", "status", "error"))
    columns += [
        _texts("s", (significant(value, 2) for value in seconds)),
        _texts("status", map(": ".join, (filter(None, pair) for pair in zip(statuses, errors, strict=True)))),
        _values("seconds", seconds, "s"),
        _values("status", statuses),
        _values("error", errors),
    ]
    title = f"{cases} cases" + (f", {' / '.join(sides)}" if sides else "")
    note = f"and {cases - rows} more, {where}" if cases > rows else ""
    return ResultTable("cases", title, columns, range(cases), note=note, most=rows)


def _texts(label: str, texts: Iterable[str]) -> Column:
    """Column for readers, of rows that are numbered."""
    return Column("", label, list(texts).__getitem__)


def _values(name: str, values: Sequence[Any], unit: str = "") -> Column:
    """Column for programs, of rows that are numbered."""
    return Column(name, "", values.__getitem__, unit)


def _unit(data: Dataset, name: str) -> str:
    """Unit of a parameter; none of texts."""
    return str(data[name].attrs.get("units", "1")) if data[name].dtype.kind in "fiu" else ""


def error_table(data: Dataset) -> ResultTable:
    """Largest relative errors of all sides and other dimensions."""
    over = str(data.attrs["convergence_over"])
    label, sizes = str(data[over].attrs["long_name"]), data[over].values.tolist()
    columns = [_texts(label, map(shown, sizes)), _values(over, sizes, _unit(data, over))]
    for name, error in largest_errors(data).items():
        columns.append(Column(f"error_{name}", name.replace("_", " "), error.values.tolist().__getitem__, "%"))
    return ResultTable("errors", f"Relative errors over {label}", columns, range(len(sizes)))


def largest_order_table(data: Dataset) -> ResultTable:
    """Order of convergence of the largest relative errors."""
    size = data[str(data.attrs["convergence_over"])].values ** (-1.0 if increasing_of(data) else 1.0)
    columns = []
    for name, error in largest_errors(data).items():
        order = [float(slope(size, error.values, finest_of(data)))]
        columns.append(Column(f"order_{name}", name.replace("_", " "), order.__getitem__, "1", 2))
    return ResultTable("order", "Order of the largest errors", columns, range(1))


def order_table(data: Dataset) -> ResultTable:
    """Orders of convergence of every series, fitted to its errors, with their standard errors."""
    series = list(series_of(data))
    labels = [series_label(data, index) for index in series]
    columns = [Column("series", "series", labels.__getitem__)]
    for name in errors_of(data):
        columns.append(_texts(name.replace("_", " "), (order_text(data, name, index) for index in series)))
        for key, prefix in ((f"order_{name}", ORDER), (f"order_error_{name}", ORDER_ERROR)):
            columns.append(_values(key, [float(data[prefix + name].isel(index)) for index in series], "1"))
    return ResultTable("orders", f"Orders over {data.attrs['convergence_over']}", columns, range(len(series)))


def order_text(data: Dataset, name: str, index: Mapping[str, int]) -> str:
    """Order of the error of a quantity in a series, with its standard error if there are at least three sizes."""
    order, deviation = (float(data[prefix + name].isel(index)) for prefix in (ORDER, ORDER_ERROR))
    if np.isnan(order):
        return "-"
    return f"{order:.2f}" if np.isnan(deviation) else f"{order:.2f} ± {deviation:.2f}"


def series_label(data: Dataset, index: Mapping[str, int]) -> str:
    """Values of the parameters that vary between series.

    Parameters:
        data: Dataset of the study.
        index: by dimension.
    """
    texts = []
    for dim, i in index.items():
        if dim == "side":
            texts.append(str(data["side"].values[i]))
            continue
        for name in parameters(data):
            if data[name].dims == (dim,) and len(set(map(str, data[name].values))) > 1:
                texts.append(f"{data[name].attrs['long_name']} = {shown(_plain(data[name].values[i]))}")
    return ", ".join(texts)


def flat(data: Dataset, name: str) -> Any:
    """Values (cases,) or (cases, sides) of a variable."""
    dims = dimensions(data)
    missing = [dim for dim in dims if dim not in data[name].dims]
    values = data[name].expand_dims({dim: data.sizes[dim] for dim in missing}).transpose(*dims, ...).values
    return values.reshape(data["status"].size, *values.shape[len(dims) :])


def _plain(value: Any) -> Any:
    return value.item() if hasattr(value, "item") else value


def _short(value: Any) -> str:
    return significant(value, 4) if isinstance(value, float) else shown(value)


def _number(value: float) -> str:
    return "-" if np.isnan(value) else significant(value, 4)
