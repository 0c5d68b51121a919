"""Rotation matrices (..., 3, 3) and rotation vectors (..., 3)."""

from __future__ import annotations

import numpy as np

from wheelrail.contact.kinematics.frames import cross
from wheelrail.support.arrays import Array


def body_rotation(roll: Array, pitch: Array, yaw: Array) -> Array:
    """Rz(yaw) Rx(roll) Ry(pitch) of angles (...) rad."""
    (cr, sr), (cp, sp), (cy, sy) = ((np.cos(a), np.sin(a)) for a in (roll, pitch, yaw))
    rows = [
        [cy * cp - sy * sr * sp, -sy * cr, cy * sp + sy * sr * cp],
        [sy * cp + cy * sr * sp, cy * cr, sy * sp - cy * sr * cp],
        [-cr * sp, sr, cr * cp],
    ]
    return np.stack([np.stack(row, axis=-1) for row in rows], axis=-2)


def rotate(matrices: Array, vectors: Array) -> Array:
    """Products (..., 3) of matrices and vectors."""
    return np.asarray((matrices @ vectors[..., None])[..., 0])


def rotate_back(matrices: Array, vectors: Array) -> Array:
    """Products (..., 3) of transposed matrices and vectors."""
    return np.asarray((vectors[..., None, :] @ matrices)[..., 0, :])


def rotation_vector(matrices: Array) -> Array:
    """Rotation vectors rad of rotations by less than pi."""
    m = matrices
    axial = 0.5 * np.stack([m[..., 2, 1] - m[..., 1, 2], m[..., 0, 2] - m[..., 2, 0], m[..., 1, 0] - m[..., 0, 1]], -1)
    sine = np.linalg.norm(axial, axis=-1)
    angle = np.arctan2(sine, 0.5 * (np.trace(m, axis1=-2, axis2=-1) - 1.0))
    small = sine < 1e-8
    return np.asarray(axial * np.where(small, 1.0, angle / np.where(small, 1.0, sine))[..., None])


def rotation_matrix(vectors: Array) -> Array:
    """Rotations by rotation vectors rad, Rodrigues' formula."""
    angle = np.linalg.norm(vectors, axis=-1)[..., None, None]
    x, y, z = np.moveaxis(vectors, -1, 0)
    zero = np.zeros_like(x)
    cross = np.stack([np.stack(row, -1) for row in ((zero, -z, y), (z, zero, -x), (-y, x, zero))], -2)
    half_sine = np.sinc(angle / (2 * np.pi))
    return np.asarray(np.eye(3) + np.sinc(angle / np.pi) * cross + 0.5 * half_sine**2 * cross @ cross)


def moment_of_gradient(rotation: Array, gradient: Array) -> Array:
    """Moments (..., 3) that do the work of the gradient of a potential by the rotation vector.

    Parameters:
        rotation: (..., 3) rad, by less than pi, of the upper in the axes of the lower body.
        gradient: (..., 3) of the potential by these components.

    Transposed inverse of the left Jacobian of rotations: m = g + r x g / 2 + c r x (r x g), c = 1/12 for small r.
    """
    angle = np.linalg.norm(rotation, axis=-1, keepdims=True)
    small = angle < 1e-3
    a = np.where(small, 1.0, angle)
    factor = np.where(small, 1 / 12 + angle**2 / 720, 1 / a**2 - (1 + np.cos(a)) / (2 * a * np.sin(a)))
    first = cross(rotation, gradient)
    return np.asarray(gradient + 0.5 * first + factor * cross(rotation, first))
