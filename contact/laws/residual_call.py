"""Compiled: calls of a friction residual, its slopes and bounds by address, so that compiled loops serve every law."""

from __future__ import annotations

from typing import Any, NamedTuple

import numpy as np
from numba import types
from numba.extending import intrinsic

from wheelrail.contact.laws.pointwise import FrictionFunctions
from wheelrail.support.arrays import Array
from wheelrail.support.compiled import compiled


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
        return cls(*functions.code.addresses, functions.parameters, regularisation)


@intrinsic  # type: ignore[untyped-decorator]
def call(context: Any, at: Any, arguments: Any) -> Any:
    """Compiled: call of the function at an address, with addresses, numbers of 64 bits and doubles."""

    def generate(ctx: Any, builder: Any, _: Any, values: Any) -> Any:
        from llvmlite import ir

        given = [builder.extract_value(values[1], i) for i in range(len(arguments))]
        function = ir.FunctionType(ir.VoidType(), [value.type for value in given]).as_pointer()
        builder.call(builder.inttoptr(values[0], function), given)
        return ctx.get_dummy_value()

    return types.void(at, arguments), generate


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
    _write(law.address, q, s, p, rho, speed, law.regularisation, law.parameters, F)
    return F


@compiled
def friction_slopes(law: ResidualCode, q: Array, s: Array, p: Array, rho: Array, speed: float) -> Array:
    """Slopes (n, 14) of `friction_residual` by q, s (2, 2 each), both pressures and the speed (2 each)."""
    slopes = np.empty((len(rho), 14))
    _write(law.slopes_address, q, s, p, rho, speed, law.regularisation, law.parameters, slopes)
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
    bounds = np.empty_like(p)
    _write_bounds(law.bounds_address, s, p, speed, law.parameters, bounds)
    return bounds


@compiled
def _write_bounds(address: int, s: Array, p: Array, speed: float, parameters: Array, out: Array) -> None:
    """As `_write`."""
    call(address, (len(p), s.ctypes.data, p.ctypes.data, speed, parameters.ctypes.data, out.ctypes.data))


@compiled
def _write(
    address: int, q: Array, s: Array, p: Array, rho: Array, speed: float, eps: float, parameters: Array, out: Array
) -> None:
    """Call a function; as parameters of this one, the arrays outlive the call."""
    points = len(rho), q.ctypes.data, s.ctypes.data, p.ctypes.data, rho.ctypes.data
    call(address, (*points, speed, eps, parameters.ctypes.data, out.ctypes.data))
