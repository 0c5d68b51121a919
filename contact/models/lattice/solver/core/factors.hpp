// LU factors of the Jacobian of a contact on a lattice, in single precision.
//
// With scaled unknowns and equations the Jacobian's condition is some 1e3, so that steps err by some 1e-6 of
// themselves. Residuals are exact: steps converge to the same solution, and factors take half of the time and memory.
#pragma once
#include "contact/models/lattice/system/core/equation_data.hpp"

namespace wr {

// Factors of the Jacobian (n, n) of a state with values (S, block), in units of STRESS, LENGTH and GAP.
struct Factors {
    Array<float, 2> lu;              // (n, n), of the transpose, column by column
    Array<int, 1> pivots;            // (n,) of LAPACK, from 1
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
        for (int k : pivots) right = right && 1 <= k && k <= n;
        return right;
    }
};

// Addresses of functions of LAPACK: LU factors in single precision, and solution with them.
struct Lapack {
    long sgetrf = 0, sgetrs = 0;

    auto fields() { return std::tie(sgetrf, sgetrs); }
};

}  // namespace wr
