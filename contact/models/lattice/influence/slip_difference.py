"""Upstream difference formula of the elastic slip in the cells of a strip."""

from __future__ import annotations

from wheelrail.support.arrays import Array

AHEAD = 2  # cells in front of a strip, of the length of its first, in the upstream difference of the slip


def upstream(x: Array) -> tuple[Array, Array, Array]:
    """Weights (S, M) of u at the cell itself and the next two upstream in -du/dx there, second order, for means at
    places x (S, M + 2) m.
    """
    near, far = x[:, 1:-1] - x[:, :-2], x[:, 2:] - x[:, :-2]
    return (near + far) / (near * far), -far / (near * (far - near)), near / (far * (far - near))
