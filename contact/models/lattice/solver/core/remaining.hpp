// Penetration that remains on unloaded strips beside the loaded ones.
#pragma once
#include <tuple>

#include "support/core/arrays.hpp"

namespace wr {

// Remaining penetration of n unloaded strips on which it may be positive.
struct Remaining {
    bool inside = false;         // whether all points lie on the surfaces and in the tables
    Array<long, 1> strips;       // (n,) their numbers
    Array<double, 1> depth;      // (n,) m, its maximum along x
    Array<double, 1> place;      // (n,) m, of the maximum
    Array<double, 1> curvature;  // (n,) 1/m there
    Array<double, 1> half;       // (n,) m, half length of the probed range
    Array<double, 1> highest;    // (m,) m, estimated maximum on all m unloaded strips

    auto fields() { return std::tie(inside, strips, depth, place, curvature, half, highest); }
};

}  // namespace wr
