"""Linearly implicit Runge-Kutta (Rosenbrock-W) methods: one factorisation a step, no iteration, any Jacobian."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]
Rows = tuple[tuple[float, ...], ...]


@dataclass(frozen=True)
class Rosenbrock:
    """Stages k_i = f(t + a_i h, x + h sum_j<i a_ij k_j) + h A sum_j<=i g_ij k_j + h g_i f_t, with any matrix A near the
    Jacobian; solution x + h b.k, companion of error_order with other weights.

    alpha: rows a_ij of stages 2 to s; gamma: rows g_ij of the same, without the diagonal, which is one number.
    Raises ValueError for rows of wrong lengths, or weights that do not add up to one.
    """

    name: str
    order: int
    error_order: int
    diagonal: float
    alpha: Rows
    gamma: Rows
    weights: tuple[float, ...]
    companion: tuple[float, ...]

    def __post_init__(self) -> None:
        lengths = list(range(1, self.stages))
        if [len(r) for r in self.alpha] != lengths or [len(r) for r in self.gamma] != lengths:
            raise ValueError(f"{self.name}: rows of 1 to {self.stages - 1} coefficients are needed")
        if len(self.companion) != self.stages or any(abs(sum(w) - 1.0) > 1e-12 for w in (self.weights, self.companion)):
            raise ValueError(f"{self.name}: as many weights as stages, adding up to 1")

    @property
    def stages(self) -> int:
        return len(self.weights)

    @cached_property
    def nodes(self) -> Array:
        """(s,) times of the stages within the step."""
        return np.asarray(self.full_alpha.sum(axis=1))

    @cached_property
    def full_alpha(self) -> Array:
        """(s, s), strictly lower triangular."""
        return _square(self.alpha)

    @cached_property
    def full_gamma(self) -> Array:
        """(s, s), lower triangular."""
        return _square(self.gamma) + self.diagonal * np.eye(self.stages)

    @cached_property
    def sums(self) -> Array:
        """(s,) rows of gamma added up: shares of the derivative by time."""
        return np.asarray(self.full_gamma.sum(axis=1))

    @cached_property
    def inverse(self) -> Array:
        """(s, s): with u = h gamma k as unknowns, no stage needs a product with the Jacobian."""
        return np.asarray(np.linalg.inv(self.full_gamma), dtype=np.float64)

    @cached_property
    def shifts(self) -> Array:
        """(s, s) weights of the u for the states of the stages."""
        return np.asarray(self.full_alpha @ self.inverse)

    @cached_property
    def ends(self) -> Array:
        """(2, s) weights of the u for the solution and for its difference to the companion."""
        b, other = np.array(self.weights), np.array(self.companion)
        return np.asarray(np.stack([b, b - other]) @ self.inverse)


def _square(rows: Rows) -> Array:
    full = np.zeros((len(rows) + 1, len(rows) + 1))
    for i, row in enumerate(rows, start=1):
        full[i, :i] = row
    return full


# J. Rang, L. Angermann, BIT Numerical Mathematics 45 (2005) 761-787, DOI 10.1007/s10543-005-0035-y: order 3 with any
# matrix in place of the Jacobian, stiffly accurate.
ROS34PW2 = Rosenbrock(
    name="rosenbrock",
    order=3,
    error_order=2,
    diagonal=0.43586652150845899942,
    alpha=((0.87173304301691799883,), (0.84457060015369423945, -0.11299064236484185), (0.0, 0.0, 1.0)),
    gamma=(
        (-0.87173304301691799883,),
        (-0.90338057013044082163, 0.054180672388095326),
        (0.24212380706095346380, -1.2232505839045147, 0.54526025533510214),
    ),
    weights=(0.24212380706095346380, -1.2232505839045147, 1.5452602553351021, 0.43586652150845899942),
    companion=(0.37810903145819369, -0.096042292212423178, 0.5, 0.21793326075422950),
)
