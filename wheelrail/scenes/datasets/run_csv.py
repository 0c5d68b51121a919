"""Results of a run as comma-separated values: one row for each output time, names and units in the first line."""

from __future__ import annotations

import csv
from collections.abc import Iterator
from io import StringIO
from itertools import product
from pathlib import Path
from typing import TYPE_CHECKING

from wheelrail.scenes.quantities import COMPONENTS
from wheelrail.support.arrays import Array
from wheelrail.support.atomic_file import atomic_file

if TYPE_CHECKING:
    from xarray import Dataset

ROWS = 1000  # that are held as text


def write_csv(data: Dataset, file: Path) -> None:
    """Write every variable over time in SI units.

    Parameters:
        data: Dataset of a run.
        file: to write; UTF-8, decimal points, NaN where a value is missing.

    Raises OSError if the file cannot be written.
    """
    heads, columns = zip(*_columns(data), strict=True)
    line = StringIO()
    csv.writer(line, lineterminator="\n").writerow(heads)  # quotes names with commas
    with atomic_file(file) as part, part.open("w", encoding="utf-8", newline="") as stream:
        stream.write(line.getvalue())
        for start in range(0, len(columns[0]), ROWS):
            for row in zip(*(column[start : start + ROWS].tolist() for column in columns), strict=True):
                stream.write(",".join(map(repr, row)).replace("nan", "NaN").replace("inf", "Inf") + "\n")


def _columns(data: Dataset) -> Iterator[tuple[str, Array]]:
    """Heads and values (n,) of all columns: time and distance first, then the others as they are stored."""
    for name in dict.fromkeys(("time", "distance", *map(str, data.variables))):
        variable = data[name].variable
        if variable.dims[:1] != ("time",):
            continue
        dims = list(map(str, variable.dims[1:]))
        values = variable.values.reshape(len(variable), -1)
        columns = (values.astype(int) if values.dtype == bool else values).T
        labels = [_labels(data, dim) for dim in dims]
        for place, column in zip(product(*map(range, variable.shape[1:])), columns, strict=True):
            components = [COMPONENTS[dim][k] for dim, k in zip(dims, place, strict=True) if dim in COMPONENTS]
            unit = components[0][1] if components else variable.attrs.get("units", "1")
            parts = [name, *(own[k] for own, k in zip(labels, place, strict=True))]
            yield f"{' '.join(parts)} [{unit}]", column


def _labels(data: Dataset, dim: str) -> list[str]:
    """Names of the places of a dimension: those of the results, of components, or numbers from 1."""
    if dim in COMPONENTS:
        return [name for name, _ in COMPONENTS[dim]]
    if dim in data.coords:
        return list(map(str, data[dim].values))
    return [f"{dim} {k + 1}" for k in range(data.sizes[dim])]
