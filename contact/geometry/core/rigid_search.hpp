// Contact points of a rigid wheel on a rigid rail: local maxima of the penetration profile, on the exact curves.
//
// The penetration is the depth of the wheel's lowest points below the rail's surface. Its slope is exact as well: that
// of the wheel's profile relative to the rail's normal. Maxima, minima and edges therefore do not depend on the initial
// sampling.
#pragma once
#include <span>
#include <vector>

#include "contact/geometry/core/lowest_point.hpp"

namespace wr {

constexpr double NEAR = -1e-4;  // m: sampled maxima lower than that are not refined
constexpr double CLOSE = 1e-9;  // m: smallest distance of a maximum and a minimum

// As `lowest`, of the line at s m on the wheel's profile.
inline Lowest deepest(const WheelRail& pair, const Pose<double>& pose, double s, double x, long sample) {
    return lowest(pair.rail, pair.radius, pose, local(pair.wheel, s), x, sample);
}

// Maximum or minimum of the penetration: position m on the wheel's profile, penetration m and place m along the rolling
// circle.
template <class T = double>
struct Extremum {
    T s{}, depth{}, x{};
};

// Where the slope changes its sign between low and high m, by false position (Illinois); rise, fall: slopes there; x,
// sample: initial guesses.
inline Extremum<> stationary_point(const WheelRail& pair, const Pose<double>& pose, double low, double high,
                                   double rise, double fall, double x, long sample) {
    double s = low, depth = 0.0;
    int side = 0;
    for (int n = 0; n < 80; ++n) {
        s = fall != rise ? high - fall * (high - low) / (fall - rise) : 0.5 * (low + high);
        s = std::min(std::max(s, low), high);
        auto at = deepest(pair, pose, s, x, sample);
        depth = at.depth, x = at.x, sample = at.sample;
        if (at.slope == 0.0 || high - low < 1e-14) break;
        double moved = 0.0;
        if ((at.slope > 0.0) == (rise > 0.0)) {
            moved = s - low, low = s, rise = at.slope;
            if (side == 1) fall *= 0.5;
            side = 1;
        } else {
            moved = high - s, high = s, fall = at.slope;
            if (side == -1) rise *= 0.5;
            side = -1;
        }
        if (moved < 1e-12) break;
    }
    return {s, depth, x};
}

// Position m at which the penetration equals a level m, by Newton's method with bounds m; `outer` if it is not less
// there. The level is exceeded at inner; the iteration starts at the outer bound, where the profile is steep. x,
// sample: initial guesses.
inline double level_crossing(const WheelRail& pair, const Pose<double>& pose, double inner, double outer, double level,
                             double x, long sample) {
    double s = outer;
    for (int n = 0; n < 60; ++n) {
        auto at = deepest(pair, pose, s, x, sample);
        x = at.x, sample = at.sample;
        if (at.depth >= level) {
            if (s == outer) return outer;
            inner = s;
        } else {
            outer = s;
        }
        double next = at.slope != 0.0 ? s - (at.depth - level) / at.slope : 0.5 * (inner + outer);
        if (!(std::min(inner, outer) <= next && next <= std::max(inner, outer))) next = 0.5 * (inner + outer);
        double moved = std::abs(next - s);
        s = next;
        if (moved < 1e-10) break;  // the next one is quadratic in it
    }
    return s;
}

// Penetration (n,) m at every line, its slope, x m, and the rail's nearest sample, -1 beside the rail.
struct Scan {
    Array<double, 1> depth, slope, x;
    Array<long, 1> sample;

    auto fields() { return std::tie(depth, slope, x, sample); }
    bool fits() const {
        long n = depth.size();
        return n > 0 && slope.size() == n && x.size() == n && sample.size() == n;
    }
    // Whether the samples belong to a rail.
    bool of(const Shape& rail) const {
        return std::all_of(sample.begin(), sample.end(), [&](long i) { return -1 <= i && i < rail.samples.size(); });
    }
};

// Positive maxima of the penetration, the minima between, the line before each maximum, and the largest penetration m.
// A gap between two maxima has the penetration 0.
struct Maxima {
    std::vector<Extremum<>> top, low;
    std::vector<long> before;
    double approach = 0.0;
};

// Way m from the first of two lines to where a slope that is quadratic between them is extreme: of the same sign at
// both, it may have the other one there. rise: of the penetration m over the distance m of the lines; NaN or outside
// without.
inline double turning(double first, double last, double rise, double away) {
    double bend = 6.0 * (rise / away - 0.5 * (first + last));
    return 0.5 * away * (1.0 + (last - first) / bend);
}

// Maxima on lines (m,) m, arc lengths on the wheel's profile, from their scan.
//
// Where slopes at two lines have the same sign, a maximum and a minimum may lie between them; the penetration there
// shows. Lines beside the rail have no slope.
inline Maxima local_maxima(const WheelRail& pair, const Pose<double>& pose, const Numbers& lines, const Scan& samples) {
    const auto& [depth, slope, where, sample] = samples;
    auto slope_at = [&](double s, long line) { return deepest(pair, pose, s, where(line), sample(line)).slope; };
    Maxima found;
    found.approach = *std::max_element(depth.begin(), depth.end());
    long n = lines.size();
    for (long i = 0; i < n - 1; ++i) {
        bool rises = slope(i) > 0.0, falls = 0.0 >= slope(i + 1);
        if (std::max(depth(i), depth(i + 1)) < NEAR || (!rises && !falls)) continue;
        long j = i, k = i + 1;
        double low = lines(j), high = lines(k), rise = 0.0, fall = 0.0;
        if (rises && falls) {
            rise = slope_at(low, j), fall = slope_at(high, k);
            if (rise <= 0.0 && j > 0) low = lines(--j), rise = slope_at(low, j);  // the samples are not accurate enough
            if (fall > 0.0 && k < n - 1) high = lines(++k), fall = slope_at(high, k);
        } else {
            double between = low + turning(slope(j), slope(k), depth(k) - depth(j), high - low);
            if (std::min(sample(j), sample(k)) < 0 || !(low < between && between < high)) continue;
            (rises ? high : low) = between;
            rise = slope_at(low, j), fall = slope_at(high, k);
        }
        if (!(rise > 0.0 && 0.0 >= fall)) continue;
        auto top = stationary_point(pair, pose, low, high, rise, fall, where(i), sample(i));
        if (!found.top.empty() && !(top.s > found.top.back().s + CLOSE)) continue;  // known from the line before
        found.approach = std::max(found.approach, top.depth);
        if (top.depth <= 0.0) continue;
        if (!found.top.empty()) {
            k = found.before.back() + 1;
            for (j = k; j <= i; ++j)
                if (depth(j) < depth(k)) k = j;
            auto& low = found.low.emplace_back();
            low = {lines(k), depth(k), where(k)};
            if (depth(k) > 0.0) {  // inside the region of penetration: refine it
                double left = std::max(lines(k - 1), found.top.back().s + CLOSE);
                double right = std::min(lines(k + 1), top.s - CLOSE);
                fall = slope_at(left, k), rise = slope_at(right, k);
                if (fall < 0.0 && 0.0 < rise)
                    low = stationary_point(pair, pose, left, right, fall, rise, where(k), sample(k));
            }
            low.depth = std::max(low.depth, 0.0);  // a gap, also where it lies between two lines
        }
        found.top.push_back(top), found.before.push_back(i);
    }
    return found;
}

}  // namespace wr
