// Cells of the tables of pairs of strips along x, and the components that are tabulated.
#pragma once
#include <tuple>

#include "support/core/lanes.hpp"

namespace wr {

constexpr int CELLS = 8;  // an octave
constexpr int DEGREE = 5;
constexpr int COMPONENTS = LANES;
enum Component { XX, TT, NN, TN, TN_TURN, XT, ROLL, XN };
constexpr int EVEN = 5;         // components that are even functions of x, the first ones; the others are odd
constexpr double REACH = 0.25;  // m, longest distance along x
constexpr double START = 0.04;  // m: cells of 5 mm up to this distance; of 2.5 mm, forces change by 1e-6

}  // namespace wr
