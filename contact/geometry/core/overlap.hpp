// Texts on overlaps of a wheel and a rail that are not solved.
#pragma once
#include <cstdio>
#include <string>

#include "support/core/plane.hpp"

namespace wr {

inline const char* const TOO_DEEP = "the wheel lies inside the rail, too deep for a contact";
inline const char* const UNSOLVED = "beyond the part of its surface that carries contact points";

// Depth m of an overlap, its place m on the wheel's profile, and the reason.
inline std::string overlap_text(double depth, const Point<double>& place, const std::string& reason) {
    char text[160];
    std::snprintf(text, sizeof text,
                  "the wheel overlaps the rail %.3g mm deep at y = %.1f, z = %.1f mm of its profile, ", 1e3 * depth,
                  1e3 * place.y, 1e3 * place.z);
    return text + reason;
}

}  // namespace wr
