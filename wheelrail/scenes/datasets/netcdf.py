"""Reading and atomic writing of results (NetCDF)."""

from __future__ import annotations

import os
import platform
from pathlib import Path
from typing import TYPE_CHECKING

from wheelrail.scenes.schema.errors import SceneError
from wheelrail.support.atomic_file import atomic_file

if TYPE_CHECKING:
    from xarray import Dataset


def machine() -> str:
    """Architecture, number of cores and operating system."""
    return f"{platform.machine()}, {os.cpu_count()} cores, {platform.system()} {platform.release()}"


def read(file: Path) -> Dataset:
    """Load a file into memory, without decoding of times. Raises SceneError if it is missing or damaged."""
    from xarray import load_dataset

    if not file.is_file():
        raise SceneError(f"{file}: file does not exist")
    try:
        return load_dataset(file, engine="netcdf4", decode_times=False)
    except (OSError, ValueError, RuntimeError, KeyError, AttributeError) as error:  # of damaged files
        raise SceneError(f"{file}: not a readable NetCDF file, it may be damaged: {error}") from None


def write(data: Dataset, file: Path) -> None:
    """Write a NetCDF file atomically; raises OSError if it cannot be written."""
    arrays = (name for name, values in data.data_vars.items() if values.ndim > 0 and values.dtype.kind not in "OU")
    packed = {name: {"zlib": True, "complevel": 1} for name in arrays}  # strings cannot be compressed
    with atomic_file(file) as part:
        try:
            data.to_netcdf(part, engine="netcdf4", encoding=packed)
        except RuntimeError as error:  # of the library for a full disk
            raise OSError(f"{file.name} cannot be written: {error}") from error
