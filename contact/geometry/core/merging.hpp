// Continuous merging of penetration maxima into one contact when close together, or when the minimum between vanishes,
// so that forces do not jump: they share its weight, and the region of each extends over the others.
#pragma once
#include <span>

#include "contact/geometry/core/rigid_search.hpp"

namespace wr {

constexpr double VIRTUAL =
    0.55;  // penetration of the virtual bodies over that of the elastic ones, Piotrowski, Kik 2008
constexpr double SEPARATION = 1.5;  // times the merging distance: two maxima further apart are separate contacts
constexpr int POWER = 4;            // of heights: of two maxima, twice as high above the minimum, the higher has 94 %
constexpr double LEAST_WEIGHT = 1e-4;  // of a contact: lower ones have none

// Smooth step (continuously differentiable) from 0 to 1 for t from 0 to 1.
template <class T>
T fade(const T& t) {
    if (!(value(t) > 0.0)) return T(0.0);
    if (value(t) >= 1.0) return T(1.0);
    return t * t * (3.0 - 2.0 * t);
}

// Row of the lowest minimum between two maxima.
template <class T>
long saddle_between(std::span<const Extremum<T>> low, long i, long j) {
    long lowest = std::min(i, j);
    for (long k = lowest; k < std::max(i, j); ++k)
        if (value(low[k].depth) < value(low[lowest].depth)) lowest = k;
    return lowest;
}

// How far two places at a distance m are separate contacts, 0 to 1.
template <class T>
T apart(const T& away, double merge) {
    return fade((away / merge - 1.0) / (SEPARATION - 1.0));
}

// Distance m of a place from another.
template <class T>
T distance(const T& a, const T& b) {
    return value(a) > value(b) ? a - b : b - a;
}

// Weights (k,) of maxima as contacts, 0 to 1. Maxima closer than merge m are one contact; low: the k - 1 minima
// between them.
//
// Maxima are joined at the minima between them, from the highest minimum down. Two groups share one contact in the
// ratio of the `POWER` of their heights above the minimum that joins them, and their joint height above it is the norm
// of both with this power. A maximum that has just appeared on a slope has no height above its minimum: neither it nor
// any other weight jumps. Sums of powers do not depend on the order in which minima of the same height are taken. From
// a maximum's own view another one counts as far as its own region, down to (1 - VIRTUAL) of its height, extends over
// the minimum, or as both are close: as much of it as `covered` has in the region, so that no load is counted twice.
template <class T>
std::vector<T> merging_weights(std::span<const Extremum<T>> top, std::span<const Extremum<T>> low, double merge) {
    long n = long(top.size());
    std::vector<T> weight(n, T(1.0));
    if (n <= 1) return weight;
    std::vector<T> share(weight), whole(n), own(n), part(n);
    std::vector<long> first(n), last(n);
    std::vector<bool> done(n);
    for (long i = 0; i < n; ++i) whole[i] = own[i] = top[i].depth, first[i] = last[i] = i;
    auto power = [](const T& height) {
        if (!(value(height) > 0.0)) return T(0.0);
        T squared = height * height;
        return squared * squared;
    };
    auto root = [](const T& sum) {
        using std::pow;
        return pow(sum, 1.0 / POWER);
    };
    for (long joined = 0; joined < n - 1; ++joined) {
        long k = -1;
        for (long j = 0; j < n - 1; ++j)
            if (!done[j] && (k < 0 || value(low[j].depth) > value(low[k].depth))) k = j;
        done[k] = true;
        T minimum = value(low[k].depth) > 0.0 ? low[k].depth : T(value(low[k].depth)), total(0.0);
        long start = first[k], middle = k + 1, stop = last[k + 1] + 1;
        for (long i = start; i < stop; ++i) {  // powers of heights, by maxima
            part[i] = share[i] * power(whole[i] - minimum);
            total += part[i];
        }
        for (long i = start; i < stop; ++i) {
            T before = power(own[i] - minimum), after = before, height = top[i].depth;
            T deep = fade((height - minimum) / (VIRTUAL * height));
            for (long j = i < middle ? middle : start; j < (i < middle ? stop : middle); ++j)
                after += (1.0 - deep * apart(distance(top[i].s, top[j].s), merge)) * part[j];
            if (value(after) > 0.0) {
                weight[i] *= before / after;
                own[i] = minimum + root(after);
            }
        }
        for (long i = start; i < stop; ++i) {
            first[i] = start, last[i] = stop - 1;
            if (value(total) > 0.0) share[i] = part[i] / total, whole[i] = minimum + root(total);
        }
    }
    for (long i = 0; i < n; ++i)
        weight[i] = value(weight[i]) > LEAST_WEIGHT ? (weight[i] - LEAST_WEIGHT) / (1.0 - LEAST_WEIGHT) : T(0.0);
    return weight;
}

// Whether the region of maximum k covers places around maximum j.
template <class T>
bool extends(std::span<const Extremum<T>> top, std::span<const Extremum<T>> low, long k, long j, double merge) {
    if (j == k) return true;
    double level = (1.0 - VIRTUAL) * value(top[k].depth), nearest = value(low[j > k ? j - 1 : j].s);
    bool open =
        value(low[saddle_between(low, k, j)].depth) > level || std::abs(nearest - value(top[k].s)) < SEPARATION * merge;
    return value(top[j].depth) > level && open;
}

// Virtual penetration m that a place behind a minimum has in the region of another maximum.
//
// Parameters: penetration m of the virtual bodies there; that at the lowest minimum on the way; distance m from the
// maximum of the region; places closer than merge m belong to the region. A place that is not higher than the minimum
// belongs to the region; the region ends where the minimum leaves it.
template <class T>
T covered(const T& depth, const T& valley, const T& away, double merge) {
    if (value(depth) <= 0.0 || value(valley) >= value(depth)) return depth;
    return depth * (1.0 - (1.0 - fade(valley / depth)) * apart(away, merge));
}

}  // namespace wr
