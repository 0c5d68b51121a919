// Displacement of short strips by the pressure of near, longer ones, whose cells are split for this.
//
// Pressure that is constant in cells of length h bends the surface beside them by a staircase, which decays with the
// distance d like exp(-2 pi d / h). A strip that is not much longer than the steps could lie in several places on it.
#pragma once
#include "contact/models/lattice/influence/core/pair_tables.hpp"

namespace wr {

// Longest cell over the distance: up to there the steps have decayed, from there on all of it counts.
constexpr double STEPS[] = {1.0, 2.0};

using SplitShares = std::array<std::array<double, SPLITS>, 3>;

// Number of PARTS in which the cells of a loaded strip are split for the displacement of another one. There is none for
// a strip as long as the loaded one, or where the cells are shorter than the distance.
//
// length, loaded: m, of the displaced and of the loaded strip. distance: m, between their middles.
// to: written up to that number: shares from 0 to 1 of these parts in the displacement, instead of the fewer ones
//     before, and their derivatives 1/m by both lengths.
inline int split_shares(double length, double loaded, double distance, const StripBasis& basis, SplitShares& to) {
    double ratio = length / loaded, cell = basis.longest * loaded / distance;
    if (ratio >= 1.0) return 0;
    double square = ratio * ratio, shorter = 1.0 - square * square;
    for (int k = 0; k < SPLITS; ++k, cell *= 0.5) {
        if (cell <= STEPS[0]) return k;
        double t = std::min((cell - STEPS[0]) / (STEPS[1] - STEPS[0]), 1.0);
        double near = t * t * (3.0 - 2.0 * t), by_t = 6.0 * t * (1.0 - t);
        double by_ratio = -8.0 * (ratio * square) * shorter * near;
        double by_cell = shorter * shorter * by_t / (STEPS[1] - STEPS[0]);
        to[0][k] = shorter * shorter * near;
        to[1][k] = by_ratio / loaded;
        to[2][k] = (by_cell * cell - by_ratio * ratio) / loaded;
    }
    return SPLITS;
}

// Write the component NN of `look_up`, G (R, C), and its slope H if wanted, for two strips in any order: it is even in
// x, and the same in either order. False where distances exceed the tables.
template <bool slopes>
bool normal_table(const PairTables& tables, long displaced, long loaded, const Numbers& rows, const Numbers& columns,
                  const View<double, 2>& G, const View<double, 2>& H) {
    Pair pair(tables, std::min(displaced, loaded), std::max(displaced, loaded), farthest(rows, columns));
    for (long r = 0; r < rows.size(); ++r)
        for (long c = 0; c < columns.size(); ++c) {
            double x = rows(r) - columns(c), slope = 0.0;
            if (!pair.normal_at(x, G(r, c), slope)) return false;
            if constexpr (slopes) H(r, c) = std::copysign(1.0, x) * slope;
        }
    return true;
}

// Split cells of loaded strips, of a number of rows of displaced ones.
struct SplitCells {
    const StripBasis& basis;
    long rows, most = basis.split_marks.size();
    int count = 0;              // of PARTS
    long size = 0, stride = 0;  // number of boundaries, and how many of the finest parts lie from one to the next
    SplitShares shares{};
    Array<double, 1> places{most};  // (size,) m, boundaries
    Array<double, 3> edges{3L, most,
                           long(MODES)};  // jumps of loads less those of whole cells, and derivatives by lengths
    Array<double, 2> jumps{3L, most};     // (3, size) N/m, the same of the force
    Array<double, 1> G_store{rows * most}, H_store{rows * most};

    // Table values and slopes of a pair (rows, size).
    View<double, 2> G() const { return {G_store.data, {rows, size}}; }
    View<double, 2> H() const { return {H_store.data, {rows, size}}; }
    Numbers boundaries() const { return places.part(0, size); }

    // Split the cells of strip j for a strip of a length m at a distance m; false where they are not.
    //
    // pressure: (MODES,) Pa. kinds: 1, or 3 with derivatives.
    bool split(const StripGrid& grid, long j, double length, double distance, const Numbers& pressure, int kinds) {
        count = split_shares(length, grid.length(j), distance, basis, shares);
        if (count == 0) return false;
        size = basis.M() * PARTS[count - 1] + 1, stride = PARTS[SPLITS - 1] / PARTS[count - 1];
        for (long c = 0; c < size; ++c) places(c) = grid.x(j, 0) + grid.length(j) * mark(c);
        for (int kind = 0; kind < kinds; ++kind)
            for (long c = 0; c < size; ++c) {
                double jump = 0.0;
                for (int m = 0; m < MODES; ++m) {
                    double edge = 0.0;
                    for (int k = 0; k < count; ++k) edge += shares[kind][k] * basis.split_edges(k, stride * c, m);
                    edges(kind, c, m) = edge;
                    jump -= grid.width(j) * pressure(m) * edge;
                }
                jumps(kind, c) = jump;
            }
        return true;
    }
    double mark(long c) const { return basis.split_marks(stride * c); }
};

// Add to the antiderivative V (S, M + 3, 3) on short strips, by the pressure in values (S, block). False where
// distances exceed the tables.
inline bool add_short_strips(const PairTables& tables, const StripGrid& grid, const Rows& values,
                             const StripBasis& basis, bool rolls, const View<double, 3>& V) {
    long S = grid.size(), M = basis.M(), at = basis.block(rolls) - MOMENTS;
    SplitCells cells{basis, M + 1};
    for (long i = 0; i < S; ++i)
        for (long j = 0; j < S; ++j) {
            double distance = std::abs(grid.middle(i) - grid.middle(j));
            Numbers pressure = values[j].part(at, at + MODES), rows = grid.x[i].part(0, M + 1);
            if (i == j || !cells.split(grid, j, grid.length(i), distance, pressure, 1)) continue;
            auto G = cells.G();
            if (!normal_table<false>(tables, grid.strip(i), grid.strip(j), rows, cells.boundaries(), G, {}))
                return false;
            for (long r = 0; r <= M; ++r)
                for (long c = 0; c < cells.size; ++c) V(i, r, 2) += G(r, c) * cells.jumps(0, c);
        }
    return true;
}

// As `add_short_strips`, and add the derivatives of the moments by modes and ends to the operator A (n, n).
inline bool add_short_strips_derivative(const PairTables& tables, const StripGrid& grid, const Rows& values,
                                        const StripBasis& basis, bool rolls, const View<double, 2>& A,
                                        const View<double, 3>& V) {
    long S = grid.size(), M = basis.M(), block = basis.block(rolls), at = block - MOMENTS;
    SplitCells cells{basis, M + 1};
    Array<double, 2> changes(M + 1,
                             MODES + 4);  // by modes and ends of the loaded strip, and by the displaced one's ends
    for (long i = 0; i < S; ++i)
        for (long j = 0; j < S; ++j) {
            double distance = std::abs(grid.middle(i) - grid.middle(j));
            Numbers pressure = values[j].part(at, at + MODES), rows = grid.x[i].part(0, M + 1);
            if (i == j || !cells.split(grid, j, grid.length(i), distance, pressure, 3)) continue;
            auto G = cells.G(), H = cells.H();
            if (!normal_table<true>(tables, grid.strip(i), grid.strip(j), rows, cells.boundaries(), G, H)) return false;
            const auto& jumps = cells.jumps;
            double over = 1.0 / grid.length(i);
            std::fill(changes.begin(), changes.end(), 0.0);
            for (long r = 0; r <= M; ++r) {
                double total = 0.0, by_length = 0.0, by_loaded = 0.0, slope = 0.0, by_high = 0.0;
                for (long c = 0; c < cells.size; ++c) {
                    total += G(r, c) * jumps(0, c);
                    by_length += G(r, c) * jumps(1, c);
                    by_loaded += G(r, c) * jumps(2, c);
                    slope += H(r, c) * jumps(0, c);
                    by_high += H(r, c) * jumps(0, c) * cells.mark(c);
                    for (int m = 0; m < MODES; ++m) changes(r, m) -= grid.width(j) * G(r, c) * cells.edges(0, c, m);
                }
                V(i, r, 2) += total;
                double mark = basis.row_marks(r);
                for (int end = 0; end < 2; ++end) {
                    double sign = end ? 1.0 : -1.0, moved = end ? by_high : slope - by_high;
                    changes(r, MODES + end) = grid.stretch(j) * (sign * by_loaded - moved);
                    double own = slope * (end ? mark : 1.0 - mark) + sign * (by_length - over * total);
                    changes(r, MODES + 2 + end) = grid.stretch(i) * own;
                }
            }
            for (int k = 0; k < MOMENTS; ++k) {
                auto row = A[i * block + at + k];
                for (long r = 0; r <= M; ++r) {
                    double weight = over * basis.moment_edges(k, r);
                    for (int m = 0; m < MODES + 2; ++m) row(j * block + at + m) += weight * changes(r, m);
                    for (int end = 0; end < 2; ++end)
                        row(i * block + at + MODES + end) += weight * changes(r, MODES + 2 + end);
                }
            }
        }
    return true;
}

}  // namespace wr
