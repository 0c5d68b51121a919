"""Elements of a page; the template renders each by its `kind`."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any, ClassVar

import numpy as np

from wheelrail.scenes.datasets.result_table import ResultTable, TextTable

LONG = 30  # rows of a table


@dataclass(frozen=True)
class PageTable:
    """Table of texts; the first column names the row. A long table scrolls and is sorted by a click on a column head.

    Parameters:
        caption: above the table.
        head: column heads.
        rows: cells by row.
        numbers: right-aligned columns.
        note: below the table.
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
    def of(cls, table: ResultTable | TextTable, caption: str = "") -> PageTable:
        """From a table of the command line."""
        text = table.as_text if isinstance(table, ResultTable) else table
        return cls(caption or text.title, text.head, [row for row in text.rows if row], text.right, text.note)


@dataclass(frozen=True)
class PagePicture:
    """Image; source: a data URI."""

    kind: ClassVar[str] = "picture"
    source: str
    caption: str
    alt: str


@dataclass(frozen=True)
class PageView:
    """Interactive 3D view: a complete page, and a still image (data URI) for browsers without WebGL."""

    kind: ClassVar[str] = "view"
    page: str
    still: str
    caption: str
    alt: str


@dataclass(frozen=True)
class PageNote:
    """A paragraph in place of a missing element."""

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
    """A page.

    Parameters:
        title: of the page.
        what: kind of results.
        status: of the computation.
        well: whether it succeeded.
        facts: values by label.
        sources: collapsed texts by label.
        sections: in their order.
    """

    title: str
    what: str
    status: str
    well: bool
    facts: Mapping[str, str]
    sources: Mapping[str, str]
    sections: Sequence[PageSection] = field(default_factory=tuple)


def number(value: Any, digits: int = 4) -> str:
    """A number with the given significant digits; a dash for NaN."""
    decimal = float(value)
    return f"{decimal + 0.0:.{digits}g}" if np.isfinite(decimal) else "–"
