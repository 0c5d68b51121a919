// Where the strips of a lattice touch at a pose, and which of them may come into contact.
#pragma once
#include <array>
#include <tuple>

#include "support/core/arrays.hpp"

namespace wr {

// Where K strips touch: on their middles, the points of largest penetration along x.
struct ContactLines {
    Array<double, 1> depth;      // (K,) m, penetration at their x, the mean over the width; -inf far from contact
    Array<double, 1> onset;      // (K,) m, mean gap of strips when they begin to touch at one edge
    Array<double, 1> whole;      // (K,) m, depth of the parabola along them when they touch on their whole width
    Array<double, 1> x;          // (K,) m, place along x of the largest penetration
    Array<double, 1> curvature;  // (K,) 1/m, relative curvature along x there
    Array<double, 1> foot;   // (K,) m, arc length of closest points on the lower body; NaN: the gap exceeds the margin
    Array<double, 2> level;  // (K, 3), longitudinal axis
    Array<bool, 1> covered;  // (K,) strips that the lines of both bodies carry
    // (K,) these and strips that penetrate: displacements may bring them into contact, for friction on a tread can
    // close the gap of a flange
    Array<bool, 1> near;
    Array<bool, 1> probed;           // (K,) strips near to contact to look at first, see `smallest_gaps`
    double approach = 0.0;           // m, the largest penetration
    std::array<double, 2> window{};  // m, range of x with possible contact, twice the region of penetration
    // m/s at which both materials flow backwards, the mean weighted by the squared penetration; 0 without penetration
    double speed = 0.0;

    auto fields() {
        return std::tie(depth, onset, whole, x, curvature, foot, level, covered, near, probed, approach, window, speed);
    }
    bool fits() const {
        long K = depth.size();
        return K > 0 && onset.size() == K && whole.size() == K && x.size() == K && curvature.size() == K &&
               foot.size() == K && level.shape == std::array{K, 3L} && covered.size() == K && near.size() == K &&
               probed.size() == K;
    }
};

}  // namespace wr
