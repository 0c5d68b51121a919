// Interpenetration regions of two bodies as contacts, each divided into strips.
#pragma once
#include <tuple>

#include "contact/geometry/core/interpenetration.hpp"

namespace wr {

// Contacts (k,) and their transverse strips (n,), contact by contact.
template <class T>
struct Regions {
    Array<T, 1> peak, peak_x;  // (k,) m, position of the maximum on the upper body's profile, and along rolling
    Array<T, 1> depth;         // (k,) m, penetration
    Array<T, 1> weight;        // (k,), weight of the contact, 0 to 1
    Array<long, 1> contact;    // (n,), contact of each strip
    Array<T, 1> s, x;          // (n,) m, position on the upper body
    Array<T, 1> width;         // (n,) m
    Array<T, 1> penetration;   // (n,) m, of the virtual bodies
    Array<T, 1> radius;        // (n,) m, along x

    auto fields() { return std::tie(peak, peak_x, depth, weight, contact, s, x, width, penetration, radius); }
    bool fits() const {
        long k = peak.size(), n = contact.size();
        bool right = peak_x.size() == k && depth.size() == k && weight.size() == k;
        for (const auto* a : {&s, &x, &width, &penetration, &radius}) right &= a->size() == n;
        for (long c : contact) right &= c >= 0 && c < k;
        return right;
    }
    Regions() = default;
    Regions(long n, long k)
        : peak(k), peak_x(k), depth(k), weight(k), contact(n), s(n), x(n), width(n), penetration(n), radius(n) {}
};

using PenetrationRegions = Regions<double>;

// Penetration regions of a wheel on a rail.
inline PenetrationRegions penetration_regions(const WheelRegions& found) {
    const auto& [contacts, strips] = std::tie(found.contacts, found.strips);
    PenetrationRegions zones(strips.size(), contacts.size());
    for (long c = 0; c < contacts.size(); ++c) {
        zones.peak(c) = contacts(c, 0), zones.peak_x(c) = contacts(c, 1), zones.depth(c) = contacts(c, 2);
        zones.weight(c) = contacts(c, 3);
    }
    for (long i = 0; i < strips.size(); ++i) {
        zones.contact(i) = found.contact(i), zones.s(i) = strips(i, 0), zones.x(i) = strips(i, 1);
        zones.width(i) = strips(i, 2), zones.penetration(i) = strips(i, 3), zones.radius(i) = strips(i, 4);
    }
    return zones;
}

// Place of a curve at an s m that varies; its bend does not.
template <class T>
OnCurve<T> at_place(const OnCurve<double>& at, const T& s) {
    return {{s.chain(at.point.y, at.tangent.y), s.chain(at.point.z, at.tangent.z)},
            {s.chain(at.tangent.y, at.bend.y), s.chain(at.tangent.z, at.bend.z)},
            {T(at.bend.y), T(at.bend.z)}};
}
template <class T>
OnCurve<T> at_place(const Shape& shape, const T& s) {
    return at_place(local(shape, value(s)), s);
}

}  // namespace wr
