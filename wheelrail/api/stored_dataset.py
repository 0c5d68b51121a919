"""Results that are one Dataset, and are kept as one."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from xarray import Dataset


@dataclass(frozen=True, repr=False)
class StoredDataset:
    """data: everything, in SI units, each variable with its unit and meaning."""

    data: Dataset

    def to_netcdf(self, file: str | Path) -> Path:
        """Keep the data in a NetCDF file, which is there whole or not at all; `wheelrail.open` reads it.

        Raises OSError.
        """
        from wheelrail.scenes.datasets.netcdf import write

        write(self.data, Path(file))
        return Path(file)
