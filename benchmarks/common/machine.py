"""Machine, versions and date of a measurement."""

from __future__ import annotations

import os
import platform
from datetime import date
from pathlib import Path


def processor() -> str:
    """Name of the processor."""
    try:
        lines = Path("/proc/cpuinfo").read_text(encoding="utf-8").splitlines()
    except OSError:
        return platform.processor() or platform.machine()
    names = [line.split(":", 1)[1].strip() for line in lines if line.startswith("model name")]
    return names[0] if names else platform.machine()


def machine_description() -> str:
    """Machine and versions, on which computing times depend, and versions of the libraries behind the errors."""
    import dolfinx
    import numpy as np
    import scipy
    from petsc4py import PETSc

    petsc = ".".join(str(part) for part in PETSc.Sys.getVersion())
    threads = os.environ.get("OMP_NUM_THREADS", "not set")
    return (
        f"{date.today().isoformat()}, {processor()}, {os.cpu_count()} cores, load {os.getloadavg()[0]:.1f}, "
        f"OMP_NUM_THREADS {threads}; Python {platform.python_version()}, dolfinx {dolfinx.__version__}, "
        f"PETSc {petsc}, NumPy {np.__version__}, SciPy {scipy.__version__}"
    )
