"""Compiled core: modules of the build for this processor; sources are in `bindings/` and in the folders `core/`."""

from __future__ import annotations

import os
from pathlib import Path

HERE = Path(__file__).parent
V3 = {"avx2", "bmi1", "bmi2", "f16c", "fma", "abm", "movbe"}  # instructions of x86-64-v3, as Linux names them


def build() -> Path:
    """Folder of the modules: $WHEELRAIL_CORE, for example one with sanitizers, else the one for this processor."""
    try:
        with open("/proc/cpuinfo", encoding="ascii", errors="replace") as file:
            flags = file.read(8192).partition("\nflags")[2].partition("\n")[0]
    except OSError:  # not Linux
        flags = ""
    return Path(os.environ.get("WHEELRAIL_CORE", HERE / ("x86-64-v3" if set(flags.split()) >= V3 else "baseline")))


def require_built(folder: Path) -> None:
    """Raises ImportError where the modules are missing or older than their sources, which installed packages lack."""
    if not (modules := [file.stat().st_mtime for file in folder.glob("_*.so")]):
        raise ImportError(f"the compiled core is missing in {folder}: make core")
    for pattern in ("../bindings/*.[ch]pp", "*/core/*.hpp", "*/*/core/*.hpp", "*/*/*/core/*.hpp", "*/*/*/*/core/*.hpp"):
        for file in HERE.parent.glob(pattern):
            if file.stat().st_mtime > max(modules) and file.name != "library.cpp":  # no part of them
                raise ImportError(f"{file} is newer than the compiled core: make core")


FOLDER = build()
__path__.append(str(FOLDER))
require_built(FOLDER)
