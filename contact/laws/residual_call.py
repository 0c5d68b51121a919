"""Compiled: calls of a friction residual, its slopes and bounds by address, so that compiled loops serve every law."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from wheelrail.contact.laws.pointwise import FrictionFunctions
from wheelrail.support.arrays import Array, Nodes
from wheelrail.support.compiled import call, compiled


class ResidualCode(NamedTuple):
    """Friction law for compiled code.

    Parameters:
        address, slopes_address, bounds_address: of the residual, of its slopes and of the bounds; 0 without friction.
        parameters: of the law.
        regularisation: creepage eps.
    """

    address: int
    slopes_address: int
    bounds_address: int
    parameters: Array
    regularisation: float

    @classmethod
    def of(cls, functions: FrictionFunctions, regularisation: float) -> ResidualCode:
        addresses = functions.residual_address, functions.slopes_address, functions.bounds_address
        return cls(*addresses, functions.parameters, regularisation)


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
def friction_bounds(law: ResidualCode, s: Array, p: Array, speed: float) -> Array:
    """Bounds mu(|s| V, p) p (n,) Pa of the tractions at n points.

    Parameters, contiguous:
        law: of friction.
        s: (2, n), slips over the rolling speed V.
        p: (n,) Pa, pressures.
        speed: V, m/s.
    """
    bounds, counts = np.empty_like(p), np.array([len(p), len(law.parameters)])
    _write_bounds(law.bounds_address, s, p, counts, np.array([speed]), law.parameters, bounds)
    return bounds


@compiled
def _write_bounds(address: int, s: Array, p: Array, counts: Nodes, speed: Array, parameters: Array, out: Array) -> None:
    """As `_write`."""
    points = s.ctypes.data, p.ctypes.data, counts.ctypes.data
    call(address, (*points, speed.ctypes.data, parameters.ctypes.data, out.ctypes.data))


@compiled
def _write(
    address: int, q: Array, s: Array, p: Array, rho: Array, counts: Nodes, numbers: Array, parameters: Array, out: Array
) -> None:
    """Call a function; as parameters of this one, the arrays outlive the call."""
    points = q.ctypes.data, s.ctypes.data, p.ctypes.data, rho.ctypes.data
    call(address, (*points, counts.ctypes.data, numbers.ctypes.data, parameters.ctypes.data, out.ctypes.data))
