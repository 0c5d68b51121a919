// Patches of contacts on strips.
#pragma once
#include <numeric>

#include "contact/models/standard/core/forces.hpp"

namespace wr {

constexpr double LEAST_LENGTH = 0.01;  // of the semi-axis along x: shorter strips are no part of a patch

// Number (k,) of the patch of each contact, with weights (k,), by decreasing load: contacts whose pressures overlap
// share one.
inline Array<long, 1> patch_numbers(const StripPressures& strips, const Numbers& weight) {
    long k = weight.size();
    constexpr double INFINITE = std::numeric_limits<double>::infinity();
    std::vector<double> first(k, INFINITE), last(k, -INFINITE), load(k);
    std::vector<long> order(k);
    Array<long, 1> patch(k);
    std::iota(patch.begin(), patch.end(), 0L), std::iota(order.begin(), order.end(), 0L);
    for (long i = 0; i < strips.s.size(); ++i)
        if (long c = strips.contact(i); strips.half(i) > LEAST_LENGTH * strips.along(c))
            first[c] = std::min(first[c], strips.s(i)), last[c] = std::max(last[c], strips.s(i));
    for (long c = 0; c < k; ++c)
        for (long other = 0; other < c; ++other)
            if (first[c] < last[other] && first[other] < last[c])
                std::replace(patch.begin(), patch.end(), long(patch(c)), long(patch(other)));
    for (long c = 0; c < k; ++c) load[patch(c)] += strips.load(c) * weight(c);
    std::stable_sort(order.begin(), order.end(), [&](long a, long b) { return load[a] > load[b]; });
    std::vector<long> rank(k);
    for (long place = 0; place < k; ++place) rank[order[place]] = place;
    for (long& own : patch) own = rank[own];
    return patch;
}

// Largest pressure Pa of a contact along the line s m, linear between its strips; 0 beyond them.
inline double pressure_at(const StripPressures& strips, long contact, double s) {
    constexpr double INFINITE = std::numeric_limits<double>::infinity();
    double below = -INFINITE, above = INFINITE, low = 0.0, high = 0.0;
    for (long i = 0; i < strips.s.size(); ++i) {
        if (strips.contact(i) != contact) continue;
        double at = strips.s(i), peak = strips.scale(i) * strips.half(i);
        if (below < at && at <= s) below = at, low = peak;
        if (s <= at && at < above) above = at, high = peak;
    }
    if (below == above) return low;
    return std::isfinite(above - below) ? low + (high - low) * (s - below) / (above - below) : 0.0;
}

// Largest pressure Pa along strip i: of contacts that are about to merge, and press on the same places, the sum; weights
// (k,) of the contacts, and patch (k,) of each.
inline double joint_pressure(const StripPressures& strips, const Numbers& weight, const Indices& patch, long i) {
    long own = strips.contact(i);
    double total = strips.scale(i) * strips.half(i), joint = weight(own) * total;
    bool alone = true;
    for (long c = 0; c < weight.size(); ++c)
        if (c != own && patch(c) == patch(own)) joint += weight(c) * pressure_at(strips, c, strips.s(i)), alone = false;
    return alone ? total : joint;
}

}  // namespace wr
