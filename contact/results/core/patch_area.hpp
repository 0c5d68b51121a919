// Area of a patch from the lengths of its strips, to second order in their widths.
#pragma once
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>

#include "support/core/arrays.hpp"

namespace wr {

constexpr long LEAST_STRIPS = 3;  // for a parabola across; of fewer, the area is that of whole strips

// Points on a strip from one end, of 2, and their shares in the area: Gauss's rule in the angle of a half circle.
struct AreaRule {
    static constexpr int POINTS = 12;
    std::array<double, POINTS> rise, share;

    AreaRule() {
        constexpr double place[POINTS / 2] = {0.12523340851146897, 0.36783149899818013, 0.5873179542866175,
                                              0.7699026741943047,  0.9041172563704749,  0.9815606342467192};
        constexpr double weight[POINTS / 2] = {0.2491470458134026,  0.2334925365383547,  0.20316742672306573,
                                               0.16007832854334608, 0.10693932599531782, 0.04717533638651319};
        for (int k = 0; k < POINTS; ++k) {
            int n = k < POINTS / 2 ? POINTS / 2 - 1 - k : k - POINTS / 2;
            double angle = 0.5 * std::numbers::pi * ((k < POINTS / 2 ? -place[n] : place[n]) + 1.0);
            rise[k] = 1.0 - std::cos(angle), share[k] = 0.25 * std::numbers::pi * weight[n] * std::sin(angle);
        }
    }
};

// A parabola a y^2 + b y + c.
struct SquareParabola {
    double a, b, c;

    // First root on the outer half of a strip with the sides -side and side m, or beyond; else the side.
    double end(double side) const {
        double under = b * b - 4.0 * a * c;
        if (under < 0.0 || (a == 0.0 && b == 0.0)) return side;
        double far = -0.5 * (b + std::copysign(std::sqrt(under), b));  // without cancellation
        double nearest = std::numeric_limits<double>::infinity();
        for (auto [top, base] : {std::pair{far, a}, std::pair{c, far}})
            if (base != 0.0 && -side < top / base && top / base < 3.0 * side) nearest = std::min(nearest, top / base);
        return std::isfinite(nearest) ? nearest : side;
    }
    SquareParabola mirrored() const { return {a, -b, c}; }
};

// Parabola within strip i, from its middle, by the means over the strip and the nearest two: squares (S,) m2 of the
// lengths of adjacent strips with lateral bounds (S + 1,) m. Its integral interpolates sums: divided differences.
inline SquareParabola square_within(Numbers square, Numbers bounds, long i) {
    long at = std::min(std::max(i - 1, 0L), square.size() - 3);
    double origin = 0.5 * (bounds(i) + bounds(i + 1));
    double s0 = bounds(at) - origin, s1 = bounds(at + 1) - origin, s2 = bounds(at + 2) - origin,
           s3 = bounds(at + 3) - origin, first = square(at), rise = (square(at + 1) - first) / (s2 - s0);
    double bend = ((square(at + 2) - square(at + 1)) / (s3 - s1) - rise) / (s3 - s0);
    double slope = 2.0 * (rise - bend * (s0 + s1 + s2));
    return {3.0 * bend, slope, first - rise * (s0 + s1) + bend * (s0 * s1 + s0 * s2 + s1 * s2)};
}

// Area m2 of S adjacent strips: squares (S,) m2 of their lengths, and their lateral bounds (S + 1,) m.
//
// The square of the length is a parabola for an ellipse, and that of a strip its mean over the width, continued beyond
// the lateral end of the contact, where it is negative. It is interpolated by parabolas with these means; the contact
// ends at their root in an outer strip, or in the unloaded one next to it.
inline double patch_area(Numbers square, Numbers bounds) {
    static const AreaRule rule;
    long S = square.size();
    double total = 0.0;
    if (S < LEAST_STRIPS) {
        for (long i = 0; i < S; ++i) total += std::sqrt(std::max(square(i), 0.0)) * (bounds(i + 1) - bounds(i));
        return total;
    }
    for (long i = 0; i < S; ++i) {
        auto of = square_within(square, bounds, i);
        double half = 0.5 * (bounds(i + 1) - bounds(i));
        double low = i == 0 ? -of.mirrored().end(half) : -half, high = i == S - 1 ? of.end(half) : half;
        for (int k = 0; k < AreaRule::POINTS; ++k) {  // the parabola may vanish at either end
            double y = low + 0.5 * (high - low) * rule.rise[k];
            total += (high - low) * rule.share[k] * std::sqrt(std::max((of.a * y + of.b) * y + of.c, 0.0));
        }
    }
    return total;
}

// Lateral ends m of the contact, in motion over the outer strips rather than at their bounds.
inline std::array<double, 2> lateral_ends(Numbers square, Numbers bounds) {
    long S = square.size();
    if (S < LEAST_STRIPS) return {bounds(0), bounds(S)};
    auto middle = [&](long i) { return 0.5 * (bounds(i) + bounds(i + 1)); };
    auto half = [&](long i) { return 0.5 * (bounds(i + 1) - bounds(i)); };
    return {middle(0) - square_within(square, bounds, 0).mirrored().end(half(0)),
            middle(S - 1) + square_within(square, bounds, S - 1).end(half(S - 1))};
}

// Area m2 of stick zones from squares (S,) m2 of their lengths in adjacent strips, zero under slip, with lateral bounds
// (S + 1,) m.
inline double stick_area(Numbers square, Numbers bounds) {
    double total = 0.0;
    for (long i = 0, first = 0; i <= square.size(); ++i)
        if (i == square.size() || square(i) == 0.0) {
            total += patch_area(square.part(first, i), bounds.part(first, i + 1));
            first = i + 1;
        }
    return total;
}

}  // namespace wr
