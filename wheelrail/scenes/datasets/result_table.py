"""Printed results of commands: tables and facts in SI units, as text for readers and as JSON for programs."""

from __future__ import annotations

import json
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from math import isfinite, isnan
from operator import itemgetter
from pathlib import Path
from typing import Any

from wheelrail.scenes.quantity import SCALES, Quantity, fixed, significant

FIGURES = 4  # significant ones of numbers without a number of decimals


@dataclass(frozen=True)
class TextTable:
    """A table of texts.

    Parameters:
        title: above the table.
        head: heads of the columns.
        rows: cells by row; an empty row separates groups.
        right: columns aligned to the right.
        note: below the table.
    """

    title: str
    head: Sequence[str]
    rows: Sequence[Sequence[str]]
    right: frozenset[int]
    note: str = ""

    def __str__(self) -> str:
        """Title, and rows in columns of equal width."""
        rows = [list(self.head), *(list(row) for row in self.rows if row)]
        widths = [max(map(len, column)) for column in zip(*rows, strict=True)]
        lines = (
            "  ".join(
                c.rjust(w) if k in self.right else c.ljust(w) for k, (c, w) in enumerate(zip(row, widths, strict=True))
            )
            for row in rows
        )
        return "\n".join(filter(None, (self.title, *map(str.rstrip, lines), self.note)))


@dataclass(frozen=True)
class Column:
    """A quantity of a table.

    Parameters:
        name: its key in JSON; empty: for readers only.
        label: its head for readers; empty: for JSON only.
        of: value of a row in SI units: a number, a text, or a list of them or mapping from side to them.
        unit: for readers, one of SCALES or an SI unit; empty for texts.
        digits: decimals; None: significant figures.
    """

    name: str
    label: str
    of: Callable[[Any], Any]
    unit: str = ""
    digits: int | None = None

    @classmethod
    def items(cls, *rows: tuple[str, str, str, int | None]) -> tuple[Column, ...]:
        """Columns of mappings: name, label, unit and digits of each."""
        return tuple(cls(name, label, itemgetter(name), unit, digits) for name, label, unit, digits in rows)

    @classmethod
    def showing(cls, quantity: Quantity, of: Callable[[Any], Any], name: str = "") -> Column:
        """Column of a quantity of results; name: its key in JSON."""
        return cls(name, quantity.name, of, quantity.shown or quantity.unit, quantity.digits)

    @property
    def head(self) -> str:
        return f"{self.label} [{self.unit}]" if self.unit not in ("", "1") else self.label

    @property
    def si_unit(self) -> str:
        return SCALES.get(self.unit, (self.unit, 1.0))[0]

    def text(self, value: Any) -> str:
        """A value for readers; values of sides and of components are in sequence, those of patches below each other."""
        if isinstance(value, Mapping):
            value = list(value.values())
        if isinstance(value, list | tuple):
            nested = any(isinstance(item, list | tuple) for item in value)
            return ("\n" if nested else "  ").join(map(self.text, value)) or "-"
        if value is None or (isinstance(value, float) and isnan(value)):
            return "-"
        if not isinstance(value, float):
            return str(value)
        shown = SCALES.get(self.unit, ("", 1.0))[1] * value
        return significant(shown, FIGURES) if self.digits is None else fixed(shown, self.digits)


@dataclass(frozen=True)
class ResultTable:
    """A table of results.

    Parameters:
        name: its key in JSON.
        title: for readers.
        columns: quantities.
        rows: of which each column takes its value.
        across: whether readers see one column for each row.
        note: for readers, below the table.
        most: number of rows for readers.
    """

    name: str
    title: str
    columns: Sequence[Column]
    rows: Sequence[Any]
    across: bool = False
    note: str = ""
    most: int | None = None

    @property
    def units(self) -> dict[str, str]:
        """SI units of the columns with numbers."""
        return {column.name: column.si_unit for column in self.columns if column.name and column.unit}

    @property
    def records(self) -> list[dict[str, Any]]:
        """Values of the rows by column, in SI units."""
        return [{column.name: column.of(row) for column in self.columns if column.name} for row in self.rows]

    @property
    def as_text(self) -> TextTable:
        """The table for readers."""
        columns = [column for column in self.columns if column.label]
        cells = [[column.text(column.of(row)) for column in columns] for row in self.rows[: self.most]]
        heads = [column.head for column in columns]
        if self.across:
            heads, *cells = ([head, *texts] for head, *texts in zip(heads, *cells, strict=True))
        numbers = frozenset(k for k, texts in enumerate(zip(*cells, strict=True)) if all(map(_is_number, texts)))
        right = frozenset(range(1, len(heads))) if self.across else numbers
        return TextTable(self.title, heads, cells, right, self.note)


def _is_number(text: str) -> bool:
    """Whether a text begins as numbers do, or stands in place of one."""
    return text[:1] in "0123456789-" or text in ("inf", "nan")


@dataclass(frozen=True)
class Results:
    """Results of a command.

    Parameters:
        command: its name.
        parts: for readers, in their order; JSON has the rows of tables of results, those of the same name in sequence.
        facts: by key of JSON, in SI units.
        units: of the facts, by key.
    """

    command: str
    parts: Sequence[ResultTable | TextTable | str] = ()
    facts: Mapping[str, Any] = field(default_factory=dict)
    units: Mapping[str, str | list[str]] = field(default_factory=dict)

    @property
    def report(self) -> dict[str, Any]:
        """Schema, units by key at any depth, facts, and tables; raises ValueError for a key with two units."""
        units: dict[str, str | list[str]] = dict(self.units)
        tables: dict[str, list[dict[str, Any]]] = {}
        for table in self.parts:
            if isinstance(table, ResultTable):
                tables.setdefault(table.name, []).extend(table.records)
                for name, unit in table.units.items():
                    if units.setdefault(name, unit) != unit:
                        raise ValueError(f"{name}: units {units[name]} and {unit}")
        return {"schema": f"wheelrail.{self.command}/1", "units": units, **self.facts, **tables}


def json_text(report: Mapping[str, Any], indent: int | None = None) -> str:
    """A report as JSON; NaN and infinity become null."""
    return json.dumps(_plain(report), allow_nan=False, indent=indent)


def _plain(value: Any) -> Any:
    if isinstance(value, Mapping):
        return {str(key): _plain(item) for key, item in value.items()}
    if isinstance(value, Path):
        return str(value)
    if hasattr(value, "tolist"):
        value = value.tolist()
    if isinstance(value, list | tuple):
        return [_plain(item) for item in value]
    return None if isinstance(value, float) and not isfinite(value) else value
