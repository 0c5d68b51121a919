"""Irregularities of a track from a text file."""

from __future__ import annotations

import re
from collections.abc import Mapping
from itertools import chain
from pathlib import Path
from typing import NamedTuple

import numpy as np

from wheelrail.meshes.profiles.text_table import style_of
from wheelrail.support.arrays import Array
from wheelrail.support.text_file import FileRefused, read_text
from wheelrail.vehicle.track import measured_track as measured
from wheelrail.vehicle.track.irregularity import QUANTITIES

Row = tuple[int, list[str]]  # number and cells
Column = tuple[str, float]  # name, and unit in m or 1 with its sign; the name of a column that is not read is empty

UNITS = {"m": 1.0, "mm": 1e-3}
STATION_UNITS = {**UNITS, "km": 1e3}
TWIST_UNITS = {"1": 1.0, "mm/m": 1e-3}
RAILS = ("level_left", "level_right", "alignment_left", "alignment_right", "twist")
MOST = 10.0  # MB
BLOCK = 1000  # rows
LARGEST = 0.1  # m; a larger value has a wrong unit
NAMES = ("s", *QUANTITIES, *RAILS)
HEAD = re.compile(r"(-?)(.*?)\s*(?:[\[(]([\w/]+)[\])])?")  # sign, title and unit


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
        columns: heads in the file by the name of a column; None: heads are names.
    """

    band: measured.Band | None = None
    chord: tuple[float, float] | None = None
    gaps: measured.Gaps | None = None
    twist_base: float = 3.0
    fade: float = 10.0
    columns: Mapping[str, str] | None = None


AS_IT_IS = Measurement()


def read_irregularities(path: str | Path, how: Measurement = AS_IT_IS) -> tuple[Array, Array]:
    """Stations (n,), m, and values (n, 4), m, as in `Irregularities`, from a table with any separator and decimal mark.

    An optional first row names the columns: s and any of alignment, level, cross_level and gauge, those of single
    rails, and twist, each with a unit if it is not m: "level [mm]", and a minus for the opposite sign: "-level".
    Without it the first five are expected in this order. With `how.columns` heads are those of the file, other columns
    are not read. Missing quantities are zero; lines that begin with # are comments. Files with columns of single rails
    have no gaps of chainage unless `how` says so. Raises IrregularityFileError naming file, row and value.
    """
    stations, columns = read_columns(path, how.columns)
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


def read_columns(path: str | Path, heads: Mapping[str, str] | None = None) -> tuple[Array, dict[str, Array]]:
    """Stations (n,) m, increasing, and the other columns (n,) m by name.

    heads: in the file, by name. Raises IrregularityFileError.
    """
    try:
        lines = read_text(path, MOST, foreign=True).splitlines()
    except FileRefused as error:
        raise IrregularityFileError(str(error)) from None
    contents = [(i, line.strip()) for i, line in enumerate(lines, start=1) if _has_data(line)]
    if len(contents) > 1 and contents[0][1][-1] in ";,":  # each row ends with a separator
        contents = [(i, line.removesuffix(contents[0][1][-1])) for i, line in contents]
    style = style_of([line for _, line in contents])
    rows = [(i, style.texts(line)) for i, line in contents]
    named = bool(contents) and (heads is not None or not any(map(_is_number, rows[0][1][:1])))
    if len(rows) - named < 2:
        raise IrregularityFileError(f"{path}: {len(rows) - named} rows of numbers, must be at least 2")
    if named:
        rows.pop(0)
        row, line = contents[0]
        line = re.sub(r"\s+(?=[\[(])", "", line) if style.split is str.split else line  # a unit belongs to its head
        columns = _columns(path, row, style.texts(line), heads)
    else:
        columns = [(name, 1.0) for name in ("s", *QUANTITIES)]
    table = np.vstack([_block(path, rows[i : i + BLOCK], columns) for i in range(0, len(rows), BLOCK)])
    by_name = {name: table[:, i] for i, (name, _) in enumerate(column for column in columns if column[0])}
    stations = by_name.pop("s")
    for i in np.flatnonzero(np.diff(stations) <= 0.0)[:1] + 1:
        raise IrregularityFileError(
            f"{path}: row {rows[i][0]}, s = {stations[i]:g}: must be greater than {stations[i - 1]:g}, the previous"
        )
    return stations, by_name


def _has_data(line: str) -> bool:
    return bool(line.strip()) and not line.lstrip().startswith("#")


def _is_number(text: str) -> bool:
    try:
        float(text)
    except ValueError:
        return False
    return True


def _columns(path: str | Path, row: int, cells: list[str], heads: Mapping[str, str] | None) -> list[Column]:
    """Name and unit of each column."""

    def parts(text: str) -> tuple[str, str, str]:
        match = HEAD.fullmatch(text.strip())
        assert match is not None
        sign, title, unit = match.groups()
        return sign, title, unit or ""

    for name in [name for name in heads or {} if name not in NAMES]:
        raise IrregularityFileError(f"{path}: columns: {name!r}: must be one of {', '.join(NAMES)}")
    columns: list[Column] = []
    named = {name: parts(head) for name, head in (heads or {}).items()}
    for cell in cells:
        sign, title, unit = parts(cell)
        name = next((name for name, own in named.items() if own[1] == title), "") if heads else title
        if heads and not name:
            columns.append(("", 1.0))
            continue
        if heads:
            sign, unit = named[name][0] or sign, named[name][2] or unit
        units = {"s": STATION_UNITS, "twist": TWIST_UNITS}.get(name, UNITS)
        scale = units.get(unit or next(iter(units)), 0.0)
        if name not in NAMES or name in dict(columns) or not scale or (sign and name == "s"):
            text = f"must be one of {', '.join(NAMES)}, each once, with unit m or mm (s: km, twist: mm/m): level [mm]"
            raise IrregularityFileError(f"{path}: row {row}, {cell.strip()!r}: {text}")
        columns.append((name, -scale if sign else scale))
    for name in [name for name in ("s", *named) if name not in dict(columns)]:
        head = f" {heads[name]!r}" if heads and name in heads else ""
        raise IrregularityFileError(f"{path}: row {row}: column {name}{head} is missing")
    return columns


def _block(path: str | Path, rows: list[Row], columns: list[Column]) -> Array:
    """Numbers by row and column that is read, m; rows are checked one by one only if the fast conversion fails."""
    read = [i for i, (name, _) in enumerate(columns) if name]
    try:
        own = (cells if len(read) == len(columns) else [cells[i] for i in read] for _, cells in rows)
        table = np.fromiter(map(float, chain.from_iterable(own)), float)
        table = table.reshape(len(rows), len(read)) * [columns[i][1] for i in read]
        limits = [np.inf if columns[i][0] == "s" else LARGEST for i in read]
        valid = (np.isfinite(table) & (np.abs(table) <= limits)).all(axis=1)
        suspects = [rows[i] for i in np.flatnonzero(~valid)]
    except (ValueError, IndexError):
        suspects = rows
    for row, cells in suspects:
        _check(path, row, cells, columns)
    return table


def _check(path: str | Path, row: int, cells: list[str], columns: list[Column]) -> None:
    if len(cells) != len(columns):
        names = ", ".join(name for name, _ in columns if name)
        raise IrregularityFileError(f"{path}: row {row}: {len(cells)} values, must be {len(columns)}: {names}")
    for cell, (name, unit) in zip(map(str.strip, cells), columns, strict=True):
        if not name:
            continue
        value = float(cell) * unit if _is_number(cell) else np.nan
        if not np.isfinite(value):
            raise IrregularityFileError(
                f"{path}: row {row}, {name} = {cell!r}: must be a finite number with a decimal point"
            )
        if name != "s" and abs(value) > LARGEST:
            raise IrregularityFileError(
                f"{path}: row {row}, {name} = {cell}: must be from -{LARGEST} to {LARGEST} m (2 mm is 0.002)"
            )
