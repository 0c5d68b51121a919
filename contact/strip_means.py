"""Compiled: mean compliance between the cells of strips from tables of its second antiderivative along x.

With G'' = C the compliance along x, the mean over cells [a1, a2] by loads on [b1, b2] is the second difference
(G(a2 - b1) + G(a1 - b2) - G(a2 - b2) - G(a1 - b1)) / ((a2 - a1) (b2 - b1)): four look-ups for any two cells.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from contact.pose import Array
from meshes.compiled import compiled

BEFORE = 2  # nodes of a table before x = 0, for the interpolation
ODD = (1, 2, 3, 6)  # of the nine components: xy, xz, yx, zx
EVEN = (0, 4, 5, 7, 8)


@dataclass(frozen=True)
class Nodes:
    """Distances start sinh(rate n) of a table's nodes, n from -BEFORE to count - BEFORE - 1."""

    count: int
    start: float
    rate: float

    @classmethod
    def over(cls, count: int, first: float, reach: float) -> Nodes:
        """So many nodes, the first about first apart, up to a distance reach."""
        rate = 1.0 / count
        for _ in range(50):
            rate = float(np.arcsinh(reach * rate / first)) / (count - BEFORE - 4)
        return cls(count, first / rate, rate)

    @property
    def x(self) -> Array:
        return np.asarray(self.start * np.sinh(self.rate * np.arange(-BEFORE, self.count - BEFORE)))


@compiled
def normal_table(near: Array, lacks: Array, stretch: Array, turn: Array, smooth: Array, factor: float) -> Array:
    """Table (S, S, nodes) of G along the normals of strips: near (S, S, nodes, 4) of half-spaces, less lacks (nodes,
    3), over the mean stretch (S,); turn (S, S) the cosine between two normals; smooth (S, S, nodes) to be added.
    """
    S, K = near.shape[0], near.shape[2]
    table = np.empty((S, S, K))
    for i in range(S):
        for j in range(S):
            over = factor / (0.5 * (stretch[i] + stretch[j]))
            one, other = 0.5 * (1.0 + turn[i, j]) * over, -0.5 * (1.0 - turn[i, j]) * over
            for k in range(K):
                table[i, j, k] = (
                    one * (near[i, j, k, 2] - lacks[k, 2])
                    + other * (near[i, j, k, 1] - lacks[k, 1])
                    + factor * smooth[i, j, k]
                )
    return table


@compiled
def full_table(
    near: Array, lacks: Array, stretch: Array, tangent: Array, even: Array, odd: Array, factor: float
) -> Array:
    """Table (S, S, nodes, 9) of all components, displacement by force, in the body's axes; as `normal_table`.

    tangent (S, 2) of the strips; even (S, S, 5, nodes) and odd (S, S, 4, nodes) components to be added.
    """
    S, K = near.shape[0], near.shape[2]
    table = np.empty((S, S, K, 9))
    for i in range(S):
        for j in range(S):
            over = factor / (0.5 * (stretch[i] + stretch[j]))
            y, z = tangent[i, 0] + tangent[j, 0], tangent[i, 1] + tangent[j, 1]
            length = np.sqrt(y * y + z * z)
            y, z = y / length, z / length
            for k in range(K):
                along = over * (near[i, j, k, 0] - lacks[k, 0])
                across = over * (near[i, j, k, 1] - lacks[k, 1])
                normal = over * (near[i, j, k, 2] - lacks[k, 2])
                mixed = over * near[i, j, k, 3]
                e, o, t = even[i, j, :, k], odd[i, j, :, k], table[i, j, k]
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
    return table


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
    (n, n). False, with total spoilt, where cells are farther apart than the table reaches.
    """
    S, M, count = edges.shape[0], edges.shape[1] - 1, table.shape[2]
    w = np.empty(6)
    G = np.empty((M + 1, M + 1))
    for i in range(S):
        for j in range(i, S):
            line = table[i, j]
            for r in range(M + 1):
                for c in range(M + 1):
                    place = np.arcsinh(abs(edges[i, r] - edges[j, c]) / start) / rate
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
    """Means C (R, M, 9) between cells with edges rows (R + 1,) and columns (M + 1,) of two strips, table (nodes, 9)."""
    R, M, count = len(rows) - 1, len(columns) - 1, table.shape[0]
    w = np.empty(6)
    for r in range(R + 1):
        for c in range(M + 1):
            x = rows[r] - columns[c]
            place = np.arcsinh(abs(x) / start) / rate
            first = int(place)
            if first + 6 > count:
                return False
            _weights(place - first + BEFORE, w)
            g = G[r, c]
            for k in range(9):
                g[k] = w[0] * table[first, k]
            for o in range(1, 6):
                for k in range(9):
                    g[k] += w[o] * table[first + o, k]
            if x < 0.0:
                g[1], g[2], g[3], g[6] = -g[1], -g[2], -g[3], -g[6]
            elif x == 0.0:
                g[1] = g[2] = g[3] = g[6] = 0.0
    for r in range(R):
        for c in range(M):
            over = 1.0 / ((rows[r + 1] - rows[r]) * (columns[c + 1] - columns[c]))
            for k in range(9):
                C[r, c, k] = over * (G[r + 1, c, k] + G[r, c + 1, k] - G[r, c, k] - G[r + 1, c + 1, k])
    return True


@compiled
def add_all_means(
    displacement: Array,
    slip: Array,
    table: Array,
    rows: Array,
    columns: Array,
    axes: Array,
    area: Array,
    weight: Array,
    turn: Array,
    start: float,
    rate: float,
) -> bool:
    """Add displacement (3, n, 3, n) and slip (2, n, 3, n) in the local axes (n, 3, 3) of the cells, component by
    component, times the area (n,) of the loaded ones.

    rows (S, M + k) edges of the strips' cells and of k - 1 more ahead of each; columns (S, M + 1); weight (k, S, M) of
    the displacements at a cell and the next ones ahead in its slip, and turn (k, S, M) rad by which the body's axes
    turn (about y) up to these.
    """
    S, M, ahead = columns.shape[0], columns.shape[1] - 1, len(weight)
    R = rows.shape[1] - 1
    G, C, L = np.empty((R + 1, M + 1, 9)), np.empty((R, M, 9)), np.empty((R, 3, 3))
    change = np.empty((3, 3))
    for i in range(S):
        for j in range(S):
            if not means(rows[i], columns[j], table[i, j], start, rate, G, C):
                return False
            for c in range(M):
                n = j * M + c
                own = axes[n]
                for r in range(R):  # columns in the local axes of the loaded cell
                    for a in range(3):
                        for b in range(3):
                            L[r, a, b] = area[n] * (
                                C[r, c, 3 * a] * own[b, 0]
                                + C[r, c, 3 * a + 1] * own[b, 1]
                                + C[r, c, 3 * a + 2] * own[b, 2]
                            )
                for r in range(M):
                    m = i * M + r
                    seen = axes[m]
                    for b in range(3):
                        for a in range(3):
                            change[a, b] = weight[0, i, r] * L[r, a, b]
                        for k in range(1, ahead):
                            # the circle's axes turn on the way: e' = e - r turn, r' = r + e turn
                            t, part = turn[k, i, r], weight[k, i, r]
                            change[0, b] += part * (L[r + k, 0, b] + t * L[r + k, 2, b])
                            change[1, b] += part * L[r + k, 1, b]
                            change[2, b] += part * (L[r + k, 2, b] - t * L[r + k, 0, b])
                        for d in range(3):
                            displacement[d, m, b, n] += (
                                seen[d, 0] * L[r, 0, b] + seen[d, 1] * L[r, 1, b] + seen[d, 2] * L[r, 2, b]
                            )
                        for d in range(2):
                            slip[d, m, b, n] += (
                                seen[d, 0] * change[0, b] + seen[d, 1] * change[1, b] + seen[d, 2] * change[2, b]
                            )
    return True
