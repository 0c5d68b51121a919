"""Two elastic half-spaces loaded on equal rectangles: Boussinesq's and Cerruti's closed forms, an oracle for tests.

Point loads (Johnson, Contact Mechanics, 1985, eqs. 3.19 and 3.75) integrated over a rectangle by antiderivatives in
both coordinates, each of which is easily differentiated back.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np

from wheelrail.contact.geometry.contact_operators import UPSTREAM
from wheelrail.contact.laws.material import Material
from wheelrail.support.arrays import Array


@dataclass(frozen=True)
class Cells:
    """Centres x, y (n,) m of cells dx by dy m."""

    x: Array
    y: Array
    dx: float
    dy: float

    @classmethod
    def inside_ellipse(cls, a: float, b: float, nx: int, ny: int) -> Cells:
        """The cells of an nx by ny grid over the ellipse's bounding box that have their centres inside."""
        dx, dy = 2 * a / nx, 2 * b / ny
        x, y = np.meshgrid((np.arange(nx) - (nx - 1) / 2) * dx, (np.arange(ny) - (ny - 1) / 2) * dy, indexing="ij")
        inside = (x / a) ** 2 + (y / b) ** 2 < 1
        return cls(x[inside], y[inside], dx, dy)

    @property
    def area(self) -> float:
        return self.dx * self.dy


@dataclass(frozen=True)
class HalfSpaces:
    """Relative compliance (upper minus lower) at cell centres by unit tractions on cells, acting on the upper body.

    Axes: x (rolling direction), y, and the outward normal of the upper body, downwards.
    """

    cells: Cells
    upper: Material
    lower: Material

    @cached_property
    def moduli(self) -> tuple[float, float, float]:
        """Sums over both bodies of (1 - nu) / G and nu / G; difference of (1 - 2 nu) / 2 G."""
        G = [s.E / 2 / (1 + s.nu) for s in (self.upper, self.lower)]
        nu = [self.upper.nu, self.lower.nu]
        return (
            sum((1 - n) / g for n, g in zip(nu, G, strict=True)),
            sum(n / g for n, g in zip(nu, G, strict=True)),
            (1 - 2 * nu[0]) / 2 / G[0] - (1 - 2 * nu[1]) / 2 / G[1],
        )

    def compliance(self, ahead: float = 0.0) -> Array:
        """(3, 3, n, n): component of displacement, component of traction, point a distance ahead of each centre,
        cell.
        """
        c = self.cells
        x, y = c.x[:, None] + ahead - c.x, c.y[:, None] - c.y
        total = np.zeros((3, 3, *x.shape))
        one, shear, turn = (m / (2 * np.pi) for m in self.moduli)
        for sx, sy in ((1, 1), (1, -1), (-1, 1), (-1, -1)):
            u, v = x + sx * c.dx / 2, y + sy * c.dy / 2
            r = np.hypot(u, v)
            # ln(v + r) = asinh(v / |u|) + ln|u|, and the last term drops out of the difference over v
            over_u, over_v = u * np.arcsinh(v / np.abs(u)), v * np.arcsinh(u / np.abs(v))
            inverse = over_u + over_v  # of 1 / r
            flat_u = v * np.log(r) + u * np.arctan(v / u)  # of u / r2
            flat_v = u * np.log(r) + v * np.arctan(u / v)  # of v / r2
            sign = sx * sy
            total[0, 0] += sign * (one * inverse + shear * over_v)  # over_v: of u2 / r3
            total[1, 1] += sign * (one * inverse + shear * over_u)
            total[0, 1] += sign * shear * -r  # of u v / r3
            total[2, 2] += sign * one * inverse
            # pressure on the upper body pulls its surface towards the load, and the lower one's too
            total[0, 2] += sign * turn * flat_u
            total[1, 2] += sign * turn * flat_v
        total[1, 0] = total[0, 1]
        total[2, 0], total[2, 1] = -total[0, 2], -total[1, 2]
        return total

    def operator(self, order: int) -> Array:
        """Rows slip x, slip y, penetration (3 n), columns tractions x, y, normal, as for `solve_tractions`."""
        n = len(self.cells.x)
        at = [self.compliance(k * self.cells.dx) for k in range(order + 1)]
        slip = sum(w * c[:2] for w, c in zip(UPSTREAM[order], at, strict=True)) / self.cells.dx
        both = np.concatenate([slip, at[0][2:]])
        return np.asarray(both.transpose(0, 2, 1, 3).reshape(3 * n, 3 * n))


def creepage(cells: Cells, xi: float, eta: float, spin: float) -> Array:
    """Rigid slip over speed (2 n,)."""
    return np.concatenate([xi - spin * cells.y, eta + spin * cells.x])


def forces(cells: Cells, q: Array) -> Array:
    """Resultants (Fx, Fy, Mz about the origin) of tangential tractions (n, 2)."""
    qx, qy = q.T
    return np.array([qx.sum(), qy.sum(), (cells.x * qy - cells.y * qx).sum()]) * cells.area
