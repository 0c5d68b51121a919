"""Rows of numbers in a text, with any cell separator and decimal mark, and the surrounding text."""

from __future__ import annotations

import re
from collections import Counter
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from itertools import pairwise

Cells = list[float | None]  # numbers, NaN for a missing value, None for text

SAMPLE = 200  # lines from which the separator is found: so many at the start, and as many of the others
MISSING = re.compile(r"[-+]?nan|n/?a|#n/?a|null|none|-+|\?+|", re.IGNORECASE)
NUMBER = re.compile(r"[-+]?(\d+\.?\d*|\.\d+)([ed][-+]?\d+)?|[-+]?inf(inity)?", re.IGNORECASE)
ANY_VALUE = re.compile(r"\d|\bnan\b|\bn/?a\b", re.IGNORECASE)
IN_BRACKETS = re.compile(r"[\[({].*?[\])}]")
COMMENT = re.compile(r"[#!%$].*|//.*")
QUOTED = re.compile(r'"([^"]*)"')
COLUMN = {"x": "x", "y": "y", "z": "z", "lateral": "y", "vertical": "z", "height": "z"}


@dataclass(frozen=True)
class TextTable:
    """Numbers of a text file.

    Parameters:
        rows: number of the line and cells, of lines with at least two numbers.
        text: number and content of all other lines that are neither empty nor comments.
        title: last line of text before the rows.
        names: its cells, without units.
        style: separator and decimal mark in words.
    """

    rows: list[tuple[int, Cells]]
    text: list[tuple[int, str]]
    title: str
    names: list[str]
    style: str

    def columns(self) -> tuple[int, int]:
        """Indices of the columns of y and z: by their names, or the first two that do not count or stay constant."""
        width = max((len(cells) for _, cells in self.rows), default=0)
        named = {COLUMN[name]: i for i, name in reversed(list(enumerate(map(column_name, self.names)))) if name}
        for pair in (("y", "z"), ("x", "z"), ("x", "y")):
            if all(named.get(name, width) < width for name in pair):
                return named[pair[0]], named[pair[1]]
        full = [i for i in range(width) if 2 * sum(_is_number(cells, i) for _, cells in self.rows) > len(self.rows)]
        varying = [i for i in full if not self._counts_or_stays(i)] if len(full) > 2 else full
        first, second = (varying if len(varying) > 1 else [*full, 0, 1])[:2]
        return first, second

    def _counts_or_stays(self, i: int) -> bool:
        """Whether column i is constant, or numbers the rows."""
        values = [value for _, cells in self.rows for value in cells[i : i + 1] if value is not None]
        steps = {round(b - a, 9) for a, b in pairwise(values)}
        return steps <= {0.0} or (steps == {1.0} and values[0] in (0.0, 1.0))


def text_table(lines: Sequence[tuple[int, str]]) -> TextTable:
    """Table of the numbered lines with at least two numbers."""
    contents = [(number, COMMENT.sub("", line).strip()) for number, line in lines]
    style = style_of([content for _, content in contents])
    rows, text = [], []
    for number, content in contents:
        cells = style.cells(content)
        if _has_numbers(cells):
            rows.append((number, cells))
        elif content:
            text.append((number, content))
    usual = Counter(len(cells) for _, cells in rows).most_common(1)
    while rows and len(rows[0][1]) != usual[0][0]:  # a date or a count of other things
        number, _ = rows.pop(0)
        text.append((number, dict(lines)[number]))
    before = [content for number, content in sorted(text) if rows and number < rows[0][0]]
    names = (
        [name for name in style.split(before[-1]) if re.search("[a-z]", IN_BRACKETS.sub("", name), re.IGNORECASE)]
        if before
        else []
    )
    return TextTable(rows, sorted(text), before[-1] if before else "", names, style.words)


@dataclass(frozen=True)
class Style:
    """How a line is split into cells.

    Parameters:
        words: description.
        split: text of a line to texts of cells.
        comma: decimals are marked by commas.
    """

    words: str
    split: Callable[[str], list[str]]
    comma: bool = False

    def texts(self, content: str) -> list[str]:
        """Cells of a line with decimal points."""
        return self.split(content.replace(",", ".") if self.comma else content)

    def cells(self, content: str) -> Cells:
        """Numbers of a line without its comment; none without a second cell."""
        content = content.replace("\u2212", "-").replace("\u00a0", " ")
        texts = self.split(content) if ANY_VALUE.search(content) else []
        return [self._number(text.strip(" \"'")) for text in texts] if len(texts) > 1 else []

    def _number(self, text: str) -> float | None:
        if self.comma:
            if "." in text:
                return None
            text = text.replace(",", ".")
        try:
            return float(text)
        except ValueError:
            if MISSING.fullmatch(text):
                return float("nan")
        return float(re.sub("[dD]", "e", text)) if NUMBER.fullmatch(text) else None


def _quoted(line: str) -> list[str]:
    """Quoted cells, which may contain the separator."""
    return QUOTED.findall(line)


STYLES = (
    Style("semicolons", lambda line: line.split(";")),
    Style("semicolons, decimal commas", lambda line: line.split(";"), comma=True),
    Style("tabs", lambda line: line.split("\t")),
    Style("tabs, decimal commas", lambda line: line.split("\t"), comma=True),
    Style("quotes, decimal commas", _quoted, comma=True),
    Style("commas", lambda line: line.split(",")),
    Style("blanks", str.split),
    Style("blanks, decimal commas", str.split, comma=True),
    Style("blanks, commas and semicolons", lambda line: re.split(r"[\s,;]+", line)),
    Style("blanks and semicolons, decimal commas", lambda line: re.split(r"[\s;]+", line), comma=True),
)


def style_of(lines: Sequence[str]) -> Style:
    """The style that gives the most lines with equally many cells and two numbers, then the fewest other cells."""
    sample = [*lines[:SAMPLE], *lines[SAMPLE :: max(1, len(lines) // SAMPLE)]]  # lines may alternate

    def rank(style: Style) -> tuple[int, int]:
        rows = [cells for cells in map(style.cells, sample) if _has_numbers(cells)]
        return max(Counter(map(len, rows)).values(), default=0), -sum(cells.count(None) for cells in rows)

    return max(STYLES, key=rank)  # the first of equal ones


def column_name(text: str) -> str:
    """The name of a lateral or vertical coordinate in a column's title, without its unit; empty for others."""
    return next((word for word in re.split(r"[^a-z]+", text.lower()) if word in COLUMN), "")


def _is_number(cells: Cells, i: int) -> bool:
    return i < len(cells) and cells[i] is not None


def _has_numbers(cells: Cells) -> bool:
    """Whether there are two numbers side by side, missing ones included."""
    return any(a is not None and b is not None for a, b in pairwise(cells))
