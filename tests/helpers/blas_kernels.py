"""Prints the names of the kernels of every loaded OpenBLAS, then runs pytest with the arguments.

python tests/helpers/blas_kernels.py ARGUMENTS
"""

from __future__ import annotations

import ctypes
import re
import sys
from pathlib import Path

import numpy as np
import pytest
import scipy.linalg

LOADED = np.dot, scipy.linalg.lu_factor  # whose libraries are asked
NAME = "openblas_get_corename"


def kernels() -> set[str]:
    """Names such as Haswell; none without OpenBLAS, or where the system does not tell which libraries are loaded."""
    maps = Path("/proc/self/maps")
    text = maps.read_text(encoding="utf-8") if maps.exists() else ""
    names = set()
    for path in set(re.findall(r"(/\S*(?:blas|lapack)\S*\.so\S*)", text)):
        library = ctypes.CDLL(path)
        for name in (NAME, f"scipy_{NAME}", f"{NAME}64_", f"scipy_{NAME}64_"):
            if hasattr(library, name):
                function = getattr(library, name)
                function.restype = ctypes.c_char_p
                names.add(function().decode())
    return names


if __name__ == "__main__":
    print("kernels", *sorted(kernels()), flush=True)
    sys.exit(pytest.main(sys.argv[1:]))
