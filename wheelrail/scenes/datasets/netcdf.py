"""Reading and atomic writing of results (NetCDF)."""

from __future__ import annotations

import os
import platform
import subprocess
import sys
from datetime import UTC, datetime
from pathlib import Path
from typing import TYPE_CHECKING

from wheelrail.scenes.datasets.sealed_file import Damaged, is_sealed, seal
from wheelrail.scenes.schema.errors import SceneError
from wheelrail.support.atomic_file import atomic_file
from wheelrail.support.memory import TooLarge, check_memory
from wheelrail.support.text_file import FileRefused, check_regular, present
from wheelrail.support.version import commit, versions

if TYPE_CHECKING:
    from xarray import Dataset

MOST = 100_000.0  # MB
LONGEST = 10_000  # characters of an attribute in the header of a file
INITIAL = 65_536  # bytes of a file in memory
TRIAL = "import sys, netCDF4; [v[...] for v in netCDF4.Dataset(sys.argv[1]).variables.values()]"
UNREADABLE = "not a readable NetCDF file, it may be damaged"
PATIENCE, RATE = 30.0, 1e7  # s and bytes/s, of a trial


def machine() -> str:
    """Architecture, number of cores and operating system."""
    return f"{platform.machine()}, {os.cpu_count()} cores, {platform.system()} {platform.release()}"


def provenance() -> dict[str, str]:
    """Versions, commit, machine and time, as attributes of results."""
    return {
        "versions": ", ".join(f"{name} {number}" for name, number in versions().items()),
        "commit": commit(),
        "machine": machine(),
        "created": datetime.now(UTC).isoformat(timespec="seconds"),
    }


def read(file: Path) -> Dataset:
    """Load a file into memory, without decoding of times.

    Parameters:
        file: of `write`, or rewritten by another program.

    Raises SceneError if the file is missing, damaged or no regular file, TooLarge.
    """
    from xarray import open_dataset

    if not present(file):
        raise SceneError(f"{file}: file does not exist")
    try:
        check_regular(file, MOST, "a NetCDF file")
        if not is_sealed(file):
            _try(file)
        with open_dataset(file, engine="netcdf4", decode_times=False) as stored:
            check_memory(str(file), 1e-9 * stored.nbytes)
            return stored.load()
    except TooLarge:
        raise
    except (FileRefused, Damaged) as error:
        raise SceneError(str(error)) from None
    except Exception as error:  # of a damaged file the libraries may raise almost any
        text = " ".join(f"{error}".split()) or type(error).__name__
        raise SceneError(f"{file}: {UNREADABLE}: {text}") from None


def _try(file: Path) -> None:
    """Read a file in another process: HDF5 may crash on damaged ones, or read them for ever. Raises Damaged."""
    limit = PATIENCE + file.stat().st_size / RATE
    try:
        done = subprocess.run([sys.executable, "-c", TRIAL, file], capture_output=True, timeout=limit, check=False)
    except subprocess.TimeoutExpired:
        raise Damaged(f"{file}: {UNREADABLE}: no end after {limit:.0f} s") from None
    if done.returncode < 0:
        raise Damaged(f"{file}: {UNREADABLE}: HDF5 crashes on it")


def write(data: Dataset, file: Path) -> None:
    """Write a NetCDF file atomically, with a hash of its content at the end; raises OSError if it cannot be written."""
    content = _content(data)
    with atomic_file(file) as part:
        part.write_bytes(content)
        seal(part)


def _content(data: Dataset) -> bytes | memoryview:
    """Bytes of a NetCDF file, made in memory: where a disk becomes full HDF5 ends the process by a crash."""
    from netCDF4 import Dataset as File
    from xarray.backends import NetCDF4DataStore

    arrays = (name for name, values in data.data_vars.items() if values.ndim > 0 and values.dtype.kind not in "OU")
    packed = {name: {"zlib": True, "complevel": 1} for name in arrays}  # strings cannot be compressed
    texts = {str(name): text for name, text in data.attrs.items() if isinstance(text, str) and len(text) > LONGEST}
    file = File("results", "w", format="NETCDF4", memory=INITIAL)
    store = NetCDF4DataStore(file)  # type: ignore[no-untyped-call]
    brief = data.copy(deep=False)
    brief.attrs = {name: value for name, value in data.attrs.items() if name not in texts}
    brief.dump_to_store(store, encoding=packed)
    for name, text in texts.items():
        file.setncattr_string(name, text)  # outside the header, which has 64 kB
    content: memoryview = file.close()
    return content
