// First contact of the strips of a lattice at a pose, and the strips that may come into contact.
#pragma once
#include <array>
#include <vector>

#include "contact/geometry/core/surface.hpp"
#include "contact/models/lattice/influence/core/pair_tables.hpp"
#include "contact/models/lattice/system/core/partial_width.hpp"

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
    // (K,) covered strips and strips that penetrate, as displacements may bring more into contact: friction on a tread
    // can close the gap of a flange
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

// Penetrating strips (K,) and, near to contact (K,), the strips at the smallest gap and their neighbours.
inline Array<bool, 1> smallest_gaps(Numbers depth, View<const bool, 1> near) {
    long K = depth.size();
    Array<bool, 1> probed(K);
    for (long k = 0; k < K; ++k) {
        long before = std::max(k - 1, 0L), after = std::min(k + 1, K - 1);
        bool smallest = near(k) && depth(k) >= depth(before) && depth(k) >= depth(after);
        if (smallest || depth(k) > 0.0)
            for (long m = before; m <= after; ++m) probed(m) = probed(m) || near(m);
    }
    return probed;
}

// Numbers of the strips that may penetrate: around those, some strips apart, whose gap is smaller than the margin m.
inline std::vector<long> strips_in_sight(const SurfaceData& surface, const Pose<double>& pose, Numbers middle,
                                         double margin, long apart) {
    long K = middle.size();
    std::vector<long> probes;
    probes.reserve((K + apart - 2) / apart + 1);
    for (long k = 0; k < (K + apart - 2) / apart + 1; ++k) probes.push_back(std::min(k * apart, K - 1));
    auto depth = std::get<0>(crests(surface, pose, taken(middle, probes))).depth;
    Array<bool, 1> own(K);
    for (long k = 0; k < depth.size(); ++k)
        for (long m = std::max(probes[k] - apart, 0L); depth(k) > -margin && m <= std::min(probes[k] + apart, K - 1);
             ++m)
            own(m) = true;
    return numbers_of(own);
}

// Ends m of the range of x of `ContactLines`; zeros where no strip is probed.
inline std::array<double, 2> contact_window(const ContactLines& at) {
    double low = std::numeric_limits<double>::infinity(), high = -low;
    for (long k : numbers_of(at.probed)) {
        double half = std::sqrt(2.0 * std::max(at.depth(k), 0.0) / at.curvature(k));
        low = std::min(low, at.x(k) - half), high = std::max(high, at.x(k) + half);
    }
    if (!std::isfinite(low)) return {0.0, 0.0};
    return {1.5 * low - 0.5 * high, 1.5 * high - 0.5 * low};
}

// `ContactLines` of the strips of a lattice; margin m: largest gap between strips that matter; apart: strips between
// those at which the penetration is estimated first.
inline ContactLines contact_lines(const SurfaceData& surface, const Motion& motion, const Lattice& lattice,
                                  double margin, long apart) {
    const auto& [middle, width] = std::tie(lattice.middle, lattice.width);
    long K = middle.size();
    auto pose = motion.pose();
    ContactLines at;
    for (Array<double, 1>* of : {&at.depth, &at.x, &at.curvature, &at.foot}) *of = Array<double, 1>(K);
    std::fill(at.depth.begin(), at.depth.end(), -std::numeric_limits<double>::infinity());
    std::fill(at.curvature.begin(), at.curvature.end(), 1.0);
    std::fill(at.foot.begin(), at.foot.end(), std::numeric_limits<double>::quiet_NaN());
    at.level = Array<double, 2>(K, 3), at.covered = Array<bool, 1>(K), at.near = Array<bool, 1>(K);

    auto inside = strips_in_sight(surface, pose, middle, margin, apart);
    auto [closest, crest, bend] = crests(surface, pose, taken(middle, inside));
    long n = crest.size();
    Array<double, 1> s(2 * n), along(2 * n);
    for (long k = 0; k < 2 * n; ++k) {
        s(k) = middle(inside[k / 2]) + double(2 * (k % 2) - 1) * GAUSS * width(inside[k / 2]);
        along(k) = crest(k / 2);
    }
    auto sides = penetration(surface, pose, s, along).depth;
    std::vector<long> touching;
    for (long k = 0; k < n; ++k) {
        long i = inside[k];
        at.depth(i) = 0.5 * (sides(2 * k) + sides(2 * k + 1));
        at.x(i) = crest(k), at.curvature(i) = bend(k);
        if (at.depth(i) > -margin) at.foot(i) = closest.foot(k), touching.push_back(i);
    }
    double total = 0.0, weights = 0.0;
    auto velocities = motion.velocities();
    Walk walk(surface);
    for (long i : touching) {
        auto on = place_at(walk, pose, middle(i), at.x(i));
        at.level(i, 0) = on.forward.x, at.level(i, 1) = on.forward.y, at.level(i, 2) = on.forward.z;
        double deep = std::max(at.depth(i), 0.0), weight = deep * deep * width(i);
        total -= weight * shift_at(on.point, on.forward, on.lateral(), on.forward, velocities).flow;
        weights += weight;
    }
    std::tie(at.onset, at.whole) = partial_widths(at.depth, at.curvature, middle, width).fields();
    for (long k = 0; k < K; ++k) {
        double half = 0.5 * width(k);
        at.covered(k) =
            lattice.carried(k) && at.foot(k) - half >= lattice.bounds(0) && at.foot(k) + half <= lattice.bounds(1);
        at.near(k) = at.covered(k) || at.depth(k) > 0.0;
    }
    at.probed = smallest_gaps(at.depth, at.near);
    at.approach = *std::max_element(at.depth.begin(), at.depth.end());
    at.window = contact_window(at);
    at.speed = weights > 0.0 ? total / weights : 0.0;
    return at;
}

}  // namespace wr
