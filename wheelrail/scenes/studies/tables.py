"""Tables of a study: cases and convergence."""

from __future__ import annotations

from collections.abc import Mapping
from typing import TYPE_CHECKING, Any

import numpy as np

from wheelrail.scenes.datasets.number_text import significant
from wheelrail.scenes.plots.fits import slope
from wheelrail.scenes.studies.convergence import (
    ORDER,
    ORDER_ERROR,
    errors_of,
    finest_of,
    increasing_of,
    largest_errors,
    series_of,
)
from wheelrail.scenes.studies.plan import SAMPLE, shown
from wheelrail.scenes.studies.quantities import MAIN, varying

if TYPE_CHECKING:
    from rich.console import RenderableType
    from rich.table import Table
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
        if name != SAMPLE and values.ndim == 1 and set(values.dims) <= study_dimensions
    ]


def tables(data: Dataset) -> list[RenderableType]:
    """Table of cases, and of errors for a convergence study."""
    if not errors_of(data):
        return [case_table(data)]
    return [case_table(data), error_table(data), *([order_table(data)] if len(series_of(data)) > 1 else [])]


def case_table(data: Dataset, rows: int = ROWS, where: str = "in the results") -> Table:
    """Table of cases, values of the sides in sequence.

    Parameters:
        data: Dataset of the study.
        rows: largest number of rows.
        where: place of the other cases, for the caption.
    """
    from rich.table import Table

    names = parameters(data)
    main = varying(data)[: 2 if "side" in data.dims and len(names) > 3 else 4]
    sides = f", {' / '.join(map(str, data['side'].values))}" if "side" in data.dims else ""
    view = Table(title=f"{data['status'].size} cases{sides}", title_justify="left")
    for name in names:
        unit = data[name].attrs.get("units", "1")
        view.add_column(f"{data[name].attrs['long_name']}" + (f" [{unit}]" if unit != "1" else ""), justify="right")
    for name in main:
        view.add_column(f"{MAIN[name][0]} [{MAIN[name][2]}]", justify="right")
    view.add_column("s", justify="right", no_wrap=True)
    view.add_column("status", min_width=9)
    values = {name: flat(data, name) for name in (*names, *main, "seconds", "status", "error")}
    for index in range(min(data["status"].size, rows)):
        case = {name: column[index] for name, column in values.items()}
        cells = [_short(_plain(case[name])) for name in names]
        for name in main:
            cells.append(" / ".join(_number(MAIN[name][1] * value) for value in np.atleast_1d(case[name])))
        status = f"{case['status']}" + (f": {case['error']}" if str(case["error"]) else "")
        view.add_row(*cells, significant(float(case["seconds"]), 2), status)
    if (omitted := data["status"].size - rows) > 0:
        view.caption, view.caption_justify = f"and {omitted} more, {where}", "left"
    return view


def error_table(data: Dataset) -> Table:
    """Largest relative errors, %, of all sides and other dimensions, and their order of convergence."""
    from rich.table import Table

    over = str(data.attrs["convergence_over"])
    largest = largest_errors(data)
    view = Table(title=f"Relative errors over {data[over].attrs['long_name']}", title_justify="left")
    view.add_column(data[over].attrs["long_name"], justify="right")
    for name in largest:
        view.add_column(f"{name.replace('_', ' ')} [%]", justify="right")
    for index, value in enumerate(data[over].values):
        view.add_row(shown(_plain(value)), *(_number(100.0 * float(error[index])) for error in largest.values()))
    view.add_section()
    size = data[over].values ** (-1.0 if increasing_of(data) else 1.0)
    finest = finest_of(data)
    view.add_row("order", *(f"{slope(size, error.values, finest):.2f}" for error in largest.values()))
    return view


def order_table(data: Dataset) -> Table:
    """Orders of convergence of every series, fitted to its errors, with their standard errors."""
    from rich.table import Table

    names = list(errors_of(data))
    view = Table(title=f"Orders over {data.attrs['convergence_over']}", title_justify="left")
    view.add_column("series")
    for name in names:
        view.add_column(name.replace("_", " "), justify="right")
    for index in series_of(data):
        view.add_row(series_label(data, index), *(order_text(data, name, index) for name in names))
    return view


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
