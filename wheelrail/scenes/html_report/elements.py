"""What a page is made of; the template draws each by its `kind`."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any, ClassVar

import numpy as np

if TYPE_CHECKING:
    from rich.table import Table as RichTable


LONG = 30  # rows of a table


@dataclass(frozen=True)
class PageTable:
    """Heads and rows of texts; the first column names the row. numbers: columns that stand at the right. A long one
    scrolls, and is sorted by a click on a head.
    """

    kind: ClassVar[str] = "table"
    caption: str
    head: Sequence[str]
    rows: Sequence[Sequence[str]]
    numbers: frozenset[int]
    note: str = ""

    @property
    def long(self) -> bool:
        return len(self.rows) > LONG

    @classmethod
    def of_rich(cls, table: RichTable, caption: str = "") -> PageTable:
        """The same as a table of the command line."""
        columns = [[str(cell) for cell in column.cells] for column in table.columns]
        right = frozenset(k for k, column in enumerate(table.columns) if column.justify == "right")
        head = [str(column.header) for column in table.columns]
        title = caption or str(table.title or "")
        return cls(title, head, list(zip(*columns, strict=True)), right, str(table.caption or ""))


@dataclass(frozen=True)
class PagePicture:
    """source: a data URI."""

    kind: ClassVar[str] = "picture"
    source: str
    caption: str
    alt: str


@dataclass(frozen=True)
class PageView:
    """A three-dimensional one: a page of its own, and a still picture (data URI) where that cannot be shown."""

    kind: ClassVar[str] = "view"
    page: str
    still: str
    caption: str
    alt: str


@dataclass(frozen=True)
class PageNote:
    """A paragraph in place of what is not there."""

    kind: ClassVar[str] = "note"
    text: str


Part = PageTable | PagePicture | PageView | PageNote


@dataclass(frozen=True)
class PageSection:
    title: str
    parts: Sequence[Part]
    text: str = ""


@dataclass(frozen=True)
class Page:
    """title; what it is (`what`), how it ended (`status`, `well`), lead: a paragraph; facts: label and value; sources:
    texts to fold out, by what they are.
    """

    title: str
    what: str
    status: str
    well: bool
    lead: str
    facts: Mapping[str, str]
    sources: Mapping[str, str]
    sections: Sequence[PageSection] = field(default_factory=tuple)


def number(value: Any, digits: int = 4) -> str:
    """A number of so many significant digits; a dash for one that is not known."""
    found = float(value)
    return f"{found + 0.0:.{digits}g}" if np.isfinite(found) else "–"
