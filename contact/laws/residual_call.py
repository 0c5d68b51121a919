"""Compiled: calls of a friction residual and its slopes by address, so that compiled loops serve every law."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from wheelrail.contact.laws.pointwise import FrictionFunctions
from wheelrail.support.arrays import Array, Nodes
from wheelrail.support.compiled import call, compiled


class ResidualCode(NamedTuple):
    """Friction law for compiled code.

    Parameters:
        address, slopes_address: of the residual and of its slopes; 0 without friction.
        parameters: of the law.
        regularisation: creepage eps.
    """

    address: int
    slopes_address: int
    parameters: Array
    regularisation: float

    @classmethod
    def of(cls, functions: FrictionFunctions, regularisation: float) -> ResidualCode:
        return cls(functions.residual_address, functions.slopes_address, functions.parameters, regularisation)


@compiled
def friction_residual(law: ResidualCode, q: Array, s: Array, p: Array, rho: Array, speed: float) -> Array:
    """Means F (2, n) Pa of the friction residual over n cells, see `wheelrail.forms.traction.mean_projected`.

    Parameters, contiguous:
        law: of friction.
        q: (2, n) Pa, tractions.
        s: (2, n), slips over the rolling speed.
        p: (2, n) Pa, pressures between which the cells have a linear one.
        rho: (n,) 1/Pa.
        speed: m/s, of rolling.
    """
    F = np.empty_like(q)
    counts, numbers = np.array([len(rho), len(law.parameters)]), np.array([speed, law.regularisation])
    _write(law.address, q, s, p, rho, counts, numbers, law.parameters, F)
    return F


@compiled
def friction_slopes(law: ResidualCode, q: Array, s: Array, p: Array, rho: Array, speed: float) -> Array:
    """Slopes (n, 14) of `friction_residual` by q, s (2, 2 each), both pressures and the speed (2 each)."""
    slopes = np.empty((len(rho), 14))
    counts, numbers = np.array([len(rho), len(law.parameters)]), np.array([speed, law.regularisation])
    _write(law.slopes_address, q, s, p, rho, counts, numbers, law.parameters, slopes)
    return slopes


@compiled
def _write(
    address: int, q: Array, s: Array, p: Array, rho: Array, counts: Nodes, numbers: Array, parameters: Array, out: Array
) -> None:
    """Call a function; as parameters of this one, the arrays outlive the call."""
    points = q.ctypes.data, s.ctypes.data, p.ctypes.data, rho.ctypes.data
    call(address, (*points, counts.ctypes.data, numbers.ctypes.data, parameters.ctypes.data, out.ctypes.data))
