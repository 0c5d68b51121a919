// LU factors of the Jacobian of a contact on a lattice, in single precision.
//
// With scaled unknowns and equations the Jacobian's condition is some 1e3, so that steps err by some 1e-6 of
// themselves. Residuals are exact: steps converge to the same solution, and factors take half of the time and memory.
#pragma once
#include <cmath>
#include <utility>

#include "contact/models/lattice/influence/core/basis.hpp"
#include "contact/models/lattice/system/core/equation_data.hpp"
#include "support/core/lu.hpp"

namespace wr {

constexpr int REFINEMENTS = 2;                             // of a solution to double precision
constexpr double REFINED = 1e-6;                           // of the solution: largest error left
constexpr double STRESS = 1e9, LENGTH = 1e-3, GAP = 1e-6;  // Pa, m, m: scales of the unknowns and of the moments

// Factors of the Jacobian (n, n) of a state with values (S, block), in units of STRESS, LENGTH and GAP.
struct Factors {
    Array<float, 2> lu;              // (n, n)
    Array<int, 1> pivots;            // (n,)
    Array<double, 1> rows, columns;  // (n,) factors from the equations' and to the unknowns' units
    Array<float, 3> slips;           // (S, 2 M, n), derivatives of the slips by the unknowns, in the units of these
    Array<double, 3> slopes;         // (S, M, SLOPES), those of the friction residual in the Jacobian
    Array<double, 3> present;        // (S, M, SLOPES), those with which the factors are corrected, see renewal.hpp
    Array<float, 2> spread, gather;  // (n, r) and (r, n), the correction: steps z become z - spread (gather z)

    auto fields() { return std::tie(lu, pivots, rows, columns, slips, slopes, present, spread, gather); }
    bool fits() const {
        long n = rows.size(), S = slopes.size(), M = slopes.shape[1], rank = gather.size();
        bool right = lu.shape == std::array{n, n} && pivots.size() == n && columns.size() == n &&
                     slips.shape == std::array{S, 2 * M, n} && slopes.shape == std::array{S, M, long(SLOPES)} &&
                     present.shape == slopes.shape && spread.shape == std::array{n, rank} &&
                     gather.shape == std::array{rank, n} && (S == 0 ? n == 0 : n % S == 0);
        for (int k : pivots) right = right && 0 <= k && k < n;
        return right;
    }
};

// Whether factors match a number of strips with some cells and unknowns each.
inline bool fit(const Factors& factors, long strips, long cells, long block) {
    return factors.rows.size() == strips * block && factors.slopes.size() == strips && factors.slopes.shape[1] == cells;
}

// Factors of a Jacobian, and whether the Jacobian is regular.
inline std::pair<bool, Factors> factorised(const Linearisation& at) {
    long S = at.slips.size(), n = at.jacobian.size(), block = n / S;
    Factors f{Array<float, 2>(n, n),
              Array<int, 1>(n),
              Array<double, 1>(n),
              Array<double, 1>(n),
              Array<float, 3>(at.slips.shape),
              at.slopes,
              at.slopes,
              Array<float, 2>(n, 0),
              Array<float, 2>(0, n)};
    for (long i = 0; i < n; ++i) {
        f.rows(i) = i % block < block - MOMENTS ? 1 / STRESS : 1 / GAP;
        f.columns(i) = i % block < block - 2 ? STRESS : LENGTH;
    }
    for (long i = 0; i < n; ++i) {
        auto to = f.lu[i];
        auto from = at.jacobian[i];
        for (long k = 0; k < n; ++k) to(k) = float(f.rows(i) * from(k) * f.columns(k));
    }
    for (long i = 0; i < S; ++i)
        for (long r = 0; r < at.slips.shape[1]; ++r) {
            auto to = f.slips[i][r];
            auto from = at.slips[i][r];
            for (long c = 0; c < n; ++c) to(c) = from(c) * float(f.columns(c));
        }
    bool regular = factorise<float>(f.lu, f.pivots);
    return {regular, f};
}

// Replace right-hand sides (k, n) by the solutions with factors that are not corrected.
inline void back_substitute(const Factors& factors, View<float, 2> right) {
    solve<float>(factors.lu, factors.pivots, right);
}

// Step (S, block) that cancels the linearised residual (S, block).
inline Array<double, 2> newton_step(const Factors& factors, Rows residual) {
    long n = factors.rows.size(), rank = factors.gather.size();
    Array<float, 2> scaled(1, n);
    auto solution = scaled[0];
    for (long k = 0; k < n; ++k) solution(k) = float(-factors.rows(k) * residual.data[k]);
    back_substitute(factors, scaled);
    if (rank) {
        Array<float, 1> gathered(rank);
        for (long r = 0; r < rank; ++r) gathered(r) = dot(factors.gather[r], solution);
        for (long k = 0; k < n; ++k) solution(k) -= dot(factors.spread[k], gathered);
    }
    Array<double, 2> step(residual.shape);
    for (long k = 0; k < n; ++k) step.data[k] = factors.columns(k) * solution(k);
    return step;
}

// Solutions (k, n) in double precision of the transposed equations for right-hand sides (k, n).
// The Jacobian (n, n) is that of factors that are not corrected. Iterative refinement: N. Higham, Accuracy and
// Stability of Numerical Algorithms, 2002, chapter 12.
inline Array<double, 2> solve_transposed(const Factors& factors, Rows jacobian, Rows right) {
    long sides = right.size(), n = right.shape[1];
    Array<double, 2> solution(sides, n), rest = Array<double, 2>::copy(right);
    Array<float, 2> change(sides, n);
    double before = 1.0;
    bool finite = true;
    for (int step = 0; step <= REFINEMENTS; ++step) {
        for (long i = 0; i < sides; ++i)
            for (long c = 0; c < n; ++c) change(i, c) = float(factors.columns(c) * rest(i, c));
        solve_transposed<float>(factors.lu, factors.pivots, change);
        double after = 0.0;
        for (long i = 0; i < sides; ++i) {
            double largest = 0.0, size = 0.0;
            for (long c = 0; c < n; ++c) {
                finite = finite && std::isfinite(change(i, c));
                solution(i, c) += factors.rows(c) * change(i, c);
                largest = std::max(largest, std::abs(solution(i, c) / factors.rows(c)));
                size = std::max(size, double(std::abs(change(i, c))));
            }
            if (largest > 0.0) after = std::max(after, size / largest);
        }
        // the error falls by as much as this change
        if (finite && step > 0 && after * after <= REFINED * before) return solution;
        before = after;
        for (long i = 0; i < sides; ++i) {
            auto left = rest[i];
            std::copy(right[i].begin(), right[i].end(), left.begin());
            for (long k = 0; k < n; ++k) {
                auto row = jacobian[k];
                double weight = solution(i, k);
                for (long c = 0; c < n; ++c) left(c) -= weight * row(c);
            }
        }
    }
    Array<double, 2> scaled(n, n);  // pivots of unscaled equations lose several digits
    for (long i = 0; i < n; ++i)
        for (long k = 0; k < n; ++k) scaled(i, k) = factors.rows(i) * jacobian(i, k) * factors.columns(k);
    for (long i = 0; i < sides; ++i)
        for (long c = 0; c < n; ++c) solution(i, c) = factors.columns(c) * right(i, c);
    solve_with<double>(scaled, solution, true);
    for (long i = 0; i < sides; ++i)
        for (long c = 0; c < n; ++c) solution(i, c) *= factors.rows(c);
    return solution;
}

}  // namespace wr
