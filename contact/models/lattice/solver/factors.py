"""LAPACK for the core's LU factors of the Jacobian of a contact on a lattice, and factors of none."""

from __future__ import annotations

import ctypes
from functools import cache

import numpy as np
from scipy.linalg import cython_lapack

from wheelrail.bindings._contact import SLOPES, Evaluation, Factors, KeptFactors, Lapack

SINGULAR = "the Jacobian of the contact is singular"
NONE = np.zeros((0, 0), dtype=np.float32)
NO_FACTORS = KeptFactors(
    False,
    Factors(
        NONE,
        np.zeros(0, dtype=np.int32),
        np.zeros(0),
        np.zeros(0),
        np.zeros((0, 0, 0), dtype=np.float32),
        *(np.zeros((0, 0, SLOPES)),) * 2,
        *(NONE,) * 2,
    ),
    Evaluation(
        False, np.zeros((0, 0)), np.zeros((0, 0, 3)), np.zeros((0, 0)), *(np.zeros((0, 2, 0)),) * 2, np.zeros((0, 0))
    ),
)


@cache
def lapack() -> Lapack:
    """Functions of SciPy's library, by their addresses."""
    return Lapack(*(_address(name) for name in ("sgetrf", "sgetrs", "dgesv")))


def _address(name: str) -> int:
    """Address of a function of LAPACK that SciPy shares as a capsule, whose name is its signature."""
    capsule = cython_lapack.__pyx_capi__[name]
    signature, pointer = ctypes.pythonapi.PyCapsule_GetName, ctypes.pythonapi.PyCapsule_GetPointer
    signature.restype, signature.argtypes = ctypes.c_char_p, [ctypes.py_object]
    pointer.restype, pointer.argtypes = ctypes.c_void_p, [ctypes.py_object, ctypes.c_char_p]
    return int(pointer(capsule, signature(capsule)))
