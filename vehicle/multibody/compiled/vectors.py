"""Vectors of three numbers, real or complex, and matrices as three columns, in compiled code."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any, TypeVar

import numpy as np

from wheelrail.support.arrays import Array
from wheelrail.support.compiled import borrowing

F = TypeVar("F", bound=Callable[..., Any])

Number = Any  # float or complex
Vector = tuple[Number, Number, Number]
Matrix = tuple[Vector, Vector, Vector]  # columns


def analytic(function: F) -> F:
    """The function as machine code for real and, where derivatives are taken by complex steps, for complex numbers,
    without checks, which cost compile time; it neither makes nor returns arrays.
    """
    return borrowing(function)


@analytic
def store(values: Array, vector: Vector) -> None:
    """Fill three values."""
    values[0], values[1], values[2] = vector


@analytic
def load(values: Array) -> Vector:
    """Three values."""
    return values[0], values[1], values[2]


@analytic
def add(a: Vector, b: Vector) -> Vector:
    return a[0] + b[0], a[1] + b[1], a[2] + b[2]


@analytic
def subtract(a: Vector, b: Vector) -> Vector:
    return a[0] - b[0], a[1] - b[1], a[2] - b[2]


@analytic
def scale(factor: Number, a: Vector) -> Vector:
    return factor * a[0], factor * a[1], factor * a[2]


@analytic
def multiply(a: Vector, b: Vector) -> Vector:
    """Products of the components."""
    return a[0] * b[0], a[1] * b[1], a[2] * b[2]


@analytic
def dot(a: Vector, b: Vector) -> Number:
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]


@analytic
def cross(a: Vector, b: Vector) -> Vector:
    return a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]


@analytic
def rotate(matrix: Matrix, a: Vector) -> Vector:
    """Product of a matrix and a vector."""
    x, y, z = matrix
    return (
        x[0] * a[0] + y[0] * a[1] + z[0] * a[2],
        x[1] * a[0] + y[1] * a[1] + z[1] * a[2],
        x[2] * a[0] + y[2] * a[1] + z[2] * a[2],
    )


@analytic
def rotate_back(matrix: Matrix, a: Vector) -> Vector:
    """Product of a transposed matrix and a vector."""
    return dot(matrix[0], a), dot(matrix[1], a), dot(matrix[2], a)


@analytic
def product(a: Matrix, b: Matrix) -> Matrix:
    return rotate(a, b[0]), rotate(a, b[1]), rotate(a, b[2])


@analytic
def relative_rotation(a: Matrix, b: Matrix) -> Matrix:
    """Product of the transposed matrix a and b: axes b in the axes a."""
    return rotate_back(a, b[0]), rotate_back(a, b[1]), rotate_back(a, b[2])


@analytic
def transposed(a: Matrix) -> Matrix:
    x, y, z = a
    return (x[0], y[0], z[0]), (x[1], y[1], z[1]), (x[2], y[2], z[2])


@analytic
def plus(a: Matrix, b: Matrix) -> Matrix:
    return add(a[0], b[0]), add(a[1], b[1]), add(a[2], b[2])


@analytic
def times(factor: Number, a: Matrix) -> Matrix:
    return scale(factor, a[0]), scale(factor, a[1]), scale(factor, a[2])


@analytic
def crossing(a: Vector) -> Matrix:
    """Matrix of the product a x."""
    zero = 0.0 * a[0]
    return (zero, a[2], -a[1]), (-a[2], zero, a[0]), (a[1], -a[0], zero)


@analytic
def dyad(a: Vector, b: Vector) -> Matrix:
    """Matrix of the product a (b .)."""
    return scale(b[0], a), scale(b[1], a), scale(b[2], a)


@analytic
def similar(axes: Matrix, a: Matrix) -> Matrix:
    """A matrix in the components along axes, in those in which the axes are."""
    return product(product(axes, a), transposed(axes))


@analytic
def body_rotation(roll: Number, pitch: Number, yaw: Number) -> Matrix:
    """Rz(yaw) Rx(roll) Ry(pitch) of angles rad."""
    cr, sr, cp, sp, cy, sy = np.cos(roll), np.sin(roll), np.cos(pitch), np.sin(pitch), np.cos(yaw), np.sin(yaw)
    return (
        (cy * cp - sy * sr * sp, sy * cp + cy * sr * sp, -cr * sp),
        (-sy * cr, cy * cr, sr),
        (cy * sp + sy * sr * cp, sy * sp - cy * sr * cp, cr * cp),
    )


@analytic
def rotation_vector(matrix: Matrix) -> Vector:
    """Rotation vector rad of a rotation by less than pi."""
    x, y, z = matrix
    axial = (0.5 * (y[2] - z[1]), 0.5 * (z[0] - x[2]), 0.5 * (x[1] - y[0]))
    sine, cosine = np.sqrt(dot(axial, axial)), 0.5 * (x[0] + y[1] + z[2] - 1.0)
    if sine.real < 1e-8:
        return axial
    return scale(2.0 * np.arctan(sine / (1.0 + cosine)) / sine, axial)


@analytic
def rotation_matrix(vector: Vector) -> Matrix:
    """Rotation by a rotation vector rad, Rodrigues' formula."""
    squared = dot(vector, vector)
    angle = np.sqrt(squared)
    if angle.real < 1e-4:
        first, second = 1.0 - squared / 6.0, 0.5 - squared / 24.0
    else:
        first, second = np.sin(angle) / angle, 2.0 * (np.sin(0.5 * angle) / angle) ** 2
    x, y, z = vector
    return (
        (1.0 - second * (y * y + z * z), second * x * y + first * z, second * x * z - first * y),
        (second * x * y - first * z, 1.0 - second * (x * x + z * z), second * y * z + first * x),
        (second * x * z + first * y, second * y * z - first * x, 1.0 - second * (x * x + y * y)),
    )


@analytic
def moment_of_gradient(rotation: Vector, gradient: Vector) -> Vector:
    """Moment that does the work of the gradient of a potential by the rotation vector.

    Parameters:
        rotation: rad, by less than pi, of the upper in the axes of the lower body.
        gradient: of the potential by these components.

    Transposed inverse of the left Jacobian of rotations: m = g + r x g / 2 + c r x (r x g), c = 1/12 for small r.
    """
    squared = dot(rotation, rotation)
    angle = np.sqrt(squared)
    if angle.real < 1e-3:
        factor = 1.0 / 12.0 + squared / 720.0
    else:
        factor = 1.0 / squared - (1.0 + np.cos(angle)) / (2.0 * angle * np.sin(angle))
    first = cross(rotation, gradient)
    return add(gradient, add(scale(0.5, first), scale(factor, cross(rotation, first))))
