// Values (S, block) of loaded strips, and their change by steps (S, block). Strip by strip: tractions Pa of the cells
// along and across (none without friction), amplitudes Pa of the pressure modes, and ends m.
#pragma once
#include <cmath>
#include <limits>

#include "contact/models/lattice/influence/core/basis.hpp"

namespace wr {

constexpr double SHORTEST = 0.02;   // of the squared half length, or of the load: the least that remains after one step
constexpr double LARGE_STEP = 0.5;  // step after which a negative load or squared length is no reason to leave
constexpr double VANISHED = 5e-3;   // half length over the largest one: of a penetration of some 1e-5 of the approach
constexpr double LONGEST = 3.0;     // largest relative growth of a squared half length in one step
constexpr double SHRUNK = 0.7;      // largest relative decrease of that of a long strip
constexpr double LEAST_PRESSURE = 1e3;  // Pa, to which steps are related at least
constexpr double INFINITE = std::numeric_limits<double>::infinity();

// Half the length m of strip i, or its change in a step.
inline double half_length(Rows values, long i) {
    long last = values.shape[1] - 1;
    return 0.5 * (values(i, last) - values(i, last - 1));
}

inline double longest_half(Rows values) {
    double largest = 0.0;
    for (long i = 0; i < values.size(); ++i) largest = std::max(largest, half_length(values, i));
    return largest;
}

// Factor of a load that touches on the whole width: its square root falls where it ends up below that. Where the
// penetration does not vary across, whole is zero, and at least SHORTEST of the load remains.
inline double remaining_load(double factor, double load, double whole) {
    if (whole == 0.0) return std::max(factor, SHORTEST);
    if (load * factor >= whole) return factor;
    double root = 0.5 + 0.5 * std::max(load * factor / whole, -1.0);
    return root * root * whole / load;
}

// Values after a fraction of a step; whole (S,) Pa m, loads on the whole width. The steps are taken in the squared half
// length and in loads per width, or in their roots where a strip touches on a part of its width: these are nearly
// linear in the penetration in excess.
inline Array<double, 2> moved(Rows values, Rows step, double factor, Numbers whole) {
    Array<double, 2> after(values.shape);
    long last = values.shape[1] - 1, first = last - 1 - MODES;
    for (long i = 0; i < values.size(); ++i) {
        auto from = values[i], by = step[i];
        auto to = after[i];
        double half = half_length(values, i), change = half_length(step, i);
        double load = from(first) * half, rise = factor * change / half, new_half = 0.0;
        double middle = 0.5 * (from(last) + from(last - 1) + factor * (by(last) + by(last - 1)));
        if (load < whole(i)) {
            new_half = half * std::max(1.0 + rise, std::sqrt(SHORTEST));
            for (long k = 0; k < last - 1; ++k) to(k) = from(k) + factor * by(k);
        } else {
            new_half = half * std::sqrt(std::max(remaining_load(1.0 + 2.0 * rise, load, whole(i)), SHORTEST));
            for (long k = 0; k < last - 1; ++k)
                to(k) = (from(k) * (half + factor * change) + factor * by(k) * half) / new_half;
            double rest = to(first) * new_half / load;
            to(first) = load * remaining_load(rest, load, whole(i)) / new_half;
        }
        to(last - 1) = middle - new_half, to(last) = middle + new_half;
    }
    return after;
}

// Pressure Pa and length m to which steps are related: the largest amplitude and half length.
struct Scales {
    double pressure = LEAST_PRESSURE, half = 0.0;

    explicit Scales(Rows values) : half(longest_half(values)) {
        long first = values.shape[1] - 2 - MODES;
        for (long i = 0; i < values.size(); ++i) pressure = std::max(pressure, std::abs(values(i, first)));
    }
};

struct Size {
    double largest = 0.0, norm = 0.0;
};

// Largest entry and norm of a step over the largest amplitude of the pressure, or half length. For the largest one
// entries are multiplied by the half length of their strip over the largest, as they count in its load: those of strips
// of micrometres are uncertain by round-off.
inline Size relative_size(Rows values, Rows step) {
    long last = values.shape[1] - 1;
    Scales scale(values);
    double largest = 0.0, total = 0.0;
    for (long i = 0; i < values.size(); ++i) {
        double weight = half_length(values, i) / scale.half;
        for (long k = 0; k <= last; ++k) {
            double part = std::abs(step(i, k)) / (k < last - 1 ? scale.pressure : scale.half);
            largest = std::max(largest, weight * part);
            total += part * part;
        }
    }
    return {std::isfinite(total) ? largest : INFINITE, std::sqrt(total)};
}

// That of two steps, of the norm of `relative_size`.
inline double inner_product(Rows values, Rows first, Rows second) {
    long last = values.shape[1] - 1;
    Scales scale(values);
    double stresses = 0.0, lengths = 0.0;
    for (long i = 0; i < values.size(); ++i) {
        for (long k = 0; k < last - 1; ++k) stresses += first(i, k) * second(i, k);
        for (long k = last - 1; k <= last; ++k) lengths += first(i, k) * second(i, k);
    }
    return stresses / (scale.pressure * scale.pressure) + lengths / (scale.half * scale.half);
}

// Strips (S,) that leave by a step of a relative size: with negative load or half length after a full step in the roots
// of `moved`, if it is a moderate one, as a step from a poor start overshoots, or if they have nearly vanished.
inline Array<bool, 1> leaving(Rows values, Rows step, double size, Numbers whole) {
    long S = values.size(), first = values.shape[1] - 2 - MODES;
    double largest = longest_half(values);
    Array<bool, 1> leaves(S);
    for (long i = 0; i < S; ++i) {
        double half = half_length(values, i), change = half_length(step, i);
        double amplitude = values(i, first), more = step(i, first), load = amplitude * half;
        bool vanishes = false;
        if (load < whole(i)) {
            vanishes = amplitude + more <= 0.0 || half + change <= 0.0;
        } else {
            double rest = std::min(load + more * half + amplitude * change, load * (1.0 + 2.0 * change / half));
            vanishes = rest <= -whole(i);
        }
        leaves(i) = vanishes && (size < LARGE_STEP || half < VANISHED * largest);
    }
    return leaves;
}

// Largest fraction of a step at which no strip moves by more than its length or grows too much.
inline double longest(Rows values, Rows step) {
    long last = values.shape[1] - 1;
    double largest = longest_half(values), limit = 1.0;
    for (long i = 0; i < values.size(); ++i) {
        double half = half_length(values, i), change = half_length(step, i);
        double away = 0.5 * std::abs(step(i, last) + step(i, last - 1)) / largest;
        double growth = half > 0.3 * largest ? 2.0 * std::max(change / LONGEST, -change / SHRUNK) / half : 0.0;
        limit = std::max({limit, growth, away});
    }
    return 1.0 / limit;
}

inline bool any(View<const bool, 1> mask) { return std::find(mask.begin(), mask.end(), true) != mask.end(); }

}  // namespace wr
