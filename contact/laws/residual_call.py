"""Compiled: call of a friction residual by its address, so that compiled loops serve every law."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from wheelrail.contact.laws.pointwise import FrictionFunctions
from wheelrail.support.arrays import Array, Nodes
from wheelrail.support.compiled import call, compiled


class ResidualCode(NamedTuple):
    """Friction law for compiled code.

    Parameters:
        address: of the residual; 0 without friction.
        parameters: of the law.
        regularisation: creepage eps.
    """

    address: int
    parameters: Array
    regularisation: float

    @classmethod
    def of(cls, functions: FrictionFunctions, regularisation: float) -> ResidualCode:
        return cls(functions.residual_address, functions.parameters, regularisation)


@compiled
def friction_residual(law: ResidualCode, q: Array, s: Array, p: Array, rho: Array, speed: float) -> Array:
    """F (2, n) Pa of `FrictionFunctions.residual`, from contiguous arrays."""
    F = np.empty_like(q)
    counts, numbers = np.array([len(p), len(law.parameters)]), np.array([speed, law.regularisation])
    _write(law.address, q, s, p, rho, counts, numbers, law.parameters, F)
    return F


@compiled
def _write(
    address: int, q: Array, s: Array, p: Array, rho: Array, counts: Nodes, numbers: Array, parameters: Array, F: Array
) -> None:
    """Call the residual; as parameters of a function, the arrays outlive the call."""
    points = q.ctypes.data, s.ctypes.data, p.ctypes.data, rho.ctypes.data
    call(address, (*points, counts.ctypes.data, numbers.ctypes.data, parameters.ctypes.data, F.ctypes.data))
