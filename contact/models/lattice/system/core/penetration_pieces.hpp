// Pieces of the undeformed penetration with one maximum each, on the exact profiles.
#pragma once
#include <utility>
#include <vector>

#include "contact/geometry/core/surface.hpp"
#include "support/core/interpolation.hpp"

namespace wr {

constexpr int SAMPLES = 4;  // in a strip, between which maxima of the penetration are sought
constexpr int ROOT_STEPS = 60;
constexpr double ROOT_ERROR = 1e-12;  // m
constexpr int PARABOLAS = 4;          // to an extremum, each over a tenth of the last one's width

// Penetration of the wheel's and the rail's lines, less a lift: places of lines, and values there, both (R,) m.
struct LiftedPenetration {
    const SurfaceData& surface;
    Pose<double> pose;
    Numbers lines, lift;

    // Largest one m along x on lines (n,) m, and where (n,) m; closest points (n,) m of the rail.
    struct Crests {
        Array<double, 1> depth, x, foot;
    };
    Crests on(Numbers s) const {
        auto [at, x, bend] = crests(surface, pose, s);
        for (long i = 0; i < s.size(); ++i) at.depth(i) -= interpolated(s(i), lines, lift);
        return {at.depth, x, at.foot};
    }
    double operator()(double s) const { return on({&s, {1}}).depth(0); }

    // Bound m of a region of penetration between a line inside and a line outside, by the Illinois method.
    double edge(double inside, double outside) const {
        double f = (*this)(inside), g = (*this)(outside);
        int kept = 0;
        for (int n = 0; n < ROOT_STEPS; ++n) {
            if (std::abs(outside - inside) < ROOT_ERROR || g == 0.0) break;
            double s = std::isfinite(g) ? inside + (outside - inside) * f / (f - g) : 0.5 * (inside + outside);
            double h = (*this)(s);
            if (std::abs(h) < ROOT_ERROR * ROOT_ERROR) return s;
            if (h > 0.0) {
                inside = s, f = h;
                if (kept == 1) g *= 0.5;
                kept = 1;
            } else {
                outside = s, g = h;
                if (kept == -1) f *= 0.5;
                kept = -1;
            }
        }
        return inside;
    }

    // Place m of a maximum (sign 1) or minimum (-1) near a line s m, by parabolas over a span m.
    double extremum(double s, double span, double sign) const {
        for (int n = 0; n < PARABOLAS; ++n) {
            double before = sign * (*this)(s - span), at = sign * (*this)(s), after = sign * (*this)(s + span);
            double bend = before - 2.0 * at + after;
            if (!(bend < 0.0 && std::isfinite(bend))) break;
            s += span * std::min(std::max(0.5 * (before - after) / bend, -1.0), 1.0);
            span *= 0.1;
        }
        return s;
    }
};

// A piece of the penetration with one maximum: bounds m, and whether it continues the last one across a saddle.
struct Piece {
    double low, high;
    bool continues;
};

// Append the pieces between lines s (n,) m.
inline void add_maxima(const LiftedPenetration& depth, Numbers s, std::vector<Piece>& found) {
    auto d = depth.on(s).depth;
    long n = s.size();
    for (long k = 0; k < n; ++k) {
        if (d(k) > 0.0) {
            double low = k > 0 ? depth.edge(s(k), s(k - 1)) : s(k);
            bool continues = false;
            while (k + 1 < n && d(k + 1) > 0.0) {
                ++k;
                if (!(k + 1 < n && d(k) <= d(k - 1) && d(k) < d(k + 1))) continue;
                double saddle = depth.extremum(s(k), 0.5 * (s(k + 1) - s(k - 1)), -1.0);
                if (!(low < saddle && saddle < s(k + 1))) continue;
                if (depth(saddle) > 0.0) {
                    found.push_back({low, saddle, continues});
                    low = saddle, continues = true;
                } else {
                    found.push_back({low, depth.edge(s(k - 1), saddle), continues});
                    low = depth.edge(s(k + 1), saddle), continues = false;
                }
            }
            found.push_back({low, k < n - 1 ? depth.edge(s(k), s(k + 1)) : s(k), continues});
        } else if (0 < k && k < n - 1 && d(k) >= d(k - 1) && d(k) > d(k + 1)) {
            double top = depth.extremum(s(k), 0.5 * (s(k + 1) - s(k - 1)), 1.0);
            if (s(k - 1) < top && top < s(k + 1) && depth(top) > 0.0)
                found.push_back({depth.edge(top, s(k - 1)), depth.edge(top, s(k + 1)), false});
        }
    }
}

// Pieces of the undeformed penetration with one maximum each, in order.
// middle, width: (K,) m, of the strips. mean: (K,) m, penetration less the lift.
inline std::vector<Piece> maxima(const LiftedPenetration& depth, Numbers middle, Numbers width, Numbers mean) {
    long K = middle.size();
    std::vector<bool> sought(K, false);
    for (long k = 0; k < K; ++k) {
        long before = std::max(k - 1, 0L), after = std::min(k + 1, K - 1);
        // a sharp maximum may penetrate where the mean over the strip does not
        bool highest = std::isfinite(mean(k)) && mean(k) >= mean(before) && mean(k) >= mean(after);
        if (mean(k) > 0.0 || highest)
            for (long m = before; m <= after; ++m) sought[m] = true;
    }
    std::vector<Piece> found;
    for (long start = 0, end = 0; start < K; start = end) {
        for (end = start; end < K && sought[end]; ++end);
        if (end == start) {
            ++end;
            continue;
        }
        Array<double, 1> s((end - start) * SAMPLES + 1);
        for (long n = 0; n < s.size() - 1; ++n) {
            long i = start + n / SAMPLES;
            s(n) = middle(i) + (double(n % SAMPLES) / SAMPLES - 0.5) * width(i);
        }
        s(s.size() - 1) = middle(end - 1) + 0.5 * width(end - 1);
        add_maxima(depth, s, found);
    }
    return found;
}

}  // namespace wr
