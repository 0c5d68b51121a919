// Hertz's ellipse, and elliptic integrals for ellipses and strips of pressure.
#pragma once
#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <type_traits>

#include "support/core/dual.hpp"

namespace wr {

// Complete elliptic integrals K and D = (K - E) / (1 - k^2).
template <class T>
struct Complete {
    T K, D;
};

// Integrals of the complementary modulus k, 0 < k <= 1, by the arithmetic-geometric mean, without cancellation at k =
// 1.
template <class T>
Complete<T> complete(const T& k) {
    using std::sqrt;
    constexpr bool derives = !std::is_same_v<T, double>;  // derivatives converge one step after the values
    T a(1.0), g = k, m = (1.0 - k) * (1.0 + k), total(0.5);
    double weight = 1.0;
    for (int n = 0; n < 40; ++n) {
        T c = 0.5 * (a - g);
        bool last = value(c) <= 1e-17 * value(a);
        if (last && !derives) break;
        if (derives && n == 0)  // (1 - k) / 2 squared over m, at k = 1 too
            total += 0.25 * (1.0 - k) / (1.0 + k);
        else
            total += weight * c * c / m;
        T before = a;
        a = 0.5 * (a + g), g = sqrt(before * g), weight *= 2.0;
        if (last) break;
    }
    T K = 0.5 * std::numbers::pi / a;
    return {K, K * total};
}

// Semi-axes short / long of the patch from the coefficients A / B <= 1 of the gap A x^2 + B y^2.
// Johnson 1985, eq. 4.26, by secant steps on a nearly straight line between logarithms.
inline double axis_ratio(double curvatures) {
    if (curvatures >= 1.0) return 1.0;
    double target = std::log(std::max(curvatures, 1e-12)), u0 = 0.0, f0 = -target, u1 = 0.66 * target;
    for (int n = 0; n < 30; ++n) {
        auto [K, D] = complete(std::exp(u1));
        double f1 = 2.0 * u1 + std::log(D / (K - D)) - target;
        if (std::abs(f1) < 1e-14 || u1 == u0 || f1 == f0) break;
        double next = std::min(u1 - f1 * (u1 - u0) / (f1 - f0), -1e-16);
        u0 = u1, f0 = f1, u1 = next;
    }
    return std::exp(u1);
}

// With derivatives: of the implicit function, whose slope is that of the line above.
template <int N>
Dual<N> axis_ratio(const Dual<N>& curvatures) {
    double k = axis_ratio(curvatures.v);
    auto [K, D] = complete(variable<Dual<1>>(k, 0, k));  // by the logarithm of k
    double slope = 2.0 + log(D / (K - D)).d[0];
    return curvatures.chain(k, k / (slope * curvatures.v));
}

// Semi-axes a, b m and peak pressure Pa. From coefficients A, B 1/m of the gap A x^2 + B y^2, the approach m and E* Pa.
inline std::array<double, 3> ellipse(double A, double B, double approach, double E_star) {
    double k = axis_ratio(std::min(A, B) / std::max(A, B));
    auto [K, D] = complete(k);
    double E = K - (1.0 - k * k) * D;
    double longer = std::sqrt(approach * E / (k * k * (A + B) * K));
    double peak = (A + B) * longer * k * E_star / E;
    if (A <= B) return {longer, k * longer, peak};
    return {k * longer, longer, peak};
}

// Potential of a strip's pressure at a lateral distance away m: the integral m over x of
// sqrt(half^2 - x^2) / sqrt(x^2 + away^2).
template <class T>
T strip_potential(const T& half, const T& away) {
    using std::sqrt;
    if (value(half) <= 0.0) return T(0.0);
    T reach = sqrt(half * half + away * away), modulus = away / reach, D;
    if (!(value(modulus) > 1e-12)) modulus = T(1e-12);
    if constexpr (std::is_same_v<T, double>) {
        D = complete(modulus).D;
    } else {
        auto own = complete(variable<Dual<1>>(value(modulus), 0)).D;
        D = modulus.chain(own.v, own.d[0]);
    }
    return 2.0 * (half / reach) * half * D;
}

}  // namespace wr
