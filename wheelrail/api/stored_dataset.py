"""Results that consist of one Dataset, stored as NetCDF."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from html import escape
from pathlib import Path
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from xarray import Dataset

    from wheelrail.scenes.datasets.result_table import TextTable


@dataclass(frozen=True, repr=False)
class StoredDataset:
    """Results in one Dataset.

    Parameters:
        data: Dataset in SI units, each variable with unit and description.
    """

    data: Dataset

    @property
    def _tables(self) -> Sequence[TextTable]:
        """Tables at the head of the displayed results."""
        raise NotImplementedError

    def __repr__(self) -> str:
        return "\n\n".join(map(str, self._tables))

    def _repr_html_(self) -> str:
        """The same tables, with the Dataset in a collapsed section below."""
        return (
            f"<div>{''.join(map(_html, self._tables))}"
            f"<details><summary>data</summary>{self.data._repr_html_()}</details></div>"
        )

    def to_netcdf(self, file: str | Path) -> Path:
        """Write the data to a NetCDF file, atomically; `wheelrail.open` reads it.

        Parameters:
            file: to write.

        Returns the file. Raises OSError.
        """
        from wheelrail.scenes.datasets.netcdf import write

        write(self.data, Path(file))
        return Path(file)


def _html(table: TextTable) -> str:
    """A table in HTML."""
    rows = "".join(
        "<tr>" + "".join(f"<{tag} style='text-align:right'>{escape(cell)}</{tag}>" for cell in row) + "</tr>"
        for row, tag in ((table.head, "th"), *((row, "td") for row in table.rows if row))
    )
    return f"<b>{escape(table.title)}</b><table>{rows}</table>"
