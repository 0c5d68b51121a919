"""Compiled: mean compliance between the cells of strips from tables of its second antiderivative along x.

With G'' = C the compliance along x, the mean over cells [a1, a2] by loads on [b1, b2] is the second difference
(G(a2 - b1) + G(a1 - b2) - G(a2 - b2) - G(a1 - b1)) / ((a2 - a1) (b2 - b1)): four table values for any two cells.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from wheelrail.support.arrays import Array
from wheelrail.support.compiled import compiled

BEFORE = 2  # nodes of a table before x = 0, for the interpolation
ODD = (1, 2, 3, 6)  # of the nine components: xy, xz, yx, zx
EVEN = (0, 4, 5, 7, 8)


@dataclass(frozen=True)
class TableNodes:
    """Distances start sinh(rate n) of a table's nodes, n from -BEFORE to count - BEFORE - 1."""

    count: int
    start: float
    rate: float

    @classmethod
    def over(cls, count: int, first: float, reach: float) -> TableNodes:
        """Given number of nodes, spaced by about first at the start, up to a distance reach."""
        rate = 1.0 / count
        for _ in range(50):
            rate = float(np.arcsinh(reach * rate / first)) / (count - BEFORE - 4)
        return cls(count, first / rate, rate)

    @property
    def x(self) -> Array:
        return np.asarray(self.start * np.sinh(self.rate * np.arange(-BEFORE, self.count - BEFORE)))

    def up_to(self, x: float) -> int:
        """Number of nodes for distances up to x."""
        return min(int(np.arcsinh(x / self.start) / self.rate) + BEFORE + 5, self.count)


@compiled
def normal_table(near: Array, lacks: Array, stretch: Array, turn: Array, smooth: Array, factor: float) -> Array:
    """Table (pairs, nodes) of G along the normals of strips: near (pairs, nodes, 4) of half-spaces, less lacks (nodes,
    3), over the mean stretch (S,); turn (S, S) the cosine between two normals; smooth (pairs, nodes) to be added.
    """
    S, K = len(stretch), near.shape[1]
    table = np.empty((len(near), K))
    at = 0
    for i in range(S):
        for j in range(i, S):
            over = factor / (0.5 * (stretch[i] + stretch[j]))
            one, other = 0.5 * (1.0 + turn[i, j]) * over, -0.5 * (1.0 - turn[i, j]) * over
            for k in range(K):
                table[at, k] = (
                    one * (near[at, k, 2] - lacks[k, 2])
                    + other * (near[at, k, 1] - lacks[k, 1])
                    + factor * smooth[at, k]
                )
            at += 1
    return table


@compiled
def full_table(
    near: Array, lacks: Array, stretch: Array, tangent: Array, even: Array, odd: Array, factor: float
) -> Array:
    """Table (pairs, nodes, 9) of all components, displacement by force, in the body's axes; as `normal_table`.

    tangent (S, 2) of the strips; even (pairs, 5, nodes) and odd (pairs, 4, nodes) components to be added.
    """
    S, K = len(stretch), near.shape[1]
    table = np.empty((len(near), K, 9))
    at = 0
    for i in range(S):
        for j in range(i, S):
            over = factor / (0.5 * (stretch[i] + stretch[j]))
            y, z = tangent[i, 0] + tangent[j, 0], tangent[i, 1] + tangent[j, 1]
            length = np.sqrt(y * y + z * z)
            y, z = y / length, z / length
            for k in range(K):
                along = over * (near[at, k, 0] - lacks[k, 0])
                across = over * (near[at, k, 1] - lacks[k, 1])
                normal = over * (near[at, k, 2] - lacks[k, 2])
                mixed = over * near[at, k, 3]
                e, o, t = even[at, :, k], odd[at, :, k], table[at, k]
                t[0] = along + factor * e[0]
                t[4] = across * y * y + normal * z * z + factor * e[1]
                t[5] = (across - normal) * y * z + factor * e[2]
                t[7] = (across - normal) * y * z + factor * e[3]
                t[8] = across * z * z + normal * y * y + factor * e[4]
                t[1] = mixed * y + factor * o[0]
                t[2] = mixed * z + factor * o[1]
                # a load along x moves the others by the opposite sine
                t[3] = mixed * y - factor * o[2]
                t[6] = mixed * z - factor * o[3]
            at += 1
    return table


@compiled
def _place(z: float, rate: float) -> float:
    """Node coordinate of a distance z >= 0: arsinh z, faster as a logarithm, over the rate."""
    return float(np.log(z + np.sqrt(z * z + 1.0)) / rate)


@compiled
def _weights(t: float, w: Array) -> None:
    """Lagrange's weights w (6,) of nodes 0 .. 5 at t."""
    a, b, c, d, e, f = t, t - 1.0, t - 2.0, t - 3.0, t - 4.0, t - 5.0
    ab, ef, cd = a * b, e * f, c * d
    w[0] = -b * cd * ef / 120.0
    w[1] = a * cd * ef / 24.0
    w[2] = -ab * d * ef / 12.0
    w[3] = ab * c * ef / 12.0
    w[4] = -ab * cd * f / 24.0
    w[5] = ab * cd * e / 120.0


@compiled
def add_normal_means(total: Array, table: Array, edges: Array, area: Array, start: float, rate: float) -> bool:
    """Add the mean compliances between cells with edges (S, M + 1), times the area (n,) of the loaded ones, to total
    (n, n); table (pairs, nodes). False, with total invalid, where cells are farther apart than the table's end.
    """
    S, M, count = edges.shape[0], edges.shape[1] - 1, table.shape[1]
    w = np.empty(6)
    G = np.empty((M + 1, M + 1))
    at = -1
    for i in range(S):
        for j in range(i, S):
            at += 1
            line = table[at]
            for r in range(M + 1):
                for c in range(M + 1):
                    place = _place(abs(edges[i, r] - edges[j, c]) / start, rate)
                    first = int(place)
                    if first + 6 > count:
                        return False
                    _weights(place - first + BEFORE, w)
                    G[r, c] = (
                        w[0] * line[first]
                        + w[1] * line[first + 1]
                        + w[2] * line[first + 2]
                        + w[3] * line[first + 3]
                        + w[4] * line[first + 4]
                        + w[5] * line[first + 5]
                    )
            for r in range(M):
                for c in range(M):
                    lengths = (edges[i, r + 1] - edges[i, r]) * (edges[j, c + 1] - edges[j, c])
                    mean = (G[r + 1, c] + G[r, c + 1] - G[r, c] - G[r + 1, c + 1]) / lengths
                    m, n = i * M + r, j * M + c
                    total[m, n] += mean * area[n]
                    if i != j:
                        total[n, m] += mean * area[m]
    return True


@compiled
def means(rows: Array, columns: Array, table: Array, start: float, rate: float, G: Array, C: Array) -> bool:
    """Means C (9, R, M) between cells with edges rows (R + 1,) and columns (M + 1,) of two strips, table (nodes, 9);
    G (R + 1, M + 1, 9) is work space. False where cells are farther apart than the table's last node.
    """
    R, M, count = len(rows) - 1, len(columns) - 1, table.shape[0]
    w = np.empty(6)
    for r in range(R + 1):
        for c in range(M + 1):
            x = rows[r] - columns[c]
            place = _place(abs(x) / start, rate)
            first = int(place)
            if first + 6 > count:
                return False
            _weights(place - first + BEFORE, w)
            sign = 1.0 if x > 0.0 else (-1.0 if x < 0.0 else 0.0)
            g = G[r, c]
            for k in range(9):
                g[k] = (
                    w[0] * table[first, k]
                    + w[1] * table[first + 1, k]
                    + w[2] * table[first + 2, k]
                    + w[3] * table[first + 3, k]
                    + w[4] * table[first + 4, k]
                    + w[5] * table[first + 5, k]
                )
            g[1], g[2], g[3], g[6] = sign * g[1], sign * g[2], sign * g[3], sign * g[6]
    for r in range(R):
        for c in range(M):
            over = 1.0 / ((rows[r + 1] - rows[r]) * (columns[c + 1] - columns[c]))
            for k in range(9):
                C[k, r, c] = over * (G[r + 1, c, k] + G[r, c + 1, k] - G[r, c, k] - G[r + 1, c + 1, k])
    return True


@compiled
def add_all_means(
    displacement: Array,
    slip: Array,
    table: Array,
    edges: Array,
    axes: Array,
    area: Array,
    weight: Array,
    turn: Array,
    start: float,
    rate: float,
) -> bool:
    """Add displacement (3, n, 3, n) and slip (2, n, 3, n) in the local axes (n, 3, 3) of the cells, component by
    component, times the area (n,) of the loaded ones; table (pairs, nodes, 9).

    edges (S, M + 3) of the strips' cells and of two more ahead of each; weight (3, S, M) of the displacements at a cell
    and the next two ahead in its slip, and turn (3, S, M) rad by which the body's axes turn (about y) up to these.
    False, with both spoilt, where cells are farther apart than the table reaches.
    """
    S, R = edges.shape[0], edges.shape[1] - 1
    G, C, back, L = np.empty((R + 1, R + 1, 9)), np.empty((9, R, R)), np.empty((9, R, R)), np.empty((3, R, R - 2))
    own = np.empty((3, R - 2))
    at = -1
    for i in range(S):
        for j in range(i, S):
            at += 1
            if not means(edges[i], edges[j], table[at], start, rate, G, C):
                return False
            _add(displacement, slip, C, i, j, axes, area, weight, turn, L, own)
            if i != j:
                # reciprocity: the displacement of j by a load on i equals that of i by a load on j
                for a in range(3):
                    for b in range(3):
                        for r in range(R):
                            for c in range(R - 2):
                                back[3 * a + b, r, c] = C[3 * b + a, c, r]
                _add(displacement, slip, back, j, i, axes, area, weight, turn, L, own)
    return True


@compiled
def _add(
    displacement: Array,
    slip: Array,
    C: Array,
    i: int,
    j: int,
    axes: Array,
    area: Array,
    weight: Array,
    turn: Array,
    L: Array,
    own: Array,
) -> None:
    """Add the displacement of strip i by loads on strip j, from the means C (9, M + 2, M + 2); L, own: work space."""
    R, M = L.shape[1], L.shape[2]
    first = j * M
    for b in range(3):
        for k in range(3):
            for c in range(M):
                own[k, c] = area[first + c] * axes[first + c, b, k]
        for a in range(3):  # columns in the local axes of the loaded cells
            for r in range(R):
                for c in range(M):
                    L[a, r, c] = (
                        C[3 * a, r, c] * own[0, c] + C[3 * a + 1, r, c] * own[1, c] + C[3 * a + 2, r, c] * own[2, c]
                    )
        for r in range(M):
            m = i * M + r
            w0, w1, w2 = weight[0, i, r], weight[1, i, r], weight[2, i, r]
            # the circle's axes rotate between the cells: e' = e - r turn, r' = r + e turn
            t1, t2 = w1 * turn[1, i, r], w2 * turn[2, i, r]
            for d in range(3):
                x, y, z = axes[m, d, 0], axes[m, d, 1], axes[m, d, 2]
                to = displacement[d, m, b]
                for c in range(M):
                    to[first + c] += x * L[0, r, c] + y * L[1, r, c] + z * L[2, r, c]
            for d in range(2):
                x, y, z = axes[m, d, 0], axes[m, d, 1], axes[m, d, 2]
                x0, y0, z0 = x * w0, y * w0, z * w0
                x1, y1, z1 = x * w1 - z * t1, y * w1, z * w1 + x * t1
                x2, y2, z2 = x * w2 - z * t2, y * w2, z * w2 + x * t2
                to = slip[d, m, b]
                for c in range(M):
                    to[first + c] += (
                        (x0 * L[0, r, c] + y0 * L[1, r, c] + z0 * L[2, r, c])
                        + (x1 * L[0, r + 1, c] + y1 * L[1, r + 1, c] + z1 * L[2, r + 1, c])
                        + (x2 * L[0, r + 2, c] + y2 * L[1, r + 2, c] + z2 * L[2, r + 2, c])
                    )
