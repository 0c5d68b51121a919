"""Irregularities of a track from a text file."""

from __future__ import annotations

import re
from itertools import chain
from pathlib import Path
from typing import NamedTuple

import numpy as np

from wheelrail.support.arrays import Array
from wheelrail.support.text_file import FileRefused, read_text
from wheelrail.vehicle.track import measured_track as measured
from wheelrail.vehicle.track.irregularity import QUANTITIES

Row = tuple[int, list[str]]  # number and cells

UNITS = {"m": 1.0, "mm": 1e-3}
TWIST_UNITS = {"1": 1.0, "mm/m": 1e-3}
RAILS = ("level_left", "level_right", "alignment_left", "alignment_right", "twist")
MOST = 10.0  # MB
BLOCK = 1000  # rows
LARGEST = 0.1  # m; a larger value has a wrong unit
COLUMNS = f"s, {', '.join((*QUANTITIES, *RAILS))}"


class IrregularityFileError(ValueError):
    """The file is invalid."""


class Measurement(NamedTuple):
    """Measurement of a track and its use.

    Parameters:
        band: wavelengths that are kept, m; None: all.
        chord: parts m of the chord of levels and alignments, behind and ahead; None: inertial.
        gaps: treatment of gaps of chainage; None: steps of any length are interpolated.
        twist_base: m.
        fade: length m over which values fade beside a gap.
    """

    band: measured.Band | None = None
    chord: tuple[float, float] | None = None
    gaps: measured.Gaps | None = None
    twist_base: float = 3.0
    fade: float = 10.0


AS_IT_IS = Measurement()


def read_irregularities(path: str | Path, how: Measurement = AS_IT_IS) -> tuple[Array, Array]:
    """Stations (n,), m, and values (n, 4), m, as in `Irregularities`, from numbers separated by commas or semicolons.

    An optional first row names the columns: s and any of alignment, level, cross_level and gauge, those of single
    rails, and twist, each with a unit if it is not m: "level [mm]", and a minus for the opposite sign: "-level".
    Without it the first five are expected in this order. Missing quantities are zero; lines that begin with # are
    comments. Files with columns of single rails have no gaps of chainage unless `how` says so. Raises
    IrregularityFileError naming file, row and value.
    """
    stations, columns = read_columns(path)
    try:
        gaps = how.gaps or ("refuse" if set(columns) & set(RAILS) else None)
        if gaps:
            names = list(columns)
            stations, values = measured.without_gaps(stations, np.stack(list(columns.values()), 1), gaps, how.fade)
            columns = dict(zip(names, values.T, strict=True))
        if how.band is not None and how.chord is not None:
            for name in columns:
                if name.startswith(("level", "alignment")):
                    even, values = measured.band_passed(stations, columns[name][:, None], how.band, how.chord)
                    columns[name] = np.interp(stations, even, values[:, 0])
        found = measured.quantities(stations, columns, how.twist_base)
        return (stations, found) if how.band is None else measured.band_passed(stations, found, how.band)
    except measured.MeasurementError as error:
        raise IrregularityFileError(f"{path}: {error}") from None


def read_columns(path: str | Path) -> tuple[Array, dict[str, Array]]:
    """Stations (n,) m, increasing, and the other columns (n,) m by name. Raises IrregularityFileError."""
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
    stations = by_name.pop("s")
    for i in np.flatnonzero(np.diff(stations) <= 0.0)[:1] + 1:
        raise IrregularityFileError(
            f"{path}: row {rows[i][0]}, s = {stations[i]:g}: must be greater than {stations[i - 1]:g}, the previous"
        )
    return stations, by_name


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
        match = re.fullmatch(r"(-?)(\w+)\s*(?:[\[(]([\w/]+)[\])])?", cell)
        sign, name, unit = match.groups() if match else ("", "", None)
        units = TWIST_UNITS if name == "twist" else UNITS
        scale = units.get(unit or next(iter(units)), 0.0)
        if name not in ("s", *QUANTITIES, *RAILS) or name in dict(columns) or not scale or (sign and name == "s"):
            text = f"must be one of {COLUMNS}, each once, with unit m or mm (twist: mm/m): level [mm]"
            raise IrregularityFileError(f"{path}: row {row}, {cell!r}: {text}")
        columns.append((name, -scale if sign else scale))
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
