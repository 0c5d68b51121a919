// Compliance between single cells, for starts, and displacements beside the loaded strips.
#pragma once
#include "contact/models/lattice/influence/core/operator.hpp"
#include "contact/models/lattice/influence/core/short_strips.hpp"

namespace wr {

using Compliance = View<double, 4>;  // (R, C, 3, 3) displacement (row) by force (column)

// Displacement by force from table values (R, C, 8); turned: (C, R, ..).
inline void store_compliance(const Blocks& G, double turn, const Compliance& K) {
    for (long r = 0; r < G.shape[0]; ++r)
        for (long c = 0; c < G.shape[1]; ++c) {
            auto g = G[r][c];
            auto k = turn > 0.0 ? K[r][c] : K[c][r];
            k(0, 0) = g(XX), k(0, 1) = g(XT), k(0, 2) = turn * (g(XN) + g(ROLL));
            k(1, 0) = g(XT), k(1, 1) = g(TT), k(1, 2) = g(TN) + turn * g(TN_TURN);
            k(2, 0) = -turn * g(XN), k(2, 1) = g(TN) - turn * g(TN_TURN), k(2, 2) = g(NN);
        }
}

// Slips and displacements of the cells of strip i by unit tractions on the cells of strip j, into A (3, n, 3, n).
inline void store_cells(const Compliance& K, long i, long j, const StripGrid& grid, const StripBasis& basis,
                        const View<double, 4>& A) {
    long M = basis.M();
    double width = grid.width(j), over = 1.0 / grid.length(i), per_slip = slip_power(over, basis);
    for (long c = 0; c < M; ++c)
        for (long r = 0; r < M; ++r)
            for (int b = 0; b < 3; ++b) {
                long m = i * M + r, n = j * M + c;
                double first = K(r, c, 2, b) - K(r, c + 1, 2, b);
                double second = K(r + 1, c, 2, b) - K(r + 1, c + 1, 2, b);
                A(2, m, b, n) = width * (second - first) * over / (basis.marks(r + 1) - basis.marks(r));
                for (int a = 0; a < 2; ++a) {
                    double total = 0.0;
                    for (int k = 0; k < 4; ++k)
                        total += basis.slip_edges(r, k) * (K(r + k, c, a, b) - K(r + k, c + 1, a, b));
                    A(a, m, b, n) = width * per_slip * total;
                }
            }
}

// Slips along and across and relative normal displacement of all n cells by unit tractions (along, across, pressure):
// (3 n, 3 n), or without rolling displacement by pressure alone (n, n); rows and columns component by component. The
// flag is false where distances exceed the tables.
inline std::pair<bool, Array<double, 2>> cell_operator(const PairTables& tables, const StripGrid& grid,
                                                       const StripBasis& basis, bool rolls) {
    long S = grid.size(), R = basis.M() + 3, n = S * basis.M();
    Array<double, 2> A(3 * n, 3 * n);
    View<double, 4> blocks{A.data, {3, n, 3, n}};
    Array<double, 3> G(R, R, LANES);
    Array<double, 4> K(R, R, 3, 3);
    for (long i = 0; i < S; ++i)
        for (long j = i; j < S; ++j) {
            if (!look_up<false>(tables, grid.strip(i), grid.strip(j), grid.x[i], grid.x[j], G, {})) return {false, A};
            store_compliance(G, 1.0, K);
            store_cells(K, i, j, grid, basis, blocks);
            if (i == j) continue;
            store_compliance(G, -1.0, K);
            store_cells(K, j, i, grid, basis, blocks);
        }
    if (rolls) return {true, A};
    Array<double, 2> by_pressure(n, n);
    for (long m = 0; m < n; ++m)
        for (long c = 0; c < n; ++c) by_pressure(m, c) = blocks(2, m, 2, c);
    return {true, by_pressure};
}

// Relative normal displacement (n, C) m of cells on n unloaded strips, and whether all distances lie in the tables.
//
// tables: of the pairs of strips. strips, middle: (n,) numbers of the unloaded ones, and m.
// edges: (n, C + 1) m, by length on the surface.
// grid, values (S, block), jumps (S, M + 1, 3), basis: of the loaded strips.
inline std::pair<bool, Array<double, 2>> normal_displacements(const PairTables& tables, const Indices& strips,
                                                              const Numbers& middle, const Rows& edges,
                                                              const StripGrid& grid, const Rows& values,
                                                              const Blocks& jumps, const StripBasis& basis,
                                                              bool rolls) {
    long n = edges.size(), C = edges.shape[1] - 1, S = grid.size(), M = basis.M();
    long at = basis.block(rolls) - MOMENTS;
    Array<double, 2> displacement(n, C);
    Array<double, 3> G(C + 1, M + 1, LANES);
    SplitCells split{basis, C + 1};
    for (long i = 0; i < n; ++i)
        for (long j = 0; j < S; ++j) {
            auto rows = edges[i];
            long first = std::min(strips(i), grid.strip(j)), last = std::max(strips(i), grid.strip(j));
            double turn =
                strips(i) == first ? 1.0 : -1.0;  // reciprocity: the transposed table at the opposite distance
            double before = 0.0;
            // Add means over the cells, from an antiderivative at their boundaries.
            auto add = [&](long r, double total) {
                if (r > 0) displacement(i, r - 1) += (total - before) / (rows(r) - rows(r - 1));
                before = total;
            };
            if (!look_up<false>(tables, first, last, rows, grid.x[j].part(0, M + 1), G, {}, turn))
                return {false, displacement};
            for (long r = 0; r <= C; ++r) {
                auto [x, t, normal] = products<3>(vectors(G[r]), jumps[j]);
                add(r, normal[NN] + t[TN] - turn * (x[XN] + t[TN_TURN]));
            }
            double distance = std::abs(middle(i) - grid.middle(j));
            if (!split.split(grid, j, 0.0, distance, values[j].part(at, at + MODES), 1)) continue;
            auto table = split.G();
            if (!normal_table<false>(tables, strips(i), grid.strip(j), rows, split.boundaries(), table, {}))
                return {false, displacement};
            for (long r = 0; r <= C; ++r) {
                double total = 0.0;
                for (long c = 0; c < split.size; ++c) total += table(r, c) * split.jumps(0, c);
                add(r, total);
            }
        }
    return {true, displacement};
}

}  // namespace wr
