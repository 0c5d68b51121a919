"""Compiled: operations on eight doubles at once, written as vectors because Numba makes none of loops of eight.

Addresses are integers (`array.ctypes.data`); the caller keeps the arrays alive. Multiplications and additions are fused
explicitly, so that the rounding does not depend on the compiler.
"""

from __future__ import annotations

from typing import Any

from numba import types
from numba.core import cgutils
from numba.extending import intrinsic

WIDTH = 8
BYTES = 8 * WIDTH


def _ir() -> Any:
    from llvmlite import ir  # type: ignore[import-untyped]

    return ir


def _vector() -> Any:
    ir = _ir()
    return ir.VectorType(ir.DoubleType(), WIDTH)


def _load(builder: Any, address: Any) -> Any:
    pointer = builder.inttoptr(address, _vector().as_pointer())
    value = builder.load(pointer)
    value.align = 8
    return value


def _store(builder: Any, value: Any, address: Any) -> None:
    builder.store(value, builder.inttoptr(address, _vector().as_pointer())).align = 8


def _splat(builder: Any, value: Any) -> Any:
    ir = _ir()
    vector = ir.Constant(_vector(), ir.Undefined)
    index = ir.IntType(32)
    first = builder.insert_element(vector, value, ir.Constant(index, 0))
    mask = ir.Constant(ir.VectorType(index, WIDTH), [0] * WIDTH)
    return builder.shuffle_vector(first, vector, mask)


def _fma(builder: Any) -> Any:
    ir = _ir()
    kind = ir.FunctionType(_vector(), [_vector()] * 3)
    return cgutils.get_or_insert_function(builder.module, kind, "llvm.fma.v8f64")


def _offset(builder: Any, address: Any, bytes_: int) -> Any:
    return builder.add(address, _ir().Constant(_ir().IntType(64), bytes_))


@intrinsic  # type: ignore[untyped-decorator]
def bits(context: Any, x: Any) -> Any:
    """The bits of a double as an integer."""

    def generate(_: Any, builder: Any, __: Any, arguments: Any) -> Any:
        return builder.bitcast(arguments[0], _ir().IntType(64))

    return types.int64(types.float64), generate


@intrinsic  # type: ignore[untyped-decorator]
def double(context: Any, x: Any) -> Any:
    """The double with the bits of an integer."""

    def generate(_: Any, builder: Any, __: Any, arguments: Any) -> Any:
        return builder.bitcast(arguments[0], _ir().DoubleType())

    return types.float64(types.int64), generate


@intrinsic  # type: ignore[untyped-decorator]
def polynomials(context: Any, parts: Any, sign: Any, values: Any, slopes: Any) -> Any:
    """Write values (8,), and slopes (8,) unless None, of sums of polynomials of degree 5.

    Parameters:
        parts: (address of coefficients (6, 8), u, du/dx) of each.
        sign: of x; the first five components are even in x, the others odd, and u belongs to |x|.
        values, slopes: addresses.
    """

    def generate(ctx: Any, builder: Any, _: Any, arguments: Any) -> Any:
        ir = _ir()
        fma, mask = _fma(builder), ir.Constant(ir.VectorType(ir.IntType(32), WIDTH), [0] * 5 + [WIDTH] * 3)
        one, signs = _splat(builder, ir.Constant(ir.DoubleType(), 1.0)), _splat(builder, arguments[1])
        value = slope = None
        for p in range(len(parts)):
            table, u, inverse = (builder.extract_value(builder.extract_value(arguments[0], p), k) for k in range(3))
            coefficient = [_load(builder, _offset(builder, table, BYTES * k)) for k in range(6)]
            at, derivative = _splat(builder, u), coefficient[5]
            own = coefficient[5]
            for k in (4, 3, 2, 1, 0):
                if k < 4:
                    derivative = builder.call(fma, [derivative, at, own])
                own = builder.call(fma, [own, at, coefficient[k]])
            derivative = builder.fmul(derivative, _splat(builder, inverse))
            value = own if value is None else builder.fadd(value, own)
            slope = derivative if slope is None else builder.fadd(slope, derivative)
        _store(builder, builder.fmul(value, builder.shuffle_vector(one, signs, mask)), arguments[2])
        if not isinstance(slopes, types.NoneType):
            _store(builder, builder.fmul(slope, builder.shuffle_vector(signs, one, mask)), arguments[3])
        return ctx.get_dummy_value()

    return types.void(parts, sign, values, slopes), generate


@intrinsic  # type: ignore[untyped-decorator]
def products(context: Any, g: Any, stride: Any, weights: Any, count: Any, out: Any, apart: Any, number: Any) -> Any:
    """Write sums (8,) over count places of vectors at g, a stride of bytes apart, times each of weights (count, K).

    Parameters:
        out: address of the first sum.
        apart: bytes from one sum to the next one.
        number: constant tuple of length K. All sums stay in registers, and each vector is read once.
    """

    def generate(ctx: Any, builder: Any, _: Any, arguments: Any) -> Any:
        ir = _ir()
        g, stride, weights, count, out, apart, _ = arguments
        fma, integer, K = _fma(builder), ir.IntType(64), len(number)
        zero = ir.Constant(_vector(), [0.0] * WIDTH)
        sums = [cgutils.alloca_once_value(builder, zero) for _ in range(K)]
        for total in sums:
            builder.store(zero, total)
        pointer = builder.inttoptr(weights, ir.DoubleType().as_pointer())
        with cgutils.for_range(builder, count) as loop:
            value = _load(builder, builder.add(g, builder.mul(loop.index, stride)))
            for k, total in enumerate(sums):
                place = builder.add(builder.mul(loop.index, ir.Constant(integer, K)), ir.Constant(integer, k))
                weight = _splat(builder, builder.load(builder.gep(pointer, [place])))
                builder.store(builder.call(fma, [value, weight, builder.load(total)]), total)
        for k, total in enumerate(sums):
            _store(builder, builder.load(total), builder.add(out, builder.mul(apart, ir.Constant(integer, k))))
        return ctx.get_dummy_value()

    return types.void(g, stride, weights, count, out, apart, number), generate


@intrinsic  # type: ignore[untyped-decorator]
def add_multiple(context: Any, values: Any, weight: Any, count: Any, to: Any) -> Any:
    """Add a multiple of vectors (count, 8) at an address, by a weight, to those at another one."""

    def generate(ctx: Any, builder: Any, _: Any, arguments: Any) -> Any:
        values, weight, count, to = arguments
        fma, factor, size = _fma(builder), _splat(builder, weight), _ir().Constant(_ir().IntType(64), BYTES)
        with cgutils.for_range(builder, count) as loop:
            offset = builder.mul(loop.index, size)
            place = builder.add(to, offset)
            total = builder.call(fma, [_load(builder, builder.add(values, offset)), factor, _load(builder, place)])
            _store(builder, total, place)
        return ctx.get_dummy_value()

    return types.void(values, weight, count, to), generate
