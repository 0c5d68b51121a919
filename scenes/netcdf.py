"""Results on disk, whole or not at all."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

from meshes.whole_file import whole_file

if TYPE_CHECKING:
    from xarray import Dataset


def versions() -> dict[str, str]:
    """Versions of this package and of what computes, by name."""
    from importlib.metadata import PackageNotFoundError, version

    found = {}
    for name in ("wheelrail", "numpy", "scipy", "numba", "fenics-dolfinx", "petsc4py", "xarray"):
        try:
            found[name] = version(name)
        except PackageNotFoundError:
            continue
    return found


def write(data: Dataset, file: Path) -> None:
    """Write NetCDF, whole or not at all; raises OSError if it cannot be written."""
    arrays = (name for name, values in data.data_vars.items() if values.ndim > 0 and values.dtype.kind not in "OU")
    packed = {name: {"zlib": True, "complevel": 1} for name in arrays}  # texts cannot be
    with whole_file(file) as part:
        try:
            data.to_netcdf(part, engine="netcdf4", encoding=packed)
        except RuntimeError as error:  # what the library makes of a full disk
            raise OSError(f"{file.name} cannot be written: {error}") from error
