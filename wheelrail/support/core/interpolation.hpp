// Linear interpolation, and searches in ascending numbers.
#pragma once
#include <algorithm>

#include "support/core/arrays.hpp"
#include "support/core/dual.hpp"

namespace wr {

// Segment of ascending places (n,) around x, or at an end: number of its first place, 0 to n - 2.
inline long segment(Numbers places, double x) {
    long after = std::upper_bound(places.begin(), places.end(), x) - places.begin();
    return std::clamp(after - 1, 0L, std::max(places.size() - 2, 0L));
}

// Value at x, linear between ascending places (n,), constant beyond the ends.
template <class T>
T interpolated(const T& x, Numbers places, Numbers values) {
    long last = places.size() - 1;
    if (value(x) <= places(0)) return T(values(0));
    if (value(x) >= places(last)) return T(values(last));
    long k = segment(places, value(x));
    double slope = (values(k + 1) - values(k)) / (places(k + 1) - places(k));
    return slope * (x - places(k)) + values(k);
}

}  // namespace wr
