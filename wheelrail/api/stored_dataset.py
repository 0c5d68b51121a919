"""Results that consist of one Dataset, stored as NetCDF."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from xarray import Dataset


@dataclass(frozen=True, repr=False)
class StoredDataset:
    """Results in one Dataset.

    Parameters:
        data: Dataset in SI units, each variable with unit and description.
    """

    data: Dataset

    def to_netcdf(self, file: str | Path) -> Path:
        """Write the data to a NetCDF file, atomically; `wheelrail.open` reads it.

        Parameters:
            file: to write.

        Returns the file. Raises OSError.
        """
        from wheelrail.scenes.datasets.netcdf import write

        write(self.data, Path(file))
        return Path(file)
