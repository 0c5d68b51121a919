// Texts on overlaps that are not solved.
#pragma once
#include <string>

#include "support/core/plane.hpp"
#include "support/core/text.hpp"

namespace wr {

inline const char* const TOO_DEEP = "the wheel lies inside the rail, too deep for a contact";
inline const char* const UNSOLVED = "beyond the part of its surface that carries contact points";

constexpr double TOUCHES = 1e-6;  // m, overlaps at which the search for a load ends where its solves begin to fail

// Depth m of an overlap, its place m on the wheel's profile, and the reason.
inline std::string overlap_text(double depth, const Point<double>& place, const std::string& reason) {
    std::string how = depth < TOUCHES ? "touches the rail" : text("overlaps the rail %.3g mm deep", 1e3 * depth);
    return "the wheel " + how + text(" at y = %.1f, z = %.1f mm of its profile, ", 1e3 * place.y, 1e3 * place.z) +
           reason;
}

// of the contact modulus: a patch on a sphere is then 0.3 times as wide as that, too wide for half-spaces
constexpr double LARGEST_PRESSURE = 0.19;

// Text on bodies with a contact modulus Pa that are pressed together by an approach m and a largest pressure Pa; empty
// where these are no reason not to solve.
inline std::string overloaded(double approach, double pressure, double modulus) {
    double highest = LARGEST_PRESSURE * modulus;
    if (!(pressure > highest)) return "";
    return text("the bodies overlap by %.3g mm, too deep for half-spaces: %.3g GPa are above %g E* = %.3g GPa",
                1e3 * approach, 1e-9 * pressure, LARGEST_PRESSURE, 1e-9 * highest);
}

}  // namespace wr
