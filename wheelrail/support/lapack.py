"""Functions of LAPACK for the core."""

from __future__ import annotations

import ctypes
from functools import cache

from scipy.linalg import cython_lapack

from wheelrail.bindings._contact import Lapack

NAMES = "sgetrf", "sgetrs", "dgesv", "dgetrf", "dgetrs"


@cache
def lapack() -> Lapack:
    """Addresses of those of SciPy's library."""
    return Lapack(*(_address(name) for name in NAMES))


def _address(name: str) -> int:
    capsule = cython_lapack.__pyx_capi__[name]
    label = ctypes.pythonapi.PyCapsule_GetName
    label.restype, label.argtypes = ctypes.c_char_p, [ctypes.py_object]
    pointer = ctypes.pythonapi.PyCapsule_GetPointer
    pointer.restype, pointer.argtypes = ctypes.c_void_p, [ctypes.py_object, ctypes.c_char_p]
    return int(pointer(capsule, label(capsule)))
