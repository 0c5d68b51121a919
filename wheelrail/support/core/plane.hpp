// Points and directions in the plane of a profile, of doubles or of numbers with derivatives.
#pragma once
#include <complex>

#include "support/core/dual.hpp"

namespace wr {

template <class T>
struct Point {
    T y{}, z{};
};

inline Point<double> point_of(const std::complex<double>& c) { return {c.real(), c.imag()}; }

template <class A, class B>
auto operator+(const Point<A>& a, const Point<B>& b) {
    return Point<decltype(a.y + b.y)>{a.y + b.y, a.z + b.z};
}
template <class A, class B>
auto operator-(const Point<A>& a, const Point<B>& b) {
    return Point<decltype(a.y - b.y)>{a.y - b.y, a.z - b.z};
}
template <class A, class B>
auto operator*(const A& s, const Point<B>& a) {
    return Point<decltype(s * a.y)>{s * a.y, s * a.z};
}
template <class A, class B>
auto dot(const Point<A>& a, const Point<B>& b) {
    return a.y * b.y + a.z * b.z;
}
// Sine of the angle from a to b, times their lengths.
template <class A, class B>
auto cross(const Point<A>& a, const Point<B>& b) {
    return a.y * b.z - a.z * b.y;
}
template <class T>
T squared(const Point<T>& a) {
    return a.y * a.y + a.z * a.z;
}
template <class T>
Point<double> value(const Point<T>& a) {
    return {value(a.y), value(a.z)};
}

}  // namespace wr
