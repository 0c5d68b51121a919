// Factors for cells that have begun to slip or to stick: a change of the Jacobian of low rank.
//
// Most Jacobians that are no longer close enough differ in the friction of a few cells, whose rows are linear in the
// slips and in the slopes of the law: J = J0 + E W, where E picks the rows of these cells, and (Sherman, Morrison,
// Woodbury)
//
//     J^-1 = J0^-1 - Z (1 + W Z)^-1 W J0^-1,  Z = J0^-1 E.
#pragma once
#include <vector>

#include "contact/models/lattice/solver/core/factors.hpp"

namespace wr {

constexpr double CHANGED = 0.3;       // of the slopes of a cell, without dimension: with smaller changes steps contract
constexpr double LARGEST_RANK = 0.2;  // rank over unknowns: of higher ones, new factors take less time

// Numbers (k,) of the cells whose slopes (S, M, SLOPES) have changed; rho (M,) 1/Pa.
inline std::vector<long> changed_cells(Blocks before, Blocks after, Numbers rho) {
    std::vector<long> cells;
    long M = before.shape[1];
    for (long i = 0; i < before.size(); ++i)
        for (long r = 0; r < M; ++r) {
            bool changed = false;
            for (int k = 0; k < SLOPES; ++k) {
                if (8 <= k && k < 10) continue;  // by the speed
                double size = std::abs(after(i, r, k) - before(i, r, k));
                changed |= (4 <= k && k < 8 ? size * rho(r) : size) > CHANGED;
            }
            if (changed) cells.push_back(i * M + r);
        }
    return cells;
}

// Changes (2 k, n) of the rows of some cells (k,) in the units of `Factors`, and the same rows of the unit matrix.
struct RowChanges {
    Array<float, 2> change, picked;

    RowChanges(const Factors& factors, Blocks slopes, const std::vector<long>& cells)
        : change(2 * long(cells.size()), factors.rows.size()), picked(change.shape) {
        long M = slopes.shape[1], n = factors.rows.size(), block = n / slopes.size();
        for (long k = 0; k < long(cells.size()); ++k) {
            long i = cells[k] / M, r = cells[k] % M, x = i * block + r, y = x + M;
            auto along = factors.slips[i][r], across = factors.slips[i][M + r];
            double scale = factors.rows(x);
            for (int a = 0; a < 2; ++a) {
                auto row = change[2 * k + a];
                auto by = [&](int slope) { return scale * (slopes(i, r, slope) - factors.slopes(i, r, slope)); };
                float first = float(by(4 + 2 * a)), second = float(by(5 + 2 * a));
                for (long c = 0; c < n; ++c) row(c) = first * along(c) + second * across(c);
                auto add = [&](long column, double slope) {
                    row(column) = float(row(column) + slope * factors.columns(column));
                };
                add(x, by(2 * a)), add(y, by(2 * a + 1));
                for (int m = 0; m < MODES; ++m) add(i * block + 2 * M + m, by(10 + 2 * m + a));
                picked(2 * k + a, x + a * M) = 1.0f;
            }
        }
    }
};

// Update the factors for cells whose friction slopes (S, M, SLOPES) changed; rho (M,) 1/Pa. The flag is false if none
// has changed since the latest factors, or too many since the Jacobian for a low-rank update.
inline std::pair<bool, Factors> renewed(const Factors& factors, const Array<double, 3>& slopes, Numbers rho) {
    if (changed_cells(factors.present, slopes, rho).empty()) return {false, factors};
    auto cells = changed_cells(factors.slopes, slopes, rho);
    long n = factors.rows.size(), rank = 2 * long(cells.size());
    if (double(rank) > LARGEST_RANK * double(n)) return {false, factors};
    RowChanges rows(factors, slopes, cells);
    back_substitute(factors, rows.picked);
    Factors after = factors;
    after.present = slopes, after.spread = Array<float, 2>(n, rank), after.gather = Array<float, 2>(rank, n);
    if (rank == 0) return {true, after};
    Array<float, 2> small(rank, rank), sides(n, rank);
    for (long r = 0; r < rank; ++r) {
        for (long k = 0; k < n; ++k) after.spread(k, r) = rows.picked(r, k), sides(k, r) = rows.change(r, k);
        for (long c = 0; c < rank; ++c) small(r, c) = dot(rows.change[r], rows.picked[c]);
        small(r, r) += 1.0f;
    }
    Array<int, 1> pivots(rank);
    if (!factorise<float>(small, pivots)) return {false, factors};
    solve<float>(small, pivots, sides);
    for (long r = 0; r < rank; ++r)
        for (long k = 0; k < n; ++k) after.gather(r, k) = sides(k, r);
    return {true, after};
}

}  // namespace wr
