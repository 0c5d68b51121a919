// Gap of the undeformed surfaces of a wheel and a rail: the smallest distance of their points, always a number.
#pragma once
#include "contact/geometry/core/line_scan.hpp"

namespace wr {

constexpr double GOLDEN = 0.6180339887498949;  // (sqrt(5) - 1) / 2
constexpr double SAMPLED = 1e-6;               // m, error of the gap on sampled lines
constexpr int SECTIONS = 28;                   // of an interval of two lines, down to 1e-9 m

// The largest penetration between two positions m, from guesses of x and of the rail's nearest sample: where its slope
// vanishes, or, as at corners, by golden sections if that finds no more than a guess m of the penetration.
inline Extremum<> largest(const WheelRail& pair, const Pose<double>& pose, double low, double high, double x,
                          long sample, double least) {
    double rise = deepest(pair, pose, low, x, sample).slope, fall = deepest(pair, pose, high, x, sample).slope;
    if (rise > 0.0 && 0.0 > fall) {
        auto found = stationary_point(pair, pose, low, high, rise, fall, x, sample);
        if (found.depth >= least) return found;
    }
    double step = GOLDEN * (high - low), left = high - step, right = low + step;
    auto a = deepest(pair, pose, left, x, -1), b = deepest(pair, pose, right, x, -1);
    for (int n = 0; n < SECTIONS; ++n) {
        step *= GOLDEN;
        if (a.depth > b.depth) {
            high = right, right = left, b = a;
            left = high - step;
            a = deepest(pair, pose, left, x, -1);
        } else {
            low = left, left = right, a = b;
            right = low + step;
            b = deepest(pair, pose, right, x, -1);
        }
    }
    return a.depth > b.depth ? Extremum<>{left, a.depth, a.x} : Extremum<>{right, b.depth, b.x};
}

// Where the penetration is largest; separated surfaces have minus their gap. part: the lines that may overlap the rail;
// samples: their scan.
inline Extremum<> nearest_place(const WheelRail& pair, const Pose<double>& pose, const Lines& lines, Part part,
                                Scan samples) {
    const Numbers& s = lines.s;
    auto highest_of = [&] {
        auto looked = samples.depth.part(part.first, part.second);
        return *std::max_element(looked.begin(), looked.end());
    };
    double highest = highest_of();
    if (highest < 0.0)  // others may be nearer
        if (Part near = lines_to_scan(lines, pair.radius, pose, -highest); near != part) {
            part = near, samples = scan(pair.rail, lines, pair.radius, pose, near);
            highest = highest_of();
        }
    const auto& depth = samples.depth;
    Extremum<> found{0.0, -std::numeric_limits<double>::infinity(), 0.0};
    for (long i = part.first; i < part.second; ++i) {
        long before = std::max(i - 1, part.first), after = std::min(i + 1, part.second - 1);
        // the penetration changes by at most the way along the profile
        if (!(depth(i) >= std::max(std::max(depth(before), depth(after)), highest - (s(after) - s(before))))) continue;
        auto own = largest(pair, pose, s(before), s(after), samples.x(i), samples.sample(i), depth(i) - SAMPLED);
        if (own.depth > found.depth) found = own;
    }
    return found;
}

}  // namespace wr
