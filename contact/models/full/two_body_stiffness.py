"""The stiffness of two bodies in one matrix, distributed over the ranks like the bodies."""

from __future__ import annotations

from typing import Any

import numpy as np
from petsc4py import PETSc

from wheelrail.contact.elasticity.solid_body import ElasticBody
from wheelrail.support.arrays import Array, Nodes


def two_body_stiffness(wheel: ElasticBody, rail: ElasticBody) -> Any:
    """K of both bodies N/m, PETSc, symmetric positive definite; on each rank the wheel's rows before the rail's."""
    ends = [body.stiffness.getOwnershipRanges() for body in (wheel, rail)]  # rows of rank k: from k to k + 1
    pointers: list[Nodes] = []
    columns: list[Nodes] = []
    values: list[Array] = []
    for number, body in enumerate((wheel, rail)):
        pointer, column, value = body.stiffness.getValuesCSR()
        owner = np.searchsorted(ends[number], column, side="right") - 1
        # rows of the wheel on rank k follow the rail's of the ranks below k; the rail's follow the wheel's up to k
        column = column + (ends[1][owner] if number == 0 else ends[0][owner + 1])
        pointers.append(pointer[number > 0 :] + (pointers[0][-1] if pointers else 0))
        columns.append(column)
        values.append(value)
    csr = tuple(np.concatenate(parts) for parts in (pointers, columns, values))
    rows, total = (sum(body.stiffness.getSizes()[0][k] for body in (wheel, rail)) for k in (0, 1))
    matrix = PETSc.Mat().createAIJ([[rows, total]] * 2, bsize=3, csr=csr, comm=wheel.ranks.comm)
    matrix.setOption(PETSc.Mat.Option.SPD, True)
    return matrix


def with_rigid_motions(matrix: Any, points: Array) -> Any:
    """The matrix with its near-null space for multigrid: the rigid motions of this rank's points (n, 3) m."""
    vectors: list[Any] = []
    for mode in rigid_motions(points).T:
        vector = matrix.createVecLeft()
        vector.array[:] = mode
        for previous in vectors:
            vector.axpy(-vector.dot(previous), previous)
        vector.normalize()
        vectors.append(vector)
    matrix.setNearNullSpace(PETSc.NullSpace().create(vectors=vectors, comm=matrix.comm))
    return matrix


def rigid_motions(points: Array) -> Array:
    """Rigid motions (3 n, 6) of points (n, 3) m, rotations about the origin, which is the same on all ranks."""
    modes = np.zeros((len(points), 3, 6))
    for axis in range(3):
        modes[:, axis, axis] = 1.0
        i, j = (axis + 1) % 3, (axis + 2) % 3
        modes[:, j, 3 + axis], modes[:, i, 3 + axis] = points[:, i], -points[:, j]
    return modes.reshape(-1, 6)
