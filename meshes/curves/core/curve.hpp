// Curves of piecewise polynomials in arc length, and their closest points.
#pragma once
#include <complex>
#include <limits>
#include <tuple>

#include "support/core/arrays.hpp"

namespace wr {

// A curve of m pieces, for the core.
struct Shape {
    Numbers breaks;                              // (m + 1,) m, arc length of the ends of the pieces
    Numbers middles;                             // (m,) m
    View<const std::complex<double>, 3> table;   // (m, 3, 8), coefficients of y + iz and its first two derivatives
    Numbers samples;                             // (n,) m, arc length
    View<const std::complex<double>, 1> sampled; // (n,) m, points y + iz there
    bool hollow = false;                         // whether it turns back by more than a groove: several closest points

    auto fields() { return std::tie(breaks, middles, table, samples, sampled, hollow); }
    bool fits() const {
        long m = middles.size();
        return m > 0 && breaks.size() == m + 1 && table.shape == std::array<long, 3>{m, 3, 8} && samples.size() > 0 &&
               samples.size() == sampled.size();
    }
};

}  // namespace wr
