"""Results on disk, whole or not at all."""

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
    """The machine that this runs on, in a few words."""
    return f"{platform.machine()}, {os.cpu_count()} cores, {platform.system()} {platform.release()}"


def read(file: Path) -> Dataset:
    """All of a file, closed again; times stay numbers. Raises SceneError where it is missing or cannot be read."""
    from xarray import load_dataset

    if not file.is_file():
        raise SceneError(f"{file}: no such file")
    try:
        return load_dataset(file, engine="netcdf4", decode_times=False)
    except (OSError, ValueError, RuntimeError, KeyError, AttributeError) as error:  # whatever a spoiled one brings up
        raise SceneError(f"{file}: cannot be read as NetCDF, it may be damaged: {error}") from None


def write(data: Dataset, file: Path) -> None:
    """Write NetCDF, whole or not at all; raises OSError if it cannot be written."""
    arrays = (name for name, values in data.data_vars.items() if values.ndim > 0 and values.dtype.kind not in "OU")
    packed = {name: {"zlib": True, "complevel": 1} for name in arrays}  # texts cannot be
    with atomic_file(file) as part:
        try:
            data.to_netcdf(part, engine="netcdf4", encoding=packed)
        except RuntimeError as error:  # what the library makes of a full disk
            raise OSError(f"{file.name} cannot be written: {error}") from error
