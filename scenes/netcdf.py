"""Results on disk, whole or not at all."""

from __future__ import annotations

import os
import tempfile
from pathlib import Path
from typing import TYPE_CHECKING

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
    """Write NetCDF in one stroke: the file is the old one or the whole new one, never a part."""
    file.parent.mkdir(parents=True, exist_ok=True)
    handle, temporary = tempfile.mkstemp(prefix=f".{file.name}.", dir=file.parent)
    os.close(handle)
    try:
        arrays = (name for name, values in data.data_vars.items() if values.ndim > 0 and values.dtype.kind not in "OU")
        packed = {name: {"zlib": True, "complevel": 1} for name in arrays}  # texts cannot be
        data.to_netcdf(temporary, engine="netcdf4", encoding=packed)
        os.chmod(temporary, 0o644)
        os.replace(temporary, file)
    except BaseException:
        Path(temporary).unlink(missing_ok=True)
        raise
