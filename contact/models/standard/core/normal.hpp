// Pressure on strips along the rolling direction, semi-elliptic on each: of Hertz, or of Piotrowski and Kik.
#pragma once
#include <tuple>

#include "contact/models/standard/core/ellipse.hpp"
#include "contact/models/standard/core/regions.hpp"

namespace wr {

// Pressures on n strips of k contacts, contact by contact.
template <class T>
struct Pressures {
    Array<long, 1> contact;   // (n,), index of the contact
    Array<T, 1> s, x;         // (n,) m, middle of the strip: arc length on the upper body's profile, and along rolling
    Array<T, 1> width, half;  // (n,) m, width and half length
    Array<T, 1> scale;        // (n,) Pa/m; the pressure at x from the middle is scale sqrt(half^2 - x^2)
    Array<T, 1> load;         // (k,) N, normal force
    Array<T, 1> along, across;  // (k,) m, semi-axes of the ellipse with the pressure's second moments

    auto fields() { return std::tie(contact, s, x, width, half, scale, load, along, across); }
    bool fits() const {
        long n = contact.size(), k = load.size();
        bool right = along.size() == k && across.size() == k;
        for (const auto* a : {&s, &x, &width, &half, &scale}) right &= a->size() == n;
        for (long c : contact) right &= c >= 0 && c < k;
        return right;
    }
    Pressures() = default;
    Pressures(long n, long k) : contact(n), s(n), x(n), width(n), half(n), scale(n), load(k), along(k), across(k) {}
};

using StripPressures = Pressures<double>;

// One past the last strip of a contact, from its first one on.
template <class I>
long end_of(const I& contact, long start, long c) {
    while (start < contact.size() && contact(start) == c) ++start;
    return start;
}

// Centre s, x m and semi-axes m, along and across, of the Hertz ellipse with the first and second moments of strips.
template <class T>
struct Moments {
    T s{}, x{}, along{}, across{};
};

// Moments of the strips from start to before stop.
template <class T>
Moments<T> moments(const Pressures<T>& of, long start, long stop) {
    using std::sqrt;
    T total{}, first{}, first_x{}, second{}, along{};
    for (long i = start; i < stop; ++i) {
        T load = of.half(i) * of.half(i) * of.width(i);
        total += load, first += load * of.s(i), first_x += load * of.x(i);
        along += load * of.half(i) * of.half(i);
    }
    for (long i = start; i < stop; ++i) {
        T away = of.s(i) - first / total;
        second += of.half(i) * of.half(i) * of.width(i) * (away * away);
    }
    return {first / total, first_x / total, sqrt(1.25 * along / total), sqrt(5.0 * second / total)};
}

// Piotrowski and Kik's pressure on the interpenetration regions, with shape correction.
//
// The deflection at the deepest point equals the penetration there. An elliptic region is too slender: length and width
// are scaled about the centre of the normal force, at constant area, to the ratio of semi-axes that Hertz gives for the
// same curvatures. Non-elliptic regions by their second moments.
template <class T>
Pressures<T> virtual_penetration(const Regions<T>& zones, double E_star) {
    using std::sqrt, std::numbers::pi;
    long n = zones.s.size(), k = zones.peak.size(), start = 0;
    Pressures<T> p(n, k);
    for (long i = 0; i < n; ++i) {
        p.contact(i) = zones.contact(i), p.s(i) = zones.s(i), p.x(i) = zones.x(i), p.width(i) = zones.width(i);
        p.half(i) = sqrt(2.0 * zones.penetration(i) * zones.radius(i));
    }
    for (long c = 0; c < k; ++c) {
        long stop = end_of(zones.contact, start, c);
        auto [middle, middle_x, a, b] = moments(p, start, stop);
        T curvatures = (b / a) * (b / a);
        bool wide = value(curvatures) > 1.0;
        T hertz = axis_ratio(wide ? T(1.0 / curvatures) : curvatures);
        T stretch = sqrt((wide ? hertz : T(1.0 / hertz)) * b / a), volume{}, potential{};
        for (long i = start; i < stop; ++i) {
            T away = (p.s(i) - zones.peak(c)) / stretch;
            if (value(away) < 0.0) away = -away;
            p.s(i) = middle + (p.s(i) - middle) / stretch, p.x(i) = middle_x + (p.x(i) - middle_x) / stretch;
            p.half(i) = p.half(i) * stretch, p.width(i) = p.width(i) / stretch;
            volume += 0.5 * pi * p.half(i) * p.half(i) * p.width(i);
            potential += strip_potential(p.half(i), away) * p.width(i);
        }
        T scale = pi * E_star * zones.depth(c) / potential;
        for (long i = start; i < stop; ++i) p.scale(i) = scale;
        p.load(c) = scale * volume, p.along(c) = a * stretch, p.across(c) = b / stretch;
        start = stop;
    }
    return p;
}

// Hertz's pressure: the lateral curvature is that of the parabola whose interpenetration region has the same second
// moment.
inline StripPressures hertzian(const PenetrationRegions& zones, double E_star) {
    using std::numbers::pi;
    long k = zones.peak.size(), m = HALF, start = 0, n = 0;
    StripPressures p(2 * m * k, k), own(zones.s.size(), 0);
    for (long i = 0; i < zones.s.size(); ++i) {
        own.s(i) = zones.s(i), own.x(i) = zones.x(i), own.width(i) = zones.width(i);
        own.half(i) = std::sqrt(2.0 * zones.penetration(i) * zones.radius(i));
    }
    for (long c = 0; c < k; ++c) {
        long stop = end_of(zones.contact, start, c);
        double loads = 0.0, radius = 0.0;
        for (long i = start; i < stop; ++i) {
            double load = zones.penetration(i) * zones.radius(i) * zones.width(i);
            loads += load, radius += load * zones.radius(i);
        }
        radius /= loads;
        double wide = moments(own, start, stop).across, depth = zones.depth(c);
        auto [a, b, peak] = ellipse(0.5 / radius, VIRTUAL * depth / (wide * wide), depth, E_star);
        p.load(c) = 2.0 / 3.0 * pi * peak * a * b, p.along(c) = a, p.across(c) = b;
        for (double sign : {-1.0, 1.0})
            for (long q = 0; q < m; ++q, ++n) {
                double at = POSITIONS[q];
                p.contact(n) = c, p.s(n) = zones.peak(c) + sign * b * at, p.x(n) = zones.peak_x(c);
                p.width(n) = b * WIDTHS[q], p.half(n) = a * std::sqrt(1.0 - at * at);
                p.scale(n) = peak / a;
            }
        start = stop;
    }
    return p;
}

}  // namespace wr
