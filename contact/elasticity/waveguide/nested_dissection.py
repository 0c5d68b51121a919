"""Elimination of a section's interior by nested dissection, down to the nodes of its surface.

Required is the inverse of the stiffness on the surface only, the inverse of a Schur complement. Eliminating the
interior front by front with dense blocks costs a small part of a solve for every surface load, and the order of
elimination is the same for all wavenumbers (George, doi 10.1137/0710032; fronts: Duff and Reid, doi
10.1145/356044.356047). At 6036 unknowns with 471 surface loads a wavenumber takes a seventh of a factorisation and the
solves for all loads with MUMPS, and a twentieth with SuperLU.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import scipy.sparse as sp
from scipy.linalg import blas, lapack

from wheelrail.support.arrays import Array, Mask, Nodes

LEAF = 24  # nodes not divided further: dense blocks of about 70 unknowns


@dataclass(frozen=True)
class Front:
    """Frontal matrix: dense block of the unknowns to eliminate and of their coupled unknowns.

    Parameters:
        count: unknowns to eliminate, the first ones.
        size: of the block.
        unknowns: (size,), numbers in the matrix.
        entries, positions: indices into the sparse matrix's values, and into the flattened block.
        children: earlier fronts whose remainders are added, and where: ranges of rows and columns in the remainder, and
            in the block. Nodes have the same order in every front, so that ranges are few and long.
    """

    count: int
    size: int
    unknowns: Nodes
    entries: Nodes
    positions: Nodes
    children: tuple[tuple[int, tuple[tuple[slice, slice], ...]], ...]


@dataclass(frozen=True)
class Dissection:
    """Fronts in order of elimination; the last one eliminates nothing and holds the kept unknowns, in their order."""

    fronts: tuple[Front, ...]

    def schur(self, values: Array) -> Array:
        """Schur complement on the kept unknowns, its lower triangle, from the values of the sparse matrix.

        Raises LinAlgError unless the matrix is positive definite.
        """
        return self._eliminate(values, None)

    def solve(self, values: Array, load: Array, size: int) -> Array:
        """Displacements (size, m) of all unknowns, zero at fixed ones.

        Parameters:
            values: of the sparse matrix.
            load: (kept, m), on the kept unknowns.
            size: number of unknowns.

        Raises LinAlgError unless the matrix is positive definite.
        """
        steps: list[tuple[Front, Array, Array]] = []
        factor, status = lapack.dpotrf(self._eliminate(values, steps), lower=1, clean=0)
        if status:
            raise np.linalg.LinAlgError("the stiffness of the surface is not positive definite")
        displacement = np.zeros((size, load.shape[1]))
        displacement[self.fronts[-1].unknowns] = lapack.dpotrs(factor, load, lower=1)[0]
        for front, factor, half in reversed(steps):
            held = half.T @ displacement[front.unknowns[front.count :]]
            displacement[front.unknowns[: front.count]] = -lapack.dtrtrs(factor, held, lower=1, trans=1)[0]
        return displacement

    def _eliminate(self, values: Array, steps: list[tuple[Front, Array, Array]] | None) -> Array:
        """The Schur complement; every front's factor L and A21 L^-T are appended to the steps unless None. Of blocks
        only the lower triangle counts.
        """
        remainders: list[Array] = []
        block = np.empty((0, 0))
        for front in self.fronts:
            n = front.count
            entries = np.zeros(front.size**2)
            entries[front.positions] = values[front.entries]
            block = entries.reshape(front.size, front.size).T  # in LAPACK's order; rows become columns
            for child, ranges in front.children:
                for k, (row, to_row) in enumerate(ranges):
                    for column, to_column in ranges[: k + 1]:
                        block[to_row, to_column] += remainders[child][row, column]
                remainders[child] = np.empty(0)
            if n == 0:
                remainders.append(block)
                continue
            factor, status = lapack.dpotrf(block[:n, :n], lower=1, clean=0)
            if status:
                raise np.linalg.LinAlgError("the section's stiffness is not positive definite: it must be clamped")
            half = blas.dtrsm(1.0, factor, block[n:, :n], side=1, lower=1, trans_a=1)
            remainders.append(blas.dsyrk(-1.0, half, beta=1.0, c=block[n:, n:], lower=1))
            if steps is not None:
                steps.append((front, factor, half))
        return block

    def flexibility(self, values: Array) -> Array:
        """Inverse of the Schur complement, symmetric."""
        factor, status = lapack.dpotrf(self.schur(values), lower=1, clean=0)
        if status:
            raise np.linalg.LinAlgError("the stiffness of the surface is not positive definite")
        inverse, _ = lapack.dpotri(factor, lower=1, overwrite_c=1)
        lower = np.tril(inverse)
        return np.asarray(lower + np.tril(inverse, -1).T)


def dissect(pointer: Nodes, columns: Nodes, points: Array, *, kept: Nodes, fixed: Nodes, block: int = 3) -> Dissection:
    """Order of elimination for a symmetric sparse matrix.

    Parameters:
        pointer, columns: of its rows (CSR).
        points: (n, 2), positions of the nodes.
        kept: (ns,) nodes that remain, in that order.
        fixed: nodes that are omitted.
        block: unknowns of each node.
    """
    n = len(points)
    nodes = sp.csr_array(
        (np.ones(len(columns[pointer[0] : pointer[-1]]), dtype=np.int8), columns // block, pointer),
        shape=(n * block, n),
    )[::block]
    graph = sp.csr_array((np.ones(nodes.nnz, dtype=np.int8), nodes.indices, nodes.indptr), shape=(n, n))
    graph.sum_duplicates()
    interior = np.ones(n, dtype=bool)
    interior[kept] = interior[fixed] = False
    tree: list[tuple[Nodes, tuple[int, ...]]] = []
    top = _split(np.flatnonzero(interior), points, graph, tree)
    tree.append((kept[:0], top))
    return Dissection(tuple(_fronts(tree, pointer, columns, graph, kept, fixed, block)))


def _split(
    members: Nodes, points: Array, graph: sp.csr_array, tree: list[tuple[Nodes, tuple[int, ...]]]
) -> tuple[int, ...]:
    """Append the fronts that eliminate the members, children first; returns the numbers of the topmost ones."""
    if len(members) > LEAF:
        best: tuple[Nodes, Nodes, Nodes] | None = None
        for axis in (0, 1):
            value = points[members, axis]
            right = value > np.median(value)
            if right.all() or not right.any():
                continue
            side = np.zeros(graph.shape[0], dtype=np.int8)
            side[members[right]] = 1
            across = (graph[members[~right]] @ side) > 0
            parts = members[~right][across], members[~right][~across], members[right]
            if best is None or len(parts[0]) < len(best[0]):
                best = parts
        if best is not None and len(best[0]) < len(members) // 2:
            separator, *halves = best
            separator = separator[np.lexsort(points[separator].T)]  # what touches a part of it touches a range
            below = tuple(t for half in halves if len(half) for t in _split(half, points, graph, tree))
            tree.append((separator, below))
            return (len(tree) - 1,)
    tree.append((members, ()))
    return (len(tree) - 1,)


def _fronts(
    tree: list[tuple[Nodes, tuple[int, ...]]],
    pointer: Nodes,
    columns: Nodes,
    graph: sp.csr_array,
    kept: Nodes,
    fixed: Nodes,
    block: int,
) -> list[Front]:
    """Sizes, index maps and matrix entries of every front."""
    done: Mask = np.zeros(graph.shape[0], dtype=bool)
    done[fixed] = True
    where = np.full(graph.shape[0], -1)
    touched: list[Nodes] = []
    fronts: list[Front] = []
    rank = np.empty(graph.shape[0], dtype=np.int64)
    eliminated = np.concatenate([*(members for members, _ in tree), kept])
    rank[eliminated] = np.arange(len(eliminated))

    def unknowns(nodes: Nodes) -> Nodes:
        return np.asarray((block * nodes[:, None] + np.arange(block)).ravel())

    for members, below in tree:
        last = len(fronts) == len(tree) - 1
        rows = kept if last else members
        done[members] = True
        near = np.unique(np.concatenate([graph[members].indices, *(touched[b] for b in below)]))
        beyond = rows[:0] if last else near[~done[near]]
        beyond = beyond[np.argsort(rank[beyond])]
        order = np.concatenate([rows, beyond]).astype(np.int64)
        touched.append(beyond)
        where[order] = np.arange(len(order))
        size = block * len(order)
        lines = unknowns(rows)
        length = pointer[lines + 1] - pointer[lines]
        entry = np.repeat(pointer[lines] - np.cumsum(length) + length, length) + np.arange(length.sum())
        column = columns[entry]
        node = where[column // block]
        present = node >= 0
        position = np.repeat(np.arange(len(lines)) * size, length) + node * block + column % block
        children = tuple((b, _ranges(where[touched[b]], block)) for b in below)
        fronts.append(Front(block * len(members), size, unknowns(order), entry[present], position[present], children))
        where[order] = -1
    return fronts


def _ranges(places: Nodes, block: int) -> tuple[tuple[slice, slice], ...]:
    """Ranges of unknowns of consecutive nodes with consecutive positions, and the corresponding ranges of positions."""
    ends = np.flatnonzero(np.diff(places) != 1) + 1
    return tuple(
        (slice(block * a, block * b), slice(block * places[a], block * (places[b - 1] + 1)))
        for a, b in zip([0, *ends], [*ends, len(places)], strict=True)
        if a < b
    )
