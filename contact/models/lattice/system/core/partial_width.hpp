// Strips that touch on a part of their width, and the gap that is left on the rest.
//
// At a lateral end of a contact the surfaces separate like y^(3/2), with the distance y, and the load per width rises
// like y (Johnson, Contact Mechanics, 1985, sec. 4.2). Over a strip of width w that touches on the part c of it the
// load is c^2 of that at c = 1, and the mean gap (1 - c)^(5/2) of that at c = 0, its onset. Both follow from the
// undeformed penetration, as those of an ellipse with its end in the strip.
#pragma once
#include <cmath>
#include <numbers>

#include "support/core/arrays.hpp"
#include "support/core/dual.hpp"

namespace wr {

// mean over w of (2 sqrt(2) / 3) y^(3/2) at a unit curvature and distance to the end
inline const double ONSET = 4.0 * std::sqrt(2.0) / 15.0;
// exponent of the ratio of curvatures in that of the semi-axes: Hamrock, Brewe 1983
constexpr double SLENDER = 2.0 / std::numbers::pi;
constexpr double LEAST_PART = 1e-10;  // touching part in the derivative of the gap, which is infinite at none
constexpr double OPENING = 2.5;       // exponent of the gap
constexpr int BISECTIONS = 20;

// Slope and second derivative at the middle of three places, from values there and the distances before and after.
template <class T>
struct Parabola {
    T slope, bend;

    Parabola(const T* values, double before, double after) {
        T first = (values[1] - values[0]) / before, second = (values[2] - values[1]) / after;
        slope = (first * after + second * before) / (before + after);
        bend = 2.0 * (second - first) / (before + after);
    }
};

// Of a strip: mean gap m when it begins to touch at one edge, and the depth m of the parabola along it when it touches
// on its whole width; both zero where the penetration does not vary across.
template <class T>
struct PartialWidth {
    T onset{}, whole{};

    // Penetration m of the strip and the next ones, at places (3) m across; curvature 1/m along x; width m. With the
    // variation v = w dd/ds of the penetration d the end of a circle is 2 w d / v away. Across a maximum or a saddle v
    // is the width of a uniform distribution with the variance of a parabola.
    PartialWidth(const T* depth, double curvature, const double* middle, double width) {
        using std::sqrt, std::pow;
        Parabola<T> across(depth, middle[1] - middle[0], middle[2] - middle[1]);
        if (!std::isfinite(value(across.slope)) || !std::isfinite(value(across.bend))) return;
        T fall = across.slope * width, turn = across.bend * (width * width);
        T square = fall * fall + turn * turn / 60.0;
        if (!(value(square) > 0.0)) return;
        T variation = sqrt(square), distance = sqrt(square + 4.0 * (depth[1] * depth[1]));
        T ratio = curvature * (width * width) * distance / square;
        T slender = ratio / sqrt(1.0 + ratio * ratio);  // beyond a sharp end the gap is not larger than at a circle's
        onset = ONSET * variation * sqrt(variation / distance) * pow(slender, 1.0 - SLENDER);
        whole = 0.5 * variation * pow(ratio, 1.0 - 2.0 * SLENDER);
    }
};

struct PartialWidths {
    Array<double, 1> onset, whole;  // (K,) m

    auto fields() { return std::tie(onset, whole); }
};

// `PartialWidth` of strips, from their undeformed penetration depth (K,) m, -inf far from contact, relative curvature
// (K,) 1/m along x, middle and width (K,) m.
inline PartialWidths partial_widths(Numbers depth, Numbers curvature, Numbers middle, Numbers width) {
    long K = depth.size();
    PartialWidths all{Array<double, 1>(K), Array<double, 1>(K)};
    for (long k = 1; k < K - 1; ++k) {
        PartialWidth<double> at(depth.part(k - 1, k + 2).data, curvature(k), middle.part(k - 1, k + 2).data, width(k));
        all.onset(k) = at.onset, all.whole(k) = at.whole;
    }
    return all;
}

struct PartialWidthChanges {
    Array<double, 2> onset, whole;  // (S, n), relative

    auto fields() { return std::tie(onset, whole); }
};

// Relative derivatives of `partial_widths`. From the penetration depth and places middle (S, 3) m of strips and the
// next ones on either side, curvature (S,) 1/m, width (S,) m, and derivatives change (S, 3, n) of the penetration.
inline PartialWidthChanges partial_width_changes(Rows depth, Numbers curvature, Rows middle, Numbers width,
                                                 Blocks change) {
    long S = depth.size(), n = change.shape[2];
    PartialWidthChanges all{Array<double, 2>(S, n), Array<double, 2>(S, n)};
    for (long i = 0; i < S; ++i) {
        using D = Dual<3>;
        D of[3];
        for (int k = 0; k < 3; ++k) of[k] = variable<D>(depth(i, k), k);
        PartialWidth<D> at(of, curvature(i), middle[i].data, width(i));
        for (long j = 0; j < n; ++j)
            for (int k = 0; k < 3; ++k) {
                all.onset(i, j) += at.onset.d[k] / at.onset.v * change(i, k, j);
                all.whole(i, j) += at.whole.d[k] / at.whole.v * change(i, k, j);
            }
    }
    return all;
}

struct Opening {
    double gap, slope;
};

// Mean gap m left on a strip, and its derivative by the load, continued to negative loads of trial states: load Pa m,
// amplitude times half length; onset m; whole Pa m, the load on the whole width. The slope is infinite at no load,
// where it is held by LEAST_PART.
inline Opening opening(double load, double onset, double whole) {
    if (load >= whole || whole == 0.0) return {0.0, 0.0};
    double part = std::copysign(std::max(std::sqrt(std::abs(load) / whole), LEAST_PART), load);
    double rest = onset * std::pow(1.0 - part, OPENING - 1.0);
    return {rest * (1.0 - part), -0.5 * OPENING * rest / (std::abs(part) * whole)};
}

// Derivatives m of the gap by relative changes of onset and whole, for a load below the latter: it depends on the load
// over whole.
struct OpeningChanges {
    double onset, whole;

    OpeningChanges(double load, double onset_, double whole_) {
        auto at = opening(load, onset_, whole_);
        onset = at.gap, whole = -load * at.slope;
    }
};

// Touching part of a width, or root of the load relative to the whole width if larger. depth: penetration m without
// load, where the strip begins to touch. compliance: displacement m under the load on the whole width. Root c of depth
// - onset - compliance c^2 + onset (1 - c)^(5/2), which falls with c, by bisection.
inline double pressed(double depth, double compliance, double onset) {
    double excess = depth - onset;
    if (excess >= compliance) return std::sqrt(std::max(excess, 0.0) / compliance);
    double low = 0.0, high = 1.0;
    for (int n = 0; n < BISECTIONS; ++n) {
        double c = 0.5 * (low + high);
        (excess - compliance * c * c + onset * std::pow(1.0 - c, OPENING) < 0.0 ? high : low) = c;
    }
    return high;
}

}  // namespace wr
