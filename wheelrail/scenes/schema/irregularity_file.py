"""Irregularities of a track from a text file."""

from __future__ import annotations

import re
from itertools import chain
from pathlib import Path

import numpy as np

from wheelrail.support.arrays import Array
from wheelrail.support.text_file import FileRefused, read_text
from wheelrail.vehicle.track.irregularity import QUANTITIES

Row = tuple[int, list[str]]  # number and cells

UNITS = {"m": 1.0, "mm": 1e-3}
MOST = 10.0  # MB
BLOCK = 1000  # rows
LARGEST = 0.1  # m; a larger value has a wrong unit
COLUMNS = f"s, {', '.join(QUANTITIES)}"


class IrregularityFileError(ValueError):
    """The file is invalid."""


def read_irregularities(path: str | Path) -> tuple[Array, Array]:
    """Stations (n,), m, and values (n, 4), m, as in `Irregularities`, from numbers separated by commas or semicolons.

    An optional first row names the columns: s and any of alignment, level, cross_level and gauge, each with a unit if
    it is not m: "level [mm]". Without it all five are expected in this order. Missing quantities are zero; lines that
    begin with # are comments. Raises IrregularityFileError naming file, row and value.
    """
    try:
        lines = read_text(path, MOST, foreign=True).splitlines()
    except FileRefused as error:
        raise IrregularityFileError(str(error)) from None
    rows = [(i, _cells(line)) for i, line in enumerate(lines, start=1) if _has_data(line)]
    if rows and not _is_number(rows[0][1][0]):
        columns = _columns(path, *rows.pop(0))
    else:
        columns = [(name, 1.0) for name in ("s", *QUANTITIES)]
    if len(rows) < 2:
        raise IrregularityFileError(f"{path}: {len(rows)} rows of numbers, must be at least 2")
    table = np.vstack([_block(path, rows[i : i + BLOCK], columns) for i in range(0, len(rows), BLOCK)])
    by_name = {name: table[:, i] for i, (name, _) in enumerate(columns)}
    stations = by_name["s"]
    for i in np.flatnonzero(np.diff(stations) <= 0.0)[:1] + 1:
        raise IrregularityFileError(
            f"{path}: row {rows[i][0]}, s = {stations[i]:g}: must be greater than {stations[i - 1]:g}, the previous"
        )
    return stations, np.stack([by_name.get(name, np.zeros(len(rows))) for name in QUANTITIES], axis=1)


def _has_data(line: str) -> bool:
    return bool(line.strip()) and not line.lstrip().startswith("#")


def _cells(line: str) -> list[str]:
    return line.split(";" if ";" in line else ",")


def _is_number(text: str) -> bool:
    try:
        float(text)
    except ValueError:
        return False
    return True


def _columns(path: str | Path, row: int, cells: list[str]) -> list[tuple[str, float]]:
    """Name and unit of each column."""
    columns: list[tuple[str, float]] = []
    for cell in (cell.strip() for cell in cells):
        match = re.fullmatch(r"(\w+)\s*(?:[\[(](\w+)[\])])?", cell)
        name, unit = match.groups() if match else ("", None)
        if name not in ("s", *QUANTITIES) or name in dict(columns) or (unit or "m") not in UNITS:
            text = f"must be one of {COLUMNS}, each once, with unit m or mm: level [mm]"
            raise IrregularityFileError(f"{path}: row {row}, {cell!r}: {text}")
        columns.append((name, UNITS[unit or "m"]))
    if "s" not in dict(columns):
        raise IrregularityFileError(f"{path}: row {row}: column s is missing")
    return columns


def _block(path: str | Path, rows: list[Row], columns: list[tuple[str, float]]) -> Array:
    """Numbers by row and column, m; rows are checked one by one only if the fast conversion fails."""
    try:
        table = np.fromiter(map(float, chain.from_iterable(cells for _, cells in rows)), float)
        table = table.reshape(len(rows), len(columns)) * [unit for _, unit in columns]
        limits = [np.inf if name == "s" else LARGEST for name, _ in columns]
        valid = (np.isfinite(table) & (np.abs(table) <= limits)).all(axis=1)
        suspects = [rows[i] for i in np.flatnonzero(~valid)]
    except ValueError:
        suspects = rows
    for row, cells in suspects:
        _check(path, row, cells, columns)
    return table


def _check(path: str | Path, row: int, cells: list[str], columns: list[tuple[str, float]]) -> None:
    if len(cells) != len(columns):
        names = ", ".join(name for name, _ in columns)
        raise IrregularityFileError(f"{path}: row {row}: {len(cells)} values, must be {len(columns)}: {names}")
    for cell, (name, unit) in zip(map(str.strip, cells), columns, strict=True):
        value = float(cell) * unit if _is_number(cell) else np.nan
        if not np.isfinite(value):
            raise IrregularityFileError(
                f"{path}: row {row}, {name} = {cell!r}: must be a finite number with a decimal point"
            )
        if name != "s" and abs(value) > LARGEST:
            raise IrregularityFileError(
                f"{path}: row {row}, {name} = {cell}: must be from -{LARGEST} to {LARGEST} m (2 mm is 0.002)"
            )
